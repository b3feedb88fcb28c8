//! RRT-Connect planner on sphere covers.

use std::time::{Duration, Instant};

use elbowroom_scene::SceneState;

use super::constrained_validator::ConstrainedValidator;
use super::cover_model::{CoverModel, CoverObstacles};
use super::cover_validator::CoverValidator;
use super::disconnection_proof::Projection;
use super::query_ends::QueryEnds;
use super::separating_value::SeparatingValue;
use crate::deadline::Deadline;
use crate::interpolation::{length, path_length};
use crate::joint_path::JointPath;
use crate::rrt_connect::{
    MotionValidator, Random, RegionSampler, RrtConnect, RrtConnectError, RrtConnectSettings, Shortcutting, TreeSearch,
};

/// Fraction of the time limit after which the exact scene is searched.
const COVER_SHARE: f64 = 0.5;
/// Fraction of its time after which a search on covers is interrupted to try to prove that no path exists.
const FIRST_SHARE: f64 = 0.02;
/// Time before which a search is not interrupted, because most paths are found within it.
const FIRST_TIME: Duration = Duration::from_millis(20);
/// Fraction of its time after which a search with a short time limit is interrupted even before that.
const LARGEST_FIRST_SHARE: f64 = 0.4;
/// Fraction of its time that such proofs may take: usually a path exists.
const PROOF_SHARE: f64 = 0.3;
/// Fraction of the proofs' time for values of one joint that no path crosses.
const VALUE_SHARE: f64 = 0.3;

/// Plans for one robot of a scene on sphere covers: the same answers as [`RrtConnect`], much faster.
///
/// Edges are proven by the covers, sixteen configurations at a time. If the covers leave an end open, the exact scene
/// proves an edge that leaves this end; if the covers leave no path, the exact scene is searched.
///
/// ```
/// use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, RrtConnect, RrtConnectSettings};
/// use elbowroom_robot::RobotId;
/// use elbowroom_scene::{SceneState, example};
/// let (scene, robot) = (example::two_arms(), RobotId(0));
/// let mut start = SceneState::new(&scene);
/// start.set_q(&scene, robot, &[-0.9, 1.3, 0.6])?;
/// let model = CoverModel::new(&scene, &start, robot, 0.0)?;
/// let obstacles = CoverObstacles::new(&model, &scene, &start, 0.0);
/// let mut planner = CoverRrtConnect::new(RrtConnect::new(&scene, robot)?, &model, &obstacles);
/// let path = planner.plan(&start, &[0.9, 1.3, 0.6], &RrtConnectSettings::default())?;
/// assert!(path.waypoints.len() > 2 && path.length_rad < 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct CoverRrtConnect<'m> {
    pub(super) exact: RrtConnect<'m>,
    pub(super) covers: CoverValidator<'m>,
}

impl<'m> CoverRrtConnect<'m> {
    /// Creates a planner on the covers of the robot of an exact planner, whose limits and constraint also apply here.
    pub fn new(exact: RrtConnect<'m>, model: &'m CoverModel, obstacles: &'m CoverObstacles) -> Self {
        let covers = CoverValidator::new(model, obstacles, exact.robot());
        Self { exact, covers }
    }

    /// Plans from the robot's configuration in `start` to `goal` (rad, m for prismatic joints). Everything else in the
    /// scene must be where it was when the obstacles were made, with the same clearance.
    ///
    /// # Errors
    /// The errors of [`RrtConnect::plan`]; and [`RrtConnectError::Disconnected`] if it is proven that no path exists.
    pub fn plan(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        self.plan_to_any(start, &[goal], settings)
    }

    /// Like [`plan`](Self::plan), but stops at the first of several goals that it reaches; the last waypoint is that
    /// goal. Goals that are beyond limits or not free are skipped.
    ///
    /// # Errors
    /// The errors of [`plan`](Self::plan); a proof covers these goals only. If no goal is valid, the error of the first
    /// goal; [`RrtConnectError::NoGoal`] without goals.
    pub fn plan_to_any<G: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        goals: &[G],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        let begin = Instant::now();
        let on_covers = RrtConnectSettings { time_limit: settings.time_limit.mul_f64(COVER_SHARE), ..*settings };
        let on_covers = match self.plan_on_covers(begin, start, goals, &on_covers) {
            Err(error @ RrtConnectError::NotFound { .. }) => error,
            other => return other,
        };
        let spent = begin.elapsed();
        let left = RrtConnectSettings { time_limit: settings.time_limit.saturating_sub(spent), ..*settings };
        let path = self.exact.plan_to_any(start, goals, &left).map_err(|e| e.after(&on_covers))?;
        Ok(JointPath { planning_time: path.planning_time + spent, ..path })
    }

    fn plan_on_covers<G: AsRef<[f64]>>(
        &mut self,
        begin: Instant,
        start: &SceneState,
        goals: &[G],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        let mut random = Random::new(settings.seed);
        let ends = self.validator().query_ends(start, goals, settings, &mut random)?;
        let mut waypoints = match self.straight(&ends) {
            Some(straight) => straight,
            None => self.search(begin, &ends, settings, &mut random)?,
        };
        let planning_time = begin.elapsed();
        let raw_length_rad = path_length(&waypoints);
        let mut search = self.validator();
        if waypoints.len() > 2 {
            // The straight segment was tested first.
            Shortcutting::of_rejected_ends(&mut search, &waypoints).run(&mut waypoints);
        }
        let path = JointPath {
            length_rad: path_length(&waypoints),
            raw_length_rad,
            waypoints,
            planning_time,
            simplification_time: begin.elapsed().saturating_sub(planning_time),
            states_checked: self.covers.states_checked(),
        };
        Ok(ends.completed(path))
    }

    pub(super) fn validator(&mut self) -> ConstrainedValidator<'_, 'm> {
        ConstrainedValidator { exact: &mut self.exact, covers: &mut self.covers }
    }

    /// The first straight segment to a goal that is proven free, nearest goals first.
    fn straight(&mut self, ends: &QueryEnds) -> Option<Vec<Vec<f64>>> {
        let from = ends.from();
        let mut goals: Vec<&[f64]> = ends.goals().collect();
        goals.sort_by(|a, b| length(from, a).total_cmp(&length(from, b)));
        let mut search = self.validator();
        let reached = goals.into_iter().find(|to| search.motion_is_free(from, to))?;
        Some(vec![from.to_vec(), reached.to_vec()])
    }

    /// Searches for waypoints from the start to a goal.
    fn search(
        &mut self,
        begin: Instant,
        ends: &QueryEnds,
        settings: &RrtConnectSettings,
        random: &mut Random,
    ) -> Result<Vec<Vec<f64>>, RrtConnectError> {
        let region = self.exact.validator.bounds.sampling_region_of(ends.all());
        let mut sampler = RegionSampler::new(region, random);
        let last_deadline = self.exact.validator.deadline.clone();
        self.covers.extend_deadline(last_deadline.no_later_than(begin + time_before_proof(settings.time_limit)));
        let mut search = self.validator();
        let mut trees = TreeSearch::new(&mut search, ends.from(), ends.goals());
        let mut found = trees.run(&mut sampler);
        if found.is_none() {
            let proof_deadline = Instant::now() + settings.time_limit.mul_f64(PROOF_SHARE);
            trees.validator.expect_connected(ends, &last_deadline.no_later_than(proof_deadline))?;
            trees.validator.covers.extend_deadline(last_deadline);
            found = trees.run(&mut sampler);
        }
        let nodes = trees.nodes();
        found.ok_or_else(|| self.covers.not_found(begin.elapsed(), nodes))
    }
}

/// Time of a search on covers until it tries to prove that no path exists.
fn time_before_proof(limit: Duration) -> Duration {
    limit.mul_f64(FIRST_SHARE).max(FIRST_TIME.min(limit.mul_f64(LARGEST_FIRST_SHARE)))
}

impl ConstrainedValidator<'_, '_> {
    /// Returns an error if it is proven that no path leads from the start to any goal.
    fn expect_connected(&mut self, ends: &QueryEnds, deadline: &Deadline) -> Result<(), RrtConnectError> {
        let bounds = &self.exact.validator.bounds;
        let ranges = bounds.ranges();
        if ends.misses_goals() {
            return Ok(());
        }
        let (scene, state) = self.exact.validator.scene_state();
        let mut separating = SeparatingValue::new(scene, state, self.exact.robot(), ranges.clone());
        let mut proof = None;
        for to in ends.goals() {
            let from = ends.from();
            let of_values = deadline.no_later_than(Instant::now() + deadline.left().mul_f64(VALUE_SHARE));
            let of_value = separating.joint_between(from, to, &of_values).map(|joint| vec![joint]);
            let mut all = projections(bounds.dof()).into_iter();
            let joints = of_value.or_else(|| {
                let found = all.find(|some| self.covers.are_disconnected(&ranges, [from, to], some, deadline));
                found.map(|projection| projection.joints)
            });
            match joints {
                Some(joints) => proof = proof.or(Some((joints, to))),
                None => return Ok(()),
            }
        }
        proof.map_or(Ok(()), |(joints, to)| {
            let joints = joints.iter().map(|&j| bounds.name(j).to_owned()).collect();
            Err(RrtConnectError::Disconnected { joints, nearer: bounds.equivalent_goals(ends.from(), to) })
        })
    }
}

/// Each joint alone, then neighbours in the chain; the cells are finer for fewer joints.
fn projections(dof: usize) -> Vec<Projection> {
    let neighbours = |count: usize, step: f64| {
        (0..(dof + 1).saturating_sub(count)).map(move |j| Projection { joints: (j..j + count).collect(), step })
    };
    [(1, 0.01), (2, 0.04), (3, 0.1)].into_iter().flat_map(|(count, step)| neighbours(count, step)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_time_limit_is_not_spent_on_proofs() {
        let ms = Duration::from_millis;
        let times = [10, 50, 2500].map(|limit| time_before_proof(ms(limit)));
        assert_eq!(times, [ms(4), ms(20), ms(50)]);
    }
}
