//! Parallel evaluation of queries, with ordered results.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use elbowroom_formats::FormatError;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, CheckerStats, Level, PairContact, Scene, SceneError, SceneState};
use elbowroom_spatial::Vec3;

use super::{QueryKind, QueryRow, QueryStates};

/// States per checker: its learned weights must not depend on the number of threads.
pub const BLOCK: usize = 256;

/// Largest number of finished blocks per thread that wait for an earlier one.
const WAITING: usize = 8;

/// Evaluates a query for every state. `take` is called with the rows, in order and block by block; it returns whether
/// to continue. Returns the counters of the work for the rows taken.
///
/// # Errors
/// [`FormatError`] where a state does not fit the scene; states that were read for its model do.
pub fn evaluate(
    scene: &Scene,
    states: &QueryStates,
    kind: QueryKind,
    level: Level,
    take: &mut dyn FnMut(&[QueryRow]) -> bool,
) -> Result<CheckerStats, FormatError> {
    let blocks = states.len().div_ceil(BLOCK);
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(blocks);
    let wrong = |e: SceneError| FormatError::new(&states.file, None, e.to_string());
    let mut done = CheckerStats::default();
    if cores <= 1 {
        for block in 0..blocks {
            let (rows, counts) = rows_of_block(scene, states, kind, level, block).map_err(wrong)?;
            done += counts;
            if !take(&rows) {
                break;
            }
        }
        return Ok(done);
    }
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    std::thread::scope(|threads| {
        let (send, receive) = mpsc::sync_channel(WAITING * cores);
        for _ in 0..cores {
            let send = send.clone();
            let (next, stop) = (&next, &stop);
            threads.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let block = next.fetch_add(1, Ordering::Relaxed);
                    if block >= blocks || send.send((block, rows_of_block(scene, states, kind, level, block))).is_err()
                    {
                        return;
                    }
                }
            });
        }
        drop(send);
        let mut waiting = BTreeMap::new();
        let mut due = 0;
        for (block, rows) in receive {
            waiting.insert(block, rows);
            while let Some(rows) = waiting.remove(&due) {
                due += 1;
                let continues = match rows {
                    Ok((rows, counts)) => {
                        done += counts;
                        take(&rows)
                    }
                    Err(e) => {
                        stop.store(true, Ordering::Relaxed);
                        return Err(wrong(e));
                    }
                };
                if !continues {
                    stop.store(true, Ordering::Relaxed);
                    return Ok(done);
                }
            }
        }
        Ok(done)
    })
}

/// The rows of a block. Likely pairs are tested first; the weights are updated from state to state.
fn rows_of_block(
    scene: &Scene,
    states: &QueryStates,
    kind: QueryKind,
    level: Level,
    block: usize,
) -> Result<(Vec<QueryRow>, CheckerStats), SceneError> {
    let mut checker = Checker::new(scene, CheckerOptions { level, ..CheckerOptions::default() });
    let mut state = SceneState::new(scene);
    let rows = block * BLOCK..states.len().min((block + 1) * BLOCK);
    let rows = rows.map(|index| {
        for (robot, q) in states.of(index) {
            state.set_q(scene, RobotId(robot), q)?;
        }
        Ok(QueryRow { index, ..row_of_state(&mut checker, &state, kind) })
    });
    Ok((rows.collect::<Result<_, SceneError>>()?, checker.stats()))
}

/// The row of one state; its index is 0.
fn row_of_state(checker: &mut Checker<'_>, state: &SceneState, kind: QueryKind) -> QueryRow {
    let nothing = |level| QueryRow { index: 0, collides: false, distance_m: None, pair: None, witness: None, level };
    match kind {
        QueryKind::Collision => {
            let Some(contact) = checker.collides(state) else { return nothing(checker.last_level()) };
            QueryRow {
                collides: true,
                distance_m: Some(0.0),
                pair: Some((contact.a, contact.b)),
                witness: witness_of_contact(checker, state, contact),
                ..nothing(contact.level)
            }
        }
        QueryKind::Distance => distance(checker, state).unwrap_or_else(|| nothing(checker.last_level())),
        QueryKind::Tolerance(t) => {
            if checker.within(state, t).is_none() {
                return nothing(checker.last_level());
            }
            let level = checker.last_level();
            let row = distance(checker, state).unwrap_or_else(|| nothing(level));
            QueryRow { collides: true, ..row }
        }
    }
}

/// The row of a distance query; `None` without pairs.
fn distance(checker: &mut Checker<'_>, state: &SceneState) -> Option<QueryRow> {
    let d = checker.distance(state)?;
    let row = QueryRow {
        index: 0,
        // A NaN distance counts as contact.
        collides: !(d.metres > 0.0),
        distance_m: Some(d.metres.max(0.0)),
        pair: Some((d.a, d.b)),
        witness: Some((d.on_a, d.on_b)),
        level: d.level,
    };
    if row.collides || d.lower_bound > 0.0 {
        return Some(row);
    }
    // Below the accuracy of the distance the collision test decides, so that all kinds of queries agree.
    let Some(contact) = checker.collides(state) else { return Some(row) };
    let pair = Some((contact.a, contact.b));
    let witness = if row.pair == pair { row.witness } else { witness_of_contact(checker, state, contact) };
    Some(QueryRow { collides: true, distance_m: Some(0.0), pair, witness, ..row })
}

/// Witness points of two geometries in contact.
fn witness_of_contact(checker: &mut Checker<'_>, state: &SceneState, contact: PairContact) -> Option<(Vec3, Vec3)> {
    let found = checker.between(contact.a.into(), contact.b.into()).distance(state);
    found.map(|d| (d.on_a, d.on_b))
}
