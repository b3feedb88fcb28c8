//! The robot's side of the protocol.

use thiserror::Error;

use crate::{Boot, GrantsMessage, Micros, Occupancy, RobotSlot, SlotAnswer, SlotId, SlotReport, StateMessage, Token};

/// Why a message of an arbiter was not obeyed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Ignored {
    /// The message is for another robot or another cell.
    #[error("the message is for another robot or another cell")]
    OtherRobot,
    /// The arbiter has another cell file.
    #[error("the arbiter has another configuration: load the same cell file on both sides")]
    OtherConfiguration,
    /// The message answers another start of this robot's guard.
    #[error("the message answers another start of this guard")]
    OtherStart,
    /// A later message was obeyed before.
    #[error("a later message was obeyed before")]
    Late,
}

/// Number of sent messages whose times are stored; an answer to an older message confirms nothing.
const REMEMBERED: usize = if cfg!(test) { 8 } else { 64 };

/// The guard of one robot, which reports where the robot is and knows which slots it may enter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Guard {
    robot: RobotSlot,
    checksum: u64,
    validity: Micros,
    boot: Boot,
    sequence: u64,
    /// Times at which the last messages were sent, indexed by sequence number.
    sent: Vec<Micros>,
    arbiter: Boot,
    serial: u64,
    slots: Vec<GuardedSlot>,
}

/// The guard's state of one slot.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct GuardedSlot {
    occupancy: Occupancy,
    /// True if the robot needs the slot when it is near. It does not near a region that is switched off.
    is_needed: bool,
    token: Option<Token>,
    released: Option<Token>,
    /// Time at which the message was sent whose answer last confirmed the token.
    confirmed: Option<Micros>,
    orders: Orders,
    /// True if the grant is not obeyed any more. It is given up when the robot is next observed to be able to stop
    /// outside.
    is_closing: bool,
}

/// The arbiter's last requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Orders {
    release_requested: bool,
    halt: bool,
}

impl GuardedSlot {
    const NEW: Self = Self {
        occupancy: Occupancy::Unknown,
        is_needed: true,
        token: None,
        released: None,
        confirmed: None,
        orders: Orders { release_requested: false, halt: false },
        is_closing: false,
    };

    /// Forgets a grant that the arbiter does not know. The occupancy counts as unknown until it is observed again,
    /// because the robot may have entered since the last observation.
    fn forget(&mut self) {
        *self = Self { released: self.released, ..Self::NEW };
    }
}

impl Guard {
    /// Creates the guard of a robot in a cell with this number of slots and this configuration.
    ///
    /// `boot` must be higher than for all former guards of the robot. The time of day is sufficient: a guard that learns
    /// of a higher number takes the next number.
    pub fn new(robot: RobotSlot, slots: usize, checksum: u64, boot: Boot) -> Self {
        Self {
            robot,
            checksum,
            validity: Micros(50_000),
            boot,
            sequence: 0,
            sent: vec![Micros(0); REMEMBERED],
            arbiter: Boot::NONE,
            serial: 0,
            slots: vec![GuardedSlot::NEW; slots],
        }
    }

    /// Sets the time for which a grant may be obeyed after its request was sent; the default is 50 ms. It must not be
    /// longer than the validity in the arbiter's settings.
    #[must_use]
    pub fn validity(self, validity: Micros) -> Self {
        Self { validity, ..self }
    }

    /// The robot.
    pub fn robot(&self) -> RobotSlot {
        self.robot
    }

    /// Start of this guard.
    pub fn boot(&self) -> Boot {
        self.boot
    }

    /// The start of the arbiter that is obeyed.
    pub fn arbiter(&self) -> Boot {
        self.arbiter
    }

    /// The grant of a slot, usable or not.
    pub fn token(&self, slot: SlotId) -> Option<Token> {
        self.slots[slot.0].token
    }

    /// True if the robot must stop because another robot was found inside.
    pub fn must_halt(&self, slot: SlotId) -> bool {
        self.slots[slot.0].orders.halt
    }

    /// Records the occupancy that the monitor found at a slot in a tick, after the tick has decided with
    /// [`Guard::may_enter`].
    pub fn observe(&mut self, slot: SlotId, occupancy: Occupancy) {
        let slot = &mut self.slots[slot.0];
        slot.occupancy = occupancy;
        if slot.is_closing && occupancy != Occupancy::Unknown {
            if !occupancy.occupies() {
                slot.released = slot.token.or(slot.released);
                slot.token = None;
                slot.confirmed = None;
            }
            slot.is_closing = false;
        }
    }

    /// Sets whether the robot needs a slot when it is in the slot's warning zone; true until this is called. Set it to
    /// false if all regions of the slot there are switched off. The robot keeps a slot that it has until it is outside.
    pub fn need(&mut self, slot: SlotId, is_needed: bool) {
        self.slots[slot.0].is_needed = is_needed;
    }

    /// Records that the robot's position is not known any more: then no other robot is granted a slot that it can be in.
    pub fn lose_sight(&mut self) {
        self.slots.iter_mut().for_each(|slot| slot.occupancy = Occupancy::Unknown);
    }

    /// Number of slots of the cell.
    pub fn slots(&self) -> usize {
        self.slots.len()
    }

    /// True if the robot may enter the regions of a slot now: its grant is confirmed, and the confirmation is not older
    /// than the validity.
    pub fn may_enter(&self, slot: SlotId, now: Micros) -> bool {
        let slot = &self.slots[slot.0];
        let is_fresh = slot.confirmed.is_some_and(|sent| sent <= now && now - sent <= self.validity);
        slot.token.is_some() && is_fresh && !slot.is_closing && !slot.orders.halt
    }

    /// The next message to the arbiter.
    pub fn state(&mut self, now: Micros) -> StateMessage {
        let mut message = StateMessage::with_slots(self.slots.len());
        self.state_into(now, &mut message);
        message
    }

    /// Writes the next message to the arbiter. Does not allocate if `message` has as many slots as the cell.
    pub fn state_into(&mut self, now: Micros, message: &mut StateMessage) {
        for slot in &mut self.slots {
            let is_asked = slot.orders.release_requested || slot.orders.halt;
            let may_release = slot.occupancy == Occupancy::Outside || slot.occupancy == Occupancy::Warning && is_asked;
            slot.is_closing |= slot.token.is_some() && may_release;
        }
        self.sequence += 1;
        self.sent[self.sequence as usize % REMEMBERED] = now;
        (message.robot, message.boot, message.sequence) = (self.robot, self.boot, self.sequence);
        (message.checksum, message.arbiter) = (self.checksum, self.arbiter);
        message.slots.clear();
        message.slots.extend(self.slots.iter().map(GuardedSlot::report));
    }

    /// Processes a message of an arbiter.
    ///
    /// # Errors
    /// [`Ignored`] states why the message is not obeyed.
    pub fn receive(&mut self, message: &GrantsMessage) -> Result<(), Ignored> {
        if message.robot != self.robot || message.slots.len() != self.slots.len() {
            return Err(Ignored::OtherRobot);
        }
        if message.checksum != self.checksum {
            return Err(Ignored::OtherConfiguration);
        }
        if message.robot_boot != self.boot {
            self.take_next_boot(message.robot_boot);
            return Err(Ignored::OtherStart);
        }
        if message.arbiter < self.arbiter || message.arbiter == self.arbiter && message.serial <= self.serial {
            return Err(Ignored::Late);
        }
        if message.arbiter > self.arbiter {
            self.arbiter = message.arbiter;
            self.slots.iter_mut().for_each(GuardedSlot::forget);
        }
        self.serial = message.serial;
        let sent = self.sent_at(message.echo);
        for (slot, answer) in self.slots.iter_mut().zip(&message.slots) {
            slot.take(*answer, sent);
        }
        Ok(())
    }

    /// Restarts this guard with the next number, because the arbiter knows a later start of this robot's guard.
    fn take_next_boot(&mut self, known: Boot) {
        if known > self.boot {
            self.boot = known.next();
            self.sequence = 0;
            self.slots.fill(GuardedSlot::NEW);
        }
    }

    /// Time at which the message with this sequence number was sent.
    pub(crate) fn sent_at(&self, sequence: u64) -> Option<Micros> {
        let age = self.sequence.checked_sub(sequence)?;
        (sequence > 0 && age < REMEMBERED as u64).then(|| self.sent[sequence as usize % REMEMBERED])
    }
}

impl GuardedSlot {
    fn report(&self) -> SlotReport {
        SlotReport {
            occupancy: self.occupancy,
            wants: self.occupancy > Occupancy::Outside && self.is_needed,
            token: self.token,
            released: self.released,
        }
    }

    fn take(&mut self, answer: SlotAnswer, sent: Option<Micros>) {
        self.orders = Orders { release_requested: answer.release_requested, halt: answer.halt };
        match answer.granted {
            Some(token) if self.released >= Some(token) => {}
            Some(token) => {
                if self.token != Some(token) {
                    (self.token, self.confirmed, self.is_closing) = (Some(token), None, false);
                }
                self.confirmed = self.confirmed.max(sent);
            }
            None if self.token.is_some() => self.forget(),
            None => {}
        }
    }
}

/// Access for the model check, which reads and rewrites the state.
#[cfg(test)]
impl Guard {
    pub(crate) fn each_time(&mut self, f: &mut impl FnMut(&mut Micros)) {
        self.sent.iter_mut().for_each(&mut *f);
        self.slots.iter_mut().filter_map(|slot| slot.confirmed.as_mut()).for_each(f);
    }

    /// Visits the grant that is obeyed and the last grant given up, per slot.
    pub(crate) fn each_token(&mut self, f: &mut impl FnMut(SlotId, &mut Option<Token>)) {
        for (s, slot) in self.slots.iter_mut().enumerate() {
            f(SlotId(s), &mut slot.token);
            f(SlotId(s), &mut slot.released);
        }
    }

    pub(crate) fn released_mut(&mut self, slot: SlotId) -> &mut Option<Token> {
        &mut self.slots[slot.0].released
    }

    pub(crate) fn serial_mut(&mut self) -> &mut u64 {
        &mut self.serial
    }

    /// This guard with one of its slots, as the guard of another robot.
    pub(crate) fn project(&self, robot: RobotSlot, slot: SlotId) -> Self {
        Self { robot, slots: vec![self.slots[slot.0].clone()], ..self.clone() }
    }

    pub(crate) fn replace_occupancy(&mut self, from: Occupancy, to: Occupancy) {
        self.slots.iter_mut().filter(|slot| slot.occupancy == from).for_each(|slot| slot.occupancy = to);
    }

    /// Reads or writes the fields that steps change.
    pub(crate) fn code(&mut self, codec: &mut super::model::codec::Codec) {
        codec.boot(&mut self.boot);
        codec.number(&mut self.sequence);
        let sent = self.sequence as usize + 1;
        self.sent[sent..].fill(Micros(0));
        self.sent[..sent].iter_mut().for_each(|time| codec.time(time));
        codec.boot(&mut self.arbiter);
        codec.number(&mut self.serial);
        for slot in &mut self.slots {
            codec.occupancy(&mut slot.occupancy);
            codec.token(&mut slot.token);
            codec.token(&mut slot.released);
            codec.option(&mut slot.confirmed, Micros(0), super::model::codec::Codec::time);
            codec.flag(&mut slot.orders.release_requested);
            codec.flag(&mut slot.orders.halt);
            codec.flag(&mut slot.is_closing);
        }
    }

    pub(crate) fn boot_mut(&mut self) -> &mut Boot {
        &mut self.boot
    }

    pub(crate) fn arbiter_mut(&mut self) -> &mut Boot {
        &mut self.arbiter
    }

    /// Sets whether the guard is asked to give up its grants, and forgets other orders.
    pub(crate) fn ask(&mut self, release_requested: bool) {
        self.slots.iter_mut().for_each(|slot| slot.orders = Orders { release_requested, halt: false });
    }

    pub(crate) fn set_robot(&mut self, robot: RobotSlot) {
        self.robot = robot;
    }

    /// Whether an answer to this message may still confirm a grant.
    pub(crate) fn confirms(&self, sequence: u64, now: Micros) -> bool {
        self.sent_at(sequence).is_some_and(|sent| now - sent <= self.validity)
    }

    /// Removes confirmations that are too old to be obeyed.
    pub(crate) fn forget_expired(&mut self, now: Micros) {
        let validity = self.validity;
        for slot in &mut self.slots {
            slot.confirmed = slot.confirmed.filter(|sent| now - *sent <= validity);
        }
    }

    /// Whether a message would never change anything from now on.
    pub(crate) fn is_past(&self, message: &GrantsMessage) -> bool {
        let late = message.arbiter < self.arbiter || message.arbiter == self.arbiter && message.serial <= self.serial;
        message.robot_boot < self.boot || message.robot_boot == self.boot && late
    }

    /// Sets the times at which the messages up to the last one were sent.
    pub(crate) fn set_sent(&mut self, times: &[Option<Micros>]) {
        self.sent.fill(Micros(0));
        for (sequence, time) in times.iter().enumerate() {
            self.sent[sequence] = time.unwrap_or(Micros(0));
        }
        self.sequence = times.len() as u64 - 1;
    }

    /// A planted fault for the model check: gives up a grant as soon as the guard has decided to.
    pub(crate) fn give_up_at_once(&mut self) {
        for slot in self.slots.iter_mut().filter(|slot| slot.is_closing) {
            slot.released = slot.token.or(slot.released);
            (slot.token, slot.confirmed, slot.is_closing) = (None, None, false);
        }
    }
}
