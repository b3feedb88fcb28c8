//! A timed path for one robot of a cell: what `elbowroom plan` answers.
//!
//! The scene is the one of [`query`](crate::query): objects, other robots at their `start`, the robot with tool and load, the pair matrix.
//! Permanent forbidden regions that concern the robot are obstacles to what its monitor guards.

mod answer;
pub(crate) mod subject;

use std::time::Instant;

use elbowroom_formats::FormatError;
use elbowroom_planner::{Connect, RouteError, RouteOptions};
use elbowroom_scene::{Scene, SceneState};

use crate::fence::{self, RegionFence};
use crate::{Cell, CellRobot};

pub use answer::{Motion, PathAnswer};

/// What is asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathRequest {
    /// Name of the robot; may be left out where there is one.
    pub robot: Option<String>,
    /// Values of all joints in the order of the chain, rad or m; `None`: the robot's `start`.
    pub from: Option<Vec<f64>>,
    /// The same where it shall go.
    pub to: Vec<f64>,
    /// Time, clearance and seed of the search.
    pub options: RouteOptions,
    /// Time from row to row, s; `None`: the cell's tick.
    pub period_s: Option<f64>,
}

/// Finds a collision-free path and times it.
///
/// ```
/// use elbowroom_cell::{Cell, plan::{PathRequest, plan}};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
/// links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [object.ball]
/// shape = "sphere"
/// at = [600, 0, 0]
/// radius = 100
/// "#)?;
/// let request = PathRequest { from: Some(vec![-1.0, 0.0]), to: vec![1.0, 0.0], ..PathRequest::default() };
/// let answer = plan(&cell, &request)?;
/// let motion = answer.motion.expect("the elbow can bend");
/// assert!(motion.waypoints.len() > 2 && motion.rows.last().unwrap().1 == [1.0, 0.0]);
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
///
/// # Errors
/// An unknown robot, one without speeds, ends that it cannot have: beyond limits, in collision, too few values; a goal in a
/// region, or a start in one that no straight way leads out of.
pub fn plan(cell: &Cell, request: &PathRequest) -> Result<PathAnswer, FormatError> {
    let (index, robot) = subject::robot(cell, request.robot.as_deref())?;
    let limits = subject::limits(cell, robot)?;
    let from = request.from.as_ref().unwrap_or(&robot.start);
    for (end, q) in [("start", from), ("goal", &request.to)] {
        subject::count(cell, robot, end, q)?;
    }
    let scene = crate::query::Subject::of_cell(cell).scene(false)?;
    let refused = |e: RouteError| subject::refused(cell, robot, &e);
    let state = standing(cell, &scene, index, from).map_err(|e| refused(e.into()))?;
    let least_m = if request.options.clearance_m.is_finite() { request.options.clearance_m } else { 0.0 };
    fence::at_start(cell, index, from, least_m, |fence| {
        let regions = fence.as_ref().map(RegionFence::names).unwrap_or_default();
        let mut connect = Connect::new(&scene, index).map_err(|e| refused(e.into()))?;
        if let Some(fence) = fence {
            connect = connect.fenced(fence);
        }
        let begin = Instant::now();
        let route = match connect.plan(&state, &request.to, &request.options) {
            Ok(route) => route,
            Err(e @ RouteError::NotFound { .. }) => {
                let answer = PathAnswer::none(robot, begin.elapsed(), e.to_string());
                return Ok(PathAnswer { regions, ..answer });
            }
            Err(e) => return Err(refused(e)),
        };
        let period = request.period_s.unwrap_or(cell.tick_s);
        let motion = connect.time(&state, &route, &limits, period, &request.options).map_err(refused)?;
        let rows = motion.rows(period).map_err(|e| refused(e.into()))?;
        Ok(PathAnswer { regions, ..PathAnswer::found(robot, route, &motion, rows) })
    })
}

/// All robots at their start, one of them elsewhere.
fn standing(cell: &Cell, scene: &Scene, robot: usize, q: &[f64]) -> Result<SceneState, elbowroom_scene::SceneError> {
    let mut state = SceneState::new(scene);
    for (i, r) in cell.robots.iter().enumerate() {
        let r: &CellRobot = r;
        state.set_q(scene, i, if i == robot { q } else { &r.start })?;
    }
    Ok(state)
}
