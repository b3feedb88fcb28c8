//! Places of the robots of a cell without regions at some time.

use std::path::Path;

use elbowroom_cell::Cell;
use elbowroom_sim::{RunOptions, simulate};
use elbowroom_spatial::Vec3;

use crate::fuzz_cells::oracle::{Arm, Guarded};
use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::CellSpec;

/// Tick that is exact enough for an encounter, and fast, ms.
const TICK_MS: f64 = 20.0;

/// A time at which the first robot moves, and the places of the robots then.
pub struct Encounter {
    pub cell: Cell,
    pub t_s: f64,
    /// Joint values of all robots.
    pub q: Vec<Vec<f64>>,
    /// A point on or near one of the guarded solids of the first robot.
    pub place: Vec3,
}

impl Encounter {
    /// Finds an encounter; `None` if the cell is refused or its first robot does not move.
    pub fn new(spec: &CellSpec, folder: &Path, random: &mut Random) -> Option<Self> {
        let alone = CellSpec { tick_ms: TICK_MS, regions: Vec::new(), ..spec.clone() };
        let cell = alone.parse(folder).ok()?;
        let robots = simulate(&cell, &RunOptions::default()).ok()?.recording.robots;
        let samples = &robots[0].samples;
        let moving: Vec<usize> = (1..samples.len()).filter(|k| samples[*k].q != samples[k - 1].q).collect();
        let tick = *moving.get(random.whole(0, moving.len().checked_sub(1)?))?;
        let q: Vec<Vec<f64>> = robots.iter().map(|r| r.samples[tick].q.clone()).collect();
        let guarded = Guarded::all(&cell.robots[0]);
        let one = &guarded[random.whole(0, guarded.len() - 1)];
        let [x, y, z] = random.vector(0.1);
        let place = one.center(&Arm::new(&cell.robots[0]).frames(&q[0])) + Vec3::new(x, y, z);
        Some(Self { t_s: samples[tick].t_s, q, place, cell })
    }
}
