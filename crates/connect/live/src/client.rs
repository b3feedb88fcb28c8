//! Client of a controller: encodes its messages to the node and selects the override to apply.

use elbowroom_interlock::Micros;
use thiserror::Error;

use crate::messages::{AttachedVolume, JointState, MessageError, OVERRIDE_ANSWER_BYTES, OverrideAnswer};

/// Number of messages whose send times are kept: answers to older messages are too old anyway.
const REMEMBERED: usize = 256;

/// State that a controller sends to its node in each tick. Slices hold one value per joint in the chain's order.
#[derive(Debug, Clone, Copy, Default)]
pub struct ControllerState<'a> {
    /// Joint positions, rad or m.
    pub q: &'a [f64],
    /// Joint velocities, rad/s or m/s; empty if unknown.
    pub qd: &'a [f64],
    /// Velocities of the program at override 1, rad/s or m/s; empty if unknown.
    pub intent: &'a [f64],
    /// The override set by the program or the operator, 0..1.
    pub programmed_override: f64,
    /// Gripped parts and exchanged tools.
    pub attached: &'a [AttachedVolume],
    /// Time at which the joints were read, on the same clock as all other times; `None` for now. In a periodic tick the
    /// nominal time of the tick is more accurate than now.
    pub stamp: Option<Micros>,
}

/// The connection of one controller to its node, without the network: [`Self::joint_state`] makes the bytes to send,
/// [`Self::receive`] reads the bytes that arrive. Nothing is allocated after [`Self::new`].
///
/// **The controller stops by itself**: an answer is valid for [`Self::watchdog`] from the time at which the joint
/// values that it answers were sent, on the controller's own clock. So the override is always 0 at most that long after
/// the last joint values that a running node has received, whatever delays the network adds and whether the node has
/// died or is cut off.
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

/// Why an answer is rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Refused {
    /// The message cannot be read.
    #[error("{0}")]
    Message(#[from] MessageError),
    /// The answer is for another start of this controller.
    #[error("the answer is for another start of this controller")]
    OtherStart,
    /// The node guards another cell.
    #[error("the node guards another configuration: load the same cell file on both sides")]
    OtherConfiguration,
    /// The answer is to a message that was not sent, or is older than the last answer.
    #[error("the answer is late, was there before, or answers what was not sent")]
    Late,
    /// The override is not within 0..1.
    #[error("the override is not within 0..1")]
    Override,
}

impl ControllerClient {
    /// Creates a client.
    ///
    /// `boot` must be higher than at earlier starts of this controller; use [`boot_number`](crate::boot_number).
    /// `checksum` is the number of the cell ([`configuration_number`](crate::configuration_number)), or 0 to accept any
    /// cell.
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

    /// Sets the time for which an answer is valid; the default is 20 ms.
    ///
    /// The node's stopping distances include it in their reaction time: `stale_ms` of the cell.
    #[must_use]
    pub fn with_watchdog(self, watchdog: Micros) -> Self {
        Self { watchdog, ..self }
    }

    /// Time for which an answer is valid.
    pub fn watchdog(&self) -> Micros {
        self.watchdog
    }

    /// Returns the bytes of the next message to the node. Call it in every tick.
    ///
    /// While no answer is valid the message reports programmed override 0, as if the program waited: otherwise the node
    /// would take the joint values of a robot that has stopped by itself for frozen.
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

    /// Reads an answer of the node.
    ///
    /// # Errors
    /// The reason for rejecting the answer; the previous answer then stays in use while it is valid.
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

    /// The last answer, while it is valid.
    pub fn answer(&self, now: Micros) -> Option<&OverrideAnswer> {
        self.answer.as_ref().filter(|answer| {
            let age = self.state.sequence - answer.echo;
            let sent = self.sent[answer.echo as usize % REMEMBERED];
            // If the clock was set back, no answer is valid.
            age < REMEMBERED as u64 && now >= sent && now - sent <= self.watchdog
        })
    }

    /// The override to apply now: 0 without a valid answer.
    pub fn speed_override(&self, now: Micros) -> f64 {
        self.answer(now).map_or(0.0, |answer| answer.speed_override)
    }
}
