//! The planner.

use std::time::{Duration, Instant};

use elbowroom_scene::{SceneState, SweepOptions};
use elbowroom_validity::Validity;

use super::cover_model::{CoverModel, CoverObstacles};
use super::disconnection_proof::Projection;
use super::edge_validator::{CoverValidator, EdgeValidator};
use super::shortcutting::Shortcutting;
use super::tree_search::{ConfigurationSampler, TreeSearch};
use crate::path::PathEnd;
use crate::rrt_connect::{
    JointBounds, PlannedPath, Random, RrtConnect, RrtConnectError, RrtConnectSettings, SamplingRegion, path_length,
};

/// Configurations tried around an end that the covers leave open.
const EXIT_TRIALS: usize = 400;
/// Largest distance of such a configuration from the end, rad (and m).
const EXIT_RADIUS: f64 = 0.5;
/// Share of the time limit after which the exact scene is searched.
const COVER_SHARE: f64 = 0.5;
/// Share of its time after which a search on covers is interrupted: there may be a proof that no path exists.
const FIRST_SHARE: f64 = 0.02;

/// Plans for one robot of a scene on sphere covers: the same answers as [`RrtConnect`] gives, far sooner.
///
/// Edges are proven by the covers, sixteen configurations at a time. Where the covers leave an end open, the exact scene proves
/// an edge that leaves it; where they leave no path, the exact scene is searched.
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
    /// On the covers of the robot of an exact planner, whose limits and constraint hold here, too.
    pub fn new(exact: RrtConnect<'m>, model: &'m CoverModel, obstacles: &'m CoverObstacles) -> Self {
        let covers = CoverValidator::new(model, obstacles, exact.robot());
        Self { exact, covers }
    }

    /// Plans from the robot's configuration in `start` to `goal` (rad, m for prismatic joints). What else is in the scene must
    /// be where it was when the obstacles were made, and the clearance the same.
    ///
    /// # Errors
    /// As [`RrtConnect::plan`].
    pub fn plan(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<PlannedPath, RrtConnectError> {
        let begin = Instant::now();
        let on_covers = RrtConnectSettings { time_limit: settings.time_limit.mul_f64(COVER_SHARE), ..*settings };
        match self.plan_on_covers(begin, start, goal, &on_covers) {
            Err(RrtConnectError::NotFound { .. }) => {}
            other => return other,
        }
        let spent = begin.elapsed();
        let rest = RrtConnectSettings { time_limit: settings.time_limit.saturating_sub(spent), ..*settings };
        let mut path = self.exact.plan(start, goal, &rest)?;
        path.planning_time += spent;
        Ok(path)
    }

    fn plan_on_covers(
        &mut self,
        begin: Instant,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<PlannedPath, RrtConnectError> {
        let mut random = Random::new(settings.seed);
        let ends = self.ends(start, goal, settings)?;
        let constrained = self.exact.constraint_exits(&ends, start, &mut random, settings)?;
        let exits = [self.exit(&constrained, 0, &mut random)?, self.exit(&constrained, 1, &mut random)?];
        let (from, to) = (&exits[0], &exits[1]);
        let mut search = EdgeSearch { exact: &mut self.exact, covers: &mut self.covers };
        let mut waypoints = if search.edge_is_free(from, to) {
            exits.to_vec()
        } else {
            let region = search.exact.bounds.sampling_region(from, to);
            let mut sampler = Sampler { region, random: &mut random, round: 0 };
            let last_deadline = search.exact.validator.deadline;
            search.covers.extend_deadline(last_deadline.min(begin + settings.time_limit.mul_f64(FIRST_SHARE)));
            let mut trees = TreeSearch::new(&mut search, from, to);
            let mut found = trees.run(&mut sampler);
            if found.is_none() {
                trees.validator.expect_connected(from, to)?;
                trees.validator.covers.extend_deadline(last_deadline);
                found = trees.run(&mut sampler);
            }
            let nodes = trees.nodes();
            found.ok_or_else(|| self.not_found(begin.elapsed(), nodes))?
        };
        let planning_time = begin.elapsed();
        let raw_length_rad = path_length(&waypoints);
        let mut search = EdgeSearch { exact: &mut self.exact, covers: &mut self.covers };
        Shortcutting { validator: &mut search, random: &mut random }.run(&mut waypoints);
        let path = PlannedPath {
            length_rad: path_length(&waypoints),
            raw_length_rad,
            waypoints,
            planning_time,
            simplification_time: begin.elapsed().saturating_sub(planning_time),
            states_checked: self.covers.states_checked(),
        };
        Ok(path.with_ends(constrained).with_ends(ends))
    }

    fn not_found(&self, after: Duration, nodes: usize) -> RrtConnectError {
        let states_checked = self.covers.states_checked();
        RrtConnectError::NotFound { seconds: after.as_secs_f64(), states_checked, nodes, nearer: Vec::new() }
    }

    /// Both ends within limits; the validators are prepared for the query.
    fn ends(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<[Vec<f64>; 2], RrtConnectError> {
        if let Some((setting, value)) = settings.invalid() {
            return Err(RrtConnectError::InvalidSetting { setting, value });
        }
        self.exact.begin(start, goal, settings)?;
        self.covers.begin(self.exact.validator.deadline, settings.max_states);
        let bounds: &JointBounds = &self.exact.bounds;
        let from = bounds.clamped_end(PathEnd::Start, start.q(self.exact.robot()))?;
        let to = bounds.clamped_end(PathEnd::Goal, goal)?;
        if self.exact.has_other_robots() {
            // Links that no joint moves are in no block; another robot may touch them all the same.
            self.exact.free_margin_m(PathEnd::Start, &from)?;
        }
        Ok([from, to])
    }

    /// An end, or a configuration near by that the covers prove free and that an exactly proven edge joins with it.
    fn exit(&mut self, ends: &[Vec<f64>; 2], which: usize, random: &mut Random) -> Result<Vec<f64>, RrtConnectError> {
        let q = &ends[which];
        if self.covers.state(q) == Validity::Free {
            return Ok(q.clone());
        }
        let margin = self.exact.free_margin_m([PathEnd::Start, PathEnd::Goal][which], q)?;
        let sweep = self.exact.validator.sweep;
        let sweep = SweepOptions { tolerance_m: sweep.tolerance_m.min(0.5 * margin), ..sweep };
        let region = self.exact.bounds.sampling_region(q, q);
        let mut sample = q.clone();
        for trial in 0..EXIT_TRIALS {
            let share = EXIT_RADIUS * ((trial + 1) as f64 / EXIT_TRIALS as f64).powi(2).max(0.02);
            region.around(q, share, random, &mut sample);
            if self.covers.state(&sample) == Validity::Free
                && self.covers.is_free_exactly(&mut self.exact.validator, q, &sample, &sweep)
            {
                return Ok(sample);
            }
        }
        Err(self.not_found(Duration::ZERO, 0))
    }
}

/// Edges that the covers prove, within the constraint.
pub(super) struct EdgeSearch<'p, 'm> {
    pub exact: &'p mut RrtConnect<'m>,
    pub covers: &'p mut CoverValidator<'m>,
}

impl EdgeSearch<'_, '_> {
    /// An error where it is proven that no path joins two configurations.
    fn expect_connected(&mut self, from: &[f64], to: &[f64]) -> Result<(), RrtConnectError> {
        let bounds = &self.exact.bounds;
        let (ranges, deadline) = (bounds.ranges(), self.exact.validator.deadline);
        for projection in projections(bounds.dof()) {
            if self.covers.are_disconnected(&ranges, [from, to], &projection, deadline) {
                return Err(RrtConnectError::Disconnected {
                    joints: projection.joints.iter().map(|&j| bounds.name(j).to_owned()).collect(),
                    nearer: bounds.equivalent_goals(from, to),
                });
            }
        }
        Ok(())
    }
}

/// Each joint alone, then neighbours in the chain, with finer cells where there are fewer.
fn projections(dof: usize) -> Vec<Projection> {
    let neighbours = |count: usize, step: f64| {
        (0..(dof + 1).saturating_sub(count)).map(move |j| Projection { joints: (j..j + count).collect(), step })
    };
    [(1, 0.01), (2, 0.04), (3, 0.1)].into_iter().flat_map(|(count, step)| neighbours(count, step)).collect()
}

impl EdgeValidator for EdgeSearch<'_, '_> {
    fn edge_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.covers.edge_is_free(from, to) && self.exact.validator.constraint_allows(from, to)
    }

    fn is_exhausted(&mut self) -> bool {
        self.covers.is_exhausted()
    }
}

/// Draws from the region around the ends first, later from all of it, and now and then near the ends again.
struct Sampler<'r> {
    region: SamplingRegion,
    random: &'r mut Random,
    round: u32,
}

/// One in so many samples stays near the ends.
const NEAR_ROUNDS: u32 = 4;
/// Share of the region about the ends that is sampled first, and in those rounds.
const NEAR_SHARE: f64 = 0.3;
/// Samples after which the whole region is sampled.
const WIDENING_ROUNDS: f64 = 40.0;

impl ConfigurationSampler for Sampler<'_> {
    fn sample(&mut self, out: &mut [f64]) {
        let is_near = self.round % NEAR_ROUNDS == NEAR_ROUNDS - 1;
        let wide = (NEAR_SHARE + f64::from(self.round) / WIDENING_ROUNDS).min(1.0);
        self.region.sample(if is_near { NEAR_SHARE } else { wide }, self.random, out);
        self.round = self.round.saturating_add(1);
    }
}
