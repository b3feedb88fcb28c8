//! Two boxes: the 15 separating axes of Romanelli 2011, eqs. 12-13 (Gottschalk, Lin, Manocha, "`OBBTree`", 1996).

use elbowroom_spatial::{Pose, Vec3};

use crate::Cuboid;

/// Gap along one of the 15 axes; a positive gap proves the boxes to be apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AxisGap {
    /// Gap along the unit axis, metres.
    pub gap: f64,
    /// Unit vector from b to a, frame of b.
    pub axis: Vec3,
}

/// The axis of the largest gap, or of the least overlap. Pairs of edges that are too parallel to give an axis are
/// skipped: the normals of their faces cover them.
pub(crate) fn best_axis(a: &Cuboid, b: &Cuboid, a_in_b: &Pose) -> AxisGap {
    let (r, t) = (a_in_b.rotation, a_in_b.translation);
    let u = [r.x_axis(), r.y_axis(), r.z_axis()];
    let (ha, hb) = (a.half_extents, b.half_extents);
    let gap_along = |axis: Vec3| {
        let reach_a = ha.x * u[0].dot(axis).abs() + ha.y * u[1].dot(axis).abs() + ha.z * u[2].dot(axis).abs();
        t.dot(axis).abs() - reach_a - hb.dot(axis.abs())
    };
    let mut best = AxisGap { gap: f64::NEG_INFINITY, axis: Vec3::X };
    let mut offer = |axis: Vec3| {
        let gap = gap_along(axis);
        if gap > best.gap {
            best = AxisGap { gap, axis: if t.dot(axis) < 0.0 { -axis } else { axis } };
        }
    };
    for e in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().chain(u) {
        offer(e);
    }
    for e in u {
        for axis in [Vec3::new(0.0, -e.z, e.y), Vec3::new(e.z, 0.0, -e.x), Vec3::new(-e.y, e.x, 0.0)] {
            let length = axis.length();
            if length > 1e-6 {
                offer(axis / length);
            }
        }
    }
    best
}
