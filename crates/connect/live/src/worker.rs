//! A thread that repeats one step until it is told to end.

use std::thread::JoinHandle;
use std::time::Duration;

use crate::clock::Clock;

/// The work of a thread: waits for input, at most for this time, and handles it. False at the end.
pub(crate) type Step = Box<dyn FnMut(Duration) -> bool + Send>;

#[cfg(test)]
thread_local! {
    static ADOPTED: std::cell::RefCell<Vec<Step>> = const { std::cell::RefCell::new(Vec::new()) };
}

/// The work of the workers that a simulated process has started since the last call: its simulation makes their steps.
#[cfg(test)]
pub(crate) fn take_adopted() -> Vec<Step> {
    ADOPTED.take()
}

/// A thread of a process. Its owner ends it by the input, and then drops the worker, which waits for the end.
#[derive(Debug)]
pub(crate) struct Worker(Option<JoinHandle<()>>);

impl Worker {
    /// Starts the thread. Without input for `longest` a step is made all the same.
    ///
    /// # Panics
    /// If the system cannot start a thread.
    pub(crate) fn start(name: &str, clock: Clock, longest: Duration, step: Step) -> Self {
        #[cfg(test)]
        if clock.is_simulated() {
            ADOPTED.with_borrow_mut(|adopted| adopted.push(step));
            return Self(None);
        }
        let _ = clock;
        let mut step = step;
        let repeat = move || while step(longest) {};
        let thread = std::thread::Builder::new().name(name.into()).spawn(repeat);
        Self(Some(thread.expect("the system gives no thread")))
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        if let Some(thread) = self.0.take() {
            // A thread that panicked has ended already.
            let _ = thread.join();
        }
    }
}
