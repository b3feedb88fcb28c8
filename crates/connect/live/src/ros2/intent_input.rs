//! Intended motion from `control_msgs/JointTrajectoryControllerState`.

use elbowroom_interlock::Micros;
use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::control_msgs::JointTrajectoryReference;

use super::input_error::RosInputError;
use super::joint_names::JointNames;
use super::joint_state_input::attachment;
use super::publisher_gate::PublisherGate;
use super::session::RosSample;

/// The intended velocities of one robot.
#[derive(Debug)]
pub(super) struct IntentInput {
    names: JointNames,
    gate: PublisherGate,
    places: Vec<Option<usize>>,
    velocities: Vec<f64>,
    stamp: Option<Micros>,
}

impl IntentInput {
    pub(super) fn new(names: JointNames) -> Self {
        let gate = PublisherGate::default();
        Self { names, gate, places: Vec::new(), velocities: Vec::new(), stamp: None }
    }

    /// Reads a sample. After a refused sample the intent is unknown.
    pub(super) fn take(&mut self, sample: RosSample<'_>, arrived: Micros) -> Result<(), RosInputError> {
        self.stamp = None;
        let attachment = attachment(sample)?;
        // Later releases append fields after these.
        let message = JointTrajectoryReference::decode_prefix(sample.payload)?;
        let (names, values) = (message.joint_names.len(), message.reference.velocities.len());
        if values != names && values > 0 {
            return Err(RosInputError::Length { list: "reference.velocities", names, values });
        }
        self.names.places(&message.joint_names, &mut self.places)?;
        let stamp = self.gate.pass(&attachment, message.header.stamp.nanoseconds(), arrived)?;
        self.names.sort(&self.places, &message.reference.velocities, &mut self.velocities);
        self.stamp = Some(stamp);
        Ok(())
    }

    /// Velocities of the program in the order of the chain; empty unless known and at most `oldest` old.
    pub(super) fn velocities(&mut self, now: Micros, oldest: Micros) -> &[f64] {
        match self.stamp {
            Some(stamp) if self.gate.now(now) - stamp <= oldest => &self.velocities,
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_cell::Cell;
    use elbowroom_ros2::msgs::control_msgs::JointTrajectoryControllerState;
    use elbowroom_ros2::rmw_zenoh::{Attachment, Gid};

    use super::super::settings::Ros2Robot;
    use super::*;

    fn input() -> (IntentInput, String) {
        let text = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n[robot.rail]\n\
                    dh = [{ kind = \"prismatic\", min = 0, max = 2000, speed = 1000 }]\n";
        let cell = Cell::parse("rail.toml", text).unwrap();
        let robot = Ros2Robot::of("rail");
        (IntentInput::new(JointNames::new(&cell, &robot, &[])), cell.robots[0].joint_names().remove(0))
    }

    fn take(input: &mut IntentInput, sequence: i64, name: &str, velocities: &[f64]) -> Result<(), RosInputError> {
        let mut message = JointTrajectoryControllerState {
            joint_names: vec![name.to_owned()],
            ..JointTrajectoryControllerState::default()
        };
        message.reference.velocities = velocities.to_vec();
        let stamp_ns = sequence * 2_000_000;
        let attachment = Attachment { sequence, stamp_ns, source: Gid([1; 16]) }.encode();
        let sample = RosSample { payload: &message.encode(), attachment: Some(&attachment) };
        input.take(sample, Micros(sequence as u64 * 2_000))
    }

    #[test]
    fn the_intent_is_that_of_the_last_message_while_it_is_young() {
        let (mut input, joint) = input();
        take(&mut input, 1, &joint, &[0.25]).unwrap();
        assert_eq!(input.velocities(Micros(4_000), Micros(10_000)), [0.25]);
        assert!(input.velocities(Micros(40_000), Micros(10_000)).is_empty(), "it is old");
        take(&mut input, 20, &joint, &[]).unwrap();
        assert!(input.velocities(Micros(41_000), Micros(10_000)).is_empty(), "the controller states none");
    }

    #[test]
    fn after_a_message_that_does_not_count_no_intent_is_known() {
        let (mut input, joint) = input();
        for (name, velocities) in [(&joint[..], &[0.1, 0.2][..]), ("other", &[0.1][..])] {
            take(&mut input, 1, &joint, &[0.25]).unwrap_or_else(|e| assert!(matches!(e, RosInputError::Rejected(_))));
            assert!(take(&mut input, 2, name, velocities).is_err());
            assert!(input.velocities(Micros(4_000), Micros(10_000)).is_empty());
        }
    }
}
