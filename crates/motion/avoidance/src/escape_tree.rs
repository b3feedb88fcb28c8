//! Offline search in configuration, velocity and time: decides whether an escape exists at all.
//!
//! Random time-optimal joint motions from random states grow a tree of states; each motion is kept as long as it is
//! free (a kinodynamic RRT, `LaValle` and Kuffner 2001, "Randomized kinodynamic planning"). The search tells whether a
//! hit could have been evaded, given the motion of all obstacles. A controller does not have time for this search.

use elbowroom_kinematics::JointLimits;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneError};

use crate::DynamicObstacles;
use crate::escape_check::{EscapeCheck, EscapeMotion};
use crate::escape_trajectory::{EscapeStart, EscapeTrajectory};
use crate::reversal_limiter::ReversalLimiter;

/// Clearance of a motion that counts as free, m.
const CLEARANCE_M: f64 = 1e-3;
/// Fraction of motions to random configurations within the limits; the other motions end near their start.
const GLOBAL_SHARE: f64 = 0.3;
/// Range of the other motions, in seconds of a joint at full speed.
const LOCAL_S: f64 = 1.0;
/// Fraction of the expansions that start at the latest state of the tree.
const LATEST_SHARE: f64 = 0.3;
/// Largest distance of a random target from the start of its motion, per joint, rad or m.
const UNLIMITED: f64 = 6.3;

/// Result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EscapeTreeReport {
    /// Number of tried motions.
    pub tries: usize,
    /// Smallest distance on the escape, m; `None` if no escape was found.
    pub gap_m: Option<f64>,
    /// Longest time without a hit, s: the horizon if an escape was found.
    pub longest_s: f64,
}

/// A state of the tree.
#[derive(Debug)]
struct Node {
    q: Vec<f64>,
    qd: Vec<f64>,
    t_s: f64,
    gap_m: f64,
}

/// Searches an escape of a robot from `q` and `qd` (rad, rad/s; m for prismatic joints) that is free of everything in
/// the scene for `horizon_s` seconds, with at most `tries` motions. `random` returns numbers in [0, 1). Moving
/// obstacles are assumed to continue their observed motion.
///
/// # Errors
/// The scene rejects joint values or poses.
#[allow(clippy::too_many_arguments, reason = "a state, a scene and the size of the search")]
pub fn search_escape_tree(
    scene: &Scene,
    robot: RobotId,
    limits: &[JointLimits],
    [q, qd]: [&[f64]; 2],
    obstacles: &DynamicObstacles<'_>,
    horizon_s: f64,
    tries: usize,
    random: &mut dyn FnMut() -> f64,
) -> Result<EscapeTreeReport, SceneError> {
    let reversals = ReversalLimiter::new(q.len(), 0.0);
    let mut check = EscapeCheck::new(scene, robot);
    let mut trajectory = EscapeTrajectory::new(q.len());
    let mut nodes = vec![Node { q: q.to_vec(), qd: qd.to_vec(), t_s: 0.0, gap_m: f64::INFINITY }];
    let (mut longest_s, mut target) = (0.0_f64, q.to_vec());
    for n in 0..tries {
        let latest = (0..nodes.len()).max_by(|a, b| nodes[*a].t_s.total_cmp(&nodes[*b].t_s)).unwrap_or(0);
        let any = ((random() * nodes.len() as f64) as usize).min(nodes.len() - 1);
        let from = if random() < LATEST_SHARE { latest } else { any };
        let is_global = random() < GLOBAL_SHARE;
        for (j, limit) in limits.iter().enumerate() {
            let at = nodes[from].q[j];
            let near = (2.0 * random() - 1.0) * LOCAL_S * limit.velocity;
            let (low, high) = (limit.lower.max(at - UNLIMITED), limit.upper.min(at + UNLIMITED));
            target[j] = if is_global { low + (high - low) * random() } else { (at + near).clamp(low, high) };
        }
        let node = &nodes[from];
        let start = EscapeStart { q: &node.q, qd: &node.qd, limits, speed_share: 1.0, reversals: &reversals };
        trajectory.set_target(&target, &start);
        let left_s = horizon_s - node.t_s;
        let (t_s, gap_m) = (node.t_s, node.gap_m);
        let mut motion = EscapeMotion { trajectory: &trajectory, elapsed_s: 0.0, begins_s: t_s, horizon_s: left_s };
        let moving = check.meets_moving(&motion, obstacles, CLEARANCE_M, |_| true)?;
        let free_s = moving.hit.map_or(left_s, |hit| hit.time_s);
        let gap_m = gap_m.min(moving.gap_m);
        if moving.is_free() && check.keeps_clear_of_fixed(&motion, obstacles, CLEARANCE_M)? {
            return Ok(EscapeTreeReport { tries: n + 1, gap_m: Some(gap_m), longest_s: horizon_s });
        }
        // A random part of the motion until the first moving obstacle, if this part is free of fixed obstacles.
        motion.horizon_s = free_s.min(trajectory.duration_s) * random();
        if motion.horizon_s <= 0.0 || !check.keeps_clear_of_fixed(&motion, obstacles, CLEARANCE_M)? {
            continue;
        }
        longest_s = longest_s.max(t_s + free_s);
        let (mut q, mut qd) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        trajectory.state_at(motion.horizon_s, &mut q, &mut qd);
        nodes.push(Node { q, qd, t_s: t_s + motion.horizon_s, gap_m });
    }
    Ok(EscapeTreeReport { tries, gap_m: None, longest_s })
}
