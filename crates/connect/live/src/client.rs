//! The controller's side: what to send to the node, and which override to apply.

use elbowroom_interlock::Micros;
use thiserror::Error;

use crate::messages::{AttachedVolume, JointState, MessageError, OVERRIDE_ANSWER_BYTES, OverrideAnswer};

/// The times at which this many messages were sent are remembered: answers to older ones are too old anyway.
const REMEMBERED: usize = 256;

/// What a controller tells its node in a tick. Slices hold one value per joint in the chain's order.
#[derive(Debug, Clone, Copy, Default)]
pub struct ControllerState<'a> {
    /// Joint positions, rad or m.
    pub q: &'a [f64],
    /// Joint velocities; empty if they are not known.
    pub qd: &'a [f64],
    /// Velocities of the program at override 1; empty if they are not known.
    pub intent: &'a [f64],
    /// The override set by the program or the operator, 0..1.
    pub programmed_override: f64,
    /// Gripped parts and exchanged tools.
    pub attached: &'a [AttachedVolume],
    /// When the joints were read, on the same clock as all other times, where it is known better than that it is now: the nominal
    /// time of a periodic tick.
    pub stamp: Option<Micros>,
}

/// The connection of one controller to its node, without the network: bytes go out with [`Self::joint_state`] and come in with
/// [`Self::receive`]. Nothing is allocated after [`Self::new`].
///
/// **It stops by itself**: an answer counts for [`Self::watchdog`] from the moment at which the joint values that it answers were
/// sent, on the controller's own clock. So whatever a network delays, and whether the node has died or is cut off, the override is
/// 0 at most that long after the last joint values that a living node has seen.
///
/// ```
/// use elbowroom_interlock::Micros;
/// use elbowroom_live::messages::OverrideAnswer;
/// use elbowroom_live::{ControllerClient, ControllerState};
///
/// let mut client = ControllerClient::new(1, 0);
/// let sent = client.joint_state(Micros(0), &ControllerState { q: &[0.1], programmed_override: 1.0, ..Default::default() });
/// assert!(!sent.is_empty());
/// // What a node would answer:
/// let mut answer = Vec::new();
/// OverrideAnswer { boot: 1, echo: 1, sequence: 1, speed_override: 0.7, ..Default::default() }.encode(&mut answer);
/// client.receive(&answer)?;
/// assert_eq!(client.speed_override(Micros(2_000)), 0.7);
/// assert_eq!(client.speed_override(Micros(21_000)), 0.0); // the watchdog's 20 ms are over
/// # Ok::<(), elbowroom_live::Refused>(())
/// ```
#[derive(Debug, Clone)]
pub struct ControllerClient {
    checksum: u64,
    watchdog: Micros,
    state: JointState,
    bytes: Vec<u8>,
    sent: [Micros; REMEMBERED],
    answer: Option<OverrideAnswer>,
}

/// Why an answer is not obeyed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Refused {
    /// It cannot be read.
    #[error("{0}")]
    Message(#[from] MessageError),
    /// It is for another start of this controller.
    #[error("the answer is for another start of this controller")]
    OtherStart,
    /// The node guards another cell.
    #[error("the node guards another configuration: load the same cell file on both sides")]
    OtherConfiguration,
    /// It answers what was not sent, or something older than the last answer.
    #[error("the answer is late, was there before, or answers what was not sent")]
    Late,
    /// The override is not within 0..1.
    #[error("the override is not within 0..1")]
    Override,
}

impl ControllerClient {
    /// A client. `boot` must be higher than at former starts of this controller: [`boot_number`](crate::boot_number) will do.
    /// `checksum` is that of the cell ([`configuration_number`](crate::configuration_number)), or 0 to obey any.
    pub fn new(boot: u64, checksum: u64) -> Self {
        Self {
            checksum,
            watchdog: Micros(20_000),
            state: JointState { checksum, boot, ..JointState::with_capacity() },
            bytes: Vec::with_capacity(crate::messages::MAX_JOINT_STATE_BYTES),
            sent: [Micros(0); REMEMBERED],
            answer: None,
        }
    }

    /// With another time for which an answer counts; the default is 20 ms. It is a part of the reaction time that the node's
    /// stopping distances assume: `stale_ms` of the cell.
    #[must_use]
    pub fn with_watchdog(self, watchdog: Micros) -> Self {
        Self { watchdog, ..self }
    }

    /// How long an answer counts.
    pub fn watchdog(&self) -> Micros {
        self.watchdog
    }

    /// The bytes of the next message to the node. Call it in every tick.
    ///
    /// While no answer counts the message says that the program stands, at override 0: the node must not take a robot that stops by
    /// itself for one whose joint values are frozen.
    pub fn joint_state(&mut self, now: Micros, state: &ControllerState<'_>) -> &[u8] {
        let programmed_override = if self.answer(now).is_some() { state.programmed_override } else { 0.0 };
        let message = &mut self.state;
        message.sequence += 1;
        message.stamp_us = state.stamp.unwrap_or(now).0;
        message.programmed_override = programmed_override;
        for (to, from) in [(&mut message.q, state.q), (&mut message.qd, state.qd), (&mut message.intent, state.intent)]
        {
            to.clear();
            to.extend_from_slice(from);
        }
        message.attached.clear();
        message.attached.extend_from_slice(state.attached);
        self.sent[message.sequence as usize % REMEMBERED] = now;
        message.encode(&mut self.bytes);
        &self.bytes
    }

    /// Takes an answer of the node.
    ///
    /// # Errors
    /// Why it is not obeyed: then the former answer counts for as long as it is fresh.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), Refused> {
        if bytes.len() != OVERRIDE_ANSWER_BYTES {
            return Err(MessageError::Length(bytes.len()).into());
        }
        let answer = OverrideAnswer::decode(bytes)?;
        if answer.boot != self.state.boot {
            return Err(Refused::OtherStart);
        }
        if self.checksum != 0 && answer.checksum != self.checksum {
            return Err(Refused::OtherConfiguration);
        }
        let is_known = answer.echo > 0 && answer.echo <= self.state.sequence;
        let is_late = self.answer.is_some_and(|last| {
            answer.echo < last.echo || answer.echo == last.echo && answer.sequence <= last.sequence
        });
        if !is_known || is_late {
            return Err(Refused::Late);
        }
        if !(0.0..=1.0).contains(&answer.speed_override) {
            return Err(Refused::Override);
        }
        self.answer = Some(answer);
        Ok(())
    }

    /// The last answer, while it counts.
    pub fn answer(&self, now: Micros) -> Option<&OverrideAnswer> {
        self.answer.as_ref().filter(|answer| {
            let age = self.state.sequence - answer.echo;
            let sent = self.sent[answer.echo as usize % REMEMBERED];
            // On a clock that was set back nothing is fresh.
            age < REMEMBERED as u64 && now >= sent && now - sent <= self.watchdog
        })
    }

    /// The override to apply now: 0 without an answer that counts.
    pub fn speed_override(&self, now: Micros) -> f64 {
        self.answer(now).map_or(0.0, |answer| answer.speed_override)
    }
}
