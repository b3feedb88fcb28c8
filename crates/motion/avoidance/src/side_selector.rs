//! Selects the side to which the robot evades an obstacle: the side where the robot leaves the path of the obstacle
//! soonest, with the smallest motion.

use elbowroom_spatial::Vec3;

/// Number of candidate directions around the path of an obstacle.
const CANDIDATES: usize = 8;
/// A selected side is kept unless another side is cheaper by more than this fraction …
const HYSTERESIS_FRACTION: f64 = 1.0;
/// … and this time, s: joints that reverse brake first and rest for a while.
const HYSTERESIS_S: f64 = 0.3;
/// Cost of a second of joint motion relative to a second of waiting.
const MOTION_WEIGHT: f64 = 0.3;
/// Smallest speed in a direction that counts, m/s: the cost stays finite in a direction in which the point cannot move.
const MIN_SPEED_M_S: f64 = 1e-3;
/// Number of obstacles whose side is stored.
const CAPACITY: usize = 32;
/// Number of ticks after which the side of an obstacle that was not requested again is removed.
const EXPIRY_TICKS: u64 = 100;

/// An approaching obstacle, relative to the collision point that leaves the obstacle's path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ApproachingObstacle {
    /// Direction of its motion relative to the point, a unit vector.
    pub(crate) direction: Vec3,
    /// Vector from the axis of the obstacle's motion to the point, m.
    pub(crate) offset: Vec3,
    /// Distance from that axis at which the point is clear of the obstacle, m.
    pub(crate) clearance_m: f64,
    /// Identifies the obstacle between ticks.
    pub(crate) key: usize,
}

/// The side selected for an obstacle.
#[derive(Debug, Clone, Copy)]
struct SelectedSide {
    key: usize,
    side: Vec3,
    tick: u64,
}

/// Selects sides, with hysteresis.
#[derive(Debug, Clone)]
pub(crate) struct SideSelector {
    selected: Vec<SelectedSide>,
    tick: u64,
}

impl Default for SideSelector {
    fn default() -> Self {
        Self { selected: Vec::with_capacity(CAPACITY), tick: 0 }
    }
}

impl SideSelector {
    /// Begins a new tick.
    pub(crate) fn begin_tick(&mut self) {
        self.tick += 1;
        let tick = self.tick;
        self.selected.retain(|s| s.tick + EXPIRY_TICKS > tick);
    }

    /// The best direction, a unit vector perpendicular to the motion of the obstacle. For a direction, `max_speed`
    /// returns the largest speed of the point (m/s) and `effort` the joint motion per metre (in seconds of a joint at
    /// full speed).
    pub(crate) fn select(
        &mut self,
        obstacle: &ApproachingObstacle,
        max_speed: impl Fn(Vec3) -> f64,
        effort: impl Fn(Vec3) -> f64,
    ) -> Vec3 {
        let direction = obstacle.direction;
        let perpendicular = |v: Vec3| (v - direction * v.dot(direction)).try_normalize();
        // All links leave the path on the side of the first link, which is the nearest.
        let same_tick = self.selected.iter().find(|s| s.key == obstacle.key && s.tick == self.tick);
        if let Some(side) = same_tick.and_then(|s| perpendicular(s.side)) {
            return side;
        }
        let cost = |side: Vec3| {
            let travel = (obstacle.clearance_m - obstacle.offset.dot(side)).max(0.0);
            travel / max_speed(side).max(MIN_SPEED_M_S) + MOTION_WEIGHT * travel * effort(side)
        };
        let (e1, e2) = (direction.any_perpendicular(), direction.cross(direction.any_perpendicular()));
        let mut best = (f64::INFINITY, e1);
        for i in 0..CANDIDATES {
            let (s, c) = (std::f64::consts::TAU * i as f64 / CANDIDATES as f64).sin_cos();
            let side = e1 * c + e2 * s;
            let cost = cost(side);
            if cost < best.0 {
                best = (cost, side);
            }
        }
        if let Some(stored) = self.selected.iter_mut().find(|s| s.key == obstacle.key) {
            let kept = perpendicular(stored.side).map(|s| (cost(s), s));
            if let Some(kept) = kept.filter(|k| k.0 <= best.0 * (1.0 + HYSTERESIS_FRACTION) + HYSTERESIS_S) {
                best = kept;
            }
            (stored.side, stored.tick) = (best.1, self.tick);
        } else if self.selected.len() < CAPACITY {
            self.selected.push(SelectedSide { key: obstacle.key, side: best.1, tick: self.tick });
        }
        best.1
    }
}
