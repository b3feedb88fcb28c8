//! Node of ROS 2 on Zenoh, in the layout of `rmw_zenoh`.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use elbowroom_ros2::rmw_zenoh::{Attachment, Durability, Endpoint, EndpointKind, Gid, Node, Qos, Reliability, Topic};
use zenoh::liveliness::LivelinessToken;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Session, Wait};
use zenoh_ext::{AdvancedPublisher, AdvancedPublisherBuilderExt, CacheConfig, MissDetectionConfig};

use crate::network::{NetworkError, Subscription, Urgency, ZenohSettings, open_session};

/// Interval at which the publisher of a transient local topic announces its last sample, if it has sent one since: as
/// `rmw_zenoh_cpp` does.
const HEARTBEAT: Duration = Duration::from_millis(500);

/// A session with one node.
pub struct RosSession {
    session: Session,
    node: Node,
    next_id: AtomicU64,
    _token: LivelinessToken,
}

/// Publishes a topic. It leaves the graph when it is dropped.
pub struct RosPublisher {
    publisher: AdvancedPublisher<'static>,
    gid: Gid,
    sequence: i64,
    _token: LivelinessToken,
}

/// A sample that a subscription receives.
#[derive(Debug, Clone, Copy)]
pub struct RosSample<'a> {
    /// The message, in CDR.
    pub payload: &'a [u8],
    /// The attachment; every publisher of ROS 2 sends one.
    pub attachment: Option<&'a [u8]>,
}

/// Called with each sample, on a thread of the network: it must return soon.
pub type RosHandler = Box<dyn Fn(RosSample<'_>) + Send + Sync>;

impl fmt::Debug for RosSession {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RosSession {}", self.node.token())
    }
}

impl RosSession {
    /// Opens a session at a router, with a node of this name. Waits until the router is there.
    ///
    /// # Errors
    /// [`NetworkError`] if the address cannot be used.
    pub fn open(router: &str, domain: u32, name: &str) -> Result<Self, NetworkError> {
        let settings = ZenohSettings { listen: None, connect: Some(router.to_owned()) };
        // As in the sessions of ROS 2: caches order samples by their times.
        let session = open_session(&settings, &[("timestamping/enabled", "true")])?;
        let node =
            Node { domain, session: session.zid().to_string(), id: 0, namespace: "/".into(), name: name.to_owned() };
        let token = declare_token(&session, node.token())?;
        Ok(Self { session, node, next_id: AtomicU64::new(1), _token: token })
    }

    /// Publishes a topic.
    ///
    /// # Errors
    /// [`NetworkError::Key`].
    pub fn publisher(&self, topic: &Topic, qos: Qos, urgency: Urgency) -> Result<RosPublisher, NetworkError> {
        let (key, is_urgent) = (topic.key(self.node.domain), urgency == Urgency::RealTime);
        let builder = self
            .session
            .declare_publisher(key.clone())
            .congestion_control(CongestionControl::Drop)
            .priority(if is_urgent { Priority::RealTime } else { Priority::DataLow })
            .express(is_urgent)
            .advanced();
        let builder = match (qos.durability, qos.reliability) {
            (Durability::Volatile, _) => builder,
            (Durability::TransientLocal, reliability) => {
                let builder = builder.publisher_detection().cache(CacheConfig::default().max_samples(qos.depth));
                match reliability {
                    Reliability::BestEffort => builder,
                    Reliability::Reliable => {
                        builder.sample_miss_detection(MissDetectionConfig::default().sporadic_heartbeat(HEARTBEAT))
                    }
                }
            }
        };
        let publisher = builder.wait().map_err(|e| NetworkError::Key { key, why: e.to_string() })?;
        let (gid, token) = self.declare(topic, EndpointKind::Publisher, qos)?;
        Ok(RosPublisher { publisher, gid, sequence: 0, _token: token })
    }

    /// Calls the handler with each sample of a topic, until the subscription is dropped.
    ///
    /// Samples of publishers that state another hash of the type are received only with `any_release`.
    ///
    /// # Errors
    /// [`NetworkError::Key`].
    pub fn subscribe(
        &self,
        topic: &Topic,
        qos: Qos,
        any_release: bool,
        handler: RosHandler,
    ) -> Result<Subscription, NetworkError> {
        let domain = self.node.domain;
        let key = if any_release { topic.key_of_any_release(domain) } else { topic.key(domain) };
        let callback = move |sample: zenoh::sample::Sample| {
            let attachment = sample.attachment().map(zenoh::bytes::ZBytes::to_bytes);
            handler(RosSample { payload: &sample.payload().to_bytes(), attachment: attachment.as_deref() });
        };
        let subscriber = self.session.declare_subscriber(key.clone()).callback(callback).wait();
        let subscriber = subscriber.map_err(|e| NetworkError::Key { key, why: e.to_string() })?;
        let (_, token) = self.declare(topic, EndpointKind::Subscription, qos)?;
        Ok(Subscription::new((subscriber, token)))
    }

    fn declare(&self, topic: &Topic, kind: EndpointKind, qos: Qos) -> Result<(Gid, LivelinessToken), NetworkError> {
        let id = self.next_id.fetch_add(1, Ordering::Relaxed);
        let endpoint = Endpoint { node: &self.node, id, kind, topic, qos };
        Ok((endpoint.gid(), declare_token(&self.session, endpoint.token())?))
    }
}

fn declare_token(session: &Session, key: String) -> Result<LivelinessToken, NetworkError> {
    let token = session.liveliness().declare_token(key.clone()).wait();
    token.map_err(|e| NetworkError::Key { key, why: e.to_string() })
}

impl RosPublisher {
    /// Sends a message, without a guarantee. A message that cannot be sent now is superseded by the next one.
    pub fn publish(&mut self, payload: &[u8]) {
        self.sequence += 1;
        let attachment = Attachment { sequence: self.sequence, stamp_ns: nanoseconds_since_1970(), source: self.gid };
        let _ = self.publisher.put(payload).attachment(&attachment.encode()[..]).wait();
    }

    /// Identity of the publisher.
    pub fn gid(&self) -> Gid {
        self.gid
    }
}

/// Time of day in the form of ROS 2 stamps.
pub(super) fn nanoseconds_since_1970() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}
