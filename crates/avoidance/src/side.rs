//! On which side to let something pass: where the robot is out of its way soonest, with the least motion.

use elbowroom_spatial::Vec3;

/// Directions looked at around the way of what comes.
const AROUND: usize = 8;
/// A side once taken is kept unless another is better by more than this share …
const LOYALTY: f64 = 1.0;
/// … and this time, s: joints that turn round brake first, and stand for a while.
const LOYALTY_S: f64 = 0.3;
/// How much a second of joint motion counts beside a second of waiting.
const MOTION: f64 = 0.3;
/// Sides remembered.
const MEMORY: usize = 32;
/// Looks after which a side that was not asked for is forgotten.
const FORGET: u64 = 100;

/// What comes, seen from the point that is to leave its way.
#[derive(Debug, Clone, Copy)]
pub struct Coming {
    /// Direction of its motion relative to the point, length 1.
    pub along: Vec3,
    /// From the middle of its way to the point, m.
    pub miss: Vec3,
    /// So far from the middle of its way the point is safe, m.
    pub clear_m: f64,
    /// Names it.
    pub key: usize,
}

/// Chooses sides, and keeps to them.
#[derive(Debug, Clone)]
pub struct Sides {
    taken: Vec<(usize, Vec3, u64)>,
    look: u64,
}

impl Default for Sides {
    fn default() -> Self {
        Self { taken: Vec::with_capacity(MEMORY), look: 0 }
    }
}

impl Sides {
    /// A new tick begins.
    pub fn next(&mut self) {
        self.look += 1;
        let look = self.look;
        self.taken.retain(|(_, _, seen)| seen + FORGET > look);
    }

    /// The best direction, length 1, perpendicular to the way. `fastest` and `effort` tell of a direction how fast the
    /// point can go there (m/s) and how much joint motion a metre takes (in seconds of a joint at full speed).
    pub fn choose(&mut self, coming: &Coming, fastest: impl Fn(Vec3) -> f64, effort: impl Fn(Vec3) -> f64) -> Vec3 {
        let across = |v: Vec3| (v - coming.along * v.dot(coming.along)).try_normalize();
        // All links leave the way on the same side: that of the one that asks first, the nearest.
        let chosen = self.taken.iter().find(|(k, _, seen)| *k == coming.key && *seen == self.look);
        if let Some(side) = chosen.and_then(|(_, side, _)| across(*side)) {
            return side;
        }
        let cost = |side: Vec3| {
            let way = (coming.clear_m - coming.miss.dot(side)).max(0.0);
            way / fastest(side).max(1e-3) + MOTION * way * effort(side)
        };
        let (e1, e2) = (coming.along.any_perpendicular(), coming.along.cross(coming.along.any_perpendicular()));
        let mut best = (f64::INFINITY, e1);
        for i in 0..AROUND {
            let (s, c) = (std::f64::consts::TAU * i as f64 / AROUND as f64).sin_cos();
            let side = e1 * c + e2 * s;
            let cost = cost(side);
            if cost < best.0 {
                best = (cost, side);
            }
        }
        let memory = self.taken.iter_mut().find(|(k, ..)| *k == coming.key);
        if let Some((_, side, seen)) = memory {
            let kept = across(*side).map(|s| (cost(s), s));
            if let Some(kept) = kept.filter(|k| k.0 <= best.0 * (1.0 + LOYALTY) + LOYALTY_S) {
                best = kept;
            }
            (*side, *seen) = (best.1, self.look);
        } else if self.taken.len() < MEMORY {
            self.taken.push((coming.key, best.1, self.look));
        }
        best.1
    }
}
