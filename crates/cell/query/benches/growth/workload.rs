//! Free states of robots, and their times.

use std::num::NonZeroUsize;

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_query::{BLOCK, Query, QueryChecker, QueryKind, QueryPairs, QueryStates, evaluate_query};
use elbowroom_robot::{Robot, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, Selection};
use elbowroom_testkit::allocation::AllocationCounter;
use elbowroom_testkit::bench::{Stopwatch, least_s};
use elbowroom_testkit::folder::model;
use elbowroom_testkit::random::Random;

use super::{Result, Surroundings};

/// Number of different states.
const STATES: usize = 64;
/// Most random values that are tried for a robot.
const TRIES: usize = 200;
/// Least number of calls, and their least time (s), of which the shortest counts.
const LEAST_CALLS: usize = 4;
const LEAST_S: f64 = 0.5;
/// Tolerance of the query, m.
const TOLERANCE_M: f64 = 0.02;
const KINDS: [QueryKind; 3] = [QueryKind::Collision, QueryKind::Tolerance(TOLERANCE_M), QueryKind::Distance];

/// A model, its scene and free states.
pub struct Workload {
    pub model: QueryModel,
    scene: Scene,
    /// Time to build the scene with proofs.
    scene_ms: f64,
    /// Values of all joints, state after state.
    states: Vec<f64>,
}

impl Workload {
    /// Loads the arms, and finds free states.
    pub fn new(surroundings: &Surroundings) -> Result<Self> {
        let urdf = model("rx60b");
        let options = LoadOptions { srdf: Some(urdf.with_extension("srdf")), ..LoadOptions::default() };
        let arm = load(&urdf, &options)?.robot;
        let arms = surroundings.bases.iter().enumerate().map(|(i, base)| (format!("arm {i}"), arm.clone(), *base));
        let mut model = QueryModel::of_robots(&urdf, arms);
        model.objects.clone_from(&surroundings.objects);
        let watch = Stopwatch::start();
        let scene = model.scene(OutOfReachProofs::Compute)?;
        let scene_ms = watch.seconds() * 1e3;
        let states = free_states(&scene, &arm)?;
        Ok(Self { model, scene, scene_ms, states })
    }

    /// Joint values of so many rows: the states over and over.
    pub fn values(&self, rows: usize) -> Vec<f64> {
        let width = self.states.len() / STATES;
        let mut values = Vec::with_capacity(rows * width);
        values.extend(self.states.iter().cycle().take(rows * width));
        values
    }

    /// Seconds of a query on one thread. `visit` is called after each block of rows.
    pub fn evaluate(&self, states: &QueryStates, kind: QueryKind, visit: &mut dyn FnMut()) -> Result<f64> {
        let (pairs, start) = (QueryPairs::all(), SceneState::new(&self.scene));
        let query = Query { threads: NonZeroUsize::new(1), ..Query::new(kind, &pairs, &start) };
        let watch = Stopwatch::start();
        evaluate_query(&self.scene, states, &query, &mut |_| {
            visit();
            true
        })?;
        Ok(watch.seconds())
    }

    /// Milliseconds to build the scene, without and with proofs; microseconds of a row of each kind, without the first
    /// checker; and the part of it that is the share of a copied checker, which is made after every [`BLOCK`] rows.
    pub fn times(&self) -> Result<[f64; 6]> {
        let watch = Stopwatch::start();
        self.model.scene(OutOfReachProofs::Omit)?;
        let scene_ms = watch.seconds() * 1e3;
        let mut state = SceneState::new(&self.scene);
        self.set(&mut state, 0)?;
        let first_s = least_s(5, || drop(std::hint::black_box(self.checker())));
        let checker = self.checker();
        let copy_s = least_s(5, || {
            checker.clone().row(&state, QueryKind::Collision);
        });
        let rows = 2 * BLOCK;
        let states = QueryStates::of_rows(&self.model, self.values(rows));
        let mut row_us = [f64::INFINITY; 3];
        for (us, kind) in row_us.iter_mut().zip(KINDS) {
            let (all, mut calls) = (Stopwatch::start(), 0);
            while calls < LEAST_CALLS || all.seconds() < LEAST_S {
                *us = us.min((self.evaluate(&states, kind, &mut || ())? - first_s) * 1e6 / rows as f64);
                calls += 1;
            }
        }
        let [collision, tolerance, distance] = row_us;
        Ok([scene_ms, self.scene_ms, collision, tolerance, distance, copy_s * 1e6 / BLOCK as f64])
    }

    /// Memory of a checker that has answered, bytes, and the mean number of allocations of its next rows of all kinds.
    pub fn memory(&self) -> Result<[f64; 2]> {
        let mut state = SceneState::new(&self.scene);
        let counter = AllocationCounter::start();
        let mut checker = self.checker();
        let mut ask = || -> Result<()> {
            for i in 0..STATES {
                self.set(&mut state, i)?;
                for kind in KINDS {
                    std::hint::black_box(checker.row(&state, kind));
                }
            }
            Ok(())
        };
        ask()?;
        let bytes = counter.held_bytes() as f64;
        let counter = AllocationCounter::start();
        ask()?;
        Ok([bytes, counter.allocations() as f64 / (STATES * KINDS.len()) as f64])
    }

    fn checker(&self) -> QueryChecker<'_> {
        QueryChecker::new(&self.scene, CheckerOptions::default(), &QueryPairs::all())
    }

    fn set(&self, state: &mut SceneState, index: usize) -> Result<()> {
        let robots = self.model.robots.len();
        let dof = self.states.len() / STATES / robots;
        for robot in 0..robots {
            let at = (index * robots + robot) * dof;
            state.set_q(&self.scene, RobotId(robot), &self.states[at..at + dof])?;
        }
        Ok(())
    }
}

/// Values of all joints in states without a collision: one robot after the other gets random values at which it is free.
fn free_states(scene: &Scene, arm: &Robot) -> Result<Vec<f64>> {
    let (mut random, mut values) = (Random(3), Vec::new());
    let mut checker = Checker::new(scene, CheckerOptions::default());
    for _ in 0..STATES {
        let mut state = SceneState::new(scene);
        for robot in (0..scene.robots().len()).map(RobotId) {
            let mut is_free = |q: &[f64]| -> Result<bool> {
                state.set_q(scene, robot, q)?;
                Ok(checker.between(Selection::Robot(robot), Selection::All).collides(&state).is_none())
            };
            values.extend(free_values(arm, &mut random, &mut is_free)?);
        }
    }
    Ok(values)
}

fn free_values(arm: &Robot, random: &mut Random, is_free: &mut dyn FnMut(&[f64]) -> Result<bool>) -> Result<Vec<f64>> {
    for _ in 0..TRIES {
        let limits = arm.chain.lower().into_iter().zip(arm.chain.upper());
        let q: Vec<f64> = limits.map(|(lower, upper)| random.between(lower, upper)).collect();
        if is_free(&q)? {
            return Ok(q);
        }
    }
    Err(format!("no free values of a robot in {TRIES} tries").into())
}
