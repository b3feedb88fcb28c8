//! Entries that follow from the models alone, before any geometry is measured.

use elbowroom_robot::{GeometryId, RobotId};

use super::entry::{PairEntry, PairState};
use super::matrix::AllowedCollisionMatrix;
use super::reason::Reason;
use crate::pair_weight::{WeightPrior, joints_between};
use crate::{Object, SceneRobot};

/// Builds the matrix by the rules of [`collision_pairs`](elbowroom_robot::collision_pairs).
///
/// `ids` are the links and objects that have shapes; `padding` is in metres.
pub(crate) fn by_rules(
    robots: &[SceneRobot],
    objects: &[Object],
    ids: &[GeometryId],
    padding: &dyn Fn(GeometryId) -> f64,
) -> AllowedCollisionMatrix {
    let priors: Vec<WeightPrior> = ids.iter().map(|id| WeightPrior::of(robots, objects, *id)).collect();
    let mut entries = Vec::new();
    for (i, &a) in ids.iter().enumerate() {
        for (k, &b) in ids.iter().enumerate().skip(i + 1) {
            let (state, reason) = match rule(robots, a, b) {
                Rule::NoPair => continue,
                Rule::Skip(reason) => (PairState::Skipped, reason),
                Rule::Test => (PairState::Tested, Reason::Default),
            };
            entries.push(PairEntry {
                a,
                b,
                state,
                margin_m: padding(a) + padding(b),
                weight: priors[i].weight(&priors[k], joints_between(robots, a, b)),
                reason,
                suggestion: None,
            });
        }
    }
    AllowedCollisionMatrix::new(entries)
}

/// Result of the rules for two geometries.
enum Rule {
    /// No entry.
    NoPair,
    Skip(Reason),
    Test,
}

fn rule(robots: &[SceneRobot], a: GeometryId, b: GeometryId) -> Rule {
    let movable = |robot: RobotId, link| robots[robot.0].robot.chain.is_movable(link);
    let test_if = |moves: bool| if moves { Rule::Test } else { Rule::Skip(Reason::NoJointBetween) };
    match (a, b) {
        (GeometryId::Link { robot: ra, link: la }, GeometryId::Link { robot: rb, link: lb }) if ra == rb => {
            match robots[ra.0].robot.exclusion(la, lb) {
                Some(exclusion) => Rule::Skip(exclusion.into()),
                None => Rule::Test,
            }
        }
        (GeometryId::Link { robot: ra, link: la }, GeometryId::Link { robot: rb, link: lb }) => {
            test_if(movable(ra, la) || movable(rb, lb))
        }
        (GeometryId::Link { robot, link }, GeometryId::Object(_))
        | (GeometryId::Object(_), GeometryId::Link { robot, link }) => test_if(movable(robot, link)),
        (GeometryId::Object(_), GeometryId::Object(_)) => Rule::NoPair,
    }
}
