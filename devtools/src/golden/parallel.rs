//! Jobs on all cores, with their results in order.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Runs the jobs 0 to `count - 1` on so many threads; the results do not depend on how many. `done` is called with the number of jobs
/// done so far.
pub fn in_order<R: Send>(
    count: usize,
    threads: usize,
    job: impl Fn(usize) -> R + Sync,
    mut done: impl FnMut(usize),
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let mut results: Vec<(usize, R)> = Vec::with_capacity(count);
    std::thread::scope(|scope| {
        let (send, receive) = mpsc::channel();
        for _ in 0..threads.clamp(1, count.max(1)) {
            let (send, next, job) = (send.clone(), &next, &job);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count || send.send((index, job(index))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        for result in receive {
            results.push(result);
            done(results.len());
        }
    });
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}

/// One thread per core.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
