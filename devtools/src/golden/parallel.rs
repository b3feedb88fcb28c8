//! Jobs on all cores, with their results in order.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::progress::Progress;

/// Runs the jobs 0 to `count - 1`; the results do not depend on the number of threads. `step` names a job in the progress.
pub fn in_order<R: Send>(count: usize, progress: Progress, step: &str, job: impl Fn(usize) -> R + Sync) -> Vec<R> {
    let progress = Mutex::new((progress, 0));
    let run = |index| {
        let result = job(index);
        let (progress, done) = &mut *progress.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        progress.done(*done, step);
        result
    };
    (0..count).into_par_iter().with_max_len(1).map(run).collect()
}
