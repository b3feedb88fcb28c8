//! The planner.

use std::time::Instant;

use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneState, SweepOptions};
use elbowroom_validity::Validity;

use super::cover_model::{CoverModel, CoverObstacles};
use super::edge_validator::{CoverValidator, EdgeValidator};
use super::shortcutting::Shortcutting;
use super::tree_search::TreeSearch;
use super::{PlannerSample, Random, path_length};
use crate::path::PathEnd;
use crate::rrt_connect::{
    JointBounds, MotionValidator, PlannedPath, RrtConnectError, RrtConnectSettings, SamplingRegion, deadline,
    joint_weights,
};

/// Configurations tried around an end that the covers leave open.
const EXIT_TRIALS: usize = 400;
/// Largest distance of such a configuration from the end, rad (and m).
const EXIT_RADIUS: f64 = 0.5;

/// Plans for one robot of a scene on sphere covers.
#[derive(Debug)]
pub struct CoverRrtConnect<'m> {
    scene: &'m Scene,
    model: &'m CoverModel,
    obstacles: &'m CoverObstacles,
    bounds: JointBounds,
    weights: Vec<f64>,
    robot: RobotId,
}

impl<'m> CoverRrtConnect<'m> {
    /// For one robot of a scene.
    ///
    /// # Panics
    /// The scene has no such robot.
    pub fn new(scene: &'m Scene, robot: RobotId, model: &'m CoverModel, obstacles: &'m CoverObstacles) -> Self {
        let chain = &scene.robots()[robot.0].robot;
        let bounds = JointBounds::new(&chain.chain);
        let weights = joint_weights(chain, &bounds);
        Self { scene, model, obstacles, bounds, weights, robot }
    }

    /// With limits narrower than the robot's own: lowest and highest value per joint, rad or m.
    #[must_use]
    pub fn with_limits(mut self, limits: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.bounds.narrow(limits.into_iter());
        self
    }

    /// Plans from the robot's configuration in `start` to `goal`.
    ///
    /// # Errors
    /// As [`RrtConnect::plan`](crate::RrtConnect::plan).
    pub fn plan(
        &mut self,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<PlannedPath, RrtConnectError> {
        if let Some((setting, value)) = settings.invalid() {
            return Err(RrtConnectError::InvalidSetting { setting, value });
        }
        let mut exact = MotionValidator::new(self.scene, self.robot, self.weights.clone());
        exact.set_start(start, goal)?;
        let mut validator = CoverValidator::new(self.model, self.obstacles, exact, self.robot);
        let begin = Instant::now();
        validator.deadline = deadline(begin, settings);
        validator.max_edges = settings.max_states;
        let mut random = Random::new(settings.seed);
        let ends = [
            self.bounds.clamped_end(PathEnd::Start, start.q(self.robot))?,
            self.bounds.clamped_end(PathEnd::Goal, goal)?,
        ];
        let [from, to] = [self.exit(&mut validator, &ends, 0, &mut random, settings)?, self.exit(&mut validator, &ends, 1, &mut random, settings)?];
        let exit_time = begin.elapsed();
        let mut waypoints = if validator.edge_is_free(&from, &to) {
            vec![from, to]
        } else {
            let mut sampler = Sampler { region: self.bounds.sampling_region(&from, &to), random: &mut random, round: 0 };
            let mut search = TreeSearch::new(&mut validator, &from, &to);
            let found = search.run(&mut sampler);
            let nodes = search.nodes();
            found.ok_or_else(|| RrtConnectError::NotFound {
                seconds: begin.elapsed().as_secs_f64(),
                states_checked: validator.checker.blocks() * 16,
                nodes,
                nearer: self.bounds.equivalent_goals(&from, &to),
            })?
        };
        let planning_time = begin.elapsed();
        let (e0, b0) = (validator.edges, validator.checker.blocks());
        let raw_length_rad = path_length(&waypoints);
        Shortcutting { validator: &mut validator, random: &mut random }.run(&mut waypoints);
        let simplification_time = begin.elapsed().saturating_sub(planning_time);
        eprintln!("TRACE exit {:.1} edges {e0} blocks {b0} plan {:.1} | edges {} blocks {} simp {:.1}", exit_time.as_secs_f64() * 1e6, planning_time.as_secs_f64() * 1e6, validator.edges - e0, validator.checker.blocks() - b0, simplification_time.as_secs_f64() * 1e6);
        let path = PlannedPath {
            length_rad: path_length(&waypoints),
            raw_length_rad,
            waypoints,
            planning_time,
            simplification_time,
            states_checked: validator.checker.blocks() * 16,
        };
        Ok(path.with_ends(ends))
    }

    /// An end, or a configuration near by that the covers prove free and that an exactly proven edge joins with it.
    fn exit(
        &self,
        validator: &mut CoverValidator,
        ends: &[Vec<f64>; 2],
        which: usize,
        random: &mut Random,
        settings: &RrtConnectSettings,
    ) -> Result<Vec<f64>, RrtConnectError> {
        let q = &ends[which];
        if validator.state(q) == Validity::Free {
            return Ok(q.clone());
        }
        let end = [PathEnd::Start, PathEnd::Goal][which];
        let clearance_m = settings.clearance_m;
        validator.exact.sweep = SweepOptions { clearance_m, ..Default::default() };
        if let Some(contact) = validator.exact.first_contact(q) {
            let metres = validator.exact.pair_distance(q, &contact);
            let [a, b] = [contact.a, contact.b].map(|m| validator.exact.name(m));
            return Err(RrtConnectError::InCollision { end, a, b, metres, clearance_m });
        }
        let margin = validator.exact.nearest_pair(q).map_or(f64::INFINITY, |d| d.metres) - clearance_m;
        let mut sweep = validator.exact.sweep;
        sweep.tolerance_m = sweep.tolerance_m.min(0.5 * margin);
        let region = self.bounds.sampling_region(q, q);
        let mut sample = q.clone();
        for trial in 0..EXIT_TRIALS {
            let share = EXIT_RADIUS * ((trial + 1) as f64 / EXIT_TRIALS as f64).powi(2).max(0.02);
            region.around(q, share, random, &mut sample);
            if validator.state(&sample) == Validity::Free && validator.is_free_exactly(q, &sample, &sweep) {
                return Ok(sample);
            }
        }
        Err(RrtConnectError::NotFound { seconds: 0.0, states_checked: EXIT_TRIALS as u64, nodes: 0, nearer: Vec::new() })
    }
}

/// Draws from the region around the ends first, later from all of it.
struct Sampler<'r> {
    region: SamplingRegion,
    random: &'r mut Random,
    round: u32,
}

impl PlannerSample for Sampler<'_> {
    fn sample(&mut self, out: &mut [f64]) {
        let share = if self.round % 4 == 3 { 0.3 } else { (0.3 + f64::from(self.round) / 40.0).min(1.0) };
        self.region.sample(share, self.random, out);
        self.round += 1;
    }
}
