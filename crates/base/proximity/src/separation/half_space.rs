//! Gap of a shape and a half-space: the height of its lowest point (Romanelli 2011, eqs. 7-8 for the box).

use elbowroom_spatial::{Pose, Vec3};

use super::core::Core;
use super::gap::{Gap, rounding};

/// Normals closer to opposite than this count as opposite.
const PARALLEL: f64 = 1e-14;

/// The gap from the lowest point of the core and its projection onto the plane, in the frame of the half-space.
#[inline]
pub(super) fn core_half_space(a: &Core, a_in_b: &Pose) -> Gap {
    let down = -a_in_b.inverse_transform_vector(Vec3::Z);
    let lowest = a_in_b.transform_point(a.support(down));
    let t = a_in_b.translation.abs();
    above(lowest, t.x + t.y + t.z + a.size())
}

/// The gap from the lowest point; the solid is `z <= 0` in its frame.
#[inline]
pub(super) fn above(lowest: Vec3, scale: f64) -> Gap {
    let height = lowest.z;
    let projected = Vec3::new(lowest.x, lowest.y, height.min(0.0));
    let distance = height.max(0.0);
    Gap { distance, apart: distance, lower: (height - rounding(scale)).max(0.0), on_a: lowest, on_b: projected }
}

/// The gap of two half-spaces, which are apart only if they face each other exactly.
pub(super) fn half_space_half_space(a_in_b: &Pose) -> Gap {
    let normal = a_in_b.rotation.z_axis();
    let p = a_in_b.translation;
    if normal.z < 0.0 && normal.x.abs().max(normal.y.abs()) < PARALLEL {
        return above(p, p.x.abs() + p.y.abs() + p.z.abs());
    }
    // Move against both normals at once until the point is below the second plane as well.
    let down = -(normal + Vec3::Z);
    let shared = if p.z > 0.0 { p + down * (p.z / (1.0 + normal.z)) } else { p };
    let shared = if shared.is_finite() { shared } else { p };
    Gap::touching(shared, shared)
}
