//! A way of an object's own: straight from point to point at one speed, turning at one rate.

use elbowroom_spatial::{Motion, Pose, Rotation, Vec3};

/// What happens at the end of a way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Repeat {
    /// It stops at the last point.
    No,
    /// From the last point straight to the first, and again.
    Loop,
    /// The way back, and again.
    BackAndForth,
}

/// Straight lines at constant speed; at the corners the direction changes at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// Where the object's origin goes, m; with [`Repeat::Loop`] the first again at the end.
    corners: Vec<Vec3>,
    /// Length of the way to each corner, m.
    lengths: Vec<f64>,
    speed: f64,
    start_s: f64,
    repeat: Repeat,
    turn: Vec3,
}

/// A moment on the way.
struct Moment {
    at: Vec3,
    velocity: Vec3,
    /// How long it has been turning, s.
    turning_s: f64,
    turns: bool,
}

impl Way {
    /// A way through `corners` (m, in the world; the first is where the object stands), at `speed` (m/s) from `start_s`
    /// on, turning at `turn` (rad/s, about world axes through its origin) while it moves. With one corner it stays there
    /// and turns for ever.
    pub fn new(mut corners: Vec<Vec3>, speed: f64, start_s: f64, repeat: Repeat, turn: Vec3) -> Self {
        if repeat == Repeat::Loop {
            corners.extend(corners.first().copied());
        }
        let mut way = 0.0;
        let mut last = corners.first().copied().unwrap_or_default();
        let lengths = corners
            .iter()
            .map(|c| {
                way += c.distance(std::mem::replace(&mut last, *c));
                way
            })
            .collect();
        Self { corners, lengths, speed, start_s, repeat, turn }
    }

    /// The corners, m.
    pub fn corners(&self) -> &[Vec3] {
        &self.corners
    }

    /// Every number that decides where it goes, for a checksum. A field that is added has to be named here.
    pub(crate) fn numbers(&self, each: &mut dyn FnMut(f64)) {
        // The lengths follow from the corners.
        let Self { corners, lengths: _, speed, start_s, repeat, turn } = self;
        let repeat = match repeat {
            Repeat::No => 0.0,
            Repeat::Loop => 1.0,
            Repeat::BackAndForth => 2.0,
        };
        [*speed, *start_s, repeat].into_iter().for_each(&mut *each);
        corners.iter().chain([turn]).flat_map(|v| v.to_array()).for_each(each);
    }

    pub(super) fn pose(&self, rest_in_world: Pose, t_s: f64) -> Pose {
        let now = self.moment(t_s);
        Pose::new(Rotation::from_rotation_vector(self.turn * now.turning_s) * rest_in_world.rotation, now.at)
    }

    pub(super) fn motion(&self, t_s: f64) -> Motion {
        let now = self.moment(t_s);
        let angular_velocity = if now.turns { self.turn } else { Vec3::ZERO };
        Motion { velocity: now.velocity, angular_velocity, ..Motion::REST }
    }

    /// No point within `radius` m of the origin is ever faster, m/s.
    pub(crate) fn fastest(&self, radius: f64) -> f64 {
        let goes = self.length() > 0.0;
        (if goes { self.speed } else { 0.0 }) + self.turn.length() * radius
    }

    /// When it has stopped, s; `None` where it never does.
    pub(super) fn end_s(&self) -> Option<f64> {
        if self.length() > 0.0 {
            (self.repeat == Repeat::No).then(|| self.start_s + self.length() / self.speed)
        } else if self.turn == Vec3::ZERO {
            Some(self.start_s)
        } else {
            None
        }
    }

    /// True where the velocity changes between two times.
    pub(super) fn changes(&self, from_s: f64, to_s: f64) -> bool {
        let within = |t: f64| t > from_s && t < to_s;
        // Not within a leg for all of the time: another leg, another round, or there was a start or an end.
        within(self.start_s) || self.end_s().is_some_and(within) || self.leg(from_s) != self.leg(to_s)
    }

    fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Which straight line it is on: round and number.
    fn leg(&self, t_s: f64) -> (f64, usize, bool) {
        let (round, along, back) = self.along((t_s - self.start_s).max(0.0));
        (round, self.lengths.partition_point(|l| *l <= along), back)
    }

    /// Round, length along the corners (m), and whether it is on its way back.
    fn along(&self, moving_s: f64) -> (f64, f64, bool) {
        let (way, length) = (moving_s * self.speed, self.length());
        if length <= 0.0 {
            return (0.0, 0.0, false);
        }
        match self.repeat {
            Repeat::No => (0.0, way.min(length), false),
            Repeat::Loop => ((way / length).floor(), way.rem_euclid(length), false),
            Repeat::BackAndForth => {
                let there_and_back = way.rem_euclid(2.0 * length);
                let back = there_and_back >= length;
                let along = if back { 2.0 * length - there_and_back } else { there_and_back };
                ((way / length).floor(), along, back)
            }
        }
    }

    fn moment(&self, t_s: f64) -> Moment {
        let first = self.corners.first().copied().unwrap_or_default();
        let moving_s = t_s - self.start_s;
        if moving_s.is_nan() || moving_s < 0.0 {
            return Moment { at: first, velocity: Vec3::ZERO, turning_s: 0.0, turns: false };
        }
        let (_, along, back) = self.along(moving_s);
        let end = self.end_s().map(|end| end - self.start_s);
        if let Some(end) = end.filter(|end| moving_s >= *end) {
            let at = self.corners.last().copied().unwrap_or(first);
            return Moment { at, velocity: Vec3::ZERO, turning_s: end, turns: false };
        }
        // On the way back a corner belongs to the line before it: that is where it goes on.
        let next = if back {
            self.lengths.partition_point(|l| *l < along)
        } else {
            self.lengths.partition_point(|l| *l <= along)
        };
        let next = next.clamp(1, self.corners.len().saturating_sub(1).max(1));
        let (Some(a), Some(b)) = (self.corners.get(next - 1), self.corners.get(next)) else {
            return Moment { at: first, velocity: Vec3::ZERO, turning_s: moving_s, turns: true };
        };
        let ahead = (*b - *a).try_normalize().unwrap_or(Vec3::ZERO);
        let velocity = ahead * if back { -self.speed } else { self.speed };
        Moment { at: *a + ahead * (along - self.lengths[next - 1]), velocity, turning_s: moving_s, turns: true }
    }
}
