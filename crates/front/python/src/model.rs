//! The robots and objects of a checker.

use elbowroom::cell::{OutOfReachProofs, QueryModel};
use elbowroom::scene::{Scene, SceneState};

use crate::error::Fault;
use crate::robot::joint_names;

/// Robots and objects with their scene: constant, and shared by threads.
pub struct Model {
    pub query: QueryModel,
    pub scene: Scene,
    pub start: SceneState,
    /// Names of the columns of states: joints of the robots, side by side.
    pub columns: Vec<String>,
}

impl Model {
    pub fn new(query: QueryModel) -> Result<Self, Fault> {
        let scene = query.scene(OutOfReachProofs::Compute)?;
        let start = query.start_state(&scene)?;
        let columns = query.robots.iter().flat_map(|robot| {
            let prefix = if query.is_single_robot { String::new() } else { format!("{}.", robot.name) };
            joint_names(&robot.robot.chain).into_iter().map(move |joint| format!("{prefix}{joint}"))
        });
        let columns: Vec<String> = columns.collect();
        if columns.is_empty() {
            let text = "the model has no joint that moves, so it has no states\n  write: a robot with joints";
            return Err(Fault::Argument(text.into()));
        }
        Ok(Self { query, scene, start, columns })
    }
}
