//! Sweep of one solid of a robot against one region, between ticks: conservative advancement with the oracle's own
//! bound of motion.

use super::guarded::Guarded;
use super::motion::OracleMotion;
use super::solid::Bounds;

/// Largest computed distance, m; larger distances are computed again when they may have become smaller.
const FAR_M: f64 = 0.5;
/// Motion of the smallest step within a tick, m: a tenth of the tolerance.
const STEP_M: f64 = 1e-7;

/// Speed below which a robot is at rest, m/s: overrides approach 0 without ever reaching it.
const REST_SPEED: f64 = 1e-4;

/// A touch: the tick before it, the fraction of the way to the next tick, and the pair that touches.
pub type Touch<'p, 'a> = (usize, f64, &'p SweptPair<'a>);

/// Finds the first touch, from tick `from` until before tick `to`, of the solids that are on their robot at tick `from`.
pub fn first_touch<'p, 'a>(pairs: &'p [SweptPair<'a>], from: usize, to: usize) -> Option<Touch<'p, 'a>> {
    let there = pairs.iter().filter(|p| p.is_there(from));
    let touches = there.filter_map(|p| p.first_touch(from, to).map(|(k, u)| (k, u, p)));
    touches.min_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap_or(std::cmp::Ordering::Equal))
}

/// A watched pair of solid and region.
pub struct SweptPair<'a> {
    pub motion: &'a OracleMotion<'a>,
    pub guarded: &'a Guarded,
    pub robot: usize,
    pub region: usize,
    lever_arms: Vec<f64>,
}

impl<'a> SweptPair<'a> {
    pub fn new(motion: &'a OracleMotion<'a>, guarded: &'a Guarded, robot: usize, region: usize) -> Self {
        let lever_arms = motion.arms[robot].lever_arms(guarded.link, guarded.radius_m);
        Self { motion, guarded, robot, region, lever_arms }
    }

    /// Whether any joint moves the solid.
    pub fn is_moved(&self) -> bool {
        self.lever_arms.iter().any(|l| *l > 0.0)
    }

    /// Upper bound, m, by which solid and region can approach each other from tick `k` to the next.
    pub fn travel(&self, k: usize) -> f64 {
        self.own_travel(k) + self.region_travel(k)
    }

    /// The robot's part of [`Self::travel`].
    fn own_travel(&self, k: usize) -> f64 {
        let (from, to) = (&self.motion.q[k][self.robot], &self.motion.q[k + 1][self.robot]);
        self.lever_arms.iter().zip(from).zip(to).map(|((l, a), b)| l * (b - a).abs()).sum()
    }

    /// Upper bound of the speed at which the robot moves the solid from tick `k` to the next, m/s; 0 after the end.
    pub fn own_speed(&self, k: usize) -> f64 {
        if k + 1 < self.motion.ticks() { self.own_travel(k) / self.motion.recording.tick_s } else { 0.0 }
    }

    /// Whether the robot moves the solid at a fraction `u` of the way from tick `k` to the next, both before and after it.
    pub fn moves_at(&self, k: usize, u: f64) -> bool {
        // A robot that comes to rest within the tick may have come to rest before a touch.
        let before = if u <= 0.0 && k > 0 { self.own_speed(k - 1) } else { f64::INFINITY };
        before.min(self.own_speed(k)).min(self.own_speed(k + 1)) > REST_SPEED
    }

    fn region_travel(&self, k: usize) -> f64 {
        let (motion, place) = (self.motion, &self.motion.places[self.region]);
        if place.is_fixed() {
            return 0.0;
        }
        let (from, to) = ((motion.times[k], &motion.q[k][..]), (motion.times[k + 1], &motion.q[k + 1][..]));
        let travel = |radius| place.carrier.travel_m(motion.arms, radius, from, to);
        if place.radius_m.is_finite() {
            return travel(place.radius_m);
        }
        // In a half-space only points that the solid can reach count.
        let frames = motion.frames(k);
        let away = frames[self.robot][self.guarded.link].at.distance(place.carrier.at(from.0, frames).at);
        travel(away + self.guarded.radius_m + self.own_travel(k) + travel(0.0))
    }

    /// Whether the region's belt begins again between tick `k` and the next: the region then does not move through the
    /// space between.
    pub fn region_jumps(&self, k: usize) -> bool {
        let carrier = &self.motion.places[self.region].carrier;
        carrier.rounds(self.motion.times[k]) != carrier.rounds(self.motion.times[k + 1])
    }

    /// Distance at a fraction `u` of the way from tick `k` to the next, up to half a metre.
    pub fn distance(&self, k: usize, u: f64) -> Bounds {
        self.distance_between((k, u), (k, u))
    }

    /// Distance of the robot at one instant from the region at another.
    pub fn distance_between(&self, (k, u): (usize, f64), (region_k, region_u): (usize, f64)) -> Bounds {
        let place = &self.motion.places[self.region];
        let frames = self.motion.frames_between(k, u);
        let is_at_once = (k, u) == (region_k, region_u);
        let later = (!is_at_once).then(|| self.motion.frames_between(region_k, region_u));
        let times = &self.motion.times;
        let next = times.get(region_k + 1).unwrap_or(&times[region_k]);
        let t_s = times[region_k] + (next - times[region_k]) * region_u;
        let at = place.at(t_s, later.as_deref().unwrap_or(&frames));
        self.guarded.distance(&frames[self.robot], &place.solid, &at, FAR_M)
    }

    /// Finds the first touch between tick `k` and the next, as a fraction of the way. `gap_m` is a proven lower bound
    /// of the distance at tick `k`.
    fn crossing(&self, k: usize, mut gap_m: f64) -> Option<f64> {
        let travel = self.travel(k);
        if travel < gap_m {
            return None;
        }
        let mut u = 0.0;
        loop {
            u += gap_m.max(STEP_M) / travel.max(STEP_M);
            if u >= 1.0 {
                return None;
            }
            let found = self.distance(k, u);
            if found.upper <= 0.0 {
                return Some(u);
            }
            gap_m = found.lower;
        }
    }

    /// Whether it is on its robot at a tick.
    pub fn is_there(&self, k: usize) -> bool {
        self.motion.has(self.robot, self.guarded, k)
    }

    /// Whether it touches the region, or lies in it, at a tick.
    pub fn is_inside(&self, k: usize) -> bool {
        self.distance(k, 0.0).upper <= 0.0 || self.is_surrounded(k)
    }

    /// Whether a point of it lies in the region at a tick, also where it is away from the surface of a mesh.
    pub fn is_surrounded(&self, k: usize) -> bool {
        let frames = self.motion.frames(k);
        let place = &self.motion.places[self.region];
        let at = place.at(self.motion.times[k], frames);
        place.contains(&at, self.guarded.any_point(&frames[self.robot]))
    }

    /// Finds the first touch from tick `from` until before tick `to`: the tick before it, and the fraction of the way
    /// to the next.
    pub fn first_touch(&self, from: usize, to: usize) -> Option<(usize, f64)> {
        // Proven lower bound of the distance at tick `k`.
        let mut gap_m = 0.0;
        for k in from..to {
            let travel = if k + 1 < self.motion.ticks() { self.travel(k) } else { 0.0 };
            if gap_m <= travel {
                let now = self.distance(k, 0.0);
                if now.upper <= 0.0 {
                    return Some((k, 0.0));
                }
                gap_m = now.lower;
            }
            if k + 1 >= self.motion.ticks() {
                return None;
            }
            if let Some(u) = self.crossing(k, gap_m) {
                return Some((k, u));
            }
            gap_m -= travel;
        }
        None
    }
}
