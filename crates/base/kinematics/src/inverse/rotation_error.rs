//! The orientation error of a pose.

use elbowroom_spatial::{Rotation, Vec3};

/// The rotation vector, in the outer frame, that rotates `current` into `wanted`. Exact to rounding even for tiny angles.
pub fn rotation_error(current: Rotation, wanted: Rotation) -> Vec3 {
    let (mut sine, mut trace) = (Vec3::ZERO, 0.0);
    for i in 0..3 {
        sine += current.axis(i).cross(wanted.axis(i)) * 0.5;
        trace += current.axis(i).dot(wanted.axis(i));
    }
    let cosine = 0.5 * (trace - 1.0);
    let length = sine.length();
    if cosine < -0.99 {
        return (wanted * current.inverse()).to_rotation_vector();
    }
    if length < 1e-9 { sine } else { sine * (length.atan2(cosine) / length) }
}
