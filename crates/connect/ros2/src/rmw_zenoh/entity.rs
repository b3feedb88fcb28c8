//! Nodes, publishers and subscriptions: their keys and liveliness tokens.

use super::gid::Gid;
use super::names::type_in_dds;
use super::qos::Qos;
use crate::message::Message;

/// Releases of ROS 2 that differ on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Distribution {
    /// Humble, which has no type hashes.
    Humble,
    /// Jazzy and later.
    #[default]
    Jazzy,
}

/// A topic with its type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topic {
    /// Its full name, such as `/ns16/joint_states`.
    pub name: String,
    /// Its type, such as `sensor_msgs::msg::dds_::JointState_`.
    pub type_name: String,
    /// The hash of its type.
    pub type_hash: String,
}

impl Topic {
    /// Creates a topic with messages of this type. A missing leading `/` is added.
    pub fn of<M: Message>(name: &str, distribution: Distribution) -> Self {
        let type_hash = match distribution {
            Distribution::Humble => "TypeHashNotSupported".to_owned(),
            Distribution::Jazzy => M::type_hash(),
        };
        Self { name: format!("/{}", name.trim_matches('/')), type_name: type_in_dds(M::NAME), type_hash }
    }

    /// The key of its samples.
    ///
    /// ```
    /// use elbowroom_ros2::msgs::std_msgs::Text;
    /// use elbowroom_ros2::rmw_zenoh::{Distribution, Topic};
    /// let topic = Topic::of::<Text>("/chatter", Distribution::Jazzy);
    /// let hash = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";
    /// assert_eq!(topic.key(0), format!("0/chatter/std_msgs::msg::dds_::String_/{hash}"));
    /// ```
    pub fn key(&self, domain: u32) -> String {
        self.key_with(domain, &self.type_hash)
    }

    /// The key expression for publishers of every release, whatever hash they state: for types to which releases append
    /// fields.
    pub fn key_of_any_release(&self, domain: u32) -> String {
        self.key_with(domain, "*")
    }

    fn key_with(&self, domain: u32, hash: &str) -> String {
        format!("{domain}/{}/{}/{hash}", self.name.trim_matches('/'), self.type_name)
    }
}

/// A node, as `ros2 node list` shows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Node {
    /// The domain, as in `ROS_DOMAIN_ID`.
    pub domain: u32,
    /// Identity of the Zenoh session, as Zenoh prints it.
    pub session: String,
    /// Number of the node in the session.
    pub id: u64,
    /// Its namespace, `/` if it has none.
    pub namespace: String,
    /// Its name.
    pub name: String,
}

/// Kind of an endpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndpointKind {
    /// A publisher.
    Publisher,
    /// A subscription.
    Subscription,
}

/// A publisher or a subscription of a node.
#[derive(Debug, Clone, Copy)]
pub struct Endpoint<'a> {
    /// Its node.
    pub node: &'a Node,
    /// Its number in the session, different from the node's.
    pub id: u64,
    /// Its kind.
    pub kind: EndpointKind,
    /// Its topic.
    pub topic: &'a Topic,
    /// Its quality of service.
    pub qos: Qos,
}

impl Node {
    /// Its liveliness token: without it `ros2 node list` does not show the node, nor `ros2 topic list` its topics.
    pub fn token(&self) -> String {
        self.token_of(self.id, "NN")
    }

    fn token_of(&self, id: u64, kind: &str) -> String {
        let Self { domain, session, id: node, namespace, name } = self;
        let namespace = part(&format!("/{}", namespace.trim_matches('/')));
        format!("@ros2_lv/{domain}/{session}/{node}/{id}/{kind}/%/{namespace}/{}", part(name))
    }
}

impl Endpoint<'_> {
    /// Its liveliness token.
    pub fn token(&self) -> String {
        let kind = match self.kind {
            EndpointKind::Publisher => "MP",
            EndpointKind::Subscription => "MS",
        };
        let Topic { name, type_name, type_hash } = self.topic;
        let node = self.node.token_of(self.id, kind);
        format!("{node}/{}/{}/{}/{}", part(name), part(type_name), part(type_hash), self.qos.token())
    }

    /// Its identity, which its samples carry.
    pub fn gid(&self) -> Gid {
        Gid::of_token(&self.token())
    }
}

/// Encodes a part of a key: percent signs stand for slashes.
fn part(text: &str) -> String {
    if text.is_empty() { "%".to_owned() } else { text.replace('/', "%") }
}
