//! Sender of a robot's speed scaling to its controller, on its own thread.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::control_msgs::SpeedScalingFactor;

use super::session::RosPublisher;
use crate::locked::locked;

/// Interval at which an unchanged factor is repeated, for watchdogs and for controllers that count the time since the
/// last one.
const REPEAT: Duration = Duration::from_millis(20);
/// Interval of checks whether an answer has become too old, if no new one arrives.
const POLL: Duration = Duration::from_millis(5);

/// Computes the present factor: 0 without a fresh answer of the node.
pub(super) type CurrentFactor = Box<dyn Fn() -> f64 + Send>;

/// Sends the factor when it changes, and repeats it periodically. When the sender is dropped, the last factor is 0.
pub(super) struct SpeedScaling {
    wake: Wake,
    thread: Option<JoinHandle<()>>,
}

/// Wakes the sending thread. Clones wake the same thread.
#[derive(Debug, Clone, Default)]
pub(super) struct Wake(Arc<(Mutex<Signal>, Condvar)>);

#[derive(Debug, Default)]
struct Signal {
    is_news: bool,
    is_closed: bool,
}

impl Wake {
    /// Signals that the factor may have changed.
    pub(super) fn notify(&self) {
        self.change(|signal| signal.is_news = true);
    }

    fn change(&self, change: impl FnOnce(&mut Signal)) {
        change(&mut locked(&self.0.0));
        self.0.1.notify_one();
    }

    /// Waits for a signal for a short time. False at the end.
    fn wait(&self) -> bool {
        let signal = locked(&self.0.0);
        let is_idle = |signal: &mut Signal| !signal.is_news && !signal.is_closed;
        let waited = self.0.1.wait_timeout_while(signal, POLL, is_idle);
        let mut signal = waited.unwrap_or_else(PoisonError::into_inner).0;
        signal.is_news = false;
        !signal.is_closed
    }
}

impl SpeedScaling {
    pub(super) fn start(mut publisher: RosPublisher, wake: Wake, factor: CurrentFactor) -> Self {
        let waiting = wake.clone();
        let run = move || {
            let mut bytes = Vec::new();
            let mut send = |factor: f64| {
                SpeedScalingFactor { factor }.encode_into(&mut bytes);
                publisher.publish(&bytes);
            };
            let mut sent: Option<(f64, Instant)> = None;
            while waiting.wait() {
                let factor = allowed(factor());
                if sent.is_none_or(|(last, at)| last != factor || at.elapsed() >= REPEAT) {
                    send(factor);
                    sent = Some((factor, Instant::now()));
                }
            }
            send(0.0);
        };
        let thread = std::thread::Builder::new().name("speed scaling".into()).spawn(run);
        Self { wake, thread: thread.ok() }
    }
}

impl Drop for SpeedScaling {
    fn drop(&mut self) {
        self.wake.change(|signal| signal.is_closed = true);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked sends nothing more: the watchdog handles that.
            let _ = thread.join();
        }
    }
}

/// Returns the factor if it is a number in 0..1, else 0.
fn allowed(factor: f64) -> f64 {
    if (0.0..=1.0).contains(&factor) { factor } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::allowed;

    #[test]
    fn what_is_no_factor_is_zero() {
        assert_eq!([0.0, 0.5, 1.0].map(allowed), [0.0, 0.5, 1.0]);
        assert_eq!([-0.1, 1.1, f64::NAN, f64::INFINITY].map(allowed), [0.0; 4]);
    }
}
