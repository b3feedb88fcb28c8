//! Gate of a topic's samples: accepts one publisher, in order.

use elbowroom_interlock::Micros;
use elbowroom_ros2::rmw_zenoh::{Attachment, Gid};

use super::input_error::RosInputError;
use crate::messages::JointState;
use crate::node::InputGate;

/// Silence after which a publisher may be replaced by another one.
const REPLACED: Micros = Micros(1_000_000);

/// The gate of the node's own input, applied to samples of ROS 2: the number is taken from the attachment, and each
/// publisher counts as another start of the controller.
#[derive(Debug, Default)]
pub(super) struct PublisherGate {
    gate: InputGate,
    source: Option<Gid>,
    starts: u64,
    heard: Micros,
}

impl PublisherGate {
    /// Accepts a sample; returns its time on its publisher's clock.
    ///
    /// `stamp_ns` is the stamp in the message; if it is 0, the attachment's stamp is used.
    pub(super) fn pass(
        &mut self,
        attachment: &Attachment,
        stamp_ns: i64,
        arrived: Micros,
    ) -> Result<Micros, RosInputError> {
        let is_other = self.source != Some(attachment.source);
        if is_other && self.source.is_some() && arrived - self.heard < REPLACED {
            return Err(RosInputError::OtherPublisher);
        }
        let stamp_ns = if stamp_ns == 0 { attachment.stamp_ns } else { stamp_ns };
        let unsigned = |value: i64| u64::try_from(value).map_err(|_| RosInputError::Negative);
        let boot = self.starts + u64::from(is_other);
        let (sequence, stamp_us) = (unsigned(attachment.sequence)?, unsigned(stamp_ns / 1000)?);
        let stamp = self.gate.pass(&JointState { boot, sequence, stamp_us, ..JointState::default() }, arrived)?;
        (self.source, self.starts, self.heard) = (Some(attachment.source), boot, arrived);
        Ok(stamp)
    }

    /// Time on the publisher's clock when this process's clock shows `local`.
    pub(super) fn now(&mut self, local: Micros) -> Micros {
        self.gate.now(local)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node::Rejected;

    fn of(source: u8, sequence: i64) -> Attachment {
        Attachment { sequence, stamp_ns: sequence * 1_000_000, source: Gid([source; 16]) }
    }

    #[test]
    fn one_publisher_counts_in_order_and_another_one_after_a_second_of_silence() {
        let mut gate = PublisherGate::default();
        gate.pass(&of(1, 5), 0, Micros(0)).unwrap();
        let late = Err(RosInputError::Rejected(Rejected::Late));
        assert_eq!(gate.pass(&of(1, 5), 0, Micros(1_000)), late);
        assert_eq!(gate.pass(&of(1, 4), 0, Micros(2_000)), late);
        assert_eq!(gate.pass(&of(2, 9), 0, Micros(3_000)), Err(RosInputError::OtherPublisher));
        gate.pass(&of(1, 6), 0, Micros(500_000)).unwrap();
        assert_eq!(gate.pass(&of(2, 9), 0, Micros(1_400_000)), Err(RosInputError::OtherPublisher));
        // A restarted controller begins at 1 again.
        gate.pass(&of(2, 1), 0, Micros(1_500_000)).unwrap();
        assert_eq!(gate.pass(&of(2, 1), 0, Micros(1_501_000)), late);
        assert_eq!(gate.pass(&of(2, -1), 0, Micros(1_502_000)), Err(RosInputError::Negative));
    }

    #[test]
    fn an_old_stamp_in_the_message_makes_it_old_whatever_the_attachment_says() {
        let mut gate = PublisherGate::default();
        for n in 1..100 {
            let stamp = gate.pass(&of(1, n), n * 1_000_000, Micros(n as u64 * 1_000)).unwrap();
            assert_eq!(gate.now(Micros(n as u64 * 1_000)) - stamp, Micros(0));
        }
        let stamp = gate.pass(&of(1, 200), 99_000_000, Micros(200_000)).unwrap();
        // Less what the clocks may have drifted apart since the message before.
        assert_eq!(gate.now(Micros(200_000)) - stamp, Micros(101_000 - 101));
        assert_eq!(gate.pass(&of(1, 201), -5_000, Micros(201_000)), Err(RosInputError::Negative));
    }
}
