//! Canonical states: states that behave the same from now on become one state. Numbers count only by their order,
//! times only by whether they are past a limit, and robots with the same program are interchangeable.

use std::collections::BTreeSet;
use std::hash::{Hash, Hasher};

use super::mixer::Mixer;
use super::renaming::what_counts;
use super::state::{CellState, NOW};
use crate::{Arbiter, Boot, Guard, Micros, RobotSlot, SlotId, SlotReport, Token};

/// Serial number of the arbiter, above all ranks.
const SERIAL: u64 = 100;
const TOKENS: u64 = 100;
/// First number of held grants, above the numbers of all other grants.
const HELD: u64 = 50;

/// Distance of the numbers of starts, so that a process whose clock was set back finds a number between any two.
const SPACING: u64 = 4;
/// Distance of such a number from the next one. The number after a start is another one.
pub(super) const BELOW: u64 = 2;

/// Forgets everything that is chosen anew in each step of a model of any cell.
pub(super) fn forget_choices(state: &mut CellState) {
    let other = state.other();
    for arbiter in state.arbiters() {
        arbiter.set_known(other, false, NOW);
        arbiter.forget_grants_and_orders(other);
    }
    state.guards.iter_mut().for_each(|guard| guard.ask(false));
    for message in state.to_arbiter.iter_mut().flatten() {
        message.slots.iter_mut().for_each(|report| report.wants = false);
    }
    for answer in state.to_guard.iter_mut().flatten().flat_map(|message| &mut message.slots) {
        (answer.release_requested, answer.halt) = (false, false);
    }
}

/// Lets time pass: makes all stored times older.
pub(super) fn pass(state: &mut CellState, step: Micros) {
    each_time(state, |time| *time = *time - step);
}

/// Replaces a state by the canonical one of all states that behave the same. Ages above `oldest` are equivalent;
/// robots of the same class have the same program.
pub(super) fn canonicalize(state: &mut CellState, oldest: Micros, classes: &[usize]) {
    each_time(state, |time| *time = (*time).max(NOW - oldest));
    if state.second.as_ref().is_some_and(|second| second.boot() > state.arbiter.boot()) {
        state.swap_arbiters();
    }
    state.arbiters().for_each(Arbiter::forget_unread);
    for robot in (0..state.guards.len()).map(RobotSlot) {
        state.guards[robot.0].forget_expired(NOW);
        drop_past_messages(state, robot);
        forget_past_releases(state, robot);
        rank_sequences(state, robot);
        rank_serials(state, robot);
        let starts = guard_starts(state, robot);
        each_guard_start(state, robot, &mut |boot| *boot = rank_start(*boot, &starts));
    }
    let starts = arbiter_starts(state);
    each_arbiter_start(state, &mut |boot| *boot = rank_start(*boot, &starts));
    let mut held: Vec<Token> =
        state.slots().flat_map(|slot| held_tokens(state, slot)).map(|(_, token)| token).collect();
    held.sort_unstable();
    for slot in state.slots() {
        rank_tokens(state, slot, &held);
    }
    state.arbiters().for_each(|arbiter| arbiter.set_counters(SERIAL, TOKENS));
    sort_robots(state, classes);
}

/// Replaces the number of a start by its rank: starts of one role are only compared with each other.
fn rank_start(boot: Boot, starts: &[Boot]) -> Boot {
    Boot(starts.binary_search(&boot).map_or(0, |rank| (rank as u64 + 1) * SPACING))
}

fn starts_of(visit: impl FnOnce(&mut dyn FnMut(&mut Boot))) -> Vec<Boot> {
    let mut starts = Vec::new();
    visit(&mut |boot| starts.extend((*boot != Boot::NONE).then_some(*boot)));
    starts.sort_unstable();
    starts.dedup();
    starts
}

/// The starts of a robot's guard that are remembered anywhere, in rising order.
pub(super) fn guard_starts(state: &mut CellState, robot: RobotSlot) -> Vec<Boot> {
    starts_of(|f| each_guard_start(state, robot, f))
}

/// The starts of the arbiter that are remembered anywhere, in rising order.
pub(super) fn arbiter_starts(state: &mut CellState) -> Vec<Boot> {
    starts_of(|f| each_arbiter_start(state, f))
}

fn each_guard_start(state: &mut CellState, robot: RobotSlot, f: &mut dyn FnMut(&mut Boot)) {
    f(state.guards[robot.0].boot_mut());
    state.arbiters().for_each(|arbiter| f(arbiter.guard_boot_mut(robot)));
    state.to_arbiter[robot.0].iter_mut().for_each(|m| f(&mut m.boot));
    state.to_guard[robot.0].iter_mut().for_each(|m| f(&mut m.robot_boot));
}

fn each_arbiter_start(state: &mut CellState, f: &mut dyn FnMut(&mut Boot)) {
    state.arbiters().for_each(|arbiter| f(arbiter.boot_mut()));
    state.guards.iter_mut().for_each(|guard| f(guard.arbiter_mut()));
    state.to_arbiter.iter_mut().flatten().for_each(|m| f(&mut m.arbiter));
    state.to_guard.iter_mut().flatten().for_each(|m| f(&mut m.arbiter));
    for slot in state.slots() {
        each_token(state, slot, &mut |token| f(&mut token.boot));
    }
}

/// Sorts the robots of each class by their states. Robots with equal keys do not differ.
fn sort_robots(state: &mut CellState, classes: &[usize]) {
    state.set_indices(|_| 0);
    let key = |r: usize| {
        let mut hasher = Mixer::default();
        state.robots[r].hash(&mut hasher);
        state.guards[r].hash(&mut hasher);
        state.to_arbiter[r].hash(&mut hasher);
        state.to_guard[r].hash(&mut hasher);
        for arbiter in std::iter::once(&state.arbiter).chain(&state.second) {
            arbiter.hash_robot(RobotSlot(r), &mut hasher);
        }
        (classes[r], hasher.finish())
    };
    let keys: Vec<_> = (0..classes.len()).map(key).collect();
    let mut order: Vec<usize> = (0..classes.len()).collect();
    // Each class keeps its set of indices.
    order.sort_by_key(|r| keys[*r]);
    let mut indices: Vec<usize> = (0..classes.len()).collect();
    indices.sort_by_key(|r| classes[*r]);
    let mut to = vec![0; classes.len()];
    for (robot, index) in order.into_iter().zip(indices) {
        to[robot] = index;
    }
    state.reindex(&to);
    state.set_indices(|r| r);
}

fn each_time(state: &mut CellState, mut f: impl FnMut(&mut Micros)) {
    state.arbiters().for_each(|arbiter| arbiter.each_time(&mut f));
    state.guards.iter_mut().for_each(|guard| guard.each_time(&mut f));
}

/// Removes messages that change nothing, unless an arbiter may still start again. Of all others, keeps only what is
/// read.
fn drop_past_messages(state: &mut CellState, RobotSlot(robot): RobotSlot) {
    let CellState { arbiter, second, guards, to_arbiter, to_guard, faults, .. } = state;
    let all = |test: &dyn Fn(&Arbiter) -> bool| test(arbiter) && second.as_ref().is_none_or(test);
    let any = Some(Token { boot: Boot(1), number: 1 });
    let guard = &guards[robot];
    to_guard[robot].retain(|m| !guard.is_past(m));
    for message in to_guard[robot].iter_mut().filter(|m| m.robot_boot != guard.boot() || !guard.confirms(m.echo, NOW)) {
        message.echo = 0;
    }
    if faults.arbiter_crashes == 0 && faults.second_arbiters == 0 {
        to_arbiter[robot].retain(|m| !all(&|arbiter| arbiter.is_past(m)));
    }
    // An arbiter trusts only messages that name its start. Other arbiters may accept a message, and learn of its start.
    for message in &mut to_arbiter[robot] {
        if all(&|arbiter| arbiter.is_past(message) || message.arbiter != arbiter.boot()) {
            message.slots.fill(SlotReport::UNKNOWN);
            if !faults.is_set_back && all(&|arbiter| message.arbiter <= arbiter.boot()) {
                message.arbiter = Boot::NONE;
            }
        }
    }
    for report in to_arbiter[robot].iter_mut().flat_map(|m| &mut m.slots) {
        report.occupancy = what_counts(report.occupancy);
        report.token = report.token.and(any);
    }
}

/// Forgets grants that were given up and do not count any more. Such a grant counts only while a late message may
/// grant it to the robot again, or while the arbiter still has the robot as its holder.
fn forget_past_releases(state: &mut CellState, robot: RobotSlot) {
    for slot in state.slots() {
        let held =
            held_tokens(state, slot).into_iter().filter(|(holder, _)| *holder == robot).map(|(_, token)| token).min();
        let granted = state.to_guard[robot.0].iter().filter_map(|m| m.slots[slot.0].granted);
        let least = granted.chain(held).min();
        let forget = |released: &mut Option<Token>, least: Option<Token>| {
            *released = released.filter(|r| least.is_some_and(|least| *r >= least));
        };
        forget(state.guards[robot.0].released_mut(slot), least);
        state.to_arbiter[robot.0].iter_mut().for_each(|m| forget(&mut m.slots[slot.0].released, held));
    }
}

/// Replaces sequence numbers by ranks. For messages under way to the arbiter and its last received message only the
/// order of the numbers of one start counts. For answered messages only the times at which they were sent count,
/// while they can still confirm a grant. The guard has sent all of these messages, and sends higher numbers from now on.
fn rank_sequences(state: &mut CellState, robot: RobotSlot) {
    let CellState { arbiter, second, guards, to_arbiter, to_guard, .. } = state;
    let (guard, to_arbiter, to_guard) = (&mut guards[robot.0], &mut to_arbiter[robot.0], &mut to_guard[robot.0]);
    let own = guard.boot();
    let mut arbiters: Vec<&mut Arbiter> = std::iter::once(arbiter).chain(second).collect();
    let heard = arbiters.iter_mut().map(|arbiter| (*arbiter.guard_boot_mut(robot), *arbiter.sequence_mut(robot)));
    let under_way = to_arbiter.iter().map(|m| (m.boot, m.sequence));
    let mut seen: Vec<(Boot, u64)> = heard.chain(under_way).chain([(own, 0)]).collect();
    seen.sort_unstable();
    seen.dedup();
    let time = |guard: &Guard, sequence| guard.sent_at(sequence).filter(|_| guard.confirms(sequence, NOW));
    let mut sent: Vec<Option<Micros>> = seen.iter().filter(|s| s.0 == own).map(|s| time(guard, s.1)).collect();
    let rank =
        |of: (Boot, u64)| seen.iter().filter(|other| other.0 == of.0 && other.1 > 0 && **other <= of).count() as u64;
    for arbiter in arbiters {
        *arbiter.sequence_mut(robot) = rank((*arbiter.guard_boot_mut(robot), *arbiter.sequence_mut(robot)));
    }
    for message in to_arbiter.iter_mut() {
        message.sequence = rank((message.boot, message.sequence));
    }
    let mut times: Vec<Micros> = to_guard.iter().filter_map(|m| time(guard, m.echo)).collect();
    times.sort_unstable();
    times.dedup();
    for message in to_guard {
        let index = time(guard, message.echo).and_then(|sent| times.iter().position(|time| *time == sent));
        message.echo = index.map_or(0, |i| (sent.len() + i) as u64);
    }
    sent.extend(times.into_iter().map(Some));
    guard.set_sent(&sent);
}

/// Replaces serial numbers by ranks. Each guard compares them within one start of the arbiter.
fn rank_serials(state: &mut CellState, RobotSlot(robot): RobotSlot) {
    let (guard, messages) = (&mut state.guards[robot], &mut state.to_guard[robot]);
    let obeyed = (guard.arbiter(), *guard.serial_mut());
    let mut seen: Vec<(Boot, u64)> = messages.iter().map(|m| (m.arbiter, m.serial)).chain([obeyed]).collect();
    seen.sort_unstable();
    seen.dedup();
    let rank = |of: (Boot, u64)| seen.iter().filter(|other| other.0 == of.0 && **other < of).count() as u64 + 1;
    *guard.serial_mut() = rank(obeyed);
    for message in messages {
        message.serial = rank((message.arbiter, message.serial));
    }
}

/// The grants of a slot that are held, with their robots.
fn held_tokens(state: &mut CellState, slot: SlotId) -> Vec<(RobotSlot, Token)> {
    let held = state.arbiters().filter_map(|arbiter| arbiter.holder_token_mut(slot));
    held.map(|(robot, token)| (robot, *token)).collect()
}

/// Replaces the numbers of grants by ranks. Grants are compared within one slot; held grants (`held`, in their
/// order) are also compared over all slots.
fn rank_tokens(state: &mut CellState, slot: SlotId, held: &[Token]) {
    let mut seen = BTreeSet::new();
    each_token(state, slot, &mut |token| _ = seen.insert(*token));
    let rank = |t: Token| match held.iter().position(|other| *other == t) {
        Some(order) => HELD + order as u64,
        None => seen.iter().filter(|other| other.boot == t.boot && **other < t).count() as u64 + 1,
    };
    each_token(state, slot, &mut |token| token.number = rank(*token));
}

fn each_token(state: &mut CellState, slot: SlotId, f: &mut impl FnMut(&mut Token)) {
    state.arbiters().filter_map(|arbiter| arbiter.holder_token_mut(slot)).for_each(|(_, token)| f(token));
    for guard in &mut state.guards {
        guard.each_token(&mut |s, token| token.iter_mut().filter(|_| s == slot).for_each(&mut *f));
    }
    let released = state.to_arbiter.iter_mut().flatten().filter_map(|m| m.slots[slot.0].released.as_mut());
    released.for_each(&mut *f);
    state.to_guard.iter_mut().flatten().filter_map(|m| m.slots[slot.0].granted.as_mut()).for_each(f);
}
