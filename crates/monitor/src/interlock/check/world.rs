//! Robots on programs of a few places, and the board between them.

use std::fmt::Write as _;
use std::sync::atomic::Ordering::SeqCst;

use super::super::{Board, Planted, RobotSlot, SlotId, Stay};
use crate::AccessClass;

/// The present of every step; what was said at time 0 is too old.
const NOW_S: f64 = 1.0;

/// Which robots may fall silent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Faults {
    None,
    First,
    All,
}

#[derive(Debug)]
pub(super) struct World {
    /// Per robot, per slot, per place.
    programs: Vec<Vec<Vec<Stay>>>,
    pub(super) board: Board,
    declares: bool,
    faults: Faults,
    repeats: bool,
    braking_known: bool,
    says_commitment: bool,
    interleaves: bool,
    switches: bool,
    jogs: bool,
}

/// One robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Body {
    pub(super) at: u8,
    moving: bool,
    silent: bool,
    /// Operation of its tick that is next, where those of different robots interleave.
    phase: u8,
}

/// Everything that decides what can happen next: the robots, and the board's memory.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct State {
    pub(super) robots: Vec<Body>,
    on: bool,
    holders: Vec<u8>,
    /// Per slot and robot: expected, stay, known, rank in the queue.
    entries: Vec<[u8; 4]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// A tick (or one operation of it); the robot goes on if it may.
    Tick(usize),
    /// A tick after which it stands though it might go on.
    Rest(usize),
    FallSilent(usize),
    Speak(usize),
    Clear(usize),
    SwitchOn,
    Jog(usize),
}

impl World {
    /// `_` is outside, `.` in the warning zone, `X` inside: per robot one word per slot.
    pub(super) fn new(programs: &[&[&str]]) -> Self {
        let stay = |c: char| match c {
            'X' => Stay::Inside,
            '.' => Stay::Warning,
            _ => Stay::Outside,
        };
        let names = ["r0", "r1", "r2"];
        let board = Board::new(&names[..programs.len()], &["a", "b", "c"][..programs[0].len()]);
        Self {
            programs: programs.iter().map(|p| p.iter().map(|s| s.chars().map(stay).collect()).collect()).collect(),
            board,
            declares: false,
            faults: Faults::None,
            repeats: false,
            braking_known: true,
            says_commitment: true,
            interleaves: false,
            switches: false,
            jogs: false,
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

    pub(super) fn commitment_unsaid(self) -> Self {
        Self { says_commitment: false, ..self }
    }

    pub(super) fn interleaved(self) -> Self {
        Self { interleaves: true, ..self }
    }

    /// The regions are off at first.
    pub(super) fn switched(self) -> Self {
        Self { switches: true, ..self }
    }

    /// A silent robot may be moved by hand, as long as no integrator said that it stands outside.
    pub(super) fn jogged(self) -> Self {
        Self { jogs: true, ..self }
    }

    pub(super) fn planted(self, fault: Planted) -> Self {
        self.board.planted.store(fault as u8, SeqCst);
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

    /// At the first place of every program, everybody known to be outside.
    pub(super) fn start(&self) -> State {
        for (slot, robot) in self.pairs() {
            self.board.publish(SlotId(slot), RobotSlot(robot), Stay::Outside, NOW_S);
        }
        let body = Body { at: 0, moving: false, silent: false, phase: 0 };
        self.save(vec![body; self.robots()], !self.switches)
    }

    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let robots = self.robots();
        (0..self.slots()).flat_map(move |s| (0..robots).map(move |r| (s, r)))
    }

    /// The board's memory, the queue's tickets as ranks: only their order counts.
    fn save(&self, robots: Vec<Body>, on: bool) -> State {
        let ticket = |(s, r): (usize, usize)| self.board.ticket(SlotId(s), RobotSlot(r));
        let mut tickets: Vec<u64> = self.pairs().map(ticket).filter(|t| *t > 0).collect();
        tickets.sort_unstable();
        let rank = |t: u64| if t == 0 { 0 } else { tickets.partition_point(|o| *o < t) as u8 + 1 };
        let entry = |(s, r): (usize, usize)| {
            let e = self.board.entry(SlotId(s), RobotSlot(r));
            let known = f64::from_bits(e.seen_s.load(SeqCst)) >= NOW_S;
            [u8::from(e.expected.load(SeqCst)), e.stay.load(SeqCst), u8::from(known), rank(ticket((s, r)))]
        };
        let holders = self.board.slots.iter().map(|s| s.holder.load(SeqCst) as u8).collect();
        State { robots, on, holders, entries: self.pairs().map(entry).collect() }
    }

    pub(super) fn restore(&self, state: &State) {
        for (slot, holder) in self.board.slots.iter().zip(&state.holders) {
            slot.holder.store(u32::from(*holder), SeqCst);
        }
        for ((s, r), [expected, stay, known, rank]) in self.pairs().zip(&state.entries) {
            let e = self.board.entry(SlotId(s), RobotSlot(r));
            e.expected.store(*expected == 1, SeqCst);
            e.stay.store(*stay, SeqCst);
            e.seen_s.store(if *known == 1 { NOW_S } else { 0.0 }.to_bits(), SeqCst);
            e.ticket.store(u64::from(*rank), SeqCst);
        }
        let last = state.entries.iter().map(|e| u64::from(e[3])).max().unwrap_or(0);
        self.board.next_ticket.store(last + 1, SeqCst);
        for robot in 0..self.robots() {
            self.declare(robot, state.robots[robot].at);
        }
    }

    /// The rest of the stretch that the robot is in: up to the next place that is outside of everything.
    fn declare(&self, robot: usize, at: u8) {
        if !self.declares {
            return;
        }
        let near = |place: usize, slot: usize| self.programs[robot][slot][place] > Stay::Outside;
        let places = (usize::from(at)..self.places(robot)).take_while(|p| (0..self.slots()).any(|s| near(*p, s)));
        let claims: Vec<usize> = places.flat_map(|p| (0..self.slots()).filter(move |s| near(p, *s))).collect();
        self.board.declare(RobotSlot(robot), claims.into_iter().map(SlotId));
    }

    /// Where the robot truly is: `Committed` where it ends inside though it is told to stop.
    fn truth(&self, robot: usize, body: Body, slot: usize) -> Stay {
        let place = |at: usize| self.programs[robot][slot][at.min(self.places(robot) - 1)];
        let at = usize::from(body.at);
        match place(at) {
            stay if stay != Stay::Inside && body.moving && place(at + 1) == Stay::Inside => Stay::Committed,
            stay => stay,
        }
    }

    /// What it says of itself.
    fn said(&self, robot: usize, body: Body, slot: usize) -> Stay {
        let truth = self.truth(robot, body, slot);
        let holds = self.board.holder(SlotId(slot)) == Some(RobotSlot(robot));
        match truth {
            Stay::Committed if !self.says_commitment => self.programs[robot][slot][usize::from(body.at)],
            Stay::Warning if !self.braking_known && holds && body.moving => Stay::Committed,
            truth => truth,
        }
    }

    pub(super) fn finished(&self, state: &State) -> bool {
        (0..self.robots()).all(|r| usize::from(state.robots[r].at) + 1 == self.places(r) && !state.robots[r].moving)
    }

    pub(super) fn steps(&self, state: &State) -> Vec<Step> {
        let mut steps = Vec::new();
        if !state.on {
            steps.push(Step::SwitchOn);
        }
        for (r, body) in state.robots.iter().enumerate() {
            let may_fail = match self.faults {
                Faults::None => false,
                Faults::First => r == 0,
                Faults::All => true,
            };
            if body.silent {
                steps.extend([Step::Speak(r), Step::Clear(r)]);
                let expected = (0..self.slots()).all(|s| state.entries[s * self.robots() + r][0] == 1);
                if self.jogs && expected && usize::from(body.at) + 1 < self.places(r) {
                    steps.push(Step::Jog(r));
                }
                continue;
            }
            steps.push(Step::Tick(r));
            if !self.repeats {
                steps.push(Step::Rest(r));
            }
            if may_fail && body.phase == 0 {
                steps.push(Step::FallSilent(r));
            }
        }
        steps
    }

    /// What comes of a step.
    ///
    /// # Errors
    /// A property that does not hold, in words.
    pub(super) fn next(&self, state: &State, step: Step) -> Result<State, String> {
        self.restore(state);
        let (mut robots, mut on) = (state.robots.clone(), state.on);
        match step {
            Step::Tick(r) | Step::Rest(r) => robots[r] = self.tick(r, robots[r], on, matches!(step, Step::Tick(_)))?,
            Step::FallSilent(r) => {
                // Its controller stops it; what it said grows old.
                robots[r] = Body { silent: true, ..self.stopped(r, robots[r]) };
                for slot in 0..self.slots() {
                    self.board.entry(SlotId(slot), RobotSlot(r)).seen_s.store(0, SeqCst);
                }
            }
            Step::Speak(r) => robots[r].silent = false,
            Step::Clear(r) => self.clear(r, robots[r]),
            Step::Jog(r) => robots[r].at += 1,
            Step::SwitchOn => {
                on = true;
                self.pairs().for_each(|(slot, robot)| self.board.forget(SlotId(slot), RobotSlot(robot)));
            }
        }
        let next = self.save(robots, on);
        self.check(state, step, &next).map_err(|what| format!("{what} after {step:?} in {}", self.show(state)))?;
        Ok(next)
    }

    fn clear(&self, robot: usize, body: Body) {
        for slot in (0..self.slots()).filter(|s| !self.truth(robot, body, *s).occupies()) {
            self.board.clear(SlotId(slot), RobotSlot(robot), AccessClass::Integrator, NOW_S);
        }
    }

    fn tick(&self, robot: usize, body: Body, on: bool, wants: bool) -> Result<Body, String> {
        let (me, slots) = (RobotSlot(robot), self.slots());
        if !on {
            (0..slots).for_each(|s| self.board.publish(SlotId(s), me, Stay::Outside, NOW_S));
            let at = body.at + u8::from(wants && usize::from(body.at) + 1 < self.places(robot));
            return Ok(Body { at, moving: at > body.at && usize::from(at) + 1 < self.places(robot), ..body });
        }
        let publish = |s: usize| self.board.publish(SlotId(s), me, self.said(robot, body, s), NOW_S);
        let holds = |s: usize| self.board.holder(SlotId(s)) == Some(me);
        let held: Vec<bool> = (0..slots).map(holds).collect();
        let near = |s: &usize| self.said(robot, body, *s) > Stay::Outside;
        let moved = if self.interleaves {
            self.operation(robot, body, wants)
        } else {
            (0..slots).for_each(publish);
            for slot in (0..slots).filter(near) {
                self.board.request(SlotId(slot), me, NOW_S);
            }
            self.go(robot, body, wants)
        };
        let early = (0..slots).find(|s| held[*s] && !holds(*s) && self.truth(robot, body, *s).occupies());
        early.map_or(Ok(moved), |s| Err(format!("robot {robot} gives slot {s} back though it cannot stop")))
    }

    /// The next operation of a tick: to publish for one slot, to look whether one may be taken, to take it, to move.
    fn operation(&self, robot: usize, body: Body, wants: bool) -> Body {
        let (me, slots, phase) = (RobotSlot(robot), self.slots(), usize::from(body.phase));
        let then = |phases: u8| Body { phase: body.phase + phases, ..body };
        if phase < slots {
            self.board.publish(SlotId(phase), me, self.said(robot, body, phase), NOW_S);
            return then(1);
        }
        let (slot, taking) = ((phase - slots) / 2, (phase - slots) % 2 == 1);
        if slot >= slots {
            return Body { phase: 0, ..self.go(robot, body, wants) };
        }
        if taking {
            self.board.take(SlotId(slot), me, NOW_S);
            return then(1);
        }
        let near = self.said(robot, body, slot) > Stay::Outside;
        if near && self.board.look(SlotId(slot), me, NOW_S).is_none() { then(1) } else { then(2) }
    }

    /// Moves by what the laws allow: into nothing that it does not hold.
    fn go(&self, robot: usize, body: Body, wants: bool) -> Body {
        let last = self.places(robot) - 1;
        let at = usize::from(body.at);
        let free = |place: usize| {
            (0..self.slots()).all(|s| {
                let held = self.board.holder(SlotId(s)) == Some(RobotSlot(robot));
                held || self.programs[robot][s][place.min(last)] != Stay::Inside
            })
        };
        if !wants || at == last || !free(at) {
            let body = self.stopped(robot, body);
            let again = self.repeats && usize::from(body.at) == last && !body.moving;
            return if again { Body { at: 0, ..body } } else { body };
        }
        if free(at + 1) && free(at + 2) {
            return Body { at: body.at + 1, moving: at + 1 < last, ..body };
        }
        if free(at + 1) && !body.moving {
            return Body { at: body.at + 1, moving: false, ..body };
        }
        self.stopped(robot, body)
    }

    /// Told to stop, it ends one place farther on.
    fn stopped(&self, robot: usize, body: Body) -> Body {
        let on = u8::from(body.moving && usize::from(body.at) + 1 < self.places(robot));
        Body { at: body.at + on, moving: false, ..body }
    }

    /// Nobody gets into a slot, or past stopping before it, while another is in it.
    fn check(&self, before: &State, step: Step, after: &State) -> Result<(), String> {
        if !before.on || matches!(step, Step::Jog(_)) {
            return Ok(());
        }
        for slot in 0..self.slots() {
            let in_it = |state: &State, r: usize| self.truth(r, state.robots[r], slot).occupies();
            let entered = |r: &usize| in_it(after, *r) && !in_it(before, *r);
            let Some(robot) = (0..self.robots()).find(entered) else { continue };
            if let Some(other) = (0..self.robots()).find(|o| *o != robot && in_it(after, *o)) {
                return Err(format!(
                    "robot {robot} gets into slot {slot} while {other} is in it ({})",
                    self.show(after)
                ));
            }
        }
        Ok(())
    }

    /// True where the board tells of robots that wait for each other in a circle.
    pub(super) fn tells_circle(&self, state: &State) -> bool {
        self.restore(state);
        (0..self.robots()).any(|r| !self.board.circle(RobotSlot(r), NOW_S).is_empty())
    }

    pub(super) fn show(&self, state: &State) -> String {
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
