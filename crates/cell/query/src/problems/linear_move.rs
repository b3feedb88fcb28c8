//! Straight motions of a link (`LIN`), and how far they are off their line.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_planner::{JointPath, LinearMove, RobotPlanner};
use elbowroom_spatial::Pose;

use super::problem_scene::{ProblemScene, ROBOT};
use super::{ProblemSettings, Unsolved, rrt_connect};
use crate::plan::LINE_TOLERANCE;

/// Largest deviation of a link from a straight line on a motion.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct LineDeviation {
    /// Distance from the line, m.
    pub metres: f64,
    /// Rotation from the orientation on the line, rad.
    pub angle_rad: f64,
}

/// The line of a link from its pose at the start of a problem to its pose at a goal. Poses are in the root link.
fn line(problem: &ProblemScene, link: LinkId, goal: &[f64]) -> LinearMove {
    let base_in_world = problem.scene().robots()[ROBOT.0].base_in_world;
    LinearMove {
        link,
        tip_in_link: Pose::IDENTITY,
        target_in_world: base_in_world * link_in_root(problem, link, goal),
        tolerance_m: LINE_TOLERANCE.0,
        tolerance_rad: LINE_TOLERANCE.1,
    }
}

fn link_in_root(problem: &ProblemScene, link: LinkId, q: &[f64]) -> Pose {
    let chain = &problem.scene().robots()[ROBOT.0].robot.chain;
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(q);
    chain.forward(&mut state);
    state.link_in_root(link)
}

/// The line to the first goal that a planner follows to its end.
///
/// # Errors
/// No line can be followed: how far the line to the first goal can, and why.
pub(super) fn plan(
    mut planner: RobotPlanner,
    problem: &ProblemScene,
    link: LinkId,
    settings: &ProblemSettings,
) -> Result<JointPath, Unsolved> {
    let begin = std::time::Instant::now();
    let rrt = rrt_connect::rrt_settings(settings, settings.time_limit);
    let mut first = None;
    for goal in problem.goals() {
        match planner.plan_linear(problem.start(), &line(problem, link, goal), &rrt) {
            Ok(path) => return Ok(JointPath { planning_time: begin.elapsed(), ..path }),
            Err(e) => first = first.or(Some(rrt_connect::reason(&e))),
        }
    }
    Err(Unsolved { reason: first.unwrap_or_default(), planning: begin.elapsed() })
}

/// How far a link is off the line between its first and its last pose, at these configurations.
///
/// The part of the line at which the orientation is compared is the one that translation and rotation together come
/// nearest to, 1 m counting as 1 rad.
pub(super) fn deviation<'q>(
    problem: &ProblemScene,
    link: LinkId,
    configurations: impl Iterator<Item = &'q [f64]>,
) -> LineDeviation {
    let poses: Vec<Pose> = configurations.map(|q| link_in_root(problem, link, q)).collect();
    let ends = poses.first().zip(poses.last());
    ends.map_or_else(LineDeviation::default, |(from, to)| largest_deviation(from, to, &poses))
}

fn largest_deviation(from: &Pose, to: &Pose, poses: &[Pose]) -> LineDeviation {
    let way = to.translation - from.translation;
    let turn = from.inverse_mul(to).rotation.to_rotation_vector();
    let size = way.length_squared() + turn.length_squared();
    let mut largest = LineDeviation::default();
    for pose in poses {
        let gone = pose.translation - from.translation;
        let turned = from.inverse_mul(pose).rotation.to_rotation_vector();
        let part = if size > 0.0 { ((gone.dot(way) + turned.dot(turn)) / size).clamp(0.0, 1.0) } else { 0.0 };
        let off = from.interpolate(to, part).inverse_mul(pose);
        largest.angle_rad = largest.angle_rad.max(off.rotation.angle());
        let along =
            if way.length_squared() > 0.0 { (gone.dot(way) / way.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
        largest.metres = largest.metres.max((gone - way * along).length());
    }
    largest
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Rotation, Vec3};

    use super::*;

    #[test]
    fn deviations_are_the_distance_from_the_line_and_the_rotation_at_that_part() {
        let from = Pose::from_translation(Vec3::new(0.3, 0.0, 1.0));
        let to = Pose::new(Rotation::from_axis_angle(Vec3::Z, 0.8), Vec3::new(0.3, 0.5, 1.0));
        let on_line: Vec<Pose> = (0..=10).map(|i| from.interpolate(&to, 0.1 * f64::from(i))).collect();
        let exact = largest_deviation(&from, &to, &on_line);
        assert!(exact.metres < 1e-12 && exact.angle_rad < 1e-7, "{exact:?}");
        let mut bent = on_line.clone();
        bent[4] = Pose::new(bent[4].rotation, bent[4].translation + Vec3::new(0.003, 0.0, 0.004));
        bent[7] = Pose::new(bent[7].rotation * Rotation::from_axis_angle(Vec3::X, 0.02), bent[7].translation);
        let found = largest_deviation(&from, &to, &bent);
        assert!((found.metres - 0.005).abs() < 1e-9 && (found.angle_rad - 0.02).abs() < 1e-4, "{found:?}");
        // A motion that turns only after it has arrived.
        let late = [from, Pose::new(from.rotation, to.translation), to];
        let found = largest_deviation(&from, &to, &late);
        assert!(found.metres < 1e-12 && found.angle_rad > 0.2, "{found:?}");
        // A turn in place, and no motion at all.
        let turn = Pose::new(to.rotation, from.translation);
        assert!(largest_deviation(&from, &turn, &[from, from.interpolate(&turn, 0.3), turn]).angle_rad < 1e-7);
        assert_eq!(largest_deviation(&from, &from, &[from, from]).metres, 0.0);
    }
}
