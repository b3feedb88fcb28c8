//! Handler of a service's events.

use std::sync::Arc;

/// Called with the text of every event.
pub type EventHandler = Arc<dyn Fn(&str) + Send + Sync>;
