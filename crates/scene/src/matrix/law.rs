//! What the models themselves say about each pair, before anything is measured.

use crate::pairs::{is_moved, why_no_pair};
use crate::weight::{Prior, joints_between};
use crate::{Member, Object, PairEntry, PairMatrix, PairState, Reason, SceneRobot};

/// The matrix by the rule of [`pairs`](crate::pairs::pairs); `solid` members only, `padding` in metres.
pub(crate) fn by_law(
    robots: &[SceneRobot],
    objects: &[Object],
    members: &[Member],
    padding: &dyn Fn(Member) -> f64,
) -> PairMatrix {
    let priors: Vec<Prior> = members.iter().map(|m| Prior::of(robots, objects, *m)).collect();
    let mut entries = Vec::new();
    for (i, &a) in members.iter().enumerate() {
        for (k, &b) in members.iter().enumerate().skip(i + 1) {
            let Some(why_not) = why_skipped(robots, a, b) else { continue };
            let state = if why_not.is_some() { PairState::Skipped } else { PairState::Tested };
            entries.push(PairEntry {
                a,
                b,
                state,
                margin_m: padding(a) + padding(b),
                weight: priors[i].weight(&priors[k], joints_between(robots, a, b)),
                reason: why_not.unwrap_or(Reason::Default),
                suggestion: None,
            });
        }
    }
    PairMatrix::new(entries)
}

/// Outer `None`: no entry at all.
#[allow(clippy::option_option)]
fn why_skipped(robots: &[SceneRobot], a: Member, b: Member) -> Option<Option<Reason>> {
    let moved = |robot: usize, link| is_moved(&robots[robot].robot.chain, link);
    let apart = |moves: bool| Some((!moves).then_some(Reason::NoJointBetween));
    match (a, b) {
        (Member::Link { robot: ra, link: la }, Member::Link { robot: rb, link: lb }) if ra == rb => {
            Some(why_no_pair(&robots[ra].robot, la, lb))
        }
        (Member::Link { robot: ra, link: la }, Member::Link { robot: rb, link: lb }) => {
            apart(moved(ra, la) || moved(rb, lb))
        }
        (Member::Link { robot, link }, Member::Object(_)) | (Member::Object(_), Member::Link { robot, link }) => {
            apart(moved(robot, link))
        }
        (Member::Object(_), Member::Object(_)) => None,
    }
}
