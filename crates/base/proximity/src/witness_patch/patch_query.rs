//! Witness points on a pair of nearly parallel faces.

use elbowroom_spatial::Vec3;

use super::polygon::Polygon;

/// The direction and the anchor by which pairs of faces are compared.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchQuery {
    /// Unit vector from the first shape to the second.
    pub direction: Vec3,
    /// Largest height of the first shape along the direction, and smallest height of the second.
    pub ends: [f64; 2],
    /// The tolerance [`PatchTolerances::tie`].
    pub tolerance: f64,
    /// The anchor: of all pairs of points, the nearest to it is returned.
    pub anchor: Vec3,
}

/// A pair of witness points on two faces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchPoints {
    pub on_a: Vec3,
    pub on_b: Vec3,
    /// Extent of the patch in which the faces overlap.
    pub patch_size: f64,
}

impl PatchQuery {
    /// True if a polygon of the first shape with these corners has a point within the tolerance of its end.
    pub fn reaches_top(&self, corners: [Vec3; 3]) -> bool {
        corners.iter().any(|p| p.dot(self.direction) >= self.ends[0] - self.tolerance)
    }

    /// The pair of points, one on each face, that are within the tolerance of the ends, opposite each other, and nearest
    /// to the anchor.
    pub fn closest_points(&self, of_a: &Polygon, of_b: &Polygon) -> Option<PatchPoints> {
        let top = of_a.clipped(-self.direction, self.tolerance - self.ends[0]);
        if top.is_empty() {
            return None;
        }
        let bottom = of_b.clipped(self.direction, self.ends[1] + self.tolerance);
        let patch = top.overlap(&bottom, self.direction, self.tolerance);
        let on_a = patch.nearest(self.anchor)?;
        let on_b = bottom.nearest(on_a + self.direction * (self.ends[1] - self.direction.dot(on_a)))?;
        Some(PatchPoints { on_a, on_b, patch_size: patch.size() })
    }
}

/// The direction with the largest gap between the ends.
pub(crate) fn widest_gap(directions: impl IntoIterator<Item = Vec3>, ends: &dyn Fn(Vec3) -> [f64; 2]) -> Option<Vec3> {
    let gap = |d: &Vec3| ends(*d)[1] - ends(*d)[0];
    directions.into_iter().max_by(|d, e| gap(d).total_cmp(&gap(e)))
}

/// Moves a point of the patch to closest points nearby, by alternating projections. They remove the deviation that
/// the tie tolerance allowed for inclined faces, and leave the points unchanged for parallel faces.
pub(crate) fn alternating_projections(
    on_a: Vec3,
    onto_a: &dyn Fn(Vec3) -> Vec3,
    onto_b: &dyn Fn(Vec3) -> Vec3,
) -> (Vec3, Vec3) {
    let mut on_a = on_a;
    for _ in 0..3 {
        on_a = onto_a(onto_b(on_a));
    }
    (on_a, onto_b(on_a))
}

/// The anchor between two centres, near the centre of the smaller shape; continuous in all arguments and symmetric.
pub(crate) fn anchor_between(a: Vec3, radius_a: f64, b: Vec3, radius_b: f64) -> Vec3 {
    let (wa, wb) = (radius_b * radius_b, radius_a * radius_a);
    let sum = wa + wb;
    if sum > 0.0 { a * (wa / sum) + b * (wb / sum) } else { a }
}
