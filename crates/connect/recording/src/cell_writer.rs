//! Writer of a cell's recording: its description, the ticks of its monitors, its status.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Seek, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_monitor::Monitor;
use elbowroom_ros2::CellMessages;
use elbowroom_ros2::msgs::builtin_interfaces::Time;
use elbowroom_ros2::msgs::control_msgs::{JointTrajectoryControllerState, SpeedScalingFactor};
use elbowroom_ros2::msgs::elbowroom_msgs::{Lost, MonitorConfiguration, MonitorTick};
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::msgs::std_msgs::{Header, Text};
use elbowroom_ros2::msgs::trajectory_msgs::JointTrajectoryPoint;
use elbowroom_ros2::rmw_zenoh::ros_name;
use elbowroom_status::CellStatus;

use crate::bag_writer::BagWriter;
use crate::{BagError, configuration, topics};

/// Longest time for which recorded data is in memory only.
const FLUSH: Duration = Duration::from_secs(1);
/// Time between two messages for viewers, ns: 50 per second move smoothly. Every tick is recorded, on its own topic.
const VIEWER_NS: u64 = 20_000_000;
/// Time between two documents for people, ns.
const DOCUMENT_NS: u64 = 100_000_000;
/// Time after which unchanged markers are written again, ns, for viewers that begin in the middle.
const REPEAT_NS: u64 = 5_000_000_000;

/// Writes the recording of a cell. It blocks while it writes: a control tick uses a [`Recorder`](crate::Recorder).
pub struct CellWriter<W: Write + Seek> {
    bag: BagWriter<W>,
    messages: CellMessages,
    robots: Vec<RobotTopics>,
    /// Time of the recording's zero, ns.
    epoch_ns: u64,
    flushed: Instant,
    region_state: Vec<u8>,
    markers: Due,
    documents: Due,
    /// Times of the transforms and of the other messages for viewers.
    viewers: Due,
}

/// Topics of a robot, and the names of its joints.
struct RobotTopics {
    joints: Vec<String>,
    joint_states: String,
    controller_state: String,
    speed_scaling: String,
    due: Due,
}

/// Time at which the next message is due.
#[derive(Debug, Clone, Copy, Default)]
struct Due {
    next_ns: u64,
}

impl Due {
    fn is_due(&mut self, now_ns: u64, period_ns: u64) -> bool {
        let is_due = now_ns >= self.next_ns;
        if is_due {
            self.next_ns = now_ns + period_ns;
        }
        is_due
    }
}

impl CellWriter<File> {
    /// Begins a recording in a file, replacing an existing recording, and writes the URDF of the whole cell beside it,
    /// with the extension `urdf`.
    ///
    /// # Errors
    /// [`BagError::Io`] and [`BagError::Write`]; [`BagError::Exists`] for a URDF without a recording.
    pub fn create(path: &Path, cell: &Cell, epoch_ns: u64) -> Result<Self, BagError> {
        let io = |file: &Path| {
            let file = file.to_owned();
            move |source| BagError::Io { file, source }
        };
        let urdf = path.with_extension("urdf");
        // A URDF beside a recording was written with it.
        if !path.exists() && urdf.exists() {
            return Err(BagError::Exists(urdf));
        }
        let file = File::create(path).map_err(io(path))?;
        let writer = Self::new(file, cell, epoch_ns)?;
        std::fs::write(&urdf, writer.messages.urdf().text()).map_err(io(&urdf))?;
        for mesh in writer.messages.urdf().meshes() {
            let file = urdf.with_file_name(&mesh.file);
            if let Some(folder) = file.parent() {
                std::fs::create_dir_all(folder).map_err(io(folder))?;
            }
            std::fs::write(&file, &mesh.stl).map_err(io(&file))?;
        }
        Ok(writer)
    }
}

impl<W: Write + Seek> CellWriter<W> {
    /// Begins a recording: the cell file, its checksum, its description.
    ///
    /// `epoch_ns` is the time of the recording's zero, ns since the Unix epoch; 0 for simulated time.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn new(file: W, cell: &Cell, epoch_ns: u64) -> Result<Self, BagError> {
        let mut bag = BagWriter::new(file)?;
        let messages = CellMessages::new(cell);
        let robots: Vec<&str> = cell.robots.iter().map(|r| &r.name[..]).collect();
        let values = [
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("cell", cell.name.clone()),
            ("cell_file", file_name(&cell.file)),
            ("checksum", cell.approval.checksum.clone()),
            ("tick_s", cell.timing.tick_s.to_string()),
            ("robots", robots.join("\n")),
        ];
        let values = values.into_iter().map(|(key, value)| (key.to_owned(), value)).collect::<BTreeMap<_, _>>();
        bag.metadata(topics::METADATA, values)?;
        // A cell made in memory has no file.
        if let Ok(text) = std::fs::read(&cell.file) {
            bag.attach(&file_name(&cell.file), "application/toml", epoch_ns, &text)?;
        }
        let stamp = stamp(epoch_ns);
        bag.write(topics::ROBOT_DESCRIPTION, epoch_ns, &messages.robot_description())?;
        bag.write(topics::TF_STATIC, epoch_ns, &messages.static_transforms(&stamp))?;
        let robots = cell.robots.iter().map(|r| {
            let name = ros_name(&r.name);
            RobotTopics {
                joints: r.joint_names(),
                joint_states: format!("/{name}/joint_states"),
                controller_state: format!("/{name}/controller_state"),
                speed_scaling: format!("/{name}/speed_scaling_input"),
                due: Due::default(),
            }
        });
        let mut writer = Self {
            robots: robots.collect(),
            bag,
            messages,
            epoch_ns,
            flushed: Instant::now(),
            region_state: Vec::new(),
            markers: Due::default(),
            documents: Due::default(),
            viewers: Due::default(),
        };
        writer.flush()?;
        Ok(writer)
    }

    /// Records the configuration of a monitor: before its first tick, and when it changes.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn configuration(&mut self, robot: u32, monitor: &Monitor, t_s: f64) -> Result<(), BagError> {
        self.configuration_message(&configuration::of_monitor(robot, monitor), t_s)
    }

    pub(crate) fn configuration_message(&mut self, message: &MonitorConfiguration, t_s: f64) -> Result<(), BagError> {
        self.bag.write(topics::CONFIGURATION, self.time_ns(t_s), message)
    }

    /// Records a tick; for viewers also joint values and override of the robot, fifty times per second.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub(crate) fn tick(&mut self, tick: &MonitorTick) -> Result<(), BagError> {
        let time_ns = self.time_ns(tick.t_s);
        self.bag.write(topics::TICK, time_ns, tick)?;
        let Some(robot) = self.robots.get_mut(tick.robot as usize) else { return Ok(()) };
        if robot.joints.len() == tick.q.len() && robot.due.is_due(time_ns, VIEWER_NS) {
            let header = Header { stamp: stamp(time_ns), frame_id: String::new() };
            self.bag.write(&robot.joint_states, time_ns, &joint_state(&header, robot, tick))?;
            self.bag.write(&robot.controller_state, time_ns, &controller_state(header, robot, tick))?;
            self.bag.write(&robot.speed_scaling, time_ns, &SpeedScalingFactor { factor: tick.speed_override })?;
        }
        self.flush_if_due()
    }

    /// Records the status of the cell: transforms, markers, diagnostics, and the status as JSON.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn status(&mut self, status: &CellStatus) -> Result<(), BagError> {
        let time_ns = self.time_ns(status.t_s);
        let stamp = stamp(time_ns);
        if self.viewers.is_due(time_ns, VIEWER_NS / 2) {
            self.bag.write(topics::TF, time_ns, &self.messages.transforms(status, &stamp))?;
            self.bag.write(topics::JOINT_STATES, time_ns, &self.messages.joint_states(status, &stamp))?;
            self.bag.write(topics::NEAREST_POINTS, time_ns, &self.messages.nearest_points(status, &stamp))?;
        }
        let state = self.messages.region_state(status);
        if state != self.region_state {
            self.markers = Due::default();
            self.region_state = state;
        }
        if self.markers.is_due(time_ns, REPEAT_NS) {
            self.bag.write(topics::REGIONS, time_ns, &self.messages.region_markers(status, &stamp))?;
        }
        // An event is in one status only.
        if self.documents.is_due(time_ns, DOCUMENT_NS) || !status.events.is_empty() {
            self.bag.write(topics::DIAGNOSTICS, time_ns, &self.messages.diagnostics(status, &stamp))?;
            let data = serde_json::to_string(status).unwrap_or_default();
            self.bag.write(topics::STATUS, time_ns, &Text { data })?;
        }
        self.flush_if_due()
    }

    /// Records the number of omitted ticks and statuses.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub(crate) fn lost(&mut self, lost: &Lost, t_s: f64) -> Result<(), BagError> {
        self.bag.write(topics::LOST, self.time_ns(t_s), lost)
    }

    /// Passes everything to the operating system, unless that was done less than a second ago: the data then survives the
    /// end of this process.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn flush_if_due(&mut self) -> Result<(), BagError> {
        if self.flushed.elapsed() >= FLUSH { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), BagError> {
        self.flushed = Instant::now();
        self.bag.flush()
    }

    /// Writes the index of the file.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn finish(self) -> Result<(), BagError> {
        self.bag.finish()
    }

    fn time_ns(&self, t_s: f64) -> u64 {
        // A monitor may have ticked before the zero of a run; such times and NaN become the zero.
        self.epoch_ns.saturating_add((t_s * 1e9).round() as u64)
    }
}

fn stamp(time_ns: u64) -> Time {
    Time::from_nanoseconds(i64::try_from(time_ns).unwrap_or(i64::MAX))
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn joint_state(header: &Header, robot: &RobotTopics, tick: &MonitorTick) -> JointState {
    JointState {
        header: header.clone(),
        name: robot.joints.clone(),
        position: tick.q.clone(),
        velocity: tick.qd.clone(),
        effort: Vec::new(),
    }
}

/// Makes the controller state with the intent as reference, as a joint trajectory controller publishes it.
fn controller_state(header: Header, robot: &RobotTopics, tick: &MonitorTick) -> JointTrajectoryControllerState {
    let point = |velocities: &[f64]| JointTrajectoryPoint {
        positions: tick.q.clone(),
        velocities: velocities.to_vec(),
        ..JointTrajectoryPoint::default()
    };
    JointTrajectoryControllerState {
        header,
        joint_names: robot.joints.clone(),
        reference: point(&tick.intent),
        feedback: point(&tick.qd),
        speed_scaling_factor: tick.programmed_override,
        ..JointTrajectoryControllerState::default()
    }
}
