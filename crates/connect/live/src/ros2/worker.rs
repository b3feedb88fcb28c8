//! Thread that waits for the router of ROS 2, so that nothing else of the process has to wait.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use super::session::RosSession;
use super::settings::Ros2Settings;
use crate::event_handler::EventHandler;
use crate::network::NetworkError;

/// Opens a session and runs a function with it.
pub(super) struct Worker {
    is_opened: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread. `run` is called when the router is there, and must end when its owner is dropped.
    pub(super) fn start(
        settings: &Ros2Settings,
        node: &'static str,
        on_event: Option<EventHandler>,
        run: impl FnOnce(&RosSession) -> Result<(), NetworkError> + Send + 'static,
    ) -> Self {
        let is_opened = Arc::new(AtomicBool::new(false));
        let (opened, router, domain) = (is_opened.clone(), settings.router().to_owned(), settings.domain);
        let work = move || {
            let result = RosSession::open(&router, domain, node).and_then(|session| {
                opened.store(true, Ordering::SeqCst);
                run(&session)
            });
            if let (Err(error), Some(on_event)) = (result, on_event) {
                on_event(&format!("ROS 2: {error}"));
            }
        };
        let thread = std::thread::Builder::new().name("ros2".into()).spawn(work);
        Self { is_opened, thread: thread.ok() }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // Without a router, the thread waits for it until the process ends.
        if let Some(thread) = self.thread.take()
            && self.is_opened.load(Ordering::SeqCst)
        {
            let _ = thread.join();
        }
    }
}
