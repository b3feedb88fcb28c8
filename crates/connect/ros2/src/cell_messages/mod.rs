//! A cell and its status as messages.

mod diagnostics;
mod frames;
mod nearest_points;
mod region_markers;
mod transforms;
mod whole_cell;

use elbowroom_cell::Cell;
use elbowroom_status::{CellStatus, RobotStatus};

use crate::msgs::builtin_interfaces::Time;
use crate::msgs::control_msgs::SpeedScalingFactor;
use crate::msgs::diagnostic_msgs::DiagnosticArray;
use crate::msgs::sensor_msgs::JointState;
use crate::msgs::std_msgs::{Header, Text};
use crate::msgs::tf2_msgs::TFMessage;
use crate::msgs::visualization_msgs::MarkerArray;
use region_markers::RegionMarkers;
use transforms::Transforms;
pub use whole_cell::{CellUrdf, UrdfMesh};

/// Makes the messages of a cell: its description once, then messages of each status.
///
/// Frames are `world`, `ROBOT/LINK`, `ROBOT/tcp`, `object/NAME` and `region/NAME`.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_ros2::{CellMessages, msgs::builtin_interfaces::Time};
/// use elbowroom_status::{CellStatus, RobotStatus};
/// let cell = Cell::parse("rail.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.rail]
/// dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
/// "#)?;
/// let mut messages = CellMessages::new(&cell);
/// assert!(messages.robot_description().data.contains("rail"));
/// let rail = RobotStatus { robot: "rail".into(), q: vec![0.5], speed_override: 0.25, ..RobotStatus::default() };
/// assert_eq!(CellMessages::speed_scaling(&rail).factor, 0.25);
/// let status = CellStatus { robots: vec![rail], ..CellStatus::default() };
/// assert!(!messages.transforms(&status, &Time::from_nanoseconds(0)).transforms.is_empty());
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug, Clone)]
pub struct CellMessages {
    urdf: CellUrdf,
    transforms: Transforms,
    regions: RegionMarkers,
    /// Names of each robot and of its joints.
    joints: Vec<(String, Vec<String>)>,
}

impl CellMessages {
    /// Prepares the messages of a cell.
    pub fn new(cell: &Cell) -> Self {
        Self {
            urdf: CellUrdf::of_cell(cell),
            transforms: Transforms::of_cell(cell),
            regions: RegionMarkers::of_cell(cell),
            joints: cell.robots.iter().map(|r| (r.name.clone(), r.joint_names())).collect(),
        }
    }

    /// The whole cell as one URDF with its meshes inside, for `/robot_description`.
    pub fn robot_description(&self) -> Text {
        Text { data: self.urdf.inline() }
    }

    /// The whole cell as a URDF with mesh files beside it.
    pub fn urdf(&self) -> &CellUrdf {
        &self.urdf
    }

    /// Transforms that never change, for `/tf_static`: bases, fixed joints, first poses of objects.
    pub fn static_transforms(&self, stamp: &Time) -> TFMessage {
        self.transforms.fixed(stamp)
    }

    /// Transforms that change, for `/tf`: joints and tool centre points of robots whose values are known, regions,
    /// objects that have moved.
    pub fn transforms(&mut self, status: &CellStatus, stamp: &Time) -> TFMessage {
        self.transforms.moving(status, stamp)
    }

    /// Regions and their warning zones, coloured by their state.
    ///
    /// They move with their frames: publish them when [`CellMessages::region_state`] changes, and repeat them from time
    /// to time.
    pub fn region_markers(&self, status: &CellStatus, stamp: &Time) -> MarkerArray {
        self.regions.markers(status, stamp)
    }

    /// State of the regions that determines their colours.
    pub fn region_state(&self, status: &CellStatus) -> Vec<u8> {
        self.regions.state(status)
    }

    /// The nearest points of robots and regions, with the distance of the governing point.
    pub fn nearest_points(&self, status: &CellStatus, stamp: &Time) -> MarkerArray {
        nearest_points::markers(status, stamp)
    }

    /// Override, reason and governing region of each robot, holders and queues of exchange regions, for `/diagnostics`.
    pub fn diagnostics(&self, status: &CellStatus, stamp: &Time) -> DiagnosticArray {
        diagnostics::diagnostics(status, stamp)
    }

    /// The joint values of all robots, for `/joint_states`: names as in the description, `ROBOT/JOINT`.
    pub fn joint_states(&self, status: &CellStatus, stamp: &Time) -> JointState {
        let header = Header { stamp: stamp.clone(), frame_id: String::new() };
        let mut message = JointState { header, ..JointState::default() };
        for robot in &status.robots {
            let Some((name, joints)) = self.joints.iter().find(|(name, _)| *name == robot.robot) else { continue };
            if joints.len() == robot.q.len() {
                message.name.extend(joints.iter().map(|joint| frames::joint(name, joint)));
                message.position.extend(&robot.q);
            }
        }
        message
    }

    /// The factor for a controller; 0 unless it is a number in 0..1.
    pub fn speed_scaling(robot: &RobotStatus) -> SpeedScalingFactor {
        let valid = (0.0..=1.0).contains(&robot.speed_override);
        SpeedScalingFactor { factor: if valid { robot.speed_override } else { 0.0 } }
    }
}
