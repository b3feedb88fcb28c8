//! Parallel evaluation of queries, with ordered results.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use elbowroom_formats::Diagnostic;
use elbowroom_scene::{Checker, CheckerOptions, CheckerStats, ContactSurfaces, Level, Scene, SceneError, SceneState};

use super::{ContactRow, QueryChecker, QueryKind, QueryPairs, QueryRow, QueryStates};

/// Number of states per checker. Its learned weights must not depend on the number of threads.
pub const BLOCK: usize = 256;

/// Largest number of finished blocks per thread that wait for an earlier one.
const WAITING: usize = 8;

/// A query, which is evaluated for every state.
#[derive(Debug, Clone, Copy)]
pub struct Query<'q> {
    /// Collision, distance or tolerance.
    pub kind: QueryKind,
    /// Resolution levels, weights and matrix; all except [`CheckerOptions::level`] change only the time.
    pub options: CheckerOptions,
    /// Whether the time of each state is measured.
    pub is_timed: bool,
    /// The pairs that are tested.
    pub pairs: &'q QueryPairs,
    /// A row for each pair no farther apart than this, m, the nearest first; `None`: a row for each state.
    pub all_pairs_m: Option<f64>,
    /// The state before joint values are set, with carried objects.
    pub start: &'q SceneState,
    /// Most threads that work; `None`: one per core.
    pub threads: Option<NonZeroUsize>,
}

impl<'q> Query<'q> {
    /// A query of a row for each state, with the default options, on all cores.
    pub fn new(kind: QueryKind, pairs: &'q QueryPairs, start: &'q SceneState) -> Self {
        let options = CheckerOptions::default();
        Self { kind, options, is_timed: false, pairs, all_pairs_m: None, start, threads: None }
    }
}

/// Like [`evaluate_query`], for all pairs.
///
/// # Errors
/// As for [`evaluate_query`].
pub fn evaluate(
    scene: &Scene,
    states: &QueryStates,
    kind: QueryKind,
    level: Level,
    take: &mut dyn FnMut(&[QueryRow]) -> bool,
) -> Result<CheckerStats, Diagnostic> {
    let (pairs, start) = (QueryPairs::all(), SceneState::new(scene));
    let options = CheckerOptions { level, ..CheckerOptions::default() };
    let query = Query { options, ..Query::new(kind, &pairs, &start) };
    Ok(evaluate_query(scene, states, &query, take)?.stats)
}

/// The work of a query.
#[derive(Debug, Clone, Default)]
pub struct QueryEffort {
    /// Counters of the states whose rows were taken.
    pub stats: CheckerStats,
    /// Time of each of these states, without setting the joint values, s; empty unless it was measured.
    pub times_s: Vec<f64>,
}

impl QueryEffort {
    fn add(&mut self, other: Self) {
        self.stats += other.stats;
        self.times_s.extend(other.times_s);
    }
}

/// Evaluates a query for every state, and returns the work for the rows taken.
///
/// `take` is called with the rows, in order and block by block; it returns whether to continue. [`QueryKind::Contacts`],
/// [`QueryKind::Time`] and [`QueryKind::Limits`] are answered like [`QueryKind::Point`]: [`evaluate_contacts`],
/// [`evaluate_motions`](super::evaluate_motions) and [`evaluate_limits`](super::evaluate_limits) have their rows.
///
/// # Errors
/// [`Diagnostic`] if a state does not fit the scene. States that were read for the scene's model always fit.
pub fn evaluate_query(
    scene: &Scene,
    states: &QueryStates,
    query: &Query<'_>,
    take: &mut dyn FnMut(&[QueryRow]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    let new = QueryChecker::new(scene, query.options, query.pairs);
    evaluate_blocks(states, (states.len(), query.threads), &|block| rows_of_block(&new, states, query, block), take)
}

/// Like [`evaluate_query`], with the touching triangles of all pairs in contact as rows.
///
/// # Errors
/// As for [`evaluate_query`].
pub fn evaluate_contacts(
    scene: &Scene,
    states: &QueryStates,
    query: &Query<'_>,
    take: &mut dyn FnMut(&[ContactRow]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    let new = Checker::new(scene, CheckerOptions { level: Level::Auto, ..query.options });
    evaluate_blocks(states, (states.len(), query.threads), &|block| contacts_of_block(&new, states, query, block), take)
}

/// The rows of a block, and the work.
pub(super) type BlockRows<R> = Result<(Vec<R>, QueryEffort), SceneError>;

/// Evaluates blocks of so many rows on so many threads, or one per core; `take` receives them in order.
pub(super) fn evaluate_blocks<R: Send>(
    states: &QueryStates,
    (count, threads): (usize, Option<NonZeroUsize>),
    rows_of_block: &(dyn Fn(usize) -> BlockRows<R> + Sync),
    take: &mut dyn FnMut(&[R]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    let blocks = count.div_ceil(BLOCK);
    let cores = cores(blocks, threads);
    let wrong = |e: SceneError| Diagnostic::new(&states.file, None, e);
    let mut done = QueryEffort::default();
    if cores <= 1 {
        for block in 0..blocks {
            let (rows, effort) = rows_of_block(block).map_err(wrong)?;
            done.add(effort);
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
                    if block >= blocks || send.send((block, rows_of_block(block))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        let (mut waiting, mut due) = (BTreeMap::new(), 0);
        for (block, rows) in receive {
            waiting.insert(block, rows);
            while let Some(rows) = waiting.remove(&due) {
                due += 1;
                let continues = match rows {
                    Ok((rows, effort)) => {
                        done.add(effort);
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

/// Number of threads for some blocks. Asking for the cores takes tens of microseconds, as long as some states.
pub(crate) fn cores(blocks: usize, most: Option<NonZeroUsize>) -> usize {
    let all = || most.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    if blocks < 2 { 1 } else { all().min(blocks) }
}

/// The touching triangles of a block.
fn contacts_of_block(
    new: &Checker<'_>,
    states: &QueryStates,
    query: &Query<'_>,
    block: usize,
) -> BlockRows<ContactRow> {
    let (scene, mut checker) = (new.scene(), new.clone());
    let mut surfaces = ContactSurfaces::new(scene);
    let mut state = query.start.clone();
    let (mut rows, mut times_s) = (Vec::new(), Vec::new());
    for index in block * BLOCK..states.len().min((block + 1) * BLOCK) {
        for (robot, q) in states.of(index) {
            state.set_q(scene, robot, q)?;
        }
        let begin = Instant::now();
        let mut pairs = BTreeSet::new();
        for &[a, b] in query.pairs.sides() {
            checker.between(a, b).contacts(&state, |pair| _ = pairs.insert((pair.a, pair.b)));
        }
        for pair in pairs {
            surfaces.contacts(&state, pair.0, pair.1, |contact| rows.push(ContactRow { index, pair, contact }));
        }
        if query.is_timed {
            times_s.push(begin.elapsed().as_secs_f64());
        }
    }
    Ok((rows, QueryEffort { stats: checker.stats(), times_s }))
}

/// The rows of a block. Likely pairs are tested first; the weights are updated from state to state.
fn rows_of_block(new: &QueryChecker<'_>, states: &QueryStates, query: &Query<'_>, block: usize) -> BlockRows<QueryRow> {
    // In a scene of thousands of objects, making another one would take longer than the rows.
    let (scene, mut checker) = (new.scene(), new.clone());
    let mut state = query.start.clone();
    let (mut rows, mut times_s) = (Vec::with_capacity(BLOCK), Vec::new());
    for index in block * BLOCK..states.len().min((block + 1) * BLOCK) {
        for (robot, q) in states.of(index) {
            state.set_q(scene, robot, q)?;
        }
        let begin = Instant::now();
        match query.all_pairs_m {
            None => rows.push(QueryRow { index, ..checker.row(&state, query.kind) }),
            Some(margin_m) => rows.extend(checker.rows_within(&state, margin_m).map(|row| QueryRow { index, ..row })),
        }
        if query.is_timed {
            times_s.push(begin.elapsed().as_secs_f64());
        }
    }
    Ok((rows, QueryEffort { stats: checker.stats(), times_s }))
}
