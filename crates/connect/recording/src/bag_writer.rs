//! Writer of messages to an MCAP file.

use std::collections::{BTreeMap, HashMap};
use std::io::{BufWriter, Seek, Write};

use elbowroom_ros2::Message;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, WriteOptions, Writer};

use crate::BagError;

/// Size of a chunk, bytes: at most the last chunk is lost.
const CHUNK_BYTES: u64 = 1 << 20;

/// An MCAP file with the profile `ros2`: CDR messages with `ros2msg` schemas.
pub(crate) struct BagWriter<W: Write + Seek> {
    writer: Writer<BufWriter<W>>,
    channels: HashMap<String, Channel>,
    /// Payload of the message that is being written.
    payload: Vec<u8>,
}

struct Channel {
    id: u16,
    sequence: u32,
}

impl<W: Write + Seek> BagWriter<W> {
    pub(crate) fn new(file: W) -> Result<Self, BagError> {
        let writer = WriteOptions::new()
            .profile("ros2")
            .library(concat!("elbowroom ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(CHUNK_BYTES))
            // A complete chunk is written as a whole: a file that is cut off ends with a whole chunk or a part of one.
            .disable_seeking(true)
            .create(BufWriter::new(file))
            .map_err(BagError::Write)?;
        Ok(Self { writer, channels: HashMap::new(), payload: Vec::new() })
    }

    /// Writes a message. Times are in nanoseconds.
    pub(crate) fn write<M: Message>(&mut self, topic: &str, time_ns: u64, message: &M) -> Result<(), BagError> {
        if !self.channels.contains_key(topic) {
            let id = self.add_channel::<M>(topic)?;
            self.channels.insert(topic.to_owned(), Channel { id, sequence: 0 });
        }
        let Some(channel) = self.channels.get_mut(topic) else { return Ok(()) };
        message.encode_into(&mut self.payload);
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        channel.sequence = channel.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, &self.payload).map_err(BagError::Write)
    }

    fn add_channel<M: Message>(&mut self, topic: &str) -> Result<u16, BagError> {
        let schema = self.writer.add_schema(M::NAME, "ros2msg", M::schema().as_bytes()).map_err(BagError::Write)?;
        let latched = ["/robot_description", "/tf_static", "/elbowroom/configuration"].contains(&topic);
        // As rosbag2 writes it, so that it plays the last message to later subscribers.
        let durability = if latched { "transient_local" } else { "volatile" };
        let qos = format!(
            "- history: keep_last\n  depth: 1\n  reliability: reliable\n  durability: {durability}\n  deadline:\n    sec: 0\n    \
             nsec: 0\n  lifespan:\n    sec: 0\n    nsec: 0\n  liveliness: automatic\n  liveliness_lease_duration:\n    \
             sec: 0\n    nsec: 0\n  avoid_ros_namespace_conventions: false\n"
        );
        let about =
            BTreeMap::from([("offered_qos_profiles".to_owned(), qos), ("topic_type_hash".to_owned(), M::type_hash())]);
        self.writer.add_channel(schema, topic, "cdr", &about).map_err(BagError::Write)
    }

    pub(crate) fn attach(&mut self, name: &str, media_type: &str, time_ns: u64, bytes: &[u8]) -> Result<(), BagError> {
        let attachment = Attachment {
            log_time: time_ns,
            create_time: time_ns,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: bytes.into(),
        };
        self.writer.attach(&attachment).map_err(BagError::Write)
    }

    pub(crate) fn metadata(&mut self, name: &str, values: BTreeMap<String, String>) -> Result<(), BagError> {
        self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata: values }).map_err(BagError::Write)
    }

    /// Completes the chunk and passes it to the operating system: everything written before survives the end of the
    /// process.
    pub(crate) fn flush(&mut self) -> Result<(), BagError> {
        self.writer.flush().map_err(BagError::Write)
    }

    /// Writes the index.
    pub(crate) fn finish(mut self) -> Result<(), BagError> {
        self.writer.finish().map(|_| ()).map_err(BagError::Write)
    }
}
