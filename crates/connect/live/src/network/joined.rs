//! Several networks as one.

use std::sync::Arc;

use super::pub_sub::{Handler, Network, NetworkError, Publisher, Subscription, Urgency};

/// Several networks as one: a message is published on each of them, and received from any of them.
///
/// For cells in which some controllers use Zenoh and some UDP datagrams.
///
/// ```
/// use std::sync::Arc;
/// use std::sync::atomic::{AtomicUsize, Ordering};
/// use elbowroom_live::network::{JoinedNetworks, LocalNetwork, Network, Urgency};
/// let (a, b, heard) = (LocalNetwork::default(), LocalNetwork::default(), Arc::new(AtomicUsize::new(0)));
/// let joined = JoinedNetworks::new(vec![Arc::new(a.clone()), Arc::new(b)]);
/// let count = heard.clone();
/// let _subscription = joined.subscribe("k", Box::new(move |_| { count.fetch_add(1, Ordering::SeqCst); }))?;
/// a.publisher("k", Urgency::RealTime)?.publish(b"by one of them");
/// joined.publisher("k", Urgency::RealTime)?.publish(b"by both");
/// assert_eq!(heard.load(Ordering::SeqCst), 3);
/// # Ok::<(), elbowroom_live::network::NetworkError>(())
/// ```
#[derive(Debug)]
pub struct JoinedNetworks {
    networks: Vec<Arc<dyn Network>>,
}

impl JoinedNetworks {
    /// Combines these networks.
    pub fn new(networks: Vec<Arc<dyn Network>>) -> Self {
        Self { networks }
    }
}

struct JoinedPublisher(Vec<Box<dyn Publisher>>);

impl Network for JoinedNetworks {
    fn publisher(&self, key: &str, urgency: Urgency) -> Result<Box<dyn Publisher>, NetworkError> {
        let publishers = self.networks.iter().map(|network| network.publisher(key, urgency));
        Ok(Box::new(JoinedPublisher(publishers.collect::<Result<_, _>>()?)))
    }

    fn subscribe(&self, key: &str, handler: Handler) -> Result<Subscription, NetworkError> {
        let handler = Arc::new(handler);
        let subscribe = |network: &Arc<dyn Network>| {
            let handler = handler.clone();
            network.subscribe(key, Box::new(move |bytes: &[u8]| handler(bytes)))
        };
        let subscriptions = self.networks.iter().map(subscribe).collect::<Result<Vec<_>, _>>()?;
        Ok(Subscription::new(subscriptions))
    }
}

impl Publisher for JoinedPublisher {
    fn publish(&mut self, bytes: &[u8]) {
        self.0.iter_mut().for_each(|publisher| publisher.publish(bytes));
    }
}
