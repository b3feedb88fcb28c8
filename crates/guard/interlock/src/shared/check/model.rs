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
    Tick(usize),
    /// A tick after which the robot rests although it may move.
    Rest(usize),
    BecomeSilent(usize),
    Resume(usize),
    Clear(usize),
    SwitchOn,
    Jog(usize),
}

/// A property that does not hold.
#[derive(Debug, thiserror::Error)]
pub(super) enum Violation {
    #[error("robot {robot} releases slot {slot} although it cannot stop")]
    EarlyRelease { robot: usize, slot: usize },
    /// States are described as [`ProtocolModel::describe`] does.
    #[error("robot {robot} enters slot {slot} while {other} occupies it ({after}) after {step:?} in {before}")]
    Entry { robot: usize, slot: usize, other: usize, step: Step, before: String, after: String },
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

    fn slots(&self) -> usize {
        self.programs[0].len()
    }

    fn places(&self, robot: usize) -> usize {
        self.programs[robot][0].len()
    }

    /// The initial state: every robot is at the first place of its program and known to be outside.
    pub(super) fn start(&self) -> ModelState {
        for (slot, robot) in self.pairs() {
            self.arbiter.publish(SlotId(slot), RobotSlot(robot), Occupancy::Outside, NOW_S);
        }
        let start = RobotState { at: 0, moving: false, silent: false, phase: 0 };
        self.save(vec![start; self.robots()], !self.switchable)
    }

    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let robots = self.robots();
        (0..self.slots()).flat_map(move |s| (0..robots).map(move |r| (s, r)))
    }

    /// Saves the memory of the arbiter, with the tickets of the queue as ranks: only their order counts.
    fn save(&self, robots: Vec<RobotState>, on: bool) -> ModelState {
        let ticket = |(s, r): (usize, usize)| self.arbiter.state.ticket(SlotId(s), RobotSlot(r));
        let mut tickets: Vec<u64> = self.pairs().map(ticket).filter(|t| *t > 0).collect();
        tickets.sort_unstable();
        let rank = |t: u64| if t == 0 { 0 } else { tickets.partition_point(|o| *o < t) as u8 + 1 };
        let entry = |(s, r): (usize, usize)| {
            let e = self.arbiter.state.entry(SlotId(s), RobotSlot(r));
            let known = f64::from_bits(e.published_s.load(SeqCst)) >= NOW_S;
            [u8::from(e.registered.load(SeqCst)), e.occupancy.load(SeqCst), u8::from(known), rank(ticket((s, r)))]
        };
        let holders = self.arbiter.state.slots.iter().map(|s| s.holder.load(SeqCst) as u8).collect();
        ModelState { robots, on, holders, entries: self.pairs().map(entry).collect() }
    }

    pub(super) fn restore(&self, state: &ModelState) {
        for (slot, holder) in self.arbiter.state.slots.iter().zip(&state.holders) {
            slot.holder.store(u32::from(*holder), SeqCst);
        }
        for ((s, r), [registered, occupancy, known, rank]) in self.pairs().zip(&state.entries) {
            let e = self.arbiter.state.entry(SlotId(s), RobotSlot(r));
            e.registered.store(*registered == 1, SeqCst);
            e.occupancy.store(*occupancy, SeqCst);
            e.published_s.store(if *known == 1 { NOW_S } else { 0.0 }.to_bits(), SeqCst);
            e.ticket.store(u64::from(*rank), SeqCst);
        }
        let last = state.entries.iter().map(|e| u64::from(e[3])).max().unwrap_or(0);
        self.arbiter.state.next_ticket.store(last + 1, SeqCst);
        for robot in 0..self.robots() {
            self.declare(robot, state.robots[robot].at);
        }
    }

    /// Declares the slots of the rest of the robot's stretch: up to the next place outside all slots.
    fn declare(&self, robot: usize, at: u8) {
        if !self.declares {
            return;
        }
        let near = |place: usize, slot: usize| self.programs[robot][slot][place] > Occupancy::Outside;
        let places = (usize::from(at)..self.places(robot)).take_while(|p| (0..self.slots()).any(|s| near(*p, s)));
        let claims: Vec<usize> = places.flat_map(|p| (0..self.slots()).filter(move |s| near(p, *s))).collect();
        self.arbiter.declare(RobotSlot(robot), claims.into_iter().map(SlotId));
    }

    /// The actual occupancy: `Committed` if the robot comes to rest inside although it is commanded to stop.
    fn actual(&self, robot: usize, current: RobotState, slot: usize) -> Occupancy {
        let place = |at: usize| self.programs[robot][slot][at.min(self.places(robot) - 1)];
        let at = usize::from(current.at);
        match place(at) {
            occupancy if occupancy != Occupancy::Inside && current.moving && place(at + 1) == Occupancy::Inside => {
                Occupancy::Committed
            }
            occupancy => occupancy,
        }
    }

    /// The occupancy that the robot publishes.
    fn published(&self, robot: usize, current: RobotState, slot: usize) -> Occupancy {
        let actual = self.actual(robot, current, slot);
        let holds = self.arbiter.holder(SlotId(slot)) == Some(RobotSlot(robot));
        match actual {
            Occupancy::Committed if !self.publishes_commitment => self.programs[robot][slot][usize::from(current.at)],
            Occupancy::Warning if !self.braking_known && holds && current.moving => Occupancy::Committed,
            actual => actual,
        }
    }

    pub(super) fn finished(&self, state: &ModelState) -> bool {
        (0..self.robots()).all(|r| usize::from(state.robots[r].at) + 1 == self.places(r) && !state.robots[r].moving)
    }

    pub(super) fn steps(&self, state: &ModelState) -> Vec<Step> {
        let mut steps = Vec::new();
        if !state.on {
            steps.push(Step::SwitchOn);
        }
        for (r, current) in state.robots.iter().enumerate() {
            let may_fail = match self.faults {
                Faults::None => false,
                Faults::First => r == 0,
                Faults::All => true,
            };
            if current.silent {
                steps.extend([Step::Resume(r), Step::Clear(r)]);
                let registered = (0..self.slots()).all(|s| state.entries[s * self.robots() + r][0] == 1);
                if self.joggable && registered && usize::from(current.at) + 1 < self.places(r) {
                    steps.push(Step::Jog(r));
                }
                continue;
            }
            steps.push(Step::Tick(r));
            if !self.repeats {
                steps.push(Step::Rest(r));
            }
            if may_fail && current.phase == 0 {
                steps.push(Step::BecomeSilent(r));
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
            Step::Tick(r) | Step::Rest(r) => robots[r] = self.tick(r, robots[r], on, matches!(step, Step::Tick(_)))?,
            Step::BecomeSilent(r) => {
                // Its controller stops it; its publications become stale.
                robots[r] = RobotState { silent: true, ..self.stopped(r, robots[r]) };
                for slot in 0..self.slots() {
                    self.arbiter.state.entry(SlotId(slot), RobotSlot(r)).published_s.store(0, SeqCst);
                }
            }
            Step::Resume(r) => robots[r].silent = false,
            Step::Clear(r) => self.clear(r, robots[r]),
            Step::Jog(r) => robots[r].at += 1,
            Step::SwitchOn => {
                on = true;
                self.pairs().for_each(|(slot, robot)| self.arbiter.invalidate(SlotId(slot), RobotSlot(robot)));
            }
        }
        let next = self.save(robots, on);
        self.check(state, step, &next)?;
        Ok(next)
    }

    fn clear(&self, robot: usize, current: RobotState) {
        for slot in (0..self.slots()).filter(|s| !self.actual(robot, current, *s).occupies()) {
            self.arbiter.clear(SlotId(slot), RobotSlot(robot), AccessClass::Integrator, NOW_S);
        }
    }

    fn tick(&self, robot: usize, current: RobotState, on: bool, may_move: bool) -> Result<RobotState, Violation> {
        let (me, slots) = (RobotSlot(robot), self.slots());
        if !on {
            (0..slots).for_each(|s| self.arbiter.publish(SlotId(s), me, Occupancy::Outside, NOW_S));
            let at = current.at + u8::from(may_move && usize::from(current.at) + 1 < self.places(robot));
            return Ok(RobotState {
                at,
                moving: at > current.at && usize::from(at) + 1 < self.places(robot),
                ..current
            });
        }
        let publish = |s: usize| self.arbiter.publish(SlotId(s), me, self.published(robot, current, s), NOW_S);
        let holds = |s: usize| self.arbiter.holder(SlotId(s)) == Some(me);
        let held: Vec<bool> = (0..slots).map(holds).collect();
        let near = |s: &usize| self.published(robot, current, *s) > Occupancy::Outside;
        let moved = if self.interleaves {
            self.operation(robot, current, may_move)
        } else {
            (0..slots).for_each(publish);
            for slot in (0..slots).filter(near) {
                self.arbiter.request(SlotId(slot), me, NOW_S);
            }
            self.advance(robot, current, may_move)
        };
        let early = (0..slots).find(|s| held[*s] && !holds(*s) && self.actual(robot, current, *s).occupies());
        early.map_or(Ok(moved), |slot| Err(Violation::EarlyRelease { robot, slot }))
    }

    /// The next operation of a tick: publish for one slot, check whether it may be acquired, acquire it, or move.
    fn operation(&self, robot: usize, current: RobotState, may_move: bool) -> RobotState {
        let (me, slots, phase) = (RobotSlot(robot), self.slots(), usize::from(current.phase));
        let then = |phases: u8| RobotState { phase: current.phase + phases, ..current };
        if phase < slots {
            self.arbiter.publish(SlotId(phase), me, self.published(robot, current, phase), NOW_S);
            return then(1);
        }
        let (slot, acquiring) = ((phase - slots) / 2, (phase - slots) % 2 == 1);
        if slot >= slots {
            return RobotState { phase: 0, ..self.advance(robot, current, may_move) };
        }
        if acquiring {
            self.arbiter.acquire(SlotId(slot), me, NOW_S);
            return then(1);
        }
        let near = self.published(robot, current, slot) > Occupancy::Outside;
        if near && self.arbiter.check(SlotId(slot), me, NOW_S).is_none() { then(1) } else { then(2) }
    }

    /// Moves the robot as the laws allow: never into a slot that it does not hold.
    fn advance(&self, robot: usize, current: RobotState, may_move: bool) -> RobotState {
        let last = self.places(robot) - 1;
        let at = usize::from(current.at);
        let free = |place: usize| {
            (0..self.slots()).all(|s| {
                let held = self.arbiter.holder(SlotId(s)) == Some(RobotSlot(robot));
                held || self.programs[robot][s][place.min(last)] != Occupancy::Inside
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
    fn stopped(&self, robot: usize, current: RobotState) -> RobotState {
        let on = u8::from(current.moving && usize::from(current.at) + 1 < self.places(robot));
        RobotState { at: current.at + on, moving: false, ..current }
    }

    /// Checks that no robot enters a slot, or passes the last point where it can stop, while another robot occupies it.
    fn check(&self, before: &ModelState, step: Step, after: &ModelState) -> Result<(), Violation> {
        if !before.on || matches!(step, Step::Jog(_)) {
            return Ok(());
        }
        for slot in 0..self.slots() {
            let occupies = |state: &ModelState, r: usize| self.actual(r, state.robots[r], slot).occupies();
            let entered = |r: &usize| occupies(after, *r) && !occupies(before, *r);
            let Some(robot) = (0..self.robots()).find(entered) else { continue };
            if let Some(other) = (0..self.robots()).find(|o| *o != robot && occupies(after, *o)) {
                let [before, after] = [before, after].map(|state| self.describe(state));
                return Err(Violation::Entry { robot, slot, other, step, before, after });
            }
        }
        Ok(())
    }

    /// True if the arbiter reports robots that wait for each other in a cycle.
    pub(super) fn reports_cycle(&self, state: &ModelState) -> bool {
        self.restore(state);
        (0..self.robots()).any(|r| !self.arbiter.wait_cycle(RobotSlot(r), NOW_S).is_empty())
    }

    pub(super) fn describe(&self, state: &ModelState) -> String {
        let mut text = String::new();
        for (r, b) in state.robots.iter().enumerate() {
            let held: Vec<usize> = (0..self.slots()).filter(|s| usize::from(state.holders[*s]) == r + 1).collect();
            let moving = if b.moving { " moving" } else { "" };
            let waits: Vec<u8> = (0..self.slots()).map(|s| state.entries[s * self.robots() + r][3]).collect();
            let _ = write!(text, "[phase {} queue {waits:?}]", b.phase);
            let _ = write!(text, "[{r} at {}{moving}{} holds {held:?}]", b.at, if b.silent { " silent" } else { "" });
        }
        text
    }
}
