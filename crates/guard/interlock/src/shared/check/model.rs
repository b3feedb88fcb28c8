//! A finite model of the exchange protocol: robots on programs of a few places, and the arbiter that they share.

use std::fmt::Write as _;
use std::sync::atomic::Ordering::SeqCst;

use super::super::shared_state::InjectedFault;
use crate::{AccessClass, Occupancy, RobotSlot, SlotId, ZoneArbiter};

/// Time of every step; a publication at time 0 is older than the silence timeout.
const NOW_S: f64 = 1.0;

/// Which robots may become silent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Faults {
    None,
    First,
    All,
}

/// Programs and options of the model.
#[derive(Debug)]
#[allow(clippy::struct_excessive_bools, reason = "independent switches of a test")]
pub(super) struct ProtocolModel {
    /// Occupancy per robot, per slot, per place.
    programs: Vec<Vec<Vec<Occupancy>>>,
    pub(super) arbiter: ZoneArbiter,
    declares: bool,
    faults: Faults,
    repeats: bool,
    braking_known: bool,
    publishes_commitment: bool,
    interleaves: bool,
    switchable: bool,
    joggable: bool,
}

/// State of one robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct RobotState {
    pub(super) at: u8,
    moving: bool,
    silent: bool,
    /// Next operation of the tick, if the operations of different robots interleave.
    phase: u8,
}

/// A state of the model: the robots and the memory of the arbiter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct ModelState {
    pub(super) robots: Vec<RobotState>,
    on: bool,
    holders: Vec<u8>,
    /// Per slot and robot: whether it is registered, its occupancy, whether that is current, and its rank in the queue.
    entries: Vec<[u8; 4]>,
}

/// A transition of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// A tick (or one operation of it) after which the robot moves if it may.
    Tick(RobotSlot),
    /// A tick after which the robot rests although it may move.
    Rest(RobotSlot),
    BecomeSilent(RobotSlot),
    Resume(RobotSlot),
    Clear(RobotSlot),
    SwitchOn,
    Jog(RobotSlot),
}

/// A property that does not hold.
#[derive(Debug, thiserror::Error)]
pub(super) enum Violation {
    #[error("robot {} releases slot {} although it cannot stop", .robot.0, .slot.0)]
    EarlyRelease { robot: RobotSlot, slot: SlotId },
    /// States are described as [`ProtocolModel::describe`] does.
    #[error("robot {} enters slot {} while {} occupies it ({after}) after {step:?} in {before}", .robot.0, .slot.0, .other.0)]
    Entry { robot: RobotSlot, slot: SlotId, other: RobotSlot, step: Step, before: String, after: String },
}

impl ProtocolModel {
    /// Builds a model from one word per robot and slot: `_` is outside, `.` in the warning zone, `X` inside.
    pub(super) fn new(programs: &[&[&str]]) -> Self {
        let occupancy = |c: char| match c {
            'X' => Occupancy::Inside,
            '.' => Occupancy::Warning,
            _ => Occupancy::Outside,
        };
        let names = ["r0", "r1", "r2"];
        let arbiter = ZoneArbiter::new(&names[..programs.len()], &["a", "b", "c"][..programs[0].len()]);
        Self {
            programs: programs.iter().map(|p| p.iter().map(|s| s.chars().map(occupancy).collect()).collect()).collect(),
            arbiter,
            declares: false,
            faults: Faults::None,
            repeats: false,
            braking_known: true,
            publishes_commitment: true,
            interleaves: false,
            switchable: false,
            joggable: false,
        }
    }

    pub(super) fn declared(self) -> Self {
        Self { declares: true, ..self }
    }

    pub(super) fn faults(self, faults: Faults) -> Self {
        Self { faults, ..self }
    }

    pub(super) fn repeating(self) -> Self {
        Self { repeats: true, ..self }
    }

    pub(super) fn braking_unknown(self) -> Self {
        Self { braking_known: false, ..self }
    }

    pub(super) fn commitment_unpublished(self) -> Self {
        Self { publishes_commitment: false, ..self }
    }

    pub(super) fn interleaved(self) -> Self {
        Self { interleaves: true, ..self }
    }

    /// Makes the regions switchable; they are off at first.
    pub(super) fn switchable(self) -> Self {
        Self { switchable: true, ..self }
    }

    /// Lets silent robots be moved by hand until an integrator clears them.
    pub(super) fn joggable(self) -> Self {
        Self { joggable: true, ..self }
    }

    pub(super) fn inject(self, fault: InjectedFault) -> Self {
        self.arbiter.state.injected_fault.store(fault as u8, SeqCst);
        self
    }

    pub(super) fn robots(&self) -> usize {
        self.programs.len()
    }

    fn slots(&self) -> impl Iterator<Item = SlotId> + use<> {
        (0..self.programs[0].len()).map(SlotId)
    }

    fn robot_slots(&self) -> impl Iterator<Item = RobotSlot> + use<> {
        (0..self.robots()).map(RobotSlot)
    }

    fn places(&self, robot: RobotSlot) -> usize {
        self.programs[robot.0][0].len()
    }

    /// The initial state: every robot is at the first place of its program and known to be outside.
    pub(super) fn start(&self) -> ModelState {
        for (slot, robot) in self.pairs() {
            self.arbiter.publish(slot, robot, Occupancy::Outside, NOW_S);
        }
        let start = RobotState { at: 0, moving: false, silent: false, phase: 0 };
        self.save(vec![start; self.robots()], !self.switchable)
    }

    fn pairs(&self) -> impl Iterator<Item = (SlotId, RobotSlot)> + use<> {
        let robots = self.robots();
        self.slots().flat_map(move |slot| (0..robots).map(move |r| (slot, RobotSlot(r))))
    }

    /// Saves the memory of the arbiter, with the tickets of the queue as ranks: only their order counts.
    fn save(&self, robots: Vec<RobotState>, on: bool) -> ModelState {
        let ticket = |(slot, robot): (SlotId, RobotSlot)| self.arbiter.state.ticket(slot, robot);
        let mut tickets: Vec<u64> = self.pairs().map(ticket).filter(|t| *t > 0).collect();
        tickets.sort_unstable();
        let rank = |t: u64| if t == 0 { 0 } else { tickets.partition_point(|o| *o < t) as u8 + 1 };
        let entry = |(slot, robot): (SlotId, RobotSlot)| {
            let e = self.arbiter.state.entry(slot, robot);
            let known = f64::from_bits(e.published_s.load(SeqCst)) >= NOW_S;
            [
                u8::from(e.registered.load(SeqCst)),
                e.occupancy.load(SeqCst),
                u8::from(known),
                rank(ticket((slot, robot))),
            ]
        };
        let holders = self.arbiter.state.slots.iter().map(|s| s.holder.load(SeqCst) as u8).collect();
        ModelState { robots, on, holders, entries: self.pairs().map(entry).collect() }
    }

    pub(super) fn restore(&self, state: &ModelState) {
        for (slot, holder) in self.arbiter.state.slots.iter().zip(&state.holders) {
            slot.holder.store(u32::from(*holder), SeqCst);
        }
        for ((slot, robot), [registered, occupancy, known, rank]) in self.pairs().zip(&state.entries) {
            let e = self.arbiter.state.entry(slot, robot);
            e.registered.store(*registered == 1, SeqCst);
            e.occupancy.store(*occupancy, SeqCst);
            e.published_s.store(if *known == 1 { NOW_S } else { 0.0 }.to_bits(), SeqCst);
            e.ticket.store(u64::from(*rank), SeqCst);
        }
        let last = state.entries.iter().map(|e| u64::from(e[3])).max().unwrap_or(0);
        self.arbiter.state.next_ticket.store(last + 1, SeqCst);
        for robot in self.robot_slots() {
            self.declare(robot, state.robots[robot.0].at);
        }
    }

    /// Declares the slots of the rest of the robot's stretch: up to the next place outside all slots.
    fn declare(&self, robot: RobotSlot, at: u8) {
        if !self.declares {
            return;
        }
        let near = |place: usize, slot: SlotId| self.programs[robot.0][slot.0][place] > Occupancy::Outside;
        let places = (usize::from(at)..self.places(robot)).take_while(|p| self.slots().any(|s| near(*p, s)));
        let claims: Vec<SlotId> = places.flat_map(|p| self.slots().filter(move |s| near(p, *s))).collect();
        self.arbiter.declare(robot, claims);
    }

    /// The actual occupancy: `Committed` if the robot comes to rest inside although it is commanded to stop.
    fn actual(&self, robot: RobotSlot, current: RobotState, slot: SlotId) -> Occupancy {
        let place = |at: usize| self.programs[robot.0][slot.0][at.min(self.places(robot) - 1)];
        let at = usize::from(current.at);
        match place(at) {
            occupancy if occupancy != Occupancy::Inside && current.moving && place(at + 1) == Occupancy::Inside => {
                Occupancy::Committed
            }
            occupancy => occupancy,
        }
    }

    /// The occupancy that the robot publishes.
    fn published(&self, robot: RobotSlot, current: RobotState, slot: SlotId) -> Occupancy {
        let actual = self.actual(robot, current, slot);
        let holds = self.arbiter.holder(slot) == Some(robot);
        match actual {
            Occupancy::Committed if !self.publishes_commitment => {
                self.programs[robot.0][slot.0][usize::from(current.at)]
            }
            Occupancy::Warning if !self.braking_known && holds && current.moving => Occupancy::Committed,
            actual => actual,
        }
    }

    pub(super) fn finished(&self, state: &ModelState) -> bool {
        self.robot_slots().all(|robot| {
            let RobotState { at, moving, .. } = state.robots[robot.0];
            usize::from(at) + 1 == self.places(robot) && !moving
        })
    }

    pub(super) fn steps(&self, state: &ModelState) -> Vec<Step> {
        let mut steps = Vec::new();
        if !state.on {
            steps.push(Step::SwitchOn);
        }
        for (robot, current) in self.robot_slots().zip(&state.robots) {
            let may_fail = match self.faults {
                Faults::None => false,
                Faults::First => robot == RobotSlot(0),
                Faults::All => true,
            };
            if current.silent {
                steps.extend([Step::Resume(robot), Step::Clear(robot)]);
                let registered = self.slots().all(|slot| state.entries[slot.0 * self.robots() + robot.0][0] == 1);
                if self.joggable && registered && usize::from(current.at) + 1 < self.places(robot) {
                    steps.push(Step::Jog(robot));
                }
                continue;
            }
            steps.push(Step::Tick(robot));
            if !self.repeats {
                steps.push(Step::Rest(robot));
            }
            if may_fail && current.phase == 0 {
                steps.push(Step::BecomeSilent(robot));
            }
        }
        steps
    }

    /// The state after a step.
    ///
    /// # Errors
    /// A property that does not hold.
    pub(super) fn next(&self, state: &ModelState, step: Step) -> Result<ModelState, Violation> {
        self.restore(state);
        let (mut robots, mut on) = (state.robots.clone(), state.on);
        match step {
            Step::Tick(r) | Step::Rest(r) => {
                robots[r.0] = self.tick(r, robots[r.0], on, matches!(step, Step::Tick(_)))?;
            }
            Step::BecomeSilent(r) => {
                // Its controller stops it; its publications become stale.
                robots[r.0] = RobotState { silent: true, ..self.stopped(r, robots[r.0]) };
                for slot in self.slots() {
                    self.arbiter.state.entry(slot, r).published_s.store(0, SeqCst);
                }
            }
            Step::Resume(r) => robots[r.0].silent = false,
            Step::Clear(r) => self.clear(r, robots[r.0]),
            Step::Jog(r) => robots[r.0].at += 1,
            Step::SwitchOn => {
                on = true;
                self.pairs().for_each(|(slot, robot)| self.arbiter.invalidate(slot, robot));
            }
        }
        let next = self.save(robots, on);
        self.check(state, step, &next)?;
        Ok(next)
    }

    fn clear(&self, robot: RobotSlot, current: RobotState) {
        for slot in self.slots().filter(|s| !self.actual(robot, current, *s).occupies()) {
            self.arbiter.clear(slot, robot, AccessClass::Integrator, NOW_S);
        }
    }

    fn tick(&self, robot: RobotSlot, current: RobotState, on: bool, may_move: bool) -> Result<RobotState, Violation> {
        if !on {
            self.slots().for_each(|slot| self.arbiter.publish(slot, robot, Occupancy::Outside, NOW_S));
            let at = current.at + u8::from(may_move && usize::from(current.at) + 1 < self.places(robot));
            return Ok(RobotState {
                at,
                moving: at > current.at && usize::from(at) + 1 < self.places(robot),
                ..current
            });
        }
        let publish = |s: SlotId| self.arbiter.publish(s, robot, self.published(robot, current, s), NOW_S);
        let holds = |s: SlotId| self.arbiter.holder(s) == Some(robot);
        let held: Vec<bool> = self.slots().map(holds).collect();
        let near = |s: &SlotId| self.published(robot, current, *s) > Occupancy::Outside;
        let moved = if self.interleaves {
            self.operation(robot, current, may_move)
        } else {
            self.slots().for_each(publish);
            for slot in self.slots().filter(near) {
                self.arbiter.request(slot, robot, NOW_S);
            }
            self.advance(robot, current, may_move)
        };
        let early = self.slots().find(|s| held[s.0] && !holds(*s) && self.actual(robot, current, *s).occupies());
        early.map_or(Ok(moved), |slot| Err(Violation::EarlyRelease { robot, slot }))
    }

    /// The next operation of a tick: publish for one slot, check whether it may be acquired, acquire it, or move.
    fn operation(&self, robot: RobotSlot, current: RobotState, may_move: bool) -> RobotState {
        let (slots, phase) = (self.slots().count(), usize::from(current.phase));
        let then = |phases: u8| RobotState { phase: current.phase + phases, ..current };
        if phase < slots {
            let slot = SlotId(phase);
            self.arbiter.publish(slot, robot, self.published(robot, current, slot), NOW_S);
            return then(1);
        }
        let (slot, acquiring) = (SlotId((phase - slots) / 2), (phase - slots) % 2 == 1);
        if slot.0 >= slots {
            return RobotState { phase: 0, ..self.advance(robot, current, may_move) };
        }
        if acquiring {
            self.arbiter.acquire(slot, robot, NOW_S);
            return then(1);
        }
        let near = self.published(robot, current, slot) > Occupancy::Outside;
        if near && self.arbiter.check(slot, robot, NOW_S).is_none() { then(1) } else { then(2) }
    }

    /// Moves the robot as the laws allow: never into a slot that it does not hold.
    fn advance(&self, robot: RobotSlot, current: RobotState, may_move: bool) -> RobotState {
        let last = self.places(robot) - 1;
        let at = usize::from(current.at);
        let free = |place: usize| {
            self.slots().all(|s| {
                let held = self.arbiter.holder(s) == Some(robot);
                held || self.programs[robot.0][s.0][place.min(last)] != Occupancy::Inside
            })
        };
        if !may_move || at == last || !free(at) {
            let current = self.stopped(robot, current);
            let again = self.repeats && usize::from(current.at) == last && !current.moving;
            return if again { RobotState { at: 0, ..current } } else { current };
        }
        if free(at + 1) && free(at + 2) {
            return RobotState { at: current.at + 1, moving: at + 1 < last, ..current };
        }
        if free(at + 1) && !current.moving {
            return RobotState { at: current.at + 1, moving: false, ..current };
        }
        self.stopped(robot, current)
    }

    /// The state after a stop: a moving robot stops one place farther on.
    fn stopped(&self, robot: RobotSlot, current: RobotState) -> RobotState {
        let on = u8::from(current.moving && usize::from(current.at) + 1 < self.places(robot));
        RobotState { at: current.at + on, moving: false, ..current }
    }

    /// Checks that no robot enters a slot, or passes the last point where it can stop, while another robot occupies it.
    fn check(&self, before: &ModelState, step: Step, after: &ModelState) -> Result<(), Violation> {
        if !before.on || matches!(step, Step::Jog(_)) {
            return Ok(());
        }
        for slot in self.slots() {
            let occupies = |state: &ModelState, r: RobotSlot| self.actual(r, state.robots[r.0], slot).occupies();
            let entered = |r: &RobotSlot| occupies(after, *r) && !occupies(before, *r);
            let Some(robot) = self.robot_slots().find(entered) else { continue };
            if let Some(other) = self.robot_slots().find(|o| *o != robot && occupies(after, *o)) {
                let [before, after] = [before, after].map(|state| self.describe(state));
                return Err(Violation::Entry { robot, slot, other, step, before, after });
            }
        }
        Ok(())
    }

    /// True if the arbiter reports robots that wait for each other in a cycle.
    pub(super) fn reports_cycle(&self, state: &ModelState) -> bool {
        self.restore(state);
        self.robot_slots().any(|robot| !self.arbiter.wait_cycle(robot, NOW_S).is_empty())
    }

    pub(super) fn describe(&self, state: &ModelState) -> String {
        let mut text = String::new();
        for (r, b) in state.robots.iter().enumerate() {
            let held: Vec<usize> =
                self.slots().map(|s| s.0).filter(|s| usize::from(state.holders[*s]) == r + 1).collect();
            let moving = if b.moving { " moving" } else { "" };
            let waits: Vec<u8> = self.slots().map(|s| state.entries[s.0 * self.robots() + r][3]).collect();
            let _ = write!(text, "[phase {} queue {waits:?}]", b.phase);
            let _ = write!(text, "[{r} at {}{moving}{} holds {held:?}]", b.at, if b.silent { " silent" } else { "" });
        }
        text
    }
}
