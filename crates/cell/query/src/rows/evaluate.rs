//! Parallel evaluation of queries, with ordered results.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use elbowroom_formats::Diagnostic;
use elbowroom_scene::{
    Checker, CheckerOptions, CheckerStats, ContactSurfaces, Detail, Level, PairContact, PairDistance, Scene,
    SceneError, SceneState, Selection,
};
use elbowroom_spatial::Vec3;

use super::{ContactRow, QueryKind, QueryPairs, QueryRow, QueryStates};

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
    let query = Query { kind, options, is_timed: false, pairs: &pairs, all_pairs_m: None, start: &start };
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
/// `take` is called with the rows, in order and block by block; it returns whether to continue. [`QueryKind::Contacts`]
/// and [`QueryKind::Time`] are answered like [`QueryKind::Point`]: [`evaluate_contacts`] and
/// [`evaluate_motions`](super::evaluate_motions) have their rows.
///
/// # Errors
/// [`Diagnostic`] if a state does not fit the scene. States that were read for the scene's model always fit.
pub fn evaluate_query(
    scene: &Scene,
    states: &QueryStates,
    query: &Query<'_>,
    take: &mut dyn FnMut(&[QueryRow]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    evaluate_blocks(states, states.len(), &|block| rows_of_block(scene, states, query, block), take)
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
    evaluate_blocks(states, states.len(), &|block| contacts_of_block(scene, states, query, block), take)
}

/// The rows of a block, and the work.
pub(super) type BlockRows<R> = Result<(Vec<R>, QueryEffort), SceneError>;

/// Evaluates blocks of `count` rows on all cores; `take` receives them in order.
pub(super) fn evaluate_blocks<R: Send>(
    states: &QueryStates,
    count: usize,
    rows_of_block: &(dyn Fn(usize) -> BlockRows<R> + Sync),
    take: &mut dyn FnMut(&[R]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    let blocks = count.div_ceil(BLOCK);
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(blocks);
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

/// The touching triangles of a block.
fn contacts_of_block(scene: &Scene, states: &QueryStates, query: &Query<'_>, block: usize) -> BlockRows<ContactRow> {
    let mut checker = Checker::new(scene, CheckerOptions { level: Level::Auto, ..query.options });
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
fn rows_of_block(scene: &Scene, states: &QueryStates, query: &Query<'_>, block: usize) -> BlockRows<QueryRow> {
    let mut pairs = CheckedPairs { checker: Checker::new(scene, query.options), sides: query.pairs.sides() };
    let mut state = query.start.clone();
    let (mut rows, mut times_s) = (Vec::with_capacity(BLOCK), Vec::new());
    for index in block * BLOCK..states.len().min((block + 1) * BLOCK) {
        for (robot, q) in states.of(index) {
            state.set_q(scene, robot, q)?;
        }
        let begin = Instant::now();
        match query.all_pairs_m {
            None => rows.push(QueryRow { index, ..pairs.row(scene, &state, query.kind) }),
            Some(margin_m) => rows.extend(pairs.rows_within(&state, margin_m).map(|row| QueryRow { index, ..row })),
        }
        if query.is_timed {
            times_s.push(begin.elapsed().as_secs_f64());
        }
    }
    Ok((rows, QueryEffort { stats: pairs.checker.stats(), times_s }))
}

/// The pairs between all sides, treated as one set.
struct CheckedPairs<'c, 's> {
    checker: Checker<'s>,
    sides: &'c [[Selection; 2]],
}

impl CheckedPairs<'_, '_> {
    fn within(&mut self, state: &SceneState, metres: f64) -> Option<PairContact> {
        self.sides.iter().find_map(|&[a, b]| self.checker.between(a, b).within(state, metres))
    }

    fn nearest(&mut self, state: &SceneState) -> Option<PairDistance> {
        let each = self.sides.iter().filter_map(|&[a, b]| self.checker.between(a, b).distance(state));
        // A NaN distance counts as contact.
        let order = |d: &PairDistance| if d.metres.is_nan() { f64::NEG_INFINITY } else { d.metres };
        each.min_by(|a, b| order(a).total_cmp(&order(b)))
    }

    /// The row of one state; its index is 0.
    fn row(&mut self, scene: &Scene, state: &SceneState, kind: QueryKind) -> QueryRow {
        match kind {
            QueryKind::Collision => {
                let Some(contact) = self.within(state, 0.0) else { return self.nothing() };
                QueryRow {
                    collides: true,
                    distance_m: Some(0.0),
                    pair: Some((contact.a, contact.b)),
                    witness: self.witness_of_contact(state, contact),
                    point_in_a: None,
                    index: 0,
                    level: contact.level,
                }
            }
            QueryKind::Point | QueryKind::Contacts | QueryKind::Time => self.collision_point(scene, state),
            QueryKind::Distance => self.distance(state).unwrap_or_else(|| self.nothing()),
            QueryKind::Tolerance(t) => {
                if self.within(state, t).is_none() {
                    return self.nothing();
                }
                let nothing = self.nothing();
                let row = self.distance(state).unwrap_or(nothing);
                QueryRow { collides: true, ..row }
            }
        }
    }

    /// The collision point of the first sides that have one: `a` is the link that collides.
    fn collision_point(&mut self, scene: &Scene, state: &SceneState) -> QueryRow {
        let mut of_sides = |&[a, b]: &[Selection; 2]| self.checker.between(a, b).collision_point(state, Detail::Exact);
        let Some(point) = self.sides.iter().find_map(&mut of_sides) else { return self.nothing() };
        QueryRow {
            collides: true,
            distance_m: Some(0.0),
            pair: Some((point.link, point.other)),
            witness: Some((point.on_link, point.on_other)),
            point_in_a: state.pose(scene, point.link).map(|pose| pose.inverse_transform_point(point.on_link)),
            ..self.nothing()
        }
    }

    /// The row without a pair.
    fn nothing(&self) -> QueryRow {
        let level = self.checker.last_level();
        QueryRow { index: 0, collides: false, distance_m: None, pair: None, witness: None, point_in_a: None, level }
    }

    /// The row of a distance query; `None` without pairs.
    fn distance(&mut self, state: &SceneState) -> Option<QueryRow> {
        let d = self.nearest(state)?;
        let row = row_of(&d);
        if row.collides || d.lower_bound > 0.0 {
            return Some(row);
        }
        // Below the accuracy of the distance, the collision test decides, so that all kinds of queries agree.
        let Some(contact) = self.within(state, 0.0) else { return Some(row) };
        let pair = Some((contact.a, contact.b));
        let witness = if row.pair == pair { row.witness } else { self.witness_of_contact(state, contact) };
        Some(QueryRow { collides: true, distance_m: Some(0.0), pair, witness, ..row })
    }

    /// A row for each pair no farther apart than a distance, the nearest first.
    fn rows_within(&mut self, state: &SceneState, margin_m: f64) -> impl Iterator<Item = QueryRow> {
        let mut rows: Vec<QueryRow> = Vec::new();
        for &[a, b] in self.sides {
            let push = |d: PairDistance| {
                // Sides may overlap.
                if !rows.iter().any(|row| row.pair == Some((d.a, d.b))) {
                    rows.push(row_of(&d));
                }
            };
            self.checker.between(a, b).distances_within(state, margin_m, push);
        }
        rows.sort_by(|a, b| a.distance_m.unwrap_or(0.0).total_cmp(&b.distance_m.unwrap_or(0.0)));
        rows.into_iter()
    }

    /// Witness points of two geometries in contact.
    fn witness_of_contact(&mut self, state: &SceneState, contact: PairContact) -> Option<(Vec3, Vec3)> {
        let found = self.checker.between(contact.a.into(), contact.b.into()).distance(state);
        found.map(|d| (d.on_a, d.on_b))
    }
}

/// The row of a distance; its index is 0.
fn row_of(d: &PairDistance) -> QueryRow {
    QueryRow {
        index: 0,
        // A NaN distance counts as contact.
        collides: !(d.metres > 0.0),
        distance_m: Some(d.metres.max(0.0)),
        pair: Some((d.a, d.b)),
        witness: Some((d.on_a, d.on_b)),
        point_in_a: None,
        level: d.level,
    }
}
