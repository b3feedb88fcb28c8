//! Spheres around the equal parts of a box (the joint-space paper, sections VI.C and VII).

use elbowroom_spatial::Vec3;

use crate::cuboid::Bisection;

/// Equal parts of a box around the origin.
#[derive(Debug, Clone)]
pub(crate) struct SphereLattice {
    half: Vec3,
    part_half: Vec3,
    centres: Vec<Vec3>,
    is_whole: bool,
}

impl SphereLattice {
    /// Bisects a box with these half edge lengths (m) across the longest edge, until it has `count` parts or more.
    pub fn new(half: Vec3, count: u32) -> Self {
        let (mut part_half, mut centres) = (half, vec![Vec3::ZERO]);
        while centres.len() < count as usize {
            let Bisection { offset, half } = Bisection::new(part_half);
            centres = centres.into_iter().flat_map(|at| [at + offset, at - offset]).collect();
            part_half = half;
        }
        Self { half, part_half, centres, is_whole: true }
    }

    /// Leaves out the parts for which `holds` is false; it gets the centre and the half edge lengths.
    pub fn retain(&mut self, mut holds: impl FnMut(Vec3, Vec3) -> bool) {
        let before = self.centres.len();
        self.centres.retain(|&centre| holds(centre, self.part_half));
        self.is_whole &= self.centres.len() == before;
    }

    /// Centre and radius of the sphere around each part. If no part was left out, one sphere replaces all those in the
    /// middle, as many as a sphere within the box encloses.
    pub fn spheres(&self) -> Vec<(Vec3, f64)> {
        let radius = self.part_half.length();
        let Some(inner) = self.inner().filter(|_| self.is_whole) else {
            return self.centres.iter().map(|&centre| (centre, radius)).collect();
        };
        let is_inner = |centre: Vec3| (0..3).all(|i| centre[i].abs() < inner[i]);
        let outer = self.centres.iter().filter(|&&centre| !is_inner(centre)).map(|&centre| (centre, radius));
        std::iter::once((Vec3::ZERO, inner.length())).chain(outer).collect()
    }

    /// Half edge lengths of the largest block of parts in the middle that a sphere within the box encloses: as many layers
    /// less on all sides as necessary.
    fn inner(&self) -> Option<Vec3> {
        let within = self.half.x.min(self.half.y).min(self.half.z);
        let without = |layers: f64| self.half - self.part_half * (2.0 * layers);
        // Half a part is a tolerance for rounding.
        let has_parts = |inner: &Vec3| (0..3).all(|i| inner[i] > 0.5 * self.part_half[i]);
        let mut blocks = (1..).map(|layers| without(f64::from(layers))).take_while(has_parts);
        blocks.find(|inner| inner.length() <= within).filter(|inner| inner.length() > 1.5 * self.part_half.length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spheres_enclose_the_box_and_no_more_than_those_of_all_parts() {
        for (half, count, spheres) in [
            // The paper's example: of 64 spheres 8 are enclosed, and one replaces them.
            (Vec3::splat(1.0), 64, 57),
            (Vec3::splat(1.0), 8, 8),
            (Vec3::splat(1.0), 512, 449),
            (Vec3::new(1.0, 1.1, 1.0), 64, 57),
            (Vec3::new(4.0, 0.3, 0.3), 16, 16),
            (Vec3::new(1.0, 1.0, 0.0), 16, 16),
        ] {
            let lattice = SphereLattice::new(half, count);
            let (parts, merged) = (lattice.part_half.length(), lattice.spheres());
            assert_eq!((lattice.centres.len(), merged.len()), (count as usize, spheres), "{half:?}");
            let mut random = elbowroom_testkit::random::SplitMix(7);
            for _ in 0..20_000 {
                let p = Vec3::from([0, 1, 2].map(|i| random.between(-1.5 * half[i] - 0.1, 1.5 * half[i] + 0.1)));
                let is_in_merged = merged.iter().any(|(at, radius)| at.distance(p) <= radius * (1.0 + 1e-12));
                let is_in_box = (0..3).all(|i| p[i].abs() <= half[i]);
                let is_in_parts = lattice.centres.iter().any(|at| at.distance(p) <= parts * (1.0 + 1e-12));
                assert!((is_in_merged || !is_in_box) && (is_in_parts || !is_in_merged), "{p:?} of {half:?}");
            }
        }
        let mut some = SphereLattice::new(Vec3::splat(1.0), 64);
        some.retain(|centre, _| centre.x > 0.0);
        assert_eq!(some.spheres().len(), 32);
    }
}
