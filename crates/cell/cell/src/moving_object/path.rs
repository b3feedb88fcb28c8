//! The path of an object: piecewise linear at constant speed, with a constant angular velocity.

use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

/// What happens at the end of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathRepeat {
    /// It stops at the last point.
    Once,
    /// It moves from the last point straight to the first, repeatedly.
    Loop,
    /// It moves back along the path and forward again, repeatedly (ping-pong).
    PingPong,
}

/// Straight segments at constant speed; at the corners the direction changes instantly.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectPath {
    /// Positions of the object's origin, m; with [`PathRepeat::Loop`] the first one again at the end.
    corners: Vec<Vec3>,
    /// Arc length to each corner, m.
    lengths: Vec<f64>,
    speed: f64,
    start_s: f64,
    repeat: PathRepeat,
    angular_velocity: Vec3,
}

/// State on the path at an instant.
struct Moment {
    at: Vec3,
    velocity: Vec3,
    /// Duration of the rotation so far, s.
    rotation_s: f64,
    rotates: bool,
}

impl ObjectPath {
    /// Creates a path through `corners` (m, in the world; the first is the initial position).
    ///
    /// The object moves at `speed` (m/s) from `start_s` (s) on, and rotates at `angular_velocity` (rad/s, about world
    /// axes through the origin) while it moves. With one corner it stays there and rotates forever.
    pub fn new(mut corners: Vec<Vec3>, speed: f64, start_s: f64, repeat: PathRepeat, angular_velocity: Vec3) -> Self {
        if repeat == PathRepeat::Loop {
            corners.extend(corners.first().copied());
        }
        let mut distance = 0.0;
        let mut last = corners.first().copied().unwrap_or_default();
        let lengths = corners
            .iter()
            .map(|c| {
                distance += c.distance(std::mem::replace(&mut last, *c));
                distance
            })
            .collect();
        Self { corners, lengths, speed, start_s, repeat, angular_velocity }
    }

    /// The corners, m.
    pub fn corners(&self) -> &[Vec3] {
        &self.corners
    }

    /// Passes every number that defines the path, for a checksum. A new field must be added here.
    pub(crate) fn numbers(&self, each: &mut dyn FnMut(f64)) {
        // The lengths follow from the corners.
        let Self { corners, lengths: _, speed, start_s, repeat, angular_velocity } = self;
        let repeat = match repeat {
            PathRepeat::Once => 0.0,
            PathRepeat::Loop => 1.0,
            PathRepeat::PingPong => 2.0,
        };
        [*speed, *start_s, repeat].into_iter().for_each(&mut *each);
        corners.iter().chain([angular_velocity]).flat_map(|v| v.to_array()).for_each(each);
    }

    pub(super) fn pose(&self, rest_in_world: Pose, t_s: f64) -> Pose {
        let now = self.moment(t_s);
        Pose::new(
            Rotation::from_rotation_vector(self.angular_velocity * now.rotation_s) * rest_in_world.rotation,
            now.at,
        )
    }

    pub(super) fn motion(&self, t_s: f64) -> FrameMotion {
        let now = self.moment(t_s);
        let angular_velocity = if now.rotates { self.angular_velocity } else { Vec3::ZERO };
        FrameMotion { velocity: now.velocity, angular_velocity, ..FrameMotion::REST }
    }

    /// Upper bound of the speed of any point within `radius` m of the origin, m/s.
    pub fn fastest(&self, radius: f64) -> f64 {
        let moves = self.length() > 0.0;
        (if moves { self.speed } else { 0.0 }) + self.angular_velocity.length() * radius
    }

    /// Time at which it stops, s; `None` if it never stops.
    pub(super) fn end_s(&self) -> Option<f64> {
        if self.length() > 0.0 {
            (self.repeat == PathRepeat::Once).then(|| self.start_s + self.length() / self.speed)
        } else if self.angular_velocity == Vec3::ZERO {
            Some(self.start_s)
        } else {
            None
        }
    }

    /// True if the velocity changes between two times.
    pub(super) fn changes(&self, from_s: f64, to_s: f64) -> bool {
        let within = |t: f64| t > from_s && t < to_s;
        // Not on one segment all of the time: another segment, another round, a start or an end.
        within(self.start_s) || self.end_s().is_some_and(within) || self.leg(from_s) != self.leg(to_s)
    }

    fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// The present segment: round, number and direction.
    fn leg(&self, t_s: f64) -> (f64, usize, bool) {
        let (round, along, back) = self.along((t_s - self.start_s).max(0.0));
        (round, self.lengths.partition_point(|l| *l <= along), back)
    }

    /// Round, arc length along the corners (m), and whether it moves backwards.
    fn along(&self, moving_s: f64) -> (f64, f64, bool) {
        let (distance, length) = (moving_s * self.speed, self.length());
        if length <= 0.0 {
            return (0.0, 0.0, false);
        }
        match self.repeat {
            PathRepeat::Once => (0.0, distance.min(length), false),
            PathRepeat::Loop => ((distance / length).floor(), distance.rem_euclid(length), false),
            PathRepeat::PingPong => {
                let there_and_back = distance.rem_euclid(2.0 * length);
                let back = there_and_back >= length;
                let along = if back { 2.0 * length - there_and_back } else { there_and_back };
                ((distance / length).floor(), along, back)
            }
        }
    }

    fn moment(&self, t_s: f64) -> Moment {
        let first = self.corners.first().copied().unwrap_or_default();
        let moving_s = t_s - self.start_s;
        if moving_s.is_nan() || moving_s < 0.0 {
            return Moment { at: first, velocity: Vec3::ZERO, rotation_s: 0.0, rotates: false };
        }
        let (_, along, back) = self.along(moving_s);
        let end = self.end_s().map(|end| end - self.start_s);
        if let Some(end) = end.filter(|end| moving_s >= *end) {
            let at = self.corners.last().copied().unwrap_or(first);
            return Moment { at, velocity: Vec3::ZERO, rotation_s: end, rotates: false };
        }
        // Moving backwards, a corner belongs to the segment before it.
        let next = if back {
            self.lengths.partition_point(|l| *l < along)
        } else {
            self.lengths.partition_point(|l| *l <= along)
        };
        let next = next.clamp(1, self.corners.len().saturating_sub(1).max(1));
        let (Some(a), Some(b)) = (self.corners.get(next - 1), self.corners.get(next)) else {
            return Moment { at: first, velocity: Vec3::ZERO, rotation_s: moving_s, rotates: true };
        };
        let ahead = (*b - *a).try_normalize().unwrap_or(Vec3::ZERO);
        let velocity = ahead * if back { -self.speed } else { self.speed };
        Moment { at: *a + ahead * (along - self.lengths[next - 1]), velocity, rotation_s: moving_s, rotates: true }
    }
}
