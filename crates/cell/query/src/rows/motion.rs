//! The first contact of the motion between two states.

use std::time::Instant;

use elbowroom_cell::QueryModel;
use elbowroom_formats::Diagnostic;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, Scene, SceneError, SceneState, SweepHit, SweepMove, SweepOptions};
use serde::Serialize;

use super::evaluate::{BLOCK, BlockRows, Query, QueryEffort, evaluate_blocks};
use super::row::PairColumns;
use super::states::QueryStates;

/// The result for the motion from one state to the next: all joints at constant rates, all together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionRow {
    /// Index of the state from which the motion starts, from 0.
    pub index: usize,
    /// The first contact; `None`: the whole motion is free, proven.
    pub hit: Option<SweepHit>,
}

/// A motion in CSV and JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionRecord {
    /// Index of the state from which the motion starts, from 0.
    pub index: usize,
    /// 0 or 1; 1 also where the motion is not proven free.
    pub collides: u8,
    /// The part of the motion that is free, from 0 to 1.
    pub free_share: f64,
    /// The pair, and the points of contact.
    #[serde(flatten)]
    pub pair: PairColumns,
    /// 0 where the proof ended without a contact: what follows `free_share` is unknown.
    pub certain: u8,
}

impl MotionRecord {
    /// The columns, in order.
    pub const HEADER: &'static str = "index,collides,free_share,a,b,ax,ay,az,bx,by,bz,certain";

    /// The record of a row, with names.
    pub fn of(row: &MotionRow, model: &QueryModel) -> Self {
        Self {
            index: row.index,
            collides: u8::from(row.hit.is_some()),
            free_share: row.hit.map_or(1.0, |hit| hit.time),
            pair: PairColumns::of(row.hit.map(|hit| (hit.a, hit.b)), row.hit.map(|hit| (hit.on_a, hit.on_b)), model),
            certain: u8::from(row.hit.is_none_or(|hit| hit.certain)),
        }
    }

    /// The CSV line, without line break; unknown values are empty.
    pub fn csv(&self) -> String {
        format!("{},{},{:?},{},{}", self.index, self.collides, self.free_share, self.pair.csv(), self.certain)
    }
}

/// Sweeps the motion from each state to the next, and returns the work for the rows taken; without a second state there
/// is none. `take` is called as by [`evaluate_query`](super::evaluate_query).
///
/// # Errors
/// [`Diagnostic`] if the states do not belong to this scene.
pub fn evaluate_motions(
    scene: &Scene,
    states: &QueryStates,
    query: &Query<'_>,
    take: &mut dyn FnMut(&[MotionRow]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    let motions = Motions { from: states, to: states, ahead: 1, count: states.len().saturating_sub(1) };
    motions.evaluate(scene, query, take)
}

/// Like [`evaluate_motions`], for the motion from each state to the one in the same row of `to`, as far as both have rows.
///
/// # Errors
/// [`Diagnostic`] if the states do not belong to this scene.
pub fn evaluate_edges(
    scene: &Scene,
    from: &QueryStates,
    to: &QueryStates,
    query: &Query<'_>,
    take: &mut dyn FnMut(&[MotionRow]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    Motions { from, to, ahead: 0, count: from.len().min(to.len()) }.evaluate(scene, query, take)
}

/// Motions from states to others.
#[derive(Clone, Copy)]
struct Motions<'s> {
    from: &'s QueryStates,
    to: &'s QueryStates,
    /// The row of the end less that of the beginning.
    ahead: usize,
    count: usize,
}

impl Motions<'_> {
    fn evaluate(
        self,
        scene: &Scene,
        query: &Query<'_>,
        take: &mut dyn FnMut(&[MotionRow]) -> bool,
    ) -> Result<QueryEffort, Diagnostic> {
        let new = Checker::new(scene, query.options);
        evaluate_blocks(self.from, (self.count, query.threads), &|block| self.block(&new, query, block), take)
    }

    fn block(self, new: &Checker<'_>, query: &Query<'_>, block: usize) -> BlockRows<MotionRow> {
        let (scene, mut checker) = (new.scene(), new.clone());
        let mut state = query.start.clone();
        let (mut rows, mut times_s) = (Vec::with_capacity(BLOCK), Vec::new());
        for index in block * BLOCK..self.count.min((block + 1) * BLOCK) {
            for (robot, q) in self.from.of(index) {
                state.set_q(scene, robot, q)?;
            }
            let moves: Vec<(RobotId, &[f64])> = self.to.of(index + self.ahead).collect();
            let begin = Instant::now();
            rows.push(MotionRow { index, hit: first_contact(&mut checker, &state, &moves, query)? });
            if query.is_timed {
                times_s.push(begin.elapsed().as_secs_f64());
            }
        }
        Ok((rows, QueryEffort { stats: checker.stats(), times_s }))
    }
}

/// The first contact between any sides.
fn first_contact(
    checker: &mut Checker<'_>,
    state: &SceneState,
    moves: &[(RobotId, &[f64])],
    query: &Query<'_>,
) -> Result<Option<SweepHit>, SceneError> {
    let moves: Vec<SweepMove> = moves.iter().map(|&(robot, to)| SweepMove::Robot { robot, to }).collect();
    let mut first: Option<SweepHit> = None;
    for &[a, b] in query.pairs.sides() {
        let hit = checker.between(a, b).sweep(state, &moves, &SweepOptions::default())?;
        let is_earlier = |hit: &SweepHit| first.is_none_or(|first| hit.time < first.time);
        first = hit.filter(is_earlier).or(first);
    }
    Ok(first)
}
