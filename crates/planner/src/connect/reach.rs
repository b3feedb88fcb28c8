//! How far a joint carries the solids below it: what makes joints of different kind and place comparable.

use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_scene::Robot;
use elbowroom_spatial::{Pose, Vec3};

use super::bounds::{Bounds, Window};
use super::random::Random;

/// Configurations that are looked at.
const SAMPLES: usize = 16;
/// Change of a joint, rad or m.
const LITTLE: f64 = 1e-4;
/// A joint counts at least so much of the one that moves most.
const LEAST: f64 = 0.05;

/// Metres that the farthest solid moves per rad (or m) of each value: an estimate, as nothing is proven with it.
pub(super) fn reach(robot: &Robot, bounds: &Bounds) -> Vec<f64> {
    let corners = corners(robot);
    let dof = bounds.dof();
    let middle: Vec<f64> = vec![0.0; dof];
    let window: Window = bounds.window(&middle, &middle);
    let (mut random, mut state) = (Random::new(0), ChainState::new(&robot.chain));
    let (mut q, mut reach) = (middle, vec![0.0_f64; dof]);
    for _ in 0..SAMPLES {
        window.sample(1.0, &mut random, &mut q);
        let before = placed(&robot.chain, &mut state, &q, &corners);
        for i in 0..dof {
            let held = q[i];
            q[i] += LITTLE;
            let after = placed(&robot.chain, &mut state, &q, &corners);
            q[i] = held;
            let moved = before.iter().zip(&after).map(|(a, b)| (*b - *a).length() / LITTLE);
            reach[i] = moved.fold(reach[i], f64::max);
        }
    }
    let most = reach.iter().copied().fold(0.0, f64::max);
    let least = if most > 0.0 { LEAST * most } else { 1.0 };
    reach.into_iter().map(|r| r.max(least)).collect()
}

/// Points that the solids of each link lie between, in the link's frame.
fn corners(robot: &Robot) -> Vec<(LinkId, Vec<Vec3>)> {
    let of = |bodies: &Vec<elbowroom_scene::Body>| {
        let boxes = bodies.iter().map(|b| in_link(&b.shape, b.in_link));
        boxes.flatten().filter(|p| p.length().is_finite()).collect()
    };
    robot.bodies.iter().enumerate().map(|(i, bodies)| (LinkId(i), of(bodies))).collect()
}

fn in_link(shape: &Shape, in_link: Pose) -> [Vec3; 8] {
    let all = shape.aabb(&in_link);
    let pick = |k: usize, bit: usize, i: usize| if k & bit == 0 { all.min[i] } else { all.max[i] };
    std::array::from_fn(|k| Vec3::new(pick(k, 1, 0), pick(k, 2, 1), pick(k, 4, 2)))
}

fn placed(chain: &Chain, state: &mut ChainState, q: &[f64], corners: &[(LinkId, Vec<Vec3>)]) -> Vec<Vec3> {
    state.q.copy_from_slice(q);
    chain.forward(state);
    let all = corners.iter().map(|(link, points)| (state.link_in_root(*link), points));
    all.flat_map(|(pose, points)| points.iter().map(move |p| pose.transform_point(*p))).collect()
}
