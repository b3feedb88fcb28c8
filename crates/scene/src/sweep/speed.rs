//! How much nearer a pair can come in some time. README.md derives the bounds.

use elbowroom_proximity::impact::Path;
use elbowroom_spatial::Vec3;

/// Factor on speeds for the rounding of the sums they are made of.
const CAREFUL: f64 = 1.0 + 1e-9;

/// What no point of a member exceeds, seen from some frame, during all of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Speed {
    /// Metres per unit of time.
    pub cap: f64,
    /// Acceleration, metres per unit of time squared.
    pub growth: f64,
}

impl Speed {
    pub const REST: Self = Self { cap: 0.0, growth: 0.0 };

    /// Of a body that moves by itself and whose points are within `radius` metres of its frame.
    pub fn of_path(path: &dyn Path, radius: f64) -> Self {
        let steady = path.steady();
        let cap = match steady {
            // Where nothing turns, far points are no faster than near ones.
            Some(s) if s.rotation == Vec3::ZERO => s.velocity.length(),
            _ => path.speed(radius, 0.0, 1.0),
        };
        let growth = steady.map_or(f64::INFINITY, |s| {
            let turn = s.rotation.length();
            if turn == 0.0 { 0.0 } else { turn * turn * (s.start.translation.distance(s.pivot) + radius) }
        });
        Self { cap, growth }.careful()
    }

    /// What carries this turns about an axis at `turn` rad per unit of time; no point is farther than `lever` metres
    /// from the axis.
    pub fn turned(self, turn: f64, lever: f64) -> Self {
        if turn == 0.0 {
            return self;
        }
        let own = turn * lever;
        // Coriolis' share counts twice.
        Self { cap: self.cap + own, growth: self.growth + turn * (own + 2.0 * self.cap) }
    }

    /// What carries this slides along at `slide` metres per unit of time.
    pub fn shifted(self, slide: f64) -> Self {
        Self { cap: self.cap + slide, ..self }
    }

    /// Both move.
    pub fn joined(self, other: Self) -> Self {
        Self { cap: self.cap + other.cap, growth: self.growth + other.growth }
    }

    /// With room for rounding; what is no number bounds nothing.
    pub fn careful(self) -> Self {
        let known = |x: f64| if x.is_nan() { f64::INFINITY } else { x * CAREFUL };
        Self { cap: known(self.cap), growth: known(self.growth) }
    }

    /// Metres that a distance can shrink in `dt` at most, when nothing is faster than `now` at one end of it.
    pub fn over(self, now: f64, dt: f64) -> f64 {
        let flat = self.cap * dt;
        let curved = now * dt + 0.5 * self.growth * dt * dt;
        // Comparisons with NaN are false.
        if curved < flat { curved } else { flat }
    }

    /// A time in which a distance cannot shrink by `room` metres; infinite where nothing moves.
    pub fn time_for(self, now: f64, room: f64) -> f64 {
        if !(room > 0.0) {
            return 0.0;
        }
        if self.cap == 0.0 {
            return f64::INFINITY;
        }
        let flat = room / self.cap;
        let curved = 2.0 * room / (now + (now * now + 2.0 * self.growth * room).sqrt());
        (if curved > flat { curved } else { flat }) / CAREFUL
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_for_a_room_closes_no_more_than_that_room() {
        let speed = Speed::REST.turned(0.7, 0.4).turned(1.3, 0.9).shifted(0.2);
        for now in [0.0, 0.3, speed.cap] {
            for room in [1e-9, 1e-3, 0.1, 2.0] {
                let dt = speed.time_for(now, room);
                assert!(speed.over(now, dt) <= room && speed.over(now, dt) > 0.99 * room);
            }
        }
    }

    #[test]
    fn what_is_unknown_gives_no_time() {
        let unknown = Speed { cap: f64::NAN, growth: f64::NAN }.careful();
        assert_eq!(unknown.time_for(unknown.cap, 1.0), 0.0);
        assert_eq!(Speed::REST.time_for(0.0, f64::NAN), 0.0);
        assert!(unknown.over(unknown.cap, 0.1) == f64::INFINITY);
    }
}
