//! Ways around for any number of joints, on the exact scene: RRT-Connect, made short, every stretch proven by a sweep.

mod bounds;
mod error;
mod exit;
mod fence;
mod random;
mod reach;
mod search;
mod shorten;
mod timed;
mod tree;
mod way;

use std::time::{Duration, Instant};

use elbowroom_scene::{Scene, SceneError, SceneState};

pub use error::RouteError;
pub use fence::Fence;

use crate::path::End;
use bounds::Bounds;
use fence::Fenced;
use random::Random;
use search::Search;
use shorten::{Shorten, total};
use way::Way;

/// More time than anybody has: a year. Instants cannot be as far apart as durations can be long.
const FOREVER: Duration = Duration::from_hours(365 * 24);

/// What a search may take, and how far it stays away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteOptions {
    /// Search and shortening together take no longer than about this.
    pub time_limit: Duration,
    /// … nor look at more configurations than about this: unlike time, the same on every machine.
    pub most_states: u64,
    /// Pairs stay farther apart than this beyond their margins, m.
    pub clearance_m: f64,
    /// Another number may find another route.
    pub seed: u64,
}

impl Default for RouteOptions {
    /// 5 s, any number of configurations, no clearance.
    fn default() -> Self {
        Self { time_limit: Duration::from_secs(5), most_states: u64::MAX, clearance_m: 0.0, seed: 1 }
    }
}

/// A way from start to goal: straight in joint space from each waypoint to the next, proven free.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// All values of the robot, rad (m where a joint slides), at least two; the first is the start.
    pub waypoints: Vec<Vec<f64>>,
    /// Euclidean length in joint space, rad (and m).
    pub length_rad: f64,
    /// Length as it was found, before it was made short.
    pub found_rad: f64,
    /// Time of the search.
    pub planning: Duration,
    /// Time of making it short.
    pub simplifying: Duration,
    /// Configurations that were looked at.
    pub states: u64,
}

/// Plans for one robot of a scene; all else stands where a state has it.
///
/// Two trees of states grow from start and goal until they meet (RRT-Connect). States between are only looked at while
/// they grow; what is on the path is proven by [`Checker::sweep`](elbowroom_scene::Checker::sweep), which jumps over nothing. For the same scene,
/// ends and options the route is the same, as long as time does not run out.
///
/// ```
/// use elbowroom_planner::{Connect, RouteOptions};
/// use elbowroom_scene::{SceneState, example};
/// let scene = example::two_arms();
/// let mut state = SceneState::new(&scene);
/// state.set_q(&scene, 0, &[-0.9, 1.3, 0.6])?;
/// let mut connect = Connect::new(&scene, 0)?;
/// // The part on the table stands between.
/// let route = connect.plan(&state, &[0.9, 1.3, 0.6], &RouteOptions::default())?;
/// assert!(route.waypoints.len() > 2 && route.length_rad < 5.0);
/// assert_eq!(route.waypoints.last().unwrap(), &[0.9, 1.3, 0.6]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Connect<'s> {
    way: Way<'s>,
    bounds: Bounds,
    robot: usize,
}

impl<'s> Connect<'s> {
    /// For one robot of a scene.
    ///
    /// # Errors
    /// The scene has no such robot.
    pub fn new(scene: &'s Scene, robot: usize) -> Result<Self, SceneError> {
        let count = scene.robots().len();
        let r = scene.robots().get(robot).ok_or(SceneError::NoSuchRobot { index: robot, count })?;
        let bounds = Bounds::new(&r.robot.chain);
        let reach = reach::reach(&r.robot, &bounds);
        Ok(Self { way: Way::new(scene, robot, reach), bounds, robot })
    }

    /// With what else its routes stay out of.
    ///
    /// A start that is in it, or nearer to it than routes may be, is left by a straight stretch that comes no nearer; at a goal
    /// that is nearer the route arrives in the same way. A goal inside is refused.
    #[must_use]
    pub fn fenced(mut self, fence: impl Fence + 's) -> Self {
        self.way.fenced = Some(Fenced::new(fence));
        self
    }

    /// Within limits narrower than the robot's own: lowest and highest value per joint, rad or m. Missing ones, and what is wider,
    /// leave its own.
    #[must_use]
    pub fn within(mut self, limits: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.bounds.narrow(limits.into_iter());
        self
    }

    /// From where `start` has the robot to `goal` (rad, m where a joint slides). Self-collision, objects and other robots,
    /// which stay where `start` has them, count by the scene's pair matrix.
    ///
    /// # Errors
    /// An end beyond limits, in contact or nearer than the clearance, a goal behind the [`Fence`]; values that are NaN or too
    /// few; an option that cannot be; no route found in time, which proves nothing.
    pub fn plan(&mut self, start: &SceneState, goal: &[f64], options: &RouteOptions) -> Result<Route, RouteError> {
        let begin = Instant::now();
        let ends = self.ends(start, goal, options)?;
        let mut random = Random::new(options.seed);
        if self.way.fenced.is_none() {
            return self.between(begin, ends, &mut random, options);
        }
        let exits = self.exits(&ends, &mut random, options)?;
        Ok(joined(ends, self.between(begin, exits, &mut random, options)?))
    }

    /// As [`plan`](Self::plan), but the ends need only be free: one that stands nearer to something than the clearance is left
    /// (or arrived at) by a straight stretch that keeps half of the room there is at it, before the clearance is kept.
    ///
    /// # Errors
    /// As [`plan`](Self::plan); no such stretch found counts as no route found.
    pub fn plan_out(&mut self, start: &SceneState, goal: &[f64], options: &RouteOptions) -> Result<Route, RouteError> {
        let begin = Instant::now();
        let ends = self.ends(start, goal, &RouteOptions { clearance_m: 0.0, ..*options })?;
        let mut random = Random::new(options.seed);
        let exits = self.exits(&ends, &mut random, options)?;
        self.way.sweep = elbowroom_scene::SweepOptions { clearance_m: options.clearance_m, ..self.way.sweep };
        Ok(joined(ends, self.between(begin, exits, &mut random, options)?))
    }

    fn between(
        &mut self,
        begin: Instant,
        [from, to]: [Vec<f64>; 2],
        random: &mut Random,
        options: &RouteOptions,
    ) -> Result<Route, RouteError> {
        let path = if self.way.free(&from, &to) {
            vec![from, to]
        } else {
            let window = self.bounds.window(&from, &to);
            let mut search = Search::new(&mut self.way, &window, random, [&from, &to]);
            let found = search.run();
            let nodes = search.nodes();
            found.ok_or_else(|| self.not_found(&[from, to], nodes, options))?
        };
        let planning = begin.elapsed();
        let mut waypoints = path;
        let found_rad = total(&waypoints);
        Shorten { way: &mut self.way, random }.run(&mut waypoints);
        let simplifying = begin.elapsed().saturating_sub(planning);
        let states = self.way.states;
        Ok(Route { length_rad: total(&waypoints), found_rad, waypoints, planning, simplifying, states })
    }

    fn not_found(&self, [from, to]: &[Vec<f64>; 2], nodes: usize, options: &RouteOptions) -> RouteError {
        let left = self.way.until.saturating_duration_since(Instant::now());
        let seconds = options.time_limit.min(FOREVER).saturating_sub(left).as_secs_f64();
        let states = self.way.states;
        RouteError::NotFound { seconds, states, nodes, nearer: self.bounds.nearer(from, to) }
    }

    /// Start and goal, within limits and free; the proof is made as fine as they are near to something.
    fn ends(&mut self, start: &SceneState, goal: &[f64], options: &RouteOptions) -> Result<[Vec<f64>; 2], RouteError> {
        let clearance_m = options.clearance_m;
        if !(clearance_m.is_finite() && clearance_m >= 0.0) {
            return Err(RouteError::Option { what: "the clearance", value: clearance_m, unit: "metres" });
        }
        self.way.stand(start, goal)?;
        self.way.until = Instant::now() + options.time_limit.min(FOREVER);
        self.way.most_states = options.most_states;
        self.way.sweep = elbowroom_scene::SweepOptions { clearance_m, ..Default::default() };
        let ends = [(End::Start, start.q(self.robot)), (End::Goal, goal)];
        let mut checked = Vec::new();
        for (end, q) in ends {
            let q = self.bounds.checked(end, q)?;
            if let Some(contact) = self.way.contact(&q) {
                let metres = self.way.apart(&q, &contact);
                let [a, b] = [contact.a, contact.b].map(|m| self.way.name(m));
                return Err(RouteError::Contact { end, a, b, metres, clearance_m });
            }
            let room = self.way.distance(&q).map_or(f64::INFINITY, |d| d.metres) - clearance_m;
            self.way.sweep.tolerance_m = self.way.sweep.tolerance_m.min(0.5 * room);
            checked.push(q);
        }
        let to = checked.pop().unwrap_or_default();
        Ok([checked.pop().unwrap_or_default(), to])
    }
}

/// With its own ends.
fn joined([from, to]: [Vec<f64>; 2], mut route: Route) -> Route {
    let before = total(&route.waypoints);
    route.waypoints.insert(0, from);
    route.waypoints.push(to);
    route.waypoints.dedup();
    if route.waypoints.len() < 2 {
        route.waypoints.push(route.waypoints[0].clone());
    }
    route.length_rad = total(&route.waypoints);
    route.found_rad += route.length_rad - before;
    route
}
