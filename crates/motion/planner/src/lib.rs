//! Path planning: paths through the free cells of a joint-space map, RRT-Connect in the exact scene, and time
//! parametrization of the paths.
//!
//! On the grid, two free cells are connected if they share a *face*; a straight segment is free if all cells that it
//! touches are free. Therefore a path exists if and only if start and goal are connected, and it never passes between
//! blocked cells that meet at an edge.
//!
//! Without a map, or for more than three joints, [`RrtConnect`] samples configurations in the exact scene and proves the path
//! there.
//!
//! ```
//! use elbowroom_kinematics::JointLimits;
//! use elbowroom_planner::{RrtConnect, RrtConnectSettings};
//! use elbowroom_robot::RobotId;
//! use elbowroom_scene::{SceneState, example};
//! let (scene, left) = (example::two_arms(), RobotId(0));
//! let mut state = SceneState::new(&scene);
//! state.set_q(&scene, left, &[-0.9, 1.3, 0.6])?;
//! let (mut planner, settings) = (RrtConnect::new(&scene, left)?, RrtConnectSettings::default());
//! // The part on the table is between start and goal.
//! let path = planner.plan(&state, &[0.9, 1.3, 0.6], &settings)?;
//! assert!(path.waypoints.len() > 2);
//! let limits = vec![JointLimits::new(2.0, 8.0, 80.0); 3];
//! let trajectory = planner.time_parametrize(&state, &path, &limits, 0.004, &settings)?;
//! assert_eq!(trajectory.at(trajectory.seconds()).q, [0.9, 1.3, 0.6]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** While the map or the scene does not change, a returned path never leaves what was proven free: all
//! cells that it touches are free, or sphere covers or a continuous sweep of the exact scene have proven every segment.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod cell_blocks;
mod cell_group_graph;
mod cell_path;
mod cover_rrt_connect;
mod deadline;
pub mod example;
mod graph_components;
mod grid_path;
mod grid_planner;
mod grid_shortcutting;
mod grid_space;
mod grid_time_parametrization;
mod interpolation;
mod joint_path;
mod line_of_sight;
mod nearest_free_cell;
mod orientation_constraint;
mod point_goal;
mod prioritized_planner;
mod robot_planner;
mod rrt_connect;
mod task_space_region;
mod theta_star;
mod time_parametrization;
mod timed_path;

pub use cover_rrt_connect::{AnytimePath, CoverModel, CoverObstacles, CoverRrtConnect, LinearMove};
pub use deadline::Interrupt;
pub use grid_path::{GridPath, GridPlannerError, GridPlannerSetting, PathEnd};
pub use grid_planner::{GridPlanner, GridPlannerSettings};
pub use joint_path::JointPath;
pub use orientation_constraint::OrientationConstraint;
pub use point_goal::{GoalLimits, PointGoal};
pub use prioritized_planner::{
    PathConstraintSource, PrioritizedMotion, PrioritizedPlanner, PrioritizedPlannerError, RobotGoal,
};
pub use robot_planner::{CoverModels, RobotPlanner};
pub use rrt_connect::{
    JointUnit, LinearMoveEnd, PathConstraint, Random, RrtConnect, RrtConnectError, RrtConnectSetting,
    RrtConnectSettings,
};
pub use task_space_region::TaskSpaceRegion;
pub use time_parametrization::{
    BlendedPath, BlendedTrajectory, CornerBlend, LimitKind, TimeOptimalTrajectory, TimeParametrizationError,
};
pub use timed_path::TimedPath;
