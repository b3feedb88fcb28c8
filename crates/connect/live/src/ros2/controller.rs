//! Controller of a robot that uses ROS 2, towards its node.
//!
//! Joint values in ROS 2 messages become messages of the node's own protocol, and the node's answers become speed
//! scaling factors. So the node treats this controller like any other.

use std::sync::{Arc, Mutex};

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_ros2::msgs::control_msgs::{JointTrajectoryControllerState, SpeedScalingFactor};
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::rmw_zenoh::{Qos, Topic};

use super::input_error::RosInputError;
use super::input_report::InputReport;
use super::intent_input::IntentInput;
use super::joint_names::JointNames;
use super::joint_state_input::JointStateInput;
use super::session::{RosSample, RosSession};
use super::settings::{Ros2Robot, Ros2Settings};
use super::speed_scaling::{SpeedScaling, Wake};
use crate::client::{ControllerClient, ControllerState};
use crate::clock::{Clock, boot_number};
use crate::configuration_number::configuration_number;
use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};

/// Parts that a controller needs.
pub(super) struct ControllerParts<'a> {
    pub(super) cell: &'a Cell,
    pub(super) settings: &'a Ros2Settings,
    pub(super) session: &'a RosSession,
    /// Network of the node.
    pub(super) network: &'a Arc<dyn Network>,
    pub(super) clock: Clock,
    pub(super) on_event: Option<EventHandler>,
}

/// The controller of one robot. It ends when it is dropped.
pub(super) struct RosController {
    // In the order in which the parts end: input stops first, then the last factor is sent.
    _subscriptions: Vec<Subscription>,
    _speed_scaling: SpeedScaling,
    report: InputReport,
}

/// State that the messages of the controller change.
struct Input {
    joint_states: JointStateInput,
    intent: IntentInput,
    to_node: Box<dyn Publisher>,
    bytes: Vec<u8>,
    oldest: Micros,
}

type Client = Arc<Mutex<ControllerClient>>;

impl RosController {
    pub(super) fn start(parts: &ControllerParts<'_>, robot: &Ros2Robot) -> Result<Self, NetworkError> {
        let ControllerParts { cell, settings, session, network, clock, on_event } = parts;
        let (clock, keys) = (*clock, Keys::new(&cell.name));
        let names = JointNames::new(cell, robot, &settings.robots);
        let oldest = Micros::from_seconds(cell.monitoring.laws.stale_s);
        let client = ControllerClient::new(boot_number(), configuration_number(cell)).with_watchdog(oldest);
        let client: Client = Arc::new(Mutex::new(client));
        let input = Arc::new(Mutex::new(Input {
            joint_states: JointStateInput::new(names.clone()),
            intent: IntentInput::new(names),
            to_node: network.publisher(&keys.joint_states(&robot.robot), Urgency::RealTime)?,
            bytes: Vec::new(),
            oldest,
        }));
        let wake = Wake::default();
        let report = InputReport::new(&robot.robot, &robot.joint_states);
        let answers = subscribe_to_answers(&***network, &keys.speed_override(&robot.robot), &client, &wake)?;
        let factor = {
            let client = client.clone();
            Box::new(move || locked(&client).speed_override(clock.micros()))
        };
        let topic = Topic::of::<SpeedScalingFactor>(&robot.speed_scaling, settings.distribution);
        let publisher = session.publisher(&topic, Qos::latched(), Urgency::RealTime)?;
        let speed_scaling = SpeedScaling::start(publisher, wake, factor);
        let intent = {
            let (input, count) = (input.clone(), counter(&report, clock, None));
            let handler = move |sample: RosSample<'_>| {
                let taken = locked(&input).intent.take(sample, clock.micros());
                if taken.is_err() {
                    count(&taken);
                }
            };
            let topic = Topic::of::<JointTrajectoryControllerState>(&robot.controller_state, settings.distribution);
            session.subscribe(&topic, Qos::sensor_data(), true, Box::new(handler))?
        };
        let joint_states = {
            let count = counter(&report, clock, on_event.clone());
            let handler = move |sample: RosSample<'_>| {
                count(&locked(&input).take(sample, clock.micros(), &client));
            };
            let topic = Topic::of::<JointState>(&robot.joint_states, settings.distribution);
            session.subscribe(&topic, Qos::sensor_data(), false, Box::new(handler))?
        };
        Ok(Self { _subscriptions: vec![joint_states, intent, answers], _speed_scaling: speed_scaling, report })
    }

    /// Report on its input.
    pub(super) fn report(&self) -> &InputReport {
        &self.report
    }
}

fn subscribe_to_answers(
    network: &dyn Network,
    key: &str,
    client: &Client,
    wake: &Wake,
) -> Result<Subscription, NetworkError> {
    let (client, wake) = (client.clone(), wake.clone());
    let handler = Box::new(move |bytes: &[u8]| {
        // A refused answer is of another start, or late: the client's watchdog handles that.
        let _ = locked(&client).receive(bytes);
        wake.notify();
    });
    network.subscribe(key, handler)
}

/// Counts the result of a message, and reports a reason that differs from the one before.
fn counter(
    report: &InputReport,
    clock: Clock,
    on_event: Option<EventHandler>,
) -> impl Fn(&Result<(), RosInputError>) + Send + Sync + 'static {
    let report = report.clone();
    move |result| {
        if let (Some(line), Some(on_event)) = (report.count(result, clock.micros()), &on_event) {
            on_event(&line);
        }
    }
}

impl Input {
    /// Passes joint values to the node.
    fn take(&mut self, sample: RosSample<'_>, now: Micros, client: &Client) -> Result<(), RosInputError> {
        let Self { joint_states, intent, to_node, bytes, oldest } = self;
        joint_states.take(sample, now)?;
        let state = ControllerState {
            q: &joint_states.q,
            qd: &joint_states.qd,
            intent: intent.velocities(now, *oldest),
            programmed_override: 1.0,
            attached: &[],
            stamp: Some(joint_states.stamp),
        };
        bytes.clear();
        bytes.extend_from_slice(locked(client).joint_state(now, &state));
        to_node.publish(bytes);
        Ok(())
    }
}
