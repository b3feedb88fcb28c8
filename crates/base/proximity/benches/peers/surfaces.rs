//! Surfaces with known numbers of triangles: tubes with round ends, and knots.

use std::f64::consts::TAU;

use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::SplitMix;

/// Vertices and triangles, outward.
pub type Surface = (Vec<Vec3>, Vec<[u32; 3]>);

/// Ripples over a surface: relative change of the radius, at most `amplitude`.
struct Ripples(Vec<[f64; 5]>);

impl Ripples {
    fn new(random: &mut SplitMix, waves: usize, amplitude: f64) -> Self {
        let mut wave = |_| {
            let turns = [1 + random.below(5), 1 + random.below(6)].map(|n| n as f64 * TAU);
            let height = random.between(0.3, 1.0) * amplitude / waves as f64;
            [turns[0], random.between(0.0, TAU), turns[1], random.between(0.0, TAU), height]
        };
        Self((0..waves).map(&mut wave).collect())
    }

    /// The ripple at a place; `along` and `around` run from 0 to 1.
    fn at(&self, along: f64, around: f64) -> f64 {
        let wave = |w: &[f64; 5]| w[4] * (w[0] * along + w[1]).sin() * (w[2] * around + w[3]).sin();
        1.0 + self.0.iter().map(wave).sum::<f64>()
    }
}

/// A tube with round ends.
pub struct Tube<'a> {
    /// The axis as a function of a parameter from 0 to 1.
    pub axis: &'a dyn Fn(f64) -> Vec3,
    /// Radius along the axis, metres.
    pub radius: &'a dyn Fn(f64) -> f64,
    /// Flanges: place along the axis, half width, height (metres).
    pub flanges: &'a [[f64; 3]],
    /// Largest relative height of the ripples.
    pub ripple: f64,
    /// Number of rings; the tube has `2 · rings · sectors` triangles.
    pub rings: usize,
    pub sectors: usize,
}

impl Tube<'_> {
    /// The closed surface, of genus 0.
    pub fn surface(&self, random: &mut SplitMix) -> Surface {
        let ripples = Ripples::new(random, 8, self.ripple);
        let mut vertices = vec![(self.axis)(0.0)];
        let mut side = Vec3::X;
        for ring in 0..self.rings {
            let along = (ring as f64 + 0.5) / self.rings as f64;
            let (center, tangent) = ((self.axis)(along), self.tangent(along));
            // The side of the last ring is made perpendicular again, so that the rings do not twist.
            side = (side - tangent * side.dot(tangent)).try_normalize().unwrap_or(tangent.any_perpendicular());
            let radius = self.outline(along);
            let point = |around, height| ring_point(center, [side, tangent.cross(side)], around, height);
            for sector in 0..self.sectors {
                let around = sector as f64 / self.sectors as f64;
                vertices.push(point(around, radius * ripples.at(along, around)));
            }
        }
        vertices.push((self.axis)(1.0));
        (vertices, tube_triangles(self.rings, self.sectors))
    }

    fn tangent(&self, along: f64) -> Vec3 {
        let (before, after) = ((along - 1e-4).max(0.0), (along + 1e-4).min(1.0));
        ((self.axis)(after) - (self.axis)(before)).try_normalize().unwrap_or(Vec3::Z)
    }

    /// The radius with flanges, rounded off over the last sixth at both ends.
    fn outline(&self, along: f64) -> f64 {
        let flange = |f: &[f64; 3]| f[2] * (-((along - f[0]) / f[1]).powi(4)).exp();
        let full = (self.radius)(along) + self.flanges.iter().map(flange).sum::<f64>();
        let in_from_end = (6.0 * along.min(1.0 - along)).min(1.0);
        full * (in_from_end * (2.0 - in_from_end)).sqrt()
    }
}

fn ring_point(center: Vec3, [x, y]: [Vec3; 2], around: f64, radius: f64) -> Vec3 {
    center + x * (radius * (around * TAU).cos()) + y * (radius * (around * TAU).sin())
}

fn tube_triangles(rings: usize, sectors: usize) -> Vec<[u32; 3]> {
    let at = |ring: usize, sector: usize| (1 + ring * sectors + sector % sectors) as u32;
    let last = (1 + rings * sectors) as u32;
    let mut triangles = Vec::with_capacity(2 * rings * sectors);
    for s in 0..sectors {
        triangles.push([0, at(0, s + 1), at(0, s)]);
        for r in 1..rings {
            triangles.push([at(r - 1, s), at(r - 1, s + 1), at(r, s)]);
            triangles.push([at(r - 1, s + 1), at(r, s + 1), at(r, s)]);
        }
        triangles.push([last, at(rings - 1, s), at(rings - 1, s + 1)]);
    }
    triangles
}

/// A rippled tube along a trefoil knot: closed, genus 1, `2 · rings · sectors` triangles.
pub fn trefoil(scale: f64, tube: f64, ripple: f64, rings: usize, sectors: usize, random: &mut SplitMix) -> Surface {
    let ripples = Ripples::new(random, 10, ripple);
    let knot = |t: f64| {
        let t = t * TAU;
        Vec3::new(t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos(), -(3.0 * t).sin()) * (scale / 1.5)
    };
    let mut vertices = Vec::with_capacity(rings * sectors);
    for ring in 0..rings {
        let along = ring as f64 / rings as f64;
        let tangent = (knot(along + 1e-5) - knot(along - 1e-5)).try_normalize().unwrap_or(Vec3::X);
        // The knot never runs along z: this frame closes without a twist.
        let up = (Vec3::Z - tangent * tangent.z).try_normalize().unwrap_or(Vec3::X);
        for sector in 0..sectors {
            let around = sector as f64 / sectors as f64;
            let radius = tube * ripples.at(along, around);
            vertices.push(ring_point(knot(along), [up, tangent.cross(up)], around, radius));
        }
    }
    let at = |ring: usize, sector: usize| ((ring % rings) * sectors + sector % sectors) as u32;
    let quad = |(r, s): (usize, usize)| {
        [[at(r, s), at(r, s + 1), at(r + 1, s)], [at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)]]
    };
    let all = (0..rings).flat_map(|r| (0..sectors).map(move |s| (r, s)));
    (vertices, all.flat_map(quad).collect())
}
