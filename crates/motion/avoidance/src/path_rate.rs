//! The rate at which the path advances.

use elbowroom_kinematics::{Chain, ChainState};

use crate::detour::SAME_CONFIGURATION_S;
use crate::{PathKind, ProximityPair, ReactiveSettings, Reference};
use elbowroom_kinematics::JointLimits;

/// Fraction of the permitted decrease of a distance that the motion along the path uses; the rest is left to an
/// evasion.
const APPROACH_SHARE: f64 = 0.5;

/// The state of the robot relative to its path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathState<'a> {
    /// Commanded joint values.
    pub(crate) q: &'a [f64],
    pub(crate) limits: &'a [JointLimits],
    pub(crate) deviation_s: f64,
    /// Deviation at which a path that may be left stops, in seconds of joint motion at full speed.
    pub(crate) max_deviation_s: f64,
}

/// Whether the robot is so far off its path that the path does not advance.
pub(crate) fn is_path_held(path: PathKind, deviation_s: f64, max_deviation_s: f64) -> bool {
    match path {
        PathKind::Continuous => deviation_s > SAME_CONFIGURATION_S,
        PathKind::PointToPoint => deviation_s >= max_deviation_s,
    }
}

/// Rate of the path, 0 to 1. `approach_rate` is the rate near obstacles of a path that must be kept.
pub(crate) fn path_rate(reference: &Reference<'_>, state: &PathState<'_>, approach_rate: impl FnOnce() -> f64) -> f64 {
    let deviation_s = state.deviation_s;
    match reference.path {
        PathKind::Continuous if deviation_s > SAME_CONFIGURATION_S => 0.0,
        PathKind::Continuous => approach_rate(),
        // The robot is ahead of its path: the nearest point of the path lies farther on.
        PathKind::PointToPoint if deviation_s > SAME_CONFIGURATION_S && lead(reference, state) > 0.0 => 1.0,
        PathKind::PointToPoint => (1.0 - deviation_s / state.max_deviation_s).max(0.0),
    }
}

/// Signed lead of the robot over the reference, in the norm of the joints' speeds: positive if the robot is ahead.
fn lead(reference: &Reference<'_>, state: &PathState<'_>) -> f64 {
    let joints = reference.qd.iter().zip(reference.q.iter().zip(state.q)).zip(state.limits);
    joints.map(|((v, (to, from)), l)| v * (from - to) / (l.velocity * l.velocity)).sum()
}

/// Rate at which the distances of dynamic obstacles decrease as fast as [`APPROACH_SHARE`] permits.
pub(crate) fn approach_rate<'a>(
    chain: &Chain,
    state: &ChainState,
    pairs: impl Iterator<Item = &'a ProximityPair>,
    settings: &ReactiveSettings,
    qd: &[f64],
    columns: &mut [[f64; 6]],
) -> f64 {
    let mut rate: f64 = 1.0;
    for pair in pairs.filter(|p| p.obstacle.is_dynamic()) {
        let in_link = state.link_in_root(pair.link).inverse().transform_point(pair.on_link);
        chain.jacobian(state, pair.link, in_link, columns);
        let along = |c: &[f64; 6]| c[0] * pair.away.x + c[1] * pair.away.y + c[2] * pair.away.z;
        let closing: f64 = -columns.iter().zip(qd).map(|(c, v)| along(c) * v).sum::<f64>();
        if closing > 0.0 {
            let allowed = APPROACH_SHARE * (pair.distance_m - settings.clearance_m) / settings.closing_s
                - pair.away.dot(pair.obstacle_velocity()).max(0.0);
            rate = rate.min((allowed / closing).max(0.0));
        }
    }
    rate
}
