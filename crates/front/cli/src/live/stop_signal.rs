//! Ctrl-C.

use std::sync::mpsc::{self, Receiver};

use crate::output::Failure;

/// Returns a receiver that gets a message when the process is asked to end.
pub(super) fn stop_signal() -> Result<Receiver<()>, Failure> {
    let (stop, stopped) = mpsc::channel();
    // The receiver is gone only when the process ends.
    let handler = move || {
        let _ = stop.send(());
    };
    ctrlc::set_handler(handler).map_err(|e| Failure::Wrong(format!("Ctrl-C cannot be handled: {e}")))?;
    Ok(stopped)
}
