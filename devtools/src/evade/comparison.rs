//! Comparison of a run without avoidance and with it.

use elbowroom_cell::{Cell, Drive, ObjectPath};
use elbowroom_robot::ObjectId;
use elbowroom_sim::run::simulate;
use elbowroom_sim::{Recording, RunOptions};
use rayon::prelude::*;

/// The runs of one object path, without avoidance and with it.
pub struct RunComparison {
    pub number: usize,
    pub off: Recording,
    pub on: Recording,
}

/// Makes the chosen runs, in parallel; returns them in order.
pub fn compare(
    cell: &Cell,
    object: ObjectId,
    paths: &[ObjectPath],
    chosen: &[usize],
) -> Result<Vec<RunComparison>, String> {
    let of_run = |&number: &usize| {
        let mut cell = cell.clone();
        let drive = Drive::Path(paths[number].clone());
        cell.moving_objects.iter_mut().filter(|m| m.object == object).for_each(|m| m.drive = drive.clone());
        let run = |avoidance| simulate(&cell, &RunOptions { avoidance, ..RunOptions::default() });
        let off = run(false).map_err(|e| e.to_string())?.recording;
        let on = run(true).map_err(|e| e.to_string())?.recording;
        Ok(RunComparison { number, off, on })
    };
    chosen.par_iter().with_max_len(1).map(of_run).collect()
}
