//! Joint values from `sensor_msgs/JointState`.

use elbowroom_interlock::Micros;
use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::sensor_msgs::JointState;
use elbowroom_ros2::rmw_zenoh::Attachment;

use super::input_error::{MAX_MESSAGE_BYTES, RosInputError};
use super::joint_names::JointNames;
use super::publisher_gate::PublisherGate;
use super::session::RosSample;

/// The joint values of one robot.
#[derive(Debug)]
pub(super) struct JointStateInput {
    names: JointNames,
    gate: PublisherGate,
    places: Vec<Option<usize>>,
    /// Positions in the order of the chain.
    pub(super) q: Vec<f64>,
    /// Velocities; empty if unknown.
    pub(super) qd: Vec<f64>,
    /// Time of the values, on the clock of the publisher.
    pub(super) stamp: Micros,
}

impl JointStateInput {
    pub(super) fn new(names: JointNames) -> Self {
        let gate = PublisherGate::default();
        Self { names, gate, places: Vec::new(), q: Vec::new(), qd: Vec::new(), stamp: Micros(0) }
    }

    /// Reads a sample. Numbers that are not finite are passed on; the monitor answers them with override 0.
    pub(super) fn take(&mut self, sample: RosSample<'_>, arrived: Micros) -> Result<(), RosInputError> {
        let attachment = attachment(sample)?;
        let message = JointState::decode(sample.payload)?;
        let names = message.name.len();
        for (list, values, may_lack) in [
            ("position", &message.position, false),
            ("velocity", &message.velocity, true),
            ("effort", &message.effort, true),
        ] {
            let is_lacking = may_lack && values.is_empty();
            if values.len() != names && !is_lacking {
                return Err(RosInputError::Length { list, names, values: values.len() });
            }
        }
        self.names.places(&message.name, &mut self.places)?;
        self.stamp = self.gate.pass(&attachment, message.header.stamp.nanoseconds(), arrived)?;
        self.names.sort(&self.places, &message.position, &mut self.q);
        self.names.sort(&self.places, &message.velocity, &mut self.qd);
        // Without an interface for velocities, joint_state_broadcaster fills the list with NaN.
        if self.qd.iter().all(|v| v.is_nan()) {
            self.qd.clear();
        }
        Ok(())
    }
}

/// Reads the attachment of a sample, if the sample is not too large.
pub(super) fn attachment(sample: RosSample<'_>) -> Result<Attachment, RosInputError> {
    if sample.payload.len() > MAX_MESSAGE_BYTES {
        return Err(RosInputError::Size(sample.payload.len()));
    }
    Ok(Attachment::decode(sample.attachment.ok_or(RosInputError::NoAttachment)?)?)
}
