//! Network within one process, for tests.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, Weak};

use super::pub_sub::{Handler, Network, NetworkError, Publisher, Subscription, Urgency};
use crate::locked::locked;

/// A network within one process. Clones are the same network.
///
/// ```
/// use std::sync::atomic::{AtomicUsize, Ordering};
/// use std::sync::Arc;
/// use elbowroom_live::network::{LocalNetwork, Network, Urgency};
/// let (network, bytes) = (LocalNetwork::default(), Arc::new(AtomicUsize::new(0)));
/// let sum = bytes.clone();
/// let subscription = network.subscribe("a/b", Box::new(move |m| { sum.fetch_add(m.len(), Ordering::SeqCst); }))?;
/// let mut publisher = network.publisher("a/b", Urgency::RealTime)?;
/// publisher.publish(b"four");
/// drop(subscription);
/// publisher.publish(b"nobody listens");
/// assert_eq!(bytes.load(Ordering::SeqCst), 4);
/// # Ok::<(), elbowroom_live::network::NetworkError>(())
/// ```
#[derive(Clone, Default)]
pub struct LocalNetwork {
    handlers: Arc<Mutex<HashMap<String, Vec<Weak<Handler>>>>>,
}

impl std::fmt::Debug for LocalNetwork {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("LocalNetwork")
    }
}

struct LocalPublisher {
    network: LocalNetwork,
    key: String,
}

impl Network for LocalNetwork {
    fn publisher(&self, key: &str, _: Urgency) -> Result<Box<dyn Publisher>, NetworkError> {
        Ok(Box::new(LocalPublisher { network: self.clone(), key: key.to_owned() }))
    }

    fn subscribe(&self, key: &str, handler: Handler) -> Result<Subscription, NetworkError> {
        let handler = Arc::new(handler);
        let mut handlers = locked(&self.handlers);
        handlers.entry(key.to_owned()).or_default().push(Arc::downgrade(&handler));
        Ok(Subscription::new(handler))
    }
}

impl Publisher for LocalPublisher {
    fn publish(&mut self, bytes: &[u8]) {
        // The lock is released before the handlers are called, as a handler may publish.
        let handlers: Vec<Arc<Handler>> = {
            let mut all = locked(&self.network.handlers);
            let Some(handlers) = all.get_mut(&self.key) else { return };
            handlers.retain(|handler| handler.strong_count() > 0);
            handlers.iter().filter_map(Weak::upgrade).collect()
        };
        for handler in handlers {
            handler(bytes);
        }
    }
}
