//! The first contact of the motion between two states.

use std::time::Instant;

use elbowroom_cell::QueryModel;
use elbowroom_formats::Diagnostic;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, Scene, SceneError, SceneState, SweepHit, SweepMove, SweepOptions};
use serde::Serialize;

use super::evaluate::{BLOCK, BlockRows, Query, QueryEffort, evaluate_blocks};
use super::row::quoted;
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
    /// First of the pair.
    pub a: Option<String>,
    /// Second of the pair.
    pub b: Option<String>,
    /// The point of contact on `a`, world, m.
    pub ax: Option<f64>,
    /// y of that point.
    pub ay: Option<f64>,
    /// z of that point.
    pub az: Option<f64>,
    /// The point on `b`.
    pub bx: Option<f64>,
    /// y of that point.
    pub by: Option<f64>,
    /// z of that point.
    pub bz: Option<f64>,
    /// 0 where the proof ended without a contact: what follows `free_share` is unknown.
    pub certain: u8,
}

impl MotionRecord {
    /// The columns, in order.
    pub const HEADER: &'static str = "index,collides,free_share,a,b,ax,ay,az,bx,by,bz,certain";

    /// The record of a row, with names.
    pub fn of(row: &MotionRow, model: &QueryModel) -> Self {
        let point = |of: fn(&SweepHit) -> [f64; 3], axis: usize| {
            row.hit.as_ref().map(|hit| of(hit)[axis]).filter(|v| v.is_finite())
        };
        let (a, b) = (|hit: &SweepHit| hit.on_a.to_array(), |hit: &SweepHit| hit.on_b.to_array());
        Self {
            index: row.index,
            collides: u8::from(row.hit.is_some()),
            free_share: row.hit.map_or(1.0, |hit| hit.time),
            a: row.hit.map(|hit| model.geometry_name(hit.a)),
            b: row.hit.map(|hit| model.geometry_name(hit.b)),
            ax: point(a, 0),
            ay: point(a, 1),
            az: point(a, 2),
            bx: point(b, 0),
            by: point(b, 1),
            bz: point(b, 2),
            certain: u8::from(row.hit.is_none_or(|hit| hit.certain)),
        }
    }

    /// The CSV line, without line break; unknown values are empty.
    pub fn csv(&self) -> String {
        let number = |v: &Option<f64>| v.map_or_else(String::new, |v| format!("{v:?}"));
        let name = |n: &Option<String>| n.as_deref().map_or_else(String::new, quoted);
        let points = [&self.ax, &self.ay, &self.az, &self.bx, &self.by, &self.bz].map(number).join(",");
        let (a, b) = (name(&self.a), name(&self.b));
        format!("{},{},{:?},{a},{b},{points},{}", self.index, self.collides, self.free_share, self.certain)
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
    let motions = states.len().saturating_sub(1);
    evaluate_blocks(states, motions, &|block| motions_of_block(scene, states, query, block), take)
}

fn motions_of_block(scene: &Scene, states: &QueryStates, query: &Query<'_>, block: usize) -> BlockRows<MotionRow> {
    let mut checker = Checker::new(scene, query.options);
    let mut state = query.start.clone();
    let (mut rows, mut times_s) = (Vec::with_capacity(BLOCK), Vec::new());
    for index in block * BLOCK..(states.len() - 1).min((block + 1) * BLOCK) {
        for (robot, q) in states.of(index) {
            state.set_q(scene, robot, q)?;
        }
        let moves: Vec<(RobotId, &[f64])> = states.of(index + 1).collect();
        let begin = Instant::now();
        rows.push(MotionRow { index, hit: first_contact(&mut checker, &state, &moves, query)? });
        if query.is_timed {
            times_s.push(begin.elapsed().as_secs_f64());
        }
    }
    Ok((rows, QueryEffort { stats: checker.stats(), times_s }))
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
