//! Conservative advancement: steps in which the shapes are guaranteed not to touch, with a distance query after
//! each.

use elbowroom_spatial::{Pose, Vec3};

use super::closing_bound::{BoundedShape, PairBounds};
use super::options::CcdOptions;
use super::rigid_motion::RigidMotion;
use super::separating_slab::separating_slab;
use super::time_of_impact::TimeOfImpact;
use crate::{DistanceSettings, Separation, Shape, WarmStart, Workspace};

/// The relative resolution of positions.
const RESOLUTION: f64 = 64.0 * f64::EPSILON;

/// The first time at which two moving shapes are within the tolerance of contact; `None` if they are apart
/// throughout.
///
/// A NaN or an infinity in a pose, a dimension or a motion gives a contact that is not certain: unknown does not
/// count as free.
pub fn time_of_impact(
    a: &Shape,
    a_motion: &dyn RigidMotion,
    b: &Shape,
    b_motion: &dyn RigidMotion,
    options: &CcdOptions,
) -> Option<TimeOfImpact> {
    time_of_impact_with(a, a_motion, b, b_motion, options, &mut Workspace::new())
}

/// Like [`time_of_impact`], with a workspace that many calls share.
///
/// ```
/// use elbowroom_proximity::ccd::{CcdOptions, ConstantTwist, time_of_impact_with};
/// use elbowroom_proximity::{Shape, Sphere, Workspace};
/// use elbowroom_spatial::{Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let flight = ConstantTwist::linear(Pose::IDENTITY, Vec3::X);
/// let (mut workspace, options) = (Workspace::new(), CcdOptions::default());
/// for x in [0.7, 0.9] {
///     let other = Pose::from_translation(Vec3::X * x);
///     let hit = time_of_impact_with(&ball, &flight, &ball, &other, &options, &mut workspace).unwrap();
///     assert!((hit.time - (x - 0.2)).abs() < 1e-3);
/// }
/// ```
pub fn time_of_impact_with(
    a: &Shape,
    a_motion: &dyn RigidMotion,
    b: &Shape,
    b_motion: &dyn RigidMotion,
    options: &CcdOptions,
    workspace: &mut Workspace,
) -> Option<TimeOfImpact> {
    let (bounded_a, bounded_b) = (BoundedShape::new(a, a_motion), BoundedShape::new(b, b_motion));
    let mut tolerance = options.tolerance;
    let mut warm_start = WarmStart::default();
    let mut t = 0.0;
    for steps in 1.. {
        let (a_in_world, b_in_world) = (a_motion.pose(t), b_motion.pose(t));
        let bounds = PairBounds { a: &bounded_a, b: &bounded_b, a_in_world, b_in_world, t };
        let finest = resolution(&bounds);
        let limit = bounds.until_end() + finest;
        let settings = DistanceSettings { limit, warm_start: Some(&mut warm_start), ..DistanceSettings::default() };
        // If the distance is larger than the rest of the motion can close, the motion is free.
        let near = workspace.separation(a, &a_in_world, b, &b_in_world, settings)?;
        if steps == 1 && options.allow_initial_proximity && near.lower_bound > 0.0 {
            tolerance = tolerance.min(0.5 * near.lower_bound);
        }
        let tolerance = if tolerance > finest { tolerance } else { finest };
        let found = |certain| Some(contact_at(&near, t, steps, certain));
        if !(near.distance > tolerance) {
            return found(near.distance <= tolerance && a_in_world.is_finite() && b_in_world.is_finite());
        }
        // Half the tolerance is kept, so that the distance never reaches 0 and the witness points always give a direction.
        let keep = 0.5 * tolerance;
        let free = bounds.time_for(near.lower_bound - keep).max(time_by_slab(&bounds, &near, keep));
        if free >= 1.0 - t {
            return None;
        }
        let next = t + free;
        if !(next > t) || steps >= options.max_steps {
            return found(false);
        }
        t = next;
    }
    None
}

/// Time during which the empty slab between the two shapes is guaranteed to stay thicker than `keep`.
fn time_by_slab(bounds: &PairBounds, near: &Separation, keep: f64) -> f64 {
    match separating_slab(bounds.a.shape, &bounds.a_in_world, bounds.b.shape, &bounds.b_in_world, near) {
        Some(slab) => bounds.time_for_slab(slab.thickness - keep, slab.normal),
        None => 0.0,
    }
}

/// The resolution of poses of this size, metres.
fn resolution(bounds: &PairBounds) -> f64 {
    let one = |shape: &BoundedShape, pose: &Pose| {
        let radius = shape.points.map_or(0.0, |p| p.radius());
        let turns = shape.twist.map_or(0.0, |s| s.rotation.length());
        let arm = shape.twist.map_or(Vec3::ZERO, |s| s.start.translation - s.pivot).length();
        let pivot = shape.twist.map_or(0.0, |s| s.pivot.length());
        pose.translation.length() + pivot + (radius + arm) * (1.0 + turns)
    };
    RESOLUTION * (one(bounds.a, &bounds.a_in_world) + one(bounds.b, &bounds.b_in_world))
}

fn contact_at(near: &Separation, time: f64, steps: u32, certain: bool) -> TimeOfImpact {
    let apart = near.on_a - near.on_b;
    let normal = if near.distance > 0.0 { apart.try_normalize() } else { None };
    TimeOfImpact { time, on_a: near.on_a, on_b: near.on_b, normal, separation: near.distance, steps, certain }
}
