//! The way out of a region for a robot that is inside.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{Escape, escape};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::gaps::Pair;
use crate::verdict::{Judge, LOOKAHEAD_S};

/// Depth must shrink by more than this (m) over [`LOOKAHEAD_S`] to count as shrinking.
const LEAST_M: f64 = 5e-6;
/// Where the program leads along a face, it may lead away from that face by this share of its way: curves of the path.
const SLOPE: f64 = 2e-3;
/// How far ahead (s) the slope is looked at.
const NEAR_S: f64 = 1e-3;
/// Looks along the way out.
const LOOKS: u32 = 32;

/// True where the program leads out of the region, never deeper on the way: at once by the nearest side, or farther on by
/// another one. `soon` are the poses of volume and region [`LOOKAHEAD_S`] later.
pub(crate) fn leads_out(judge: &Judge<'_>, pair: &Pair, intent: &ChainState, soon: (&Pose, &Pose)) -> bool {
    let (v, r) = (pair.volume, pair.region);
    let (volume, region) = (&judge.config.volumes[v].shape, &judge.config.regions[r].shape);
    let Some(out) = escape(volume, &judge.now.volume_in_world[v], region, &judge.now.region_in_world[r]) else {
        return false;
    };
    match escape(volume, soon.0, region, soon.1) {
        Some(then) if then.depth + LEAST_M < out.depth => true,
        Some(_) => leads_out_ahead(judge, pair, intent, &out),
        // At the border there is no depth left to shrink; and whoever is out soon may be so behind a thin plate.
        None => {
            judge.moves_along(pair, intent, out.direction)
                && !elbowroom_proximity::within(volume, soon.0, region, soon.1, (LEAST_M - out.depth).max(0.0))
        }
    }
}

/// True where the volume, going on as it moves now, comes out without being deeper on the way than it is now.
fn leads_out_ahead(judge: &Judge<'_>, pair: &Pair, intent: &ChainState, out: &Escape) -> bool {
    let (v, r) = (pair.volume, pair.region);
    let center = judge.now.volume_box[v].center();
    let twist = Twist::of(judge, pair, intent, center);
    let speed = judge.now.volume_box[v].extent().length() * 0.5 * twist.turning.length() + twist.velocity.length();
    if !(speed > LEAST_M / LOOKAHEAD_S) {
        return false;
    }
    let real = judge.velocity_of(&judge.now.chain, v, pair.separation.on_a);
    if real.dot(out.direction) < -SLOPE * real.length() {
        return false;
    }
    let depth_at = |ahead_s: f64| {
        let moved = twist.after(ahead_s) * judge.now.volume_in_world[v];
        let (volume, region) = (&judge.config.volumes[v].shape, &judge.config.regions[r].shape);
        escape(volume, &moved, region, &judge.now.region_in_world[r]).map(|e| e.depth)
    };
    let deeper = |depth: f64, ahead_s: f64| depth > out.depth + SLOPE * speed * ahead_s + 1e-9;
    if depth_at(NEAR_S).is_some_and(|depth| deeper(depth, NEAR_S)) {
        return false;
    }
    let boxes = judge.now.volume_box[v].extent().length()
        + if judge.now.region_box[r].extent().is_finite() { judge.now.region_box[r].extent().length() } else { 0.0 };
    let horizon_s = (boxes + 20.0 * out.depth) / speed;
    for look in 1..=LOOKS {
        let ahead_s = horizon_s * f64::from(look) / f64::from(LOOKS);
        match depth_at(ahead_s) {
            None => return true,
            // A straight course is not the program's: farther on it is only to be seen that it does not lead in.
            Some(depth) if deeper(depth, 10.0 * ahead_s) => return false,
            Some(_) => {}
        }
    }
    false
}

/// A rigid motion that goes on as it is, relative to the region.
struct Twist {
    center: Vec3,
    velocity: Vec3,
    turning: Vec3,
}

impl Twist {
    fn of(judge: &Judge<'_>, pair: &Pair, intent: &ChainState, center: Vec3) -> Self {
        let region = &judge.config.regions[pair.region];
        let base = &judge.config.base_in_world;
        let link = judge.config.volumes[pair.volume].link;
        let source = region.follow.and_then(|s| judge.snapshot.sources.get(s.0));
        let (region_velocity, region_turning) = source.map_or((Vec3::ZERO, Vec3::ZERO), |s| {
            (s.motion.velocity_at(center - s.pose.translation), s.motion.angular_velocity)
        });
        Self {
            center,
            velocity: judge.velocity_of(intent, pair.volume, center) - region_velocity,
            turning: base.transform_vector(intent.link_motion(link).angular_velocity) - region_turning,
        }
    }

    /// The motion of the world that carries the volume there: exponential of the twist.
    fn after(&self, time_s: f64) -> Pose {
        let turn = self.turning * time_s;
        let angle = turn.length();
        let (a, b) = if angle < 1e-4 {
            (0.5, 1.0 / 6.0)
        } else {
            ((1.0 - angle.cos()) / (angle * angle), (angle - angle.sin()) / (angle * angle * angle))
        };
        let way = self.velocity * time_s;
        let moved = way + turn.cross(way) * a + turn.cross(turn.cross(way)) * b;
        let rotation = Rotation::from_rotation_vector(turn);
        Pose::new(rotation, self.center + moved - rotation * self.center)
    }
}
