//! Recovery: whether the program of a robot inside a region leaves it.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{Penetration, Shape, penetration};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::placement::Placement;
use crate::tick_context::{LOOKAHEAD_S, TickContext};
use crate::volume_region_pair::VolumeRegionPair;

/// Settings of the recovery test.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RecoverySettings {
    /// Smallest decrease of the penetration depth within the lookahead time, m.
    min_decrease_m: f64,
    /// Largest increase of the depth while the program moves along a face, as a fraction of the travel; it allows for
    /// the curvature of the path.
    slope: f64,
    /// Largest increase of the depth within the lookahead time, m.
    max_increase_m: f64,
    /// Prediction time for the slope at the present position, s.
    near_s: f64,
    /// Number of samples along the predicted motion.
    samples: u32,
    /// Speed (m/s) of its border up to which a region counts as at rest: joint values of a robot at rest tremble.
    pub(crate) region_rest_speed: f64,
}

impl Default for RecoverySettings {
    fn default() -> Self {
        Self {
            min_decrease_m: 5e-6,
            slope: 2e-3,
            max_increase_m: 5e-4,
            near_s: 1e-3,
            samples: 16,
            region_rest_speed: 5e-3,
        }
    }
}

/// True if the program leaves the region without going deeper: by the nearest side within the lookahead time, or by
/// another side farther on.
pub(crate) fn leads_out(
    tick: &TickContext<'_>,
    settings: &RecoverySettings,
    pair: &VolumeRegionPair,
    intent: &ChainState,
    predicted: &Placement,
) -> bool {
    let (v, r) = (pair.volume, pair.region.0);
    let (volume, region) = (&tick.config.volumes[v].shape, &tick.config.regions[r].shape);
    let (volume_predicted, region_predicted) = (&predicted.volume_in_world[v], &predicted.region_in_world[r]);
    let Some(now) = penetration(volume, &tick.now.volume_in_world[v], region, &tick.now.region_in_world[r]) else {
        return false;
    };
    match penetration(volume, volume_predicted, region, region_predicted) {
        Some(then) if then.depth + settings.min_decrease_m < now.depth => true,
        // The increase is more than the curvature of a path explains.
        Some(then) if then.depth > now.depth + settings.max_increase_m => false,
        Some(_) => leads_out_ahead(tick, settings, pair, intent, &now),
        // At the border no depth is left to decrease, and a volume beyond a thin plate has passed through it.
        None => {
            let margin_m = (settings.min_decrease_m - now.depth).max(0.0);
            tick.leaves_along(pair, intent, now.direction)
                && !elbowroom_proximity::within(volume, volume_predicted, region, region_predicted, margin_m)
        }
    }
}

/// Upper bound of the speed (m/s) at which the border of a region moves next to a volume. The border of a ball that
/// turns about its centre, or of a cylinder that turns about its axis, does not move.
pub(crate) fn border_speed(tick: &TickContext<'_>, pair: &VolumeRegionPair) -> f64 {
    let region = &tick.config.regions[pair.region.0];
    let Some(source) = region.source_state(tick.snapshot.sources) else { return 0.0 };
    let in_world = &tick.now.region_in_world[pair.region.0];
    let (turn, axis) = (source.motion.angular_velocity, in_world.transform_vector(Vec3::Z));
    let across = (turn - axis * turn.dot(axis)).length();
    let velocity = |at: Vec3| source.motion.velocity_at(at - source.pose.translation);
    let of_center = velocity(in_world.translation).length();
    let turning = |rate: f64| {
        let radius = || tick.now.region_box[pair.region.0].max_distance(in_world.translation);
        if rate > 0.0 { rate * radius() } else { 0.0 }
    };
    match &region.shape {
        Shape::Sphere(_) => of_center,
        Shape::Cylinder(_) | Shape::Capsule(_) => of_center + turning(across),
        // For a plane only the motion across it counts, at the volume's position.
        Shape::HalfSpace(_) => {
            let volume = &tick.now.volume_box[pair.volume];
            velocity(volume.center()).dot(axis).abs() + 0.5 * across * volume.extent().length()
        }
        Shape::Cuboid(_) | Shape::Hull(_) | Shape::Mesh(_) => of_center + turning(turn.length()),
    }
}

/// True if the volume, continuing its present motion, leaves the region without going deeper than it is.
fn leads_out_ahead(
    tick: &TickContext<'_>,
    settings: &RecoverySettings,
    pair: &VolumeRegionPair,
    intent: &ChainState,
    now: &Penetration,
) -> bool {
    let (v, r) = (pair.volume, pair.region.0);
    let center = tick.now.volume_box[v].center();
    let twist = Twist::of(tick, pair, intent, center);
    let speed =
        tick.now.volume_box[v].extent().length() * 0.5 * twist.angular_velocity.length() + twist.velocity.length();
    if !(speed > settings.min_decrease_m / LOOKAHEAD_S) {
        return false;
    }
    let real = tick.volume_point_velocity(&tick.now.chain, v, pair.separation.on_a);
    if real.dot(now.direction) < -settings.slope * real.length() {
        return false;
    }
    let depth_after = |time_s: f64| {
        let moved = twist.displacement(time_s) * tick.now.volume_in_world[v];
        let (volume, region) = (&tick.config.volumes[v].shape, &tick.config.regions[r].shape);
        penetration(volume, &moved, region, &tick.now.region_in_world[r]).map(|e| e.depth)
    };
    let is_deeper = |depth: f64, time_s: f64| depth > now.depth + settings.slope * speed * time_s + 1e-9;
    if depth_after(settings.near_s).is_some_and(|depth| is_deeper(depth, settings.near_s)) {
        return false;
    }
    let boxes = tick.now.volume_box[v].extent().length()
        + if tick.now.region_box[r].extent().is_finite() { tick.now.region_box[r].extent().length() } else { 0.0 };
    let horizon_s = (boxes + 20.0 * now.depth) / speed;
    for sample in 1..=settings.samples {
        let time_s = horizon_s * f64::from(sample) / f64::from(settings.samples);
        match depth_after(time_s) {
            None => return true,
            // The program's path is not straight: farther on, only a clear increase counts.
            Some(depth) if is_deeper(depth, 10.0 * time_s) => return false,
            Some(_) => {}
        }
    }
    false
}

/// A constant twist of a volume relative to a region.
struct Twist {
    center: Vec3,
    velocity: Vec3,
    angular_velocity: Vec3,
}

impl Twist {
    fn of(tick: &TickContext<'_>, pair: &VolumeRegionPair, intent: &ChainState, center: Vec3) -> Self {
        let region = &tick.config.regions[pair.region.0];
        let base = &tick.config.base_in_world;
        let link = tick.config.volumes[pair.volume].link;
        let region_angular_velocity =
            region.source_state(tick.snapshot.sources).map_or(Vec3::ZERO, |s| s.motion.angular_velocity);
        Self {
            center,
            velocity: tick.volume_point_velocity(intent, pair.volume, center)
                - tick.region_point_velocity(pair.region, center),
            angular_velocity: base.transform_vector(intent.link_motion(link).angular_velocity)
                - region_angular_velocity,
        }
    }

    /// The displacement of the volume in the world after some time: the exponential of the twist.
    fn displacement(&self, time_s: f64) -> Pose {
        let turn = self.angular_velocity * time_s;
        let angle = turn.length();
        let (a, b) = if angle < 1e-4 {
            (0.5, 1.0 / 6.0)
        } else {
            ((1.0 - angle.cos()) / (angle * angle), (angle - angle.sin()) / (angle * angle * angle))
        };
        let straight = self.velocity * time_s;
        let moved = straight + turn.cross(straight) * a + turn.cross(turn.cross(straight)) * b;
        let rotation = Rotation::from_rotation_vector(turn);
        Pose::new(rotation, self.center + moved - rotation * self.center)
    }
}
