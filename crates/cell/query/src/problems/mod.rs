//! Planning of whole sets of problems for one robot (`elbowroom plan --problems`).
//!
//! [`ProblemModel`] is created once per file: the robot with its meshes and the proofs of which links never meet. Each
//! problem then becomes a [`ProblemScene`], which a [`PlanningEngine`] solves.
//!
//! ```
//! use elbowroom_query::problems::{ProblemModel, ProblemSettings, RrtConnectEngine, run};
//! use elbowroom_formats::{problem_set, robot};
//! # let dir = tempfile::tempdir()?;
//! # let urdf = dir.path().join("arm.urdf");
//! # std::fs::write(&urdf, r#"<robot name="arm"><link name="base"/>
//! # <link name="arm"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
//! # <joint name="waist" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
//! # <limit lower="-3" upper="3" velocity="1" effort="1"/></joint></robot>"#)?;
//! let text = br#"{"post": {"1": {
//!   "scene": {"world": {"collision_objects": [{"id": "post",
//!     "primitives": [{"type": "cylinder", "dimensions": [1.0, 0.05]}],
//!     "primitive_poses": [{"position": [-0.8, 0, 0]}]}]}},
//!   "request": {
//!     "start_state": {"joint_state": {"name": ["waist"], "position": [0.0]}},
//!     "goal_constraints": [{"joint_constraints": [{"joint_name": "waist", "position": 2.0}]}]}}}}"#;
//! let problems = problem_set::parse("post.json".as_ref(), text)?.problems;
//! let robot = robot::load(&urdf, &robot::LoadOptions::default())?.robot;
//! let model = ProblemModel::new(&urdf, robot, &[], "post.json".as_ref(), &problems)?;
//! let mut durations = Vec::new();
//! let results = run(&model, &problems, &ProblemSettings::default(), &mut RrtConnectEngine, &mut |result, timed| {
//!     durations.extend(timed.map(|timed| timed.trajectory.duration_s()));
//!     result.found
//! })?;
//! assert!(results[0].proven && results[0].cost_rad == Some(2.0) && durations[0] > 2.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cover_rrt_connect;
mod end_validity;
mod engine;
mod frames;
mod joint_move;
mod joint_values;
mod linear_move;
mod matrix;
mod messages;
mod model;
mod motion_limits;
mod moved_link;
mod problem_scene;
mod result;
mod rrt_connect;
mod run;
mod summary;

pub use cover_rrt_connect::CoverRrtConnectEngine;
pub use engine::{PlanningEngine, ProblemSettings, Unsolved};
pub use model::ProblemModel;
pub use problem_scene::ProblemScene;
pub use result::{Improvement, ProblemResult};
pub use rrt_connect::RrtConnectEngine;
pub use run::run;
pub use summary::{ProblemSummary, SetSummary, Statistics};
