//! The cell file and the model it describes.
//!
//! A cell file names robots, tools, objects, regions and programs ([`Cell::load`]; every key is in
//! `docs/cell-file.md`). In a [`Cell`] all names are resolved and all numbers are in metres, radians and seconds.
//! [`configure`] builds the configuration of each robot's monitor from it, [`QueryModel`] the scene,
//! [`region_constraint`] the constraint that keeps planned paths out of regions. [`seal`] controls who may change what
//! in the file, with the keys of [`access`]. [`export_zones`] writes regions as zones of a robot's own controller. `elbowroom_sim` runs the programs.
//!
//! ```
//! use elbowroom_cell::{Cell, configure};
//! let cell = Cell::parse("rail.toml", r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.rail]
//! dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
//! [region.end]
//! shape = "plane"
//! origin = [0, 0, 1000]
//! x = [0, 1, 1000]
//! y = [1, 0, 1000]       # its normal points down: everything above z = 1000 is forbidden
//! warning = 300
//! guards = ["tcp"]
//! "#)?;
//! assert_eq!(cell.robots[0].joint_names(), ["joint_1"]);
//! let setups = configure::setups(&cell)?;
//! assert_eq!(setups[0].configuration.regions()[0].warning_m, 0.3);
//! # Ok::<(), elbowroom_formats::Diagnostic>(())
//! ```
//!
//! **Invariant.** If a cell file is accepted, every name in its [`Cell`] is resolved and every number is in SI units
//! and radians; a key that the format does not have is always an error with its line.

mod area_border;
mod cell;
mod cell_ik_error;
mod cell_monitors;
mod cell_timing;
pub mod configure;
mod controller_zones;
mod drawn_fixture;
mod fence;
mod file;
mod fixture;
mod fixture_editor;
mod fixture_shield;
mod fixture_switches;
mod force;
mod frames;
mod gripped_objects;
mod guidance;
mod guided_arm;
mod joint_contacts;
mod measured_source;
mod model_limits;
mod moving_object;
mod object_tables;
mod operated_arm;
mod operator;
mod pair_file;
mod payload;
mod poses;
mod program;
mod query_model;
mod reach;
pub mod region_constraint;
mod region_edits;
mod region_id;
mod rest_pose_contacts;
mod rules_file;
mod scene_pairs;
pub mod seal;
mod sensor;
mod shield_report;
mod tcp_target;
mod title;
mod toml_edits;
mod tool;
mod tool_change;
pub mod trajectory;
mod virtual_robot;
mod virtual_robot_start;
mod virtual_robot_words;

pub use cell::{
    Approval, AvoidanceSpec, Cell, CellGrid, CellPairRules, CellRegion, CellRobot, Follow, FrameSources, MapSpec,
    Monitoring, RegionSolid, Units,
};
pub use cell_ik_error::CellIkError;
pub use cell_monitors::{CellInstant, CellMonitors, RobotTick};
pub use cell_timing::CellTiming;
pub use controller_zones::{ExportedRegion, ZoneExport, ZoneFrame, ZoneLanguage, export_zones};
pub use drawn_fixture::{DrawnFixture, DrawnTarget, MOST_DRAWN_POINTS};
pub use elbowroom_access as access;
pub use elbowroom_cooperation as cooperation;
pub use elbowroom_shared_control as shared_control;
pub use fence::FenceWall;
pub use file::{CellFile, QUATERNION_TOLERANCE, key_reference};
pub use fixture::{CellFixture, CellGuide, FixtureTool, ShieldSource};
pub use fixture_editor::{FixtureDraft, FixtureEditor};
pub use fixture_switches::{FixtureRef, FixtureSwitches};
pub use force::{CellForce, ForceOther, ForceResponse};
pub use frames::Frames;
pub use guidance::Guidance;
pub use measured_source::MeasuredSource;
pub use model_limits::model_limits;
pub use moving_object::{Drive, Encoder, MovingObject, ObjectMotion, ObjectPath, PathRepeat, Travel};
pub use object_tables::{ObjectTables, object_tables};
pub use operated_arm::{FixtureChange, OperatedArm};
pub use operator::{CellOperator, Interpolation, OperatorInput, OperatorRow, OperatorStream};
pub use pair_file::{PairCounts, PairFile};
pub use payload::Payload;
pub use poses::{PoseRate, PoseTrack};
pub use program::{KeptAxis, MoveTarget, PathPlanner, Program, ProgramBody, ProgramStep, StepAction, TcpTarget};
pub use query_model::{OutOfReachProofs, QueryModel, QueryRobot};
pub use region_edits::{EditedRegions, RegionEdit, cell_with_only, table_changes, why_not_continued};
pub use region_id::CellRegionId;
pub use rules_file::parse_rules;
pub use sensor::{CellSensor, SensorKind};
pub use shield_report::ShieldReport;
pub use tcp_target::TcpTargetError;
pub use tool::CellTool;
pub use virtual_robot::{CellVirtualRobot, VirtualRobotMember, WorkPieceView};
