//! Links that are always near each other without touching: their covers need a smaller slack.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::separation;
use elbowroom_robot::{GeometryId, Robot, collision_pairs};
use elbowroom_spatial::{Pose, Vec3};

use crate::cover::{Ball, ROUNDING_M, SphereCover};

/// Configurations at which the covers of a pair are compared.
const SAMPLES: usize = 24;
/// Slack of each cover as a fraction of the usual gap of its pair. The two slacks together are at most twice this
/// fraction.
const SHARE_OF_GAP: f64 = 0.3;
/// Least slack of a cover, m.
const LEAST_SLACK_M: f64 = 1e-3;

/// Links whose covers touch in every sample although the links do not, each with a slack (m) that keeps them apart.
pub(super) fn closer_slacks(robot: &Robot, covers: &[(LinkId, Option<SphereCover>)]) -> Vec<(LinkId, f64)> {
    let cover = |wanted: LinkId| covers.iter().find(|(link, _)| *link == wanted).and_then(|(_, cover)| cover.as_ref());
    let states = samples(robot);
    let mut slacks = Vec::new();
    for pair in collision_pairs(&[robot], 0) {
        let (GeometryId::Link { link: a, .. }, GeometryId::Link { link: b, .. }) = pair else { continue };
        let (Some(of_a), Some(of_b)) = (cover(a), cover(b)) else { continue };
        let b_in_a = |state: &ChainState| state.link_in_root(a).inverse() * state.link_in_root(b);
        if !states.iter().all(|state| overlap(&of_a.outer, &of_b.outer, &b_in_a(state))) {
            continue;
        }
        let mut gaps: Vec<f64> = states.iter().map(|state| gap_m(robot, a, b, &b_in_a(state))).collect();
        gaps.sort_by(f64::total_cmp);
        let usual_m = gaps[SAMPLES / 2];
        if SHARE_OF_GAP * usual_m >= LEAST_SLACK_M {
            slacks.extend([a, b].map(|link| (link, SHARE_OF_GAP * usual_m)));
        }
    }
    // If a link has several slacks, the smallest counts.
    slacks.sort_by(|(a, of_a), (b, of_b)| a.cmp(b).then(of_a.total_cmp(of_b)));
    slacks.dedup_by_key(|(link, _)| *link);
    slacks
}

/// Configurations spread over the limits, equal on every call.
fn samples(robot: &Robot) -> Vec<ChainState> {
    let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
    let at = |k: usize| {
        let mut state = ChainState::new(&robot.chain);
        for (i, q) in state.q.iter_mut().enumerate() {
            // Multiples of irrational numbers fill the unit interval evenly.
            let share = ((k + 1) as f64 * (2.0 + i as f64).sqrt() * 0.618_033_988_75).fract();
            let is_bounded = lower[i].is_finite() && upper[i].is_finite();
            let (low, high) = if is_bounded { (lower[i], upper[i]) } else { (-3.1, 3.1) };
            *q = low + share * (high - low);
        }
        robot.chain.forward(&mut state);
        state
    };
    (0..SAMPLES).map(at).collect()
}

/// Whether a ball of one cover touches a ball of the other.
///
/// `b_in_a` is the pose of the second cover in the frame of the first.
fn overlap(of_a: &[Ball], of_b: &[Ball], b_in_a: &Pose) -> bool {
    let of_b: Vec<Ball> = of_b.iter().map(|b| Ball { centre: b_in_a.transform_point(b.centre), ..*b }).collect();
    // Most balls of most pairs are far from the whole other cover.
    let near_a = touching(&of_b, &around(of_a));
    let near_b = touching(of_a, &around(&near_a));
    near_a.iter().any(|ball| near_b.iter().any(|other| touch(other, ball)))
}

fn touch(a: &Ball, b: &Ball) -> bool {
    (a.centre - b.centre).length_squared() < (a.radius + b.radius).powi(2)
}

fn touching(balls: &[Ball], whole: &Ball) -> Vec<Ball> {
    balls.iter().filter(|ball| touch(ball, whole)).copied().collect()
}

/// A ball that contains others, with room for rounding errors.
fn around(balls: &[Ball]) -> Ball {
    let centre = balls.iter().fold(Vec3::ZERO, |sum, b| sum + b.centre) * (1.0 / balls.len().max(1) as f64);
    let reach = balls.iter().map(|b| centre.distance(b.centre) + b.radius).fold(0.0, f64::max);
    Ball { centre, radius: reach + ROUNDING_M }
}

/// Distance of the shapes of two links, m.
fn gap_m(robot: &Robot, a: LinkId, b: LinkId, b_in_a: &Pose) -> f64 {
    let of_b = &robot.colliders[b.0];
    let pairs = robot.colliders[a.0].iter().flat_map(|x| of_b.iter().map(move |y| (x, y)));
    let gaps = pairs.map(|(x, y)| separation(&x.shape, &x.in_link, &y.shape, &(*b_in_a * y.in_link)).distance);
    gaps.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    #[test]
    fn covers_overlap_if_any_two_of_their_balls_do() {
        let mut random = SplitMix(3);
        let mut balls = || {
            let count = 1 + random.below(11);
            let ball = |_| Ball { centre: Vec3::from(random.within(1.0)), radius: random.between(0.01, 0.3) };
            (0..count).map(ball).collect::<Vec<_>>()
        };
        let mut counts = [0; 2];
        for i in 0..2000 {
            let (of_a, of_b) = (balls(), balls());
            let b_in_a = Pose::from_translation(Vec3::X * 0.002 * f64::from(i % 1000));
            let naive = of_b.iter().any(|b| {
                let placed = Ball { centre: b_in_a.transform_point(b.centre), ..*b };
                of_a.iter().any(|a| touch(a, &placed))
            });
            assert_eq!(overlap(&of_a, &of_b, &b_in_a), naive, "{of_a:?} {of_b:?}");
            counts[usize::from(naive)] += 1;
        }
        assert!(counts.iter().all(|&count| count > 200), "{counts:?}");
    }
}
