//! Events for whoever runs a service.

use std::sync::Arc;

/// Called with every event, in words.
pub type EventHandler = Arc<dyn Fn(&str) + Send + Sync>;
