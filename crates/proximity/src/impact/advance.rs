//! Conservative advancement: go on for as long as nothing can touch, look again.

use elbowroom_spatial::{Pose, Vec3};

use super::bound::{Body, Bounds};
use super::{Impact, Options, Path, slab};
use crate::mesh::{Hint, Scratch};
use crate::{Separation, Shape};

/// Positions are computed to about this fraction of their size; nothing finer can be told apart.
const RESOLUTION: f64 = 64.0 * f64::EPSILON;

pub(super) fn advance(
    a: (&Shape, &dyn Path),
    b: (&Shape, &dyn Path),
    options: &Options,
    scratch: &mut Scratch,
) -> Option<Impact> {
    let (body_a, body_b) = (Body::new(a.0, a.1), Body::new(b.0, b.1));
    let mut tolerance = options.tolerance;
    let mut hint = Hint::default();
    let mut t = 0.0;
    for steps in 1.. {
        let bounds = Bounds { a: &body_a, b: &body_b, a_in_world: a.1.pose(t), b_in_world: b.1.pose(t), t };
        let (pa, pb) = (&bounds.a_in_world, &bounds.b_in_world);
        let finest = resolution(&bounds);
        let limit = bounds.until_end() + finest;
        // Farther than the rest of the motion can close: free.
        let near = scratch.separation(a.0, pa, b.0, pb, limit, &mut hint)?;
        if steps == 1 && options.free_to_leave && near.lower_bound > 0.0 {
            tolerance = tolerance.min(0.5 * near.lower_bound);
        }
        let tolerance = if tolerance > finest { tolerance } else { finest };
        let found = |certain| Some(impact(&near, t, steps, certain));
        if !(near.distance > tolerance) {
            return found(near.distance <= tolerance && pa.is_finite() && pb.is_finite());
        }
        // Half the tolerance stays: the distance never reaches 0, so that witness points always tell a direction.
        let keep = 0.5 * tolerance;
        let free = bounds.time_for(near.lower_bound - keep).max(along(&bounds, &near, keep));
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

/// Time that the empty slab between the two allows.
fn along(bounds: &Bounds, near: &Separation, keep: f64) -> f64 {
    match slab::between(bounds.a.shape, &bounds.a_in_world, bounds.b.shape, &bounds.b_in_world, near) {
        Some((normal, thickness)) => bounds.time_for_slab(thickness - keep, normal),
        None => 0.0,
    }
}

/// Metres below which poses of this size cannot be told apart.
fn resolution(bounds: &Bounds) -> f64 {
    let one = |body: &Body, pose: &Pose| {
        let radius = body.carrier.map_or(0.0, |c| c.radius());
        let turns = body.steady.map_or(0.0, |s| s.rotation.length());
        let arm = body.steady.map_or(Vec3::ZERO, |s| s.start.translation - s.pivot).length();
        let pivot = body.steady.map_or(0.0, |s| s.pivot.length());
        pose.translation.length() + pivot + (radius + arm) * (1.0 + turns)
    };
    RESOLUTION * (one(bounds.a, &bounds.a_in_world) + one(bounds.b, &bounds.b_in_world))
}

fn impact(near: &Separation, time: f64, steps: u32, certain: bool) -> Impact {
    let apart = near.on_a - near.on_b;
    let normal = if near.distance > 0.0 { apart.try_normalize() } else { None };
    Impact { time, on_a: near.on_a, on_b: near.on_b, normal, separation: near.distance, steps, certain }
}
