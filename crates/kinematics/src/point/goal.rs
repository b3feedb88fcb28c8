//! Where a point and its normal should be, as equations.

use elbowroom_spatial::{Pose, Vec3};

use crate::inverse::goal::Goal;

/// The point alone: three equations.
#[derive(Debug, Clone, Copy)]
pub struct PositionGoal {
    pub target: Vec3,
    pub tolerance_m: f64,
    /// Metres that weigh as much as a radian.
    pub scale: f64,
}

impl Goal<3> for PositionGoal {
    type Place = ();

    fn place(&self, _: &Pose) {}

    #[inline]
    fn error(&self, tip_in_root: &Pose) -> [f64; 3] {
        self.column(&(), self.target - tip_in_root.translation, Vec3::ZERO)
    }

    #[inline]
    fn column(&self, (): &(), linear: Vec3, _: Vec3) -> [f64; 3] {
        (linear / self.scale).to_array()
    }

    #[inline]
    fn met(&self, e: &[f64; 3]) -> bool {
        Vec3::from(*e).length() * self.scale <= self.tolerance_m
    }
}

/// The point and the direction of its normal: five equations.
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

    /// The turn from the normal to `wanted`, along the tangents, as long as its angle.
    #[inline]
    pub fn towards(&self, wanted: Vec3) -> [f64; 2] {
        let (a, b, cosine) = (self.t1.dot(wanted), self.t2.dot(wanted), self.normal.dot(wanted));
        let sine = a.hypot(b);
        if sine > 1e-12 {
            let k = sine.atan2(cosine) / sine;
            return [a * k, b * k];
        }
        // Ahead there is nothing left to scale; straight behind, every way is as short: the first tangent.
        if cosine < 0.0 { [std::f64::consts::PI, 0.0] } else { [a, b] }
    }
}

/// Angle between two unit vectors, exact to rounding at both ends.
pub fn angle_between(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

impl Goal<5> for SurfaceGoal {
    type Place = Tangents;

    #[inline]
    fn place(&self, tip_in_root: &Pose) -> Tangents {
        Tangents::of(tip_in_root.rotation * self.normal_in_tip)
    }

    #[inline]
    fn error(&self, tip_in_root: &Pose) -> [f64; 5] {
        let [x, y, z] = self.position.error(tip_in_root);
        let [u, v] = self.place(tip_in_root).towards(self.wanted_in_root);
        [x, y, z, u, v]
    }

    #[inline]
    fn column(&self, place: &Tangents, linear: Vec3, angular: Vec3) -> [f64; 5] {
        let [x, y, z] = self.position.column(&(), linear, angular);
        let [u, v] = place.rate(angular);
        [x, y, z, u, v]
    }

    #[inline]
    fn met(&self, e: &[f64; 5]) -> bool {
        self.position.met(&[e[0], e[1], e[2]]) && e[3].hypot(e[4]) <= self.tolerance_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Rotation;

    #[test]
    fn the_turn_towards_a_normal_has_its_angle_and_its_direction() {
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
        let behind = Tangents::of(Vec3::Z).towards(-Vec3::Z);
        assert_eq!(behind, [std::f64::consts::PI, 0.0]);
    }
}
