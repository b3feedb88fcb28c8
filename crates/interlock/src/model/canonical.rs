//! States that differ only in numbers of which the order alone matters are one state.

use std::collections::{BTreeMap, BTreeSet};

use super::state::{CellState, NOW};
use crate::{Boot, Micros, Token};

/// Older than this is no different from this.
const OLDEST: Micros = Micros(300);

/// Lets time pass: everything that happened is older.
pub(super) fn pass(state: &mut CellState, step: Micros) {
    each_time(state, |time| *time = *time - step);
}

/// Replaces sequence numbers, serials and tokens by their ranks, and cuts ages off.
pub(super) fn canonicalize(state: &mut CellState) {
    each_time(state, |time| *time = (*time).max(NOW - OLDEST));
    for robot in 0..state.guards.len() {
        rank_sequences(state, robot);
    }
    rank(state, each_serial);
    rank(state, each_token);
}

fn each_time(state: &mut CellState, mut f: impl FnMut(&mut Micros)) {
    state.arbiter.each_time(&mut f);
    state.guards.iter_mut().for_each(|guard| guard.each_time(&mut f));
}

/// A number with the group within which it is compared.
type Visit<'a> = &'a mut dyn FnMut(Boot, &mut u64);

/// Replaces the numbers by their ranks within their groups.
fn rank(state: &mut CellState, each: impl Fn(&mut CellState, Visit<'_>)) {
    let mut seen: BTreeMap<Boot, BTreeSet<u64>> = BTreeMap::new();
    each(state, &mut |group, number| {
        seen.entry(group).or_default().insert(*number);
    });
    each(state, &mut |group, number| {
        *number = seen[&group].iter().position(|n| n == number).map_or(0, |rank| rank as u64 + 1);
    });
}

fn each_serial(state: &mut CellState, visit: Visit<'_>) {
    let boot = state.arbiter.boot();
    visit(boot, state.arbiter.serial_mut());
    for guard in &mut state.guards {
        let boot = guard.arbiter();
        visit(boot, guard.serial_mut());
    }
    for message in state.to_guard.iter_mut().flatten() {
        visit(message.arbiter, &mut message.serial);
    }
}

fn each_token(state: &mut CellState, visit: Visit<'_>) {
    let boot = state.arbiter.boot();
    visit(boot, state.arbiter.tokens_mut());
    let mut token = |token: &mut Option<Token>| {
        if let Some(token) = token {
            visit(token.boot, &mut token.number);
        }
    };
    state.arbiter.each_token(&mut token);
    state.guards.iter_mut().for_each(|guard| guard.each_token(&mut token));
    for report in state.to_arbiter.iter_mut().flatten().flat_map(|m| &mut m.slots) {
        token(&mut report.token);
        token(&mut report.released);
    }
    for answer in state.to_guard.iter_mut().flatten().flat_map(|m| &mut m.slots) {
        token(&mut answer.granted);
    }
}

/// Sequence numbers are also indices of the times at which messages were sent: those times move with them.
fn rank_sequences(state: &mut CellState, robot: usize) {
    let CellState { arbiter, guards, to_arbiter, to_guard, .. } = state;
    let guard = &mut guards[robot];
    let mut seen = BTreeSet::from([0, guard.sequence_now()]);
    arbiter.each_sequence(robot, &mut |n| {
        seen.insert(*n);
    });
    seen.extend(to_arbiter[robot].iter().map(|m| m.sequence));
    seen.extend(to_guard[robot].iter().map(|m| m.echo));
    let seen: Vec<u64> = seen.into_iter().collect();
    let rank = |n: &mut u64| *n = seen.binary_search(n).unwrap_or(0) as u64;
    guard.renumber(&seen);
    arbiter.each_sequence(robot, &mut |n| rank(n));
    to_arbiter[robot].iter_mut().for_each(|m| rank(&mut m.sequence));
    to_guard[robot].iter_mut().for_each(|m| rank(&mut m.echo));
}
