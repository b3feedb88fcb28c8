//! States to answers, on all cores, in order.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use elbowroom_formats::FormatError;
use elbowroom_scene::{Checker, Contact, Counts, Level, Options, Scene, SceneError, SceneState};
use elbowroom_spatial::Vec3;

use super::{Ask, Row, States};

/// States that one checker answers before it is made anew: what it learns must not depend on the number of threads.
pub const BLOCK: usize = 256;

/// Blocks that may wait for one that is late, per thread.
const WAITING: usize = 8;

/// Answers a question about every state. `take` is given the rows, in order and block by block; it says whether to go on.
/// Returns what was done for the rows that were taken: how many pairs were tested, and so on.
///
/// # Errors
/// [`FormatError`] where a state does not fit the scene; states that were read for its subject do.
pub fn answer(
    scene: &Scene,
    states: &States,
    ask: Ask,
    level: Level,
    take: &mut dyn FnMut(&[Row]) -> bool,
) -> Result<Counts, FormatError> {
    let blocks = states.len().div_ceil(BLOCK);
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(blocks);
    let wrong = |e: SceneError| FormatError::new(&states.file, None, e.to_string());
    let mut done = Counts::default();
    if cores <= 1 {
        for block in 0..blocks {
            let (rows, counts) = of_block(scene, states, ask, level, block).map_err(wrong)?;
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
                    if block >= blocks || send.send((block, of_block(scene, states, ask, level, block))).is_err() {
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
                let goes_on = match rows {
                    Ok((rows, counts)) => {
                        done += counts;
                        take(&rows)
                    }
                    Err(e) => {
                        stop.store(true, Ordering::Relaxed);
                        return Err(wrong(e));
                    }
                };
                if !goes_on {
                    stop.store(true, Ordering::Relaxed);
                    return Ok(done);
                }
            }
        }
        Ok(done)
    })
}

/// The rows of a block: likely pairs first, and what one state tells counts for the next.
fn of_block(
    scene: &Scene,
    states: &States,
    ask: Ask,
    level: Level,
    block: usize,
) -> Result<(Vec<Row>, Counts), SceneError> {
    let mut checker = Checker::new(scene, Options { level, ..Options::default() });
    let mut state = SceneState::new(scene);
    let rows = block * BLOCK..states.len().min((block + 1) * BLOCK);
    let rows = rows.map(|index| {
        for (robot, q) in states.of(index) {
            state.set_q(scene, robot, q)?;
        }
        Ok(Row { index, ..one(&mut checker, &state, ask) })
    });
    Ok((rows.collect::<Result<_, SceneError>>()?, checker.counts()))
}

fn one(checker: &mut Checker<'_>, state: &SceneState, ask: Ask) -> Row {
    let nothing = |level| Row { index: 0, collides: false, distance_m: None, pair: None, witness: None, level };
    match ask {
        Ask::Collision => {
            let Some(contact) = checker.collides(state) else { return nothing(checker.last_level()) };
            Row {
                collides: true,
                distance_m: Some(0.0),
                pair: Some((contact.a, contact.b)),
                witness: touching(checker, state, contact),
                ..nothing(contact.level)
            }
        }
        Ask::Distance => distance(checker, state).unwrap_or_else(|| nothing(checker.last_level())),
        Ask::Tolerance(t) => {
            if checker.within(state, t).is_none() {
                return nothing(checker.last_level());
            }
            let level = checker.last_level();
            let row = distance(checker, state).unwrap_or_else(|| nothing(level));
            Row { collides: true, ..row }
        }
    }
}

/// `None` where there is no pair.
fn distance(checker: &mut Checker<'_>, state: &SceneState) -> Option<Row> {
    let d = checker.distance(state)?;
    let row = Row {
        index: 0,
        // A distance that is no number is not known to be one: contact.
        collides: !(d.metres > 0.0),
        distance_m: Some(d.metres.max(0.0)),
        pair: Some((d.a, d.b)),
        witness: Some((d.on_a, d.on_b)),
        level: d.level,
    };
    if row.collides || d.lower_bound > 0.0 {
        return Some(row);
    }
    // Nearer than the distance is exact: the yes-or-no question decides, so that all questions agree.
    let Some(contact) = checker.collides(state) else { return Some(row) };
    let pair = Some((contact.a, contact.b));
    let witness = if row.pair == pair { row.witness } else { touching(checker, state, contact) };
    Some(Row { collides: true, distance_m: Some(0.0), pair, witness, ..row })
}

/// A point of each of two members in contact.
fn touching(checker: &mut Checker<'_>, state: &SceneState, contact: Contact) -> Option<(Vec3, Vec3)> {
    let found = checker.between(contact.a.into(), contact.b.into()).distance(state);
    found.map(|d| (d.on_a, d.on_b))
}
