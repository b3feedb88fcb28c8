//! Weights that make joints of different kind and place comparable: the motion of the solids that depend on each joint.

use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};

use super::joint_bounds::JointBounds;
use super::random::Random;

/// Number of sampled configurations.
const SAMPLES: usize = 16;
/// Step of the difference quotient, rad or m.
const DIFFERENCE_STEP: f64 = 1e-4;
/// Least weight of a joint, as a fraction of the largest.
const MIN_WEIGHT_RATIO: f64 = 0.05;

/// Motion of the farthest point of a solid per value, m per rad (or m): an estimate, not used in proofs.
pub(super) fn joint_weights(robot: &Robot, bounds: &JointBounds) -> Vec<f64> {
    let corners = corners(robot);
    let dof = bounds.dof();
    let mut q = vec![0.0; dof];
    let region = bounds.sampling_region(&q, &q);
    let (mut random, mut state) = (Random::new(0), ChainState::new(&robot.chain));
    let mut weights = vec![0.0_f64; dof];
    for _ in 0..SAMPLES {
        region.sample(1.0, &mut random, &mut q);
        let before = points_in_root(&robot.chain, &mut state, &q, &corners);
        for i in 0..dof {
            let held = q[i];
            q[i] += DIFFERENCE_STEP;
            let after = points_in_root(&robot.chain, &mut state, &q, &corners);
            q[i] = held;
            let moved = before.iter().zip(&after).map(|(a, b)| (*b - *a).length() / DIFFERENCE_STEP);
            weights[i] = moved.fold(weights[i], f64::max);
        }
    }
    let most = weights.iter().copied().fold(0.0, f64::max);
    let least = if most > 0.0 { MIN_WEIGHT_RATIO * most } else { 1.0 };
    weights.into_iter().map(|w| w.max(least)).collect()
}

/// Corners of the bounding boxes of each link's solids, in the link's frame.
fn corners(robot: &Robot) -> Vec<(LinkId, Vec<Vec3>)> {
    let corners = |colliders: &Vec<elbowroom_robot::Collider>| {
        let boxes = colliders.iter().map(|b| box_corners(&b.shape, b.in_link));
        boxes.flatten().filter(|p| p.length().is_finite()).collect()
    };
    robot.colliders.iter().enumerate().map(|(i, colliders)| (LinkId(i), corners(colliders))).collect()
}

fn box_corners(shape: &Shape, in_link: Pose) -> [Vec3; 8] {
    let bounds = shape.aabb(&in_link);
    let pick = |k: usize, bit: usize, i: usize| if k & bit == 0 { bounds.min[i] } else { bounds.max[i] };
    std::array::from_fn(|k| Vec3::new(pick(k, 1, 0), pick(k, 2, 1), pick(k, 4, 2)))
}

fn points_in_root(chain: &Chain, state: &mut ChainState, q: &[f64], corners: &[(LinkId, Vec<Vec3>)]) -> Vec<Vec3> {
    state.q.copy_from_slice(q);
    chain.forward(state);
    let all = corners.iter().map(|(link, points)| (state.link_in_root(*link), points));
    all.flat_map(|(pose, points)| points.iter().map(move |p| pose.transform_point(*p))).collect()
}
