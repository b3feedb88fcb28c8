//! The same run without avoidance and with it.

use std::sync::atomic::{AtomicUsize, Ordering};

use elbowroom_cell::{Cell, Drive, ObjectPath};
use elbowroom_robot::ObjectId;
use elbowroom_sim::run::simulate;
use elbowroom_sim::{Recording, RunOptions};

/// The runs of one object path, without avoidance and with it.
pub struct RunComparison {
    pub number: usize,
    pub off: Recording,
    pub on: Recording,
}

/// The chosen runs, in parallel, in order.
pub fn compare(
    cell: &Cell,
    object: ObjectId,
    paths: &[ObjectPath],
    chosen: &[usize],
) -> Result<Vec<RunComparison>, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let work = || {
        let (mut mine, mut cell) = (Vec::new(), cell.clone());
        while let Some(&number) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
            let drive = Drive::Path(paths[number].clone());
            cell.moving_objects.iter_mut().filter(|m| m.object == object).for_each(|m| m.drive = drive.clone());
            let run = |avoidance| simulate(&cell, &RunOptions { avoidance, ..RunOptions::default() });
            let comparison =
                run(false).and_then(|off| Ok(RunComparison { number, off: off.recording, on: run(true)?.recording }));
            mine.push(comparison.map_err(|e| e.to_string()));
        }
        mine
    };
    let all = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|t| t.join().expect("a run does not panic")).collect::<Result<Vec<_>, String>>()
    });
    let mut all = all?;
    all.sort_by_key(|comparison| comparison.number);
    Ok(all)
}
