//! Bounds on the speed of points carried by joints that move at constant rates.

/// Relative allowance for the rounding of the sums in a bound.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Upper bounds on the speed and the acceleration of every point of a geometry, in some frame, throughout a motion.
///
/// The unit of time is the unit of the rates: seconds, or the length of a motion whose time runs from 0 to 1. A bound is
/// built joint by joint from the geometry towards the frame ([`SpeedBound::revolute`], [`SpeedBound::prismatic`]),
/// or from the frame outwards ([`SpeedBound::of_joints`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedBound {
    /// Bound on the speed, metres per unit of time.
    pub speed: f64,
    /// Bound on the acceleration, metres per unit of time squared.
    pub acceleration: f64,
}

/// A joint at a constant rate, for [`SpeedBound::of_joints`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointRate {
    /// A revolute or continuous joint.
    Revolute {
        /// Absolute rate, rad per unit of time.
        rate: f64,
        /// Upper bound of the distance of any point of the geometry from the axis, m.
        lever_m: f64,
    },
    /// A prismatic joint.
    Prismatic {
        /// Absolute rate, metres per unit of time.
        rate: f64,
    },
}

impl SpeedBound {
    /// The bound for a geometry at rest.
    pub const REST: Self = Self { speed: 0.0, acceleration: 0.0 };

    /// The bound for joints listed from the frame outwards.
    pub fn of_joints(joints: impl IntoIterator<Item = JointRate>) -> Self {
        let (mut bound, mut rotation) = (Self::REST, 0.0);
        for joint in joints {
            match joint {
                JointRate::Revolute { rate, lever_m } => {
                    bound.speed += rate * lever_m;
                    bound.acceleration += (rate + 2.0 * rotation) * rate * lever_m;
                    rotation += rate;
                }
                JointRate::Prismatic { rate } => {
                    bound.speed += rate;
                    bound.acceleration += 2.0 * rotation * rate;
                }
            }
        }
        bound
    }

    /// The bound if a revolute joint carries everything as well. It rotates at `rate` rad per unit of time, and all
    /// points are within `lever_m` metres of its axis.
    #[must_use]
    pub fn revolute(self, rate: f64, lever_m: f64) -> Self {
        if rate == 0.0 {
            return self;
        }
        let own = rate * lever_m;
        // Centripetal acceleration, and Coriolis acceleration with its factor 2.
        Self { speed: self.speed + own, acceleration: self.acceleration + rate * (own + 2.0 * self.speed) }
    }

    /// The bound if a prismatic joint carries everything as well, at `rate` metres per unit of time.
    #[must_use]
    pub fn prismatic(self, rate: f64) -> Self {
        Self { speed: self.speed + rate, ..self }
    }

    /// The bound on the relative motion of two geometries.
    #[must_use]
    pub fn relative_to(self, other: Self) -> Self {
        Self { speed: self.speed + other.speed, acceleration: self.acceleration + other.acceleration }
    }

    /// The bound enlarged by an allowance for rounding; NaN becomes infinite.
    #[must_use]
    pub fn rounded_up(self) -> Self {
        let known = |x: f64| if x.is_nan() { f64::INFINITY } else { x * ROUNDING };
        Self { speed: known(self.speed), acceleration: known(self.acceleration) }
    }

    /// Largest distance (m) that a point travels in `dt` if at one end of it no point is faster than `speed_now`.
    pub fn distance(self, speed_now: f64, dt: f64) -> f64 {
        let linear = self.speed * dt;
        let quadratic = speed_now * dt + 0.5 * self.acceleration * dt * dt;
        // Comparisons with NaN are false.
        if quadratic < linear { quadratic } else { linear }
    }

    /// A time in which no point travels `distance_m` metres; infinite if nothing moves, 0 if `distance_m` is NaN.
    pub fn time_for(self, speed_now: f64, distance_m: f64) -> f64 {
        if !(distance_m > 0.0) {
            return 0.0;
        }
        if self.speed == 0.0 {
            return f64::INFINITY;
        }
        let linear = distance_m / self.speed;
        let quadratic =
            2.0 * distance_m / (speed_now + (speed_now * speed_now + 2.0 * self.acceleration * distance_m).sqrt());
        (if quadratic > linear { quadratic } else { linear }) / ROUNDING
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_travels_the_distance_in_the_time_for_it() {
        let bound = SpeedBound::REST.revolute(0.7, 0.4).revolute(1.3, 0.9).prismatic(0.2);
        for now in [0.0, 0.3, bound.speed] {
            for distance in [1e-9, 1e-3, 0.1, 2.0] {
                let dt = bound.time_for(now, distance);
                assert!(bound.distance(now, dt) <= distance && bound.distance(now, dt) > 0.99 * distance);
            }
        }
    }

    #[test]
    fn unknown_speeds_give_no_time() {
        let unknown = SpeedBound { speed: f64::NAN, acceleration: f64::NAN }.rounded_up();
        assert_eq!(unknown.time_for(unknown.speed, 1.0), 0.0);
        assert_eq!(SpeedBound::REST.time_for(0.0, f64::NAN), 0.0);
        assert!(unknown.distance(unknown.speed, 0.1) == f64::INFINITY);
    }

    #[test]
    fn both_directions_of_the_sum_agree() {
        let inwards = SpeedBound::REST.revolute(0.7, 0.4).prismatic(0.2).revolute(1.3, 0.9).revolute(0.4, 1.7);
        let outwards = SpeedBound::of_joints([
            JointRate::Revolute { rate: 0.4, lever_m: 1.7 },
            JointRate::Revolute { rate: 1.3, lever_m: 0.9 },
            JointRate::Prismatic { rate: 0.2 },
            JointRate::Revolute { rate: 0.7, lever_m: 0.4 },
        ]);
        assert!((inwards.speed - outwards.speed).abs() < 1e-12);
        assert!((inwards.acceleration - outwards.acceleration).abs() < 1e-12, "{inwards:?} {outwards:?}");
    }
}
