//! Names that most programs need: `use elbowroom::prelude::*;`.
//!
//! | for | names |
//! | --- | --- |
//! | poses and units | [`Pose`], [`Rotation`], [`Vec3`], [`mm`], [`deg`] |
//! | a robot | [`load_robot`], [`LoadOptions`], [`Robot`], [`Chain`], [`ChainState`] |
//! | collision and distance | [`Scene`], [`SceneState`], [`Object`], [`Checker`], [`Shape`] |
//! | a path | [`RrtConnect`], [`RrtConnectSettings`], [`JointLimits`] |
//! | interference regions in the control loop | [`Monitor`], [`Configuration`], [`ConfigurationParts`], [`Region`], [`Guards`], [`Laws`], [`StoppingSettings`], [`Volume`], [`Snapshot`] |
//! | a cell from a file | [`Cell`], [`simulate`], [`RunOptions`], [`Recording`] |

pub use elbowroom_cell::Cell;
pub use elbowroom_formats::robot::{LoadOptions, load as load_robot};
pub use elbowroom_kinematics::{Chain, ChainState, JointLimits};
pub use elbowroom_monitor::{
    Configuration, ConfigurationParts, Guards, Laws, Monitor, Region, Snapshot, StoppingSettings, TickReport, Volume,
};
pub use elbowroom_planner::{RrtConnect, RrtConnectSettings};
pub use elbowroom_proximity::Shape;
pub use elbowroom_robot::Robot;
pub use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState};
pub use elbowroom_sim::{Recording, RunOptions, RunOutcome, simulate};
pub use elbowroom_spatial::units::{deg, mm};
pub use elbowroom_spatial::{Pose, Rotation, Vec3};
