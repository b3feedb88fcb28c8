//! Model check: every interleaving of guards, arbiter, messages, crashes and clears of a small cell, on the
//! production code.
//!
//! Robots cycle through programs of a few places. A tick finds what the tick before let the robot do; messages pass
//! between the two ticks. Messages are delivered in any order, any number of times, or never. A few messages per
//! robot and direction are under way; one more replaces the oldest. Time advances in steps. States that behave the
//! same are one state ([`canonical`]), so the number of states is finite, and small cells can be explored
//! completely.

mod action;
mod canonical;
mod checks;
pub(crate) mod codec;
mod encoding;
mod explorer;
mod free;
mod mixer;
mod programs;
mod projection;
pub(crate) mod renaming;
mod state;

use stateright::{Model, Property};

use crate::{
    Arbiter, ArbiterSettings, Boot, GrantsMessage, Guard, Micros, Occupancy, RobotSettings, RobotSlot, SlotId,
    SlotReport, StateMessage, Token,
};
use action::{Action, ArbiterStep, Next, Step};
use programs::Program;
use state::{CellState, FaultBudget, NOW, RobotState};

/// The property that is checked.
const EXCLUSION: &str = "at most one robot is in a slot or may enter it";

/// A step of time.
const STEP: Micros = Micros(100);

/// Whether ages between a request and the end of its grant are distinguished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Clock {
    /// After one time step, grants have ended and robots are silent.
    Coarse,
    /// Grants are obeyed for one time step, and robots are silent after two.
    Fine,
}

impl Clock {
    fn validity(self) -> Micros {
        Micros(if self == Self::Coarse { 50 } else { 100 })
    }

    fn silence(self) -> Micros {
        Micros(if self == Self::Coarse { 50 } else { 200 })
    }

    fn stop_time(self) -> Micros {
        Micros(if self == Self::Coarse { 0 } else { 100 })
    }

    /// Age beyond which nothing changes any more.
    fn oldest(self) -> Micros {
        Micros(if self == Self::Coarse { 100 } else { 300 })
    }
}

/// Faults that are planted to test whether the model check finds them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PlantedFault {
    None,
    /// A person clears a robot that has not been silent for long enough, and grants never expire.
    HastyClear,
    /// A report without the grant counts as giving it up.
    TokensUnchecked,
    /// A grant is taken back without the consent of its holder.
    UnilateralRelease,
    /// A guard gives a grant up before it has seen that its robot can still stop outside.
    UnseenRelease,
    /// The arbiter takes a robot at rest before the border for one that is inside.
    CommittedIsInside,
}

/// A small cell.
struct CellModel {
    programs: Vec<Program>,
    slots: usize,
    /// Messages under way per robot and direction.
    under_way: usize,
    clock: Clock,
    faults: FaultBudget,
    planted: PlantedFault,
    /// Robots of the same class have the same program.
    classes: Vec<usize>,
    /// True if the cell has any number of other robots and slots ([`free`]).
    is_free: bool,
}

impl CellModel {
    fn new(programs: &[&[&str]]) -> Self {
        let class = |program| programs.iter().position(|other| other == program).unwrap_or(0);
        let classes = programs.iter().map(class).collect();
        let programs: Vec<_> = programs.iter().map(|words| Program::new(words)).collect();
        let slots = programs[0].slots();
        let (clock, faults, planted) = (Clock::Coarse, FaultBudget::default(), PlantedFault::None);
        Self { programs, slots, under_way: 1, clock, faults, planted, classes, is_free: false }
    }

    fn slots(&self) -> impl Iterator<Item = SlotId> + use<> {
        (0..self.slots).map(SlotId)
    }

    fn robots(&self) -> impl Iterator<Item = RobotSlot> + use<> {
        (0..self.programs.len()).map(RobotSlot)
    }

    fn settings(&self) -> ArbiterSettings {
        let (validity, silence, stop_time) = (self.clock.validity(), self.clock.silence(), self.clock.stop_time());
        let robot = |program: &Program| {
            let slots = self.slots().filter(|s| program.uses(*s));
            RobotSettings { stop_time, ..RobotSettings::new("robot", slots) }
        };
        let other = self.is_free.then(|| &self.programs[0]);
        let robots = self.programs.iter().chain(other).map(robot).collect();
        ArbiterSettings { silence, validity, ..ArbiterSettings::new(robots, self.slots) }
    }

    fn guard(&self, robot: RobotSlot, boot: Boot) -> Guard {
        let endless = self.planted == PlantedFault::HastyClear;
        let validity = if endless { Micros(u64::MAX) } else { self.clock.validity() };
        Guard::new(robot, self.slots, 0, boot).validity(validity)
    }

    fn is_inside(&self, robot: RobotSlot, place: usize, slot: SlotId) -> bool {
        self.programs[robot.0].is_inside(place, slot)
    }

    /// Whether the robot is in a slot, or will be in it whatever is decided now.
    fn is_in(&self, state: &CellState, robot: RobotSlot, slot: SlotId) -> bool {
        let RobotState { place, enters } = state.robots[robot.0];
        self.is_inside(robot, place, slot) || enters.is_some_and(|next| self.is_inside(robot, next, slot))
    }

    /// Whether at most one robot is in each slot or may enter it.
    fn is_exclusive(&self, state: &CellState) -> bool {
        self.slots().all(|slot| {
            let claims = |r: &RobotSlot| self.is_in(state, *r, slot) || state.guards[r.0].may_enter(slot, NOW);
            self.robots().filter(claims).count() <= 1
        })
    }

    /// The slots that the robot must be granted to move on from a place to the next one.
    fn needed(&self, robot: RobotSlot, place: usize, next: usize) -> impl Iterator<Item = SlotId> + '_ {
        let enters = move |s: &SlotId| self.is_inside(robot, next, *s) && !self.is_inside(robot, place, *s);
        self.slots().filter(enters)
    }

    /// What a robot may do in a tick.
    fn ticks(&self, state: &CellState, r: RobotSlot) -> Vec<Step> {
        let RobotState { place, enters } = state.robots[r.0];
        let nexts = |place| self.programs[r.0].nexts(place);
        let advance = nexts(place).map(Step::Advance);
        let enter = nexts(enters.unwrap_or(place)).map(Step::Enter);
        std::iter::once(Step::Remain).chain(advance).chain(enter).collect()
    }

    /// Performs one tick; `None` if the step is impossible.
    fn tick(&self, state: &mut CellState, r: RobotSlot, step: Step) -> Option<()> {
        let RobotState { place, enters } = state.robots[r.0];
        let (found, enters) = match (step, enters) {
            (Step::Remain, _) => (enters.unwrap_or(place), None),
            (Step::Advance(_), Some(_)) => return None,
            (Step::Advance(next), None) => self.needed(r, place, next).next().is_none().then_some((next, None))?,
            (Step::Enter(next), _) => {
                let found = enters.unwrap_or(place);
                let mut needed = self.needed(r, found, next).peekable();
                needed.peek()?;
                let may_enter = needed.all(|slot| state.guards[r.0].may_enter(slot, NOW));
                may_enter.then_some((found, Some(next)))?
            }
        };
        state.robots[r.0] = RobotState { place: found, enters };
        for slot in self.slots() {
            state.guards[r.0].observe(slot, self.programs[r.0].occupancy(found, slot));
        }
        Some(())
    }

    fn send(&self, state: &mut CellState, r: RobotSlot) {
        let message = state.guards[r.0].state(NOW);
        if self.planted == PlantedFault::UnseenRelease {
            state.guards[r.0].give_up_at_once();
        }
        self.push(&mut state.to_arbiter[r.0], message);
    }

    fn reply(&self, state: &mut CellState, replies: Vec<GrantsMessage>) {
        for reply in replies.into_iter().filter(|reply| reply.robot.0 < self.programs.len()) {
            self.push(&mut state.to_guard[reply.robot.0], reply);
        }
    }

    fn push<T>(&self, under_way: &mut Vec<T>, message: T) {
        if under_way.len() == self.under_way {
            under_way.remove(0);
        }
        under_way.push(message);
    }

    /// Makes all robots, which are outside, known to the arbiter.
    fn know_each_other(&self, state: &mut CellState) {
        for r in (0..2).flat_map(|_| self.robots()) {
            self.choose(state, Next::Undecided);
            self.tick(state, r, Step::Remain);
            let message = state.guards[r.0].state(NOW);
            for reply in state.arbiter.receive(&message, NOW).replies {
                let _ = state.guards[reply.robot.0].receive(&reply);
            }
        }
    }

    /// Clears a robot that is at rest outside, as an integrator does; `None` if that is refused.
    fn clear(&self, state: &mut CellState, robot: RobotSlot) -> Option<()> {
        if self.slots().any(|slot| self.is_in(state, robot, slot)) {
            return None;
        }
        FaultBudget::spend(&mut state.faults.clears);
        let outputs = if self.planted == PlantedFault::HastyClear {
            state.arbiter.clear_at_once(robot, NOW)
        } else {
            state.arbiter.clear(robot, NOW).ok()?
        };
        self.reply(state, outputs.replies);
        Some(())
    }

    fn to_arbiter(&self, state: &mut CellState, robot: RobotSlot, index: usize, next: Next) {
        let mut message = state.to_arbiter[robot.0][index].clone();
        self.choose(state, next);
        if self.is_free {
            message.slots.iter_mut().for_each(|report| report.wants = next == Next::Robot(robot));
        }
        match self.planted {
            PlantedFault::TokensUnchecked => give_up_all(&mut message),
            PlantedFault::CommittedIsInside => message.slots.iter_mut().for_each(take_for_inside),
            _ => {}
        }
        let outputs = state.arbiter.receive(&message, NOW);
        self.reply(state, outputs.replies);
    }

    /// The numbers of a new process of which the former ones had these, in rising order: above them, and if clocks may
    /// be set back also between and below them.
    fn new_starts(&self, starts: &[Boot]) -> impl Iterator<Item = Boot> {
        let back = if self.faults.is_set_back { starts } else { &[] };
        let last = starts.last().copied().unwrap_or(Boot::NONE);
        let between: Vec<Boot> = back.iter().map(|boot| Boot(boot.0 - canonical::BELOW)).chain([last.next()]).collect();
        between.into_iter()
    }

    fn simplify(&self, state: &mut CellState) {
        if self.is_free {
            canonical::forget_choices(state);
        }
        canonical::canonicalize(state, self.clock.oldest(), &self.classes);
    }

    /// Applies an action to the state; `None` if the action is impossible.
    fn act(&self, state: &mut CellState, action: Action) -> Option<()> {
        match action {
            Action::Tick(r, step) => self.tick(state, r, step)?,
            Action::Send(r) => self.send(state, r),
            Action::SendAsked(r) => {
                state.guards[r.0].ask(true);
                self.send(state, r);
            }
            Action::ToGuard(r, i) => {
                let message = state.to_guard[r.0][i].clone();
                let _ = state.guards[r.0].receive(&message);
            }
            Action::TimePasses => canonical::pass(state, STEP),
            Action::CrashGuard(r, boot) => {
                FaultBudget::spend(&mut state.faults.guard_crashes);
                state.guards[r.0] = self.guard(r, boot);
            }
            Action::Arbiter(step) => self.arbiter_step(state, step)?,
            Action::SecondArbiter(step) => {
                state.swap_arbiters();
                self.arbiter_step(state, step)?;
                state.swap_arbiters();
            }
            Action::StartSecondArbiter(boot) => {
                FaultBudget::spend(&mut state.faults.second_arbiters);
                state.second = Some(Arbiter::new(self.settings(), boot));
            }
        }
        Some(())
    }

    fn arbiter_step(&self, state: &mut CellState, step: ArbiterStep) -> Option<()> {
        match step {
            ArbiterStep::Receive(r, i, next) => self.to_arbiter(state, r, i, next),
            ArbiterStep::Crash(boot) => {
                FaultBudget::spend(&mut state.faults.arbiter_crashes);
                state.arbiter = Arbiter::new(self.settings(), boot);
            }
            ArbiterStep::Clear(r, next) => {
                self.choose(state, next);
                self.clear(state, r)?;
            }
            ArbiterStep::Other(report, next) => self.hear_other(state, report, next),
            ArbiterStep::Answer(r) => {
                let answer = state.arbiter.answer_again(r);
                self.reply(state, vec![answer]);
            }
            ArbiterStep::TakeBack(slot) => state.arbiter.take_back(slot),
        }
        Some(())
    }

    /// The steps that the first arbiter may take.
    fn arbiter_steps(&self, state: &mut CellState) -> Vec<ArbiterStep> {
        let mut steps = Vec::new();
        for r in self.robots() {
            for next in self.nexts(state, Some(r)) {
                steps.extend((0..state.to_arbiter[r.0].len()).map(|i| ArbiterStep::Receive(r, i, *next)));
                steps.extend((state.faults.clears > 0).then_some(ArbiterStep::Clear(r, *next)));
            }
        }
        if state.faults.arbiter_crashes > 0 {
            let starts = canonical::arbiter_starts(state);
            steps.extend(self.new_starts(&starts).map(ArbiterStep::Crash));
        }
        self.steps_of_others(state, &mut steps);
        if self.planted == PlantedFault::UnilateralRelease {
            steps.extend(self.slots().map(ArbiterStep::TakeBack));
        }
        steps
    }
}

impl Model for CellModel {
    type State = CellState;
    type Action = Action;

    fn init_states(&self) -> Vec<CellState> {
        let robots = self.programs.len();
        let mut state = CellState {
            arbiter: Arbiter::new(self.settings(), Boot(1)),
            second: None,
            guards: self.robots().map(|r| self.guard(r, Boot(1))).collect(),
            robots: vec![RobotState { place: 0, enters: None }; robots],
            to_arbiter: vec![Vec::new(); robots],
            to_guard: vec![Vec::new(); robots],
            faults: self.faults,
        };
        self.know_each_other(&mut state);
        self.simplify(&mut state);
        vec![state]
    }

    fn actions(&self, state: &CellState, actions: &mut Vec<Action>) {
        let mut state = state.clone();
        for r in self.robots() {
            actions.extend(self.ticks(&state, r).into_iter().map(|step| Action::Tick(r, step)));
            actions.push(Action::Send(r));
            if self.is_free {
                actions.push(Action::SendAsked(r));
            }
            actions.extend((0..state.to_guard[r.0].len()).map(|i| Action::ToGuard(r, i)));
            if state.faults.guard_crashes > 0 {
                let starts = canonical::guard_starts(&mut state, r);
                actions.extend(self.new_starts(&starts).map(|boot| Action::CrashGuard(r, boot)));
            }
        }
        actions.push(Action::TimePasses);
        actions.extend(self.arbiter_steps(&mut state).into_iter().map(Action::Arbiter));
        if state.second.is_some() {
            state.swap_arbiters();
            actions.extend(self.arbiter_steps(&mut state).into_iter().map(Action::SecondArbiter));
        } else if state.faults.second_arbiters > 0 {
            let starts = canonical::arbiter_starts(&mut state);
            actions.extend(self.new_starts(&starts).map(Action::StartSecondArbiter));
        }
    }

    fn next_state(&self, before: &CellState, action: Action) -> Option<CellState> {
        let mut state = before.clone();
        self.act(&mut state, action)?;
        self.simplify(&mut state);
        (state != *before).then_some(state)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![Property::always(EXCLUSION, CellModel::is_exclusive)]
    }
}

fn take_for_inside(report: &mut SlotReport) {
    if report.occupancy == Occupancy::Committed {
        report.occupancy = Occupancy::Inside;
    }
}

/// Makes a message give up every grant that it does not name.
fn give_up_all(message: &mut StateMessage) {
    let every = Token { boot: Boot(u64::MAX), number: u64::MAX };
    for slot in message.slots.iter_mut().filter(|slot| slot.token.is_none()) {
        slot.released = Some(every);
    }
}
