//! Target point and target normal as goals of a search.

use elbowroom_spatial::{Pose, Vec3};

use crate::inverse::goal::Goal;

/// The goal of the point alone: three equations.
#[derive(Debug, Clone, Copy)]
pub struct PositionGoal {
    pub target: Vec3,
    pub tolerance_m: f64,
    /// Length (m) whose error counts as much as one radian.
    pub scale: f64,
}

impl Goal<3> for PositionGoal {
    type Linearization = ();

    fn linearize(&self, _: &Pose) {}

    #[inline]
    fn error(&self, tip_in_root: &Pose) -> [f64; 3] {
        self.jacobian_column(&(), self.target - tip_in_root.translation, Vec3::ZERO)
    }

    #[inline]
    fn jacobian_column(&self, (): &(), linear: Vec3, _: Vec3) -> [f64; 3] {
        (linear / self.scale).to_array()
    }

    #[inline]
    fn is_met(&self, e: &[f64; 3]) -> bool {
        Vec3::from(*e).length() * self.scale <= self.tolerance_m
    }
}

/// The goal of the point and the direction of its normal: five equations.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceGoal {
    pub position: PositionGoal,
    pub normal_in_tip: Vec3,
    pub wanted_in_root: Vec3,
    pub tolerance_rad: f64,
}

/// A unit normal and its tangents, right-handed.
#[derive(Debug, Clone, Copy)]
pub struct Tangents {
    pub normal: Vec3,
    pub t1: Vec3,
    pub t2: Vec3,
}

impl Tangents {
    #[inline]
    pub fn of(normal: Vec3) -> Self {
        let t1 = normal.any_perpendicular();
        Self { normal, t1, t2: normal.cross(t1) }
    }

    /// Velocity of the normal under `angular`, along the tangents.
    #[inline]
    pub fn rate(&self, angular: Vec3) -> [f64; 2] {
        // t1·(ω × n) and t2·(ω × n).
        [self.t2.dot(angular), -self.t1.dot(angular)]
    }

    /// The rotation from the normal to `wanted`, as a vector along the tangents with the length of its angle.
    #[inline]
    pub fn towards(&self, wanted: Vec3) -> [f64; 2] {
        let (a, b, cosine) = (self.t1.dot(wanted), self.t2.dot(wanted), self.normal.dot(wanted));
        let sine = a.hypot(b);
        if sine > 1e-12 {
            let k = sine.atan2(cosine) / sine;
            return [a * k, b * k];
        }
        // If the directions are equal, nothing has to be scaled. If they are opposite, all rotations are equally short: use
        // the first tangent.
        if cosine < 0.0 { [std::f64::consts::PI, 0.0] } else { [a, b] }
    }
}

/// Angle between two unit vectors (rad), exact to rounding at both ends.
pub fn angle_between(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

impl Goal<5> for SurfaceGoal {
    type Linearization = Tangents;

    #[inline]
    fn linearize(&self, tip_in_root: &Pose) -> Tangents {
        Tangents::of(tip_in_root.rotation * self.normal_in_tip)
    }

    #[inline]
    fn error(&self, tip_in_root: &Pose) -> [f64; 5] {
        let [x, y, z] = self.position.error(tip_in_root);
        let [u, v] = self.linearize(tip_in_root).towards(self.wanted_in_root);
        [x, y, z, u, v]
    }

    #[inline]
    fn jacobian_column(&self, tangents: &Tangents, linear: Vec3, angular: Vec3) -> [f64; 5] {
        let [x, y, z] = self.position.jacobian_column(&(), linear, angular);
        let [u, v] = tangents.rate(angular);
        [x, y, z, u, v]
    }

    #[inline]
    fn is_met(&self, e: &[f64; 5]) -> bool {
        self.position.is_met(&[e[0], e[1], e[2]]) && e[3].hypot(e[4]) <= self.tolerance_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Rotation;

    #[test]
    fn the_rotation_towards_a_normal_has_its_angle_and_its_direction() {
        for (i, angle) in [0.0, 1e-13, 1e-9, 0.3, 1.5, 3.0, 3.1].into_iter().enumerate() {
            let normal = Vec3::new(0.48, -0.6, 0.64);
            let axis = Rotation::from_axis_angle(normal, i as f64) * normal.any_perpendicular();
            let wanted = Rotation::from_axis_angle(axis, angle) * normal;
            let tangents = Tangents::of(normal);
            let [u, v] = tangents.towards(wanted);
            let expected = tangents.rate(axis).map(|r| r * angle);
            assert!((u - expected[0]).hypot(v - expected[1]) < 1e-9, "{angle}");
            assert!((angle_between(normal, wanted) - angle).abs() < 1e-12);
        }
        let opposite = Tangents::of(Vec3::Z).towards(-Vec3::Z);
        assert_eq!(opposite, [std::f64::consts::PI, 0.0]);
    }
}
