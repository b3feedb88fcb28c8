//! Planning of a timed path for one robot of a cell (`elbowroom plan`).
//!
//! Planning uses the scene of [`evaluate`](crate::evaluate()): objects, other robots at their `start`, the robot with tool and
//! load, the allowed collision matrix. Permanent forbidden regions of the robot are path constraints on its guarded
//! volumes.

mod answer;
mod kept_axis;
mod map_planner;
mod on_map;
mod path_goal;
mod path_query;
mod path_request;
mod point_path;
pub(crate) mod request_validation;
mod search;
mod several;
mod tcp_motion;

use elbowroom_cell::Cell;
use elbowroom_formats::Diagnostic;

pub use answer::{PathAnswer, write_csv};
pub use elbowroom_cell::{KeptAxis, PathPlanner};
pub use kept_axis::KeptDirection;
pub use map_planner::{MapPlanner, MapPlannerError};
pub use path_goal::PathGoal;
pub use path_query::PathQuery;
pub use path_request::PathRequest;
pub use point_path::PointPath;
pub use request_validation::select_robot;
pub use several::{RobotPath, RobotPathRequest, SeveralPathsAnswer, SeveralPathsRequest, plan_several};
pub(crate) use tcp_motion::LINE_TOLERANCE;
pub use tcp_motion::TcpMotion;

/// Plans a collision-free path and times it. For more than one path in a cell, [`PathQuery`] is faster.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_query::plan::{PathRequest, plan};
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
/// let request = PathRequest { from: Some(vec![-1.0, 0.0]), to: vec![1.0, 0.0].into(), ..PathRequest::default() };
/// let answer = plan(&cell, &request)?;
/// let timed = answer.timed.expect("the elbow can bend");
/// assert!(timed.path.waypoints.len() > 2);
/// assert_eq!(timed.trajectory.last(), Some(&[1.0, 0.0][..]));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// An unknown robot; a robot without speed limits; an invalid start or goal: beyond limits, in collision, with a wrong
/// number of values; a goal in a region; a start in a region that no straight path leaves.
///
/// With [`PathPlanner::Grid`] also a map that does not have three joints, and a request that moves other joints. From a
/// start in a region, or nearer to it than the clearance, this planner finds no path.
pub fn plan(cell: &Cell, request: &PathRequest) -> Result<PathAnswer, Diagnostic> {
    PathQuery::new(cell)?.plan(request)
}
