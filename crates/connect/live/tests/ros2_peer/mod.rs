//! The other side: a session like that of a ROS 2 node with `rmw_zenoh`, which shares no code with the service.

use std::sync::{Arc, Mutex};
use std::time::{SystemTime, UNIX_EPOCH};

use zenoh::pubsub::Publisher;
use zenoh::{Session, Wait};
use zenoh_ext::{AdvancedSubscriber, AdvancedSubscriberBuilderExt, HistoryConfig, RecoveryConfig};

pub const JOINT_STATE_HASH: &str = "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e";
pub const FACTOR_HASH: &str = "RIHS01_0c240f349f2b74e33e8741f83e0f196ddeb6585923663876ed3c1f51f0566037";

/// Payloads with their attachments.
pub type Samples = Arc<Mutex<Vec<Vec<u8>>>>;

/// Factors with their attachments.
type Factors = Arc<Mutex<Vec<(f64, Vec<u8>)>>>;

/// A session.
pub struct Peer {
    session: Session,
    address: String,
    kept: Mutex<Vec<Box<dyn std::any::Any + Send>>>,
}

impl Peer {
    pub fn at(address: &str) -> Self {
        let mut config = zenoh::Config::default();
        for (key, value) in [
            ("mode", "\"client\"".to_owned()),
            ("connect/endpoints", format!("[\"tcp/{address}\"]")),
            ("scouting/multicast/enabled", "false".to_owned()),
            ("timestamping/enabled", "true".to_owned()),
        ] {
            config.insert_json5(key, &value).expect("an entry");
        }
        let session = zenoh::open(config).wait().expect("a session");
        Self { session, address: address.to_owned(), kept: Mutex::default() }
    }

    /// Returns all liveliness tokens of domain 0.
    pub fn tokens(&self) -> Vec<String> {
        let replies = self.session.liveliness().get("@ros2_lv/0/**").wait().expect("a query");
        let tokens = std::iter::from_fn(|| replies.recv().ok());
        tokens.filter_map(|reply| reply.result().ok().map(|sample| sample.key_expr().to_string())).collect()
    }

    /// Subscribes to a volatile topic as `rmw_zenoh` does.
    pub fn volatile(&self, key: &str) -> Samples {
        let (samples, callback) = collector();
        let subscriber = self.session.declare_subscriber(key.to_owned()).callback(callback).wait().expect("a key");
        self.kept.lock().unwrap().push(Box::new(subscriber));
        samples
    }

    /// Subscribes to a transient local, reliable topic with depth 1 as `rmw_zenoh` does.
    pub fn transient_local(&self, key: &str) -> Samples {
        let (samples, callback) = collector();
        self.kept.lock().unwrap().push(Box::new(latched(&self.session, key, callback)));
        samples
    }

    /// Starts a controller of this robot, with its own session.
    pub fn controller(&self, robot: &str) -> Controller {
        self.controller_of_hash(robot, JOINT_STATE_HASH)
    }

    /// Starts a controller that states another hash for its joint states.
    pub fn controller_of_hash(&self, robot: &str, hash: &str) -> Controller {
        let session = Self::at(&self.address).session;
        let key = format!("0/{robot}/joint_states/sensor_msgs::msg::dds_::JointState_/{hash}");
        let publisher = session.declare_publisher(key).wait().expect("a key");
        let factors = Factors::default();
        let taken = factors.clone();
        let key = format!("0/{robot}/speed_scaling_input/control_msgs::msg::dds_::SpeedScalingFactor_/{FACTOR_HASH}");
        let factors_of = latched(&session, &key, move |sample: zenoh::sample::Sample| {
            let payload = sample.payload().to_bytes();
            let bytes: [u8; 12] = payload.as_ref().try_into().expect("four bytes and a number");
            assert_eq!(bytes[..4], [0, 1, 0, 0]);
            let factor = f64::from_le_bytes(bytes[4..].try_into().expect("eight bytes"));
            assert!((0.0..=1.0).contains(&factor), "{factor}");
            let attachment = sample.attachment().expect("an attachment").to_bytes().to_vec();
            taken.lock().unwrap().push((factor, attachment));
        });
        let source = session.zid().to_le_bytes();
        Controller {
            publisher,
            factors,
            source,
            sequence: 0,
            last_attachment: Vec::new(),
            address: self.address.clone(),
            _subscriber: factors_of,
            _session: session,
        }
    }
}

fn collector() -> (Samples, impl Fn(zenoh::sample::Sample) + Send + Sync + 'static) {
    let samples = Samples::default();
    let taken = samples.clone();
    (samples, move |sample: zenoh::sample::Sample| taken.lock().unwrap().push(sample.payload().to_bytes().to_vec()))
}

fn latched(
    session: &Session,
    key: &str,
    callback: impl Fn(zenoh::sample::Sample) + Send + Sync + 'static,
) -> AdvancedSubscriber<()> {
    session
        .declare_subscriber(key.to_owned())
        .callback(callback)
        .history(HistoryConfig::default().detect_late_publishers().max_samples(1))
        .recovery(RecoveryConfig::default().heartbeat())
        .subscriber_detection()
        .wait()
        .expect("a key")
}

/// A controller that publishes joint states and obeys factors.
pub struct Controller {
    publisher: Publisher<'static>,
    factors: Factors,
    source: [u8; 16],
    sequence: i64,
    last_attachment: Vec<u8>,
    pub address: String,
    _subscriber: AdvancedSubscriber<()>,
    _session: Session,
}

impl Controller {
    /// Sends a message as a publisher of `rmw_zenoh` does.
    pub fn send(&mut self, payload: &[u8]) {
        self.sequence += 1;
        let stamp_ns = SystemTime::now().duration_since(UNIX_EPOCH).expect("a time").as_nanos() as i64;
        let mut attachment = Vec::new();
        attachment.extend_from_slice(&self.sequence.to_le_bytes());
        attachment.extend_from_slice(&stamp_ns.to_le_bytes());
        attachment.push(16);
        attachment.extend_from_slice(&self.source);
        self.send_with(payload, Some(&attachment));
        self.last_attachment = attachment;
    }

    pub fn send_with(&mut self, payload: &[u8], attachment: Option<&[u8]>) {
        let put = self.publisher.put(payload);
        match attachment {
            Some(attachment) => put.attachment(attachment).wait(),
            None => put.wait(),
        }
        .expect("it is sent");
    }

    pub fn last_attachment(&self) -> Vec<u8> {
        self.last_attachment.clone()
    }

    pub fn last_factor(&self) -> Option<f64> {
        self.factors.lock().unwrap().last().map(|(factor, _)| *factor)
    }

    pub fn factors(&self) -> Vec<f64> {
        self.factors.lock().unwrap().iter().map(|(factor, _)| *factor).collect()
    }

    pub fn attachments(&self) -> Vec<Vec<u8>> {
        self.factors.lock().unwrap().iter().map(|(_, attachment)| attachment.clone()).collect()
    }

    pub fn clear(&mut self) {
        self.factors.lock().unwrap().clear();
    }
}

/// Encodes `sensor_msgs/JointState` in CDR by hand: stamp 0, no frame.
pub fn cdr_joint_state(names: &[&str], position: &[f64], velocity: &[f64]) -> Vec<u8> {
    let mut contents = vec![0; 8];
    let count = |contents: &mut Vec<u8>, count: usize| {
        contents.resize(contents.len().next_multiple_of(4), 0);
        contents.extend_from_slice(&(count as u32).to_le_bytes());
    };
    count(&mut contents, 1);
    contents.push(0);
    count(&mut contents, names.len());
    for name in names {
        count(&mut contents, name.len() + 1);
        contents.extend_from_slice(name.as_bytes());
        contents.push(0);
    }
    for values in [position, velocity, &[]] {
        count(&mut contents, values.len());
        if !values.is_empty() {
            contents.resize(contents.len().next_multiple_of(8), 0);
        }
        contents.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }
    [&[0, 1, 0, 0], &contents[..]].concat()
}
