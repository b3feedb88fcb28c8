//! Publisher of the cell: its description, transforms, joint values, markers, diagnostics.

use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_ros2::msgs::builtin_interfaces::Time;
use elbowroom_ros2::msgs::diagnostic_msgs::DiagnosticArray;
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::msgs::std_msgs::Text;
use elbowroom_ros2::msgs::tf2_msgs::TFMessage;
use elbowroom_ros2::msgs::visualization_msgs::MarkerArray;
use elbowroom_ros2::rmw_zenoh::{Distribution, Qos, Topic};
use elbowroom_ros2::{CellMessages, Message};
use elbowroom_status::CellStatus;

use super::input_report::InputReport;
use super::session::{RosPublisher, RosSession, nanoseconds_since_1970};
use crate::network::{NetworkError, Urgency};

/// Interval at which diagnostics are repeated, as by every publisher of `/diagnostics`; at once when a reason changes.
const DIAGNOSTICS: Duration = Duration::from_secs(1);
/// Interval at which the markers of the regions are repeated; at once when a region changes.
const REGIONS: Duration = Duration::from_secs(5);

/// The topics of a cell.
pub(super) struct CellPublisher {
    messages: CellMessages,
    tf: RosPublisher,
    joint_states: RosPublisher,
    diagnostics: Repeated<Vec<String>>,
    regions: Repeated<Vec<u8>>,
    nearest_points: RosPublisher,
    bytes: Vec<u8>,
    // Their samples do not change; they are kept for subscribers that come later.
    _latched: [RosPublisher; 2],
}

/// A topic that is published at a change, and repeated periodically.
struct Repeated<S> {
    publisher: RosPublisher,
    period: Duration,
    last: Option<(S, Instant)>,
}

impl<S: PartialEq> Repeated<S> {
    fn is_due(&mut self, state: S) -> bool {
        let is_due = self.last.as_ref().is_none_or(|(last, at)| *last != state || at.elapsed() >= self.period);
        if is_due {
            self.last = Some((state, Instant::now()));
        }
        is_due
    }
}

impl CellPublisher {
    /// Opens the topics, and publishes the constant ones.
    pub(super) fn start(cell: &Cell, session: &RosSession, distribution: Distribution) -> Result<Self, NetworkError> {
        let messages = CellMessages::new(cell);
        let opened = Opener { session, distribution };
        let mut description = opened.publisher::<Text>("/robot_description", Qos::latched())?;
        description.publish(&messages.robot_description().encode());
        let mut fixed = opened.publisher::<TFMessage>("/tf_static", Qos::latched())?;
        fixed.publish(&messages.static_transforms(&now()).encode());
        let diagnostics = opened.publisher::<DiagnosticArray>("/diagnostics", Qos::keep_last(10))?;
        let regions = opened.publisher::<MarkerArray>("/elbowroom/regions", Qos::latched())?;
        Ok(Self {
            messages,
            tf: opened.publisher::<TFMessage>("/tf", Qos::keep_last(100))?,
            joint_states: opened.publisher::<JointState>("/elbowroom/joint_states", Qos::keep_last(10))?,
            diagnostics: Repeated { publisher: diagnostics, period: DIAGNOSTICS, last: None },
            regions: Repeated { publisher: regions, period: REGIONS, last: None },
            nearest_points: opened.publisher::<MarkerArray>("/elbowroom/nearest_points", Qos::keep_last(10))?,
            bytes: Vec::new(),
            _latched: [description, fixed],
        })
    }

    /// Publishes a status, and the state of the inputs at `time` of the process's clock.
    pub(super) fn publish(&mut self, status: &CellStatus, inputs: &[InputReport], time: Micros) {
        let Self { messages, tf, joint_states, diagnostics, regions, nearest_points, bytes, .. } = self;
        let stamp = now();
        let mut send = |publisher: &mut RosPublisher, encode: &dyn Fn(&mut Vec<u8>)| {
            encode(bytes);
            publisher.publish(bytes);
        };
        let moving = messages.transforms(status, &stamp);
        send(tf, &|bytes| moving.encode_into(bytes));
        let values = messages.joint_states(status, &stamp);
        send(joint_states, &|bytes| values.encode_into(bytes));
        let points = messages.nearest_points(status, &stamp);
        send(nearest_points, &|bytes| points.encode_into(bytes));
        if regions.is_due(messages.region_state(status)) {
            let markers = messages.region_markers(status, &stamp);
            send(&mut regions.publisher, &|bytes| markers.encode_into(bytes));
        }
        if diagnostics.is_due(status.robots.iter().map(|robot| robot.reason.clone()).collect()) {
            let mut array = messages.diagnostics(status, &stamp);
            array.status.extend(inputs.iter().map(|input| input.diagnostic(time)));
            send(&mut diagnostics.publisher, &|bytes| array.encode_into(bytes));
        }
    }
}

/// Opens the topics of a cell, which are for people.
struct Opener<'a> {
    session: &'a RosSession,
    distribution: Distribution,
}

impl Opener<'_> {
    fn publisher<M: Message>(&self, topic: &str, qos: Qos) -> Result<RosPublisher, NetworkError> {
        self.session.publisher(&Topic::of::<M>(topic, self.distribution), qos, Urgency::Display)
    }
}

fn now() -> Time {
    Time::from_nanoseconds(nanoseconds_since_1970())
}
