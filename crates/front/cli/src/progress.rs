//! Progress on standard error, if it is a terminal.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Steps of a bar that shows a fraction instead of a count.
const STEPS: u64 = 1000;

/// A progress bar that appears after a delay, and only on a terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    begin: Instant,
    appears_after: Duration,
}

impl Progress {
    /// Creates a bar that counts `total` things.
    pub(crate) fn of(total: usize, things: &str) -> Self {
        Self::new(
            Some(total as u64),
            Duration::from_secs(2),
            &format!("{{bar:30}} {{pos}} of {{len}} {things}, {{msg}}"),
        )
    }

    /// Creates a bar for a fraction from 0 to 1.
    pub(crate) fn share() -> Self {
        Self::new(Some(STEPS), Duration::from_secs(2), "{bar:30} {percent} %, {msg}")
    }

    /// Creates a spinner for work of unknown length; it also turns between messages.
    pub(crate) fn unknown() -> Self {
        let progress = Self::new(None, Duration::from_millis(700), "{spinner} {msg} [{elapsed_precise}]");
        if std::io::stderr().is_terminal() {
            let (bar, appears_after) = (progress.bar.clone(), progress.appears_after);
            std::thread::spawn(move || {
                std::thread::sleep(appears_after);
                if !bar.is_finished() {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    bar.enable_steady_tick(Duration::from_millis(100));
                }
            });
        }
        progress
    }

    fn new(total: Option<u64>, appears_after: Duration, template: &str) -> Self {
        let bar = ProgressBar::with_draw_target(total, ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self { bar, begin: Instant::now(), appears_after }
    }

    /// Shows that `done` things are done, with a message and the estimated time left.
    pub(crate) fn count(&self, done: usize, message: &str) {
        self.show(done as u64, message);
    }

    /// Shows a fraction from 0 to 1, with a message and the estimated time left.
    pub(crate) fn reach(&self, share: f64, message: &str) {
        self.show((share * STEPS as f64) as u64, message);
    }

    /// Replaces the message; the position stays.
    pub(crate) fn go_on(&self, message: String) {
        self.bar.set_message(message);
    }

    fn show(&self, done: u64, message: &str) {
        if !self.is_shown() {
            return;
        }
        let all = self.bar.length().unwrap_or(0);
        let left = self.begin.elapsed().mul_f64(all.saturating_sub(done) as f64 / done.max(1) as f64);
        let left = if done == 0 { String::new() } else { format!("{} left", HumanDuration(left)) };
        let parts: Vec<&str> = [message, &left].into_iter().filter(|part| !part.is_empty()).collect();
        self.bar.set_message(parts.join(", "));
        self.bar.set_position(done);
    }

    fn is_shown(&self) -> bool {
        if self.begin.elapsed() < self.appears_after || !std::io::stderr().is_terminal() {
            return false;
        }
        if self.bar.is_hidden() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        true
    }

    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
