//! Reader of an MCAP file, from beginning to end, in the order of writing.

use std::collections::{BTreeMap, HashMap};
use std::io::Read;

use crate::records::{self, Framed, MAGIC, Record};
use crate::{BagError, Damage};

/// A message of a recording.
#[derive(Debug, Clone)]
pub struct BagMessage {
    /// Number of the message in the file, from 0.
    pub index: u64,
    /// Its topic.
    pub topic: String,
    /// Name of its type, such as `sensor_msgs/msg/JointState`; empty if the file does not name it.
    pub message_type: String,
    /// Time of recording, ns.
    pub time_ns: u64,
    /// Its payload.
    pub payload: Vec<u8>,
}

/// An MCAP file as a stream of messages.
///
/// A chunk is checked before its messages are returned; a file that ends early returns the messages that it has, and
/// [`BagReader::is_cut_off`] is then true.
pub struct BagReader<R: Read> {
    file: R,
    /// The present chunk.
    chunk: Vec<u8>,
    at: usize,
    schemas: HashMap<u16, String>,
    /// Topic and type of each channel.
    channels: HashMap<u16, (String, String)>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    attachments: Vec<String>,
    messages: u64,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Begin,
    Data,
    End,
    CutOff,
}

impl<R: Read> BagReader<R> {
    /// Creates a reader of a file.
    pub fn new(file: R) -> Self {
        Self {
            file,
            chunk: Vec::new(),
            at: 0,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            metadata: BTreeMap::new(),
            attachments: Vec::new(),
            messages: 0,
            state: State::Begin,
        }
    }

    /// Returns the next message; `None` at the end.
    ///
    /// # Errors
    /// [`BagError::Foreign`] and [`BagError::Damaged`].
    pub fn next_message(&mut self) -> Result<Option<BagMessage>, BagError> {
        if self.state == State::Begin {
            self.begin()?;
        }
        while self.state == State::Data {
            let messages = self.messages;
            let found = if self.at < self.chunk.len() { self.next_in_chunk() } else { self.next_in_file() };
            if let Some(message) = found.map_err(|source| BagError::Damaged { messages, source })? {
                return Ok(Some(message));
            }
        }
        Ok(None)
    }

    fn begin(&mut self) -> Result<(), BagError> {
        let mut magic = Vec::new();
        let read = (&mut self.file).take(MAGIC.len() as u64).read_to_end(&mut magic);
        read.map_err(|e| BagError::Damaged { messages: 0, source: Damage::Unreadable(e) })?;
        if magic != MAGIC {
            return Err(BagError::Foreign);
        }
        self.state = State::Data;
        Ok(())
    }

    fn next_in_file(&mut self) -> Result<Option<BagMessage>, Damage> {
        match records::next(&mut self.file)? {
            Framed::CutOff => {
                self.state = State::CutOff;
                Ok(None)
            }
            Framed::Record { opcode, body } => {
                let record = records::parse(opcode, &body)?;
                self.take(record)
            }
        }
    }

    fn next_in_chunk(&mut self) -> Result<Option<BagMessage>, Damage> {
        let chunk = std::mem::take(&mut self.chunk);
        let (opcode, body, rest) = records::first(&chunk[self.at..])?;
        let at = chunk.len() - rest.len();
        let found = match records::parse(opcode, body)? {
            Record::Chunk(_) => return Err(Damage::NestedChunk),
            record => self.take(record),
        };
        (self.chunk, self.at) = (chunk, at);
        found
    }

    fn take(&mut self, record: Record<'_>) -> Result<Option<BagMessage>, Damage> {
        match record {
            Record::Message { channel, time_ns, payload } => {
                let known = self.channels.get(&channel).cloned();
                let (topic, message_type) = known.ok_or(Damage::Channel(channel))?;
                let index = self.messages;
                self.messages += 1;
                return Ok(Some(BagMessage { index, topic, message_type, time_ns, payload: payload.to_vec() }));
            }
            Record::Schema { id, name } => _ = self.schemas.insert(id, name.to_owned()),
            Record::Channel { id, schema, topic } => {
                let message_type = self.schemas.get(&schema).cloned().unwrap_or_default();
                self.channels.insert(id, (topic.to_owned(), message_type));
            }
            Record::Chunk(contents) => (self.chunk, self.at) = (contents, 0),
            Record::Metadata { name, values } => {
                let values = values.into_iter().map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
                self.metadata.insert(name.to_owned(), values);
            }
            Record::Attachment { name } => self.attachments.push(name.to_owned()),
            Record::End => self.state = State::End,
            Record::Other => {}
        }
        Ok(None)
    }

    /// Number of messages read so far.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// Metadata of this name, if read so far.
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        self.metadata.get(name)
    }

    /// Names of the attachments read so far.
    pub fn attachments(&self) -> &[String] {
        &self.attachments
    }

    /// Whether the file ended before the end of its data.
    pub fn is_cut_off(&self) -> bool {
        self.state == State::CutOff
    }
}
