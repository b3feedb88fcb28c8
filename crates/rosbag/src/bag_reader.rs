//! Reads an MCAP file from begin to end, in the order in which it was written.

use std::collections::{BTreeMap, HashMap};
use std::io::Read;

use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::BagError;

/// Largest record, bytes.
const MAX_RECORD_BYTES: usize = 1 << 30;

/// A message of a recording.
#[derive(Debug, Clone)]
pub struct BagMessage {
    /// Its number in the file, from 0.
    pub index: u64,
    /// Its topic.
    pub topic: String,
    /// When it was recorded, ns.
    pub time_ns: u64,
    /// Its payload.
    pub payload: Vec<u8>,
}

/// An MCAP file as a stream of messages. Chunks are checked before their messages are handed out; a file that ends early gives
/// what it has, and [`BagReader::is_cut_off`] is true then.
pub struct BagReader<R: Read> {
    file: R,
    reader: LinearReader,
    topics: HashMap<u16, String>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    attachments: Vec<String>,
    messages: u64,
    has_ended: bool,
    is_cut_off: bool,
}

impl<R: Read> BagReader<R> {
    /// Reads from a file.
    pub fn new(file: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_validate_data_section_crc(false)
            .with_record_length_limit(MAX_RECORD_BYTES);
        Self {
            file,
            reader: LinearReader::new_with_options(options),
            topics: HashMap::new(),
            metadata: BTreeMap::new(),
            attachments: Vec::new(),
            messages: 0,
            has_ended: false,
            is_cut_off: false,
        }
    }

    /// The next message; `None` at the end.
    ///
    /// # Errors
    /// [`BagError::Foreign`] and [`BagError::Damaged`].
    pub fn next_message(&mut self) -> Result<Option<BagMessage>, BagError> {
        while !self.has_ended {
            let request = match self.reader.next_event() {
                None => break,
                Some(Ok(LinearReadEvent::ReadRequest(count))) => count,
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    let record = mcap::parse_record(opcode, data).map(Record::into_owned);
                    match record.map_err(|e| damaged(self.messages, e))? {
                        Record::Message { header, data } => {
                            let message = self.message(header.channel_id, header.log_time, data.into_owned());
                            return message.map(Some);
                        }
                        other => self.note(other),
                    }
                    continue;
                }
                Some(Err(McapError::UnexpectedEof)) => {
                    (self.is_cut_off, self.has_ended) = (true, true);
                    break;
                }
                Some(Err(McapError::BadMagic)) if self.messages == 0 => return Err(BagError::Foreign),
                Some(Err(e)) => return Err(damaged(self.messages, e)),
            };
            let buffer = self.reader.insert(request);
            let count = self.file.read(buffer).map_err(|e| damaged(self.messages, McapError::Io(e)))?;
            self.reader.notify_read(count);
        }
        self.has_ended = true;
        Ok(None)
    }

    fn message(&mut self, channel: u16, time_ns: u64, payload: Vec<u8>) -> Result<BagMessage, BagError> {
        let Some(topic) = self.topics.get(&channel).cloned() else {
            return Err(damaged(self.messages, McapError::UnknownChannel(0, channel)));
        };
        let index = self.messages;
        self.messages += 1;
        Ok(BagMessage { index, topic, time_ns, payload })
    }

    fn note(&mut self, record: Record<'static>) {
        match record {
            Record::Channel(channel) => {
                self.topics.insert(channel.id, channel.topic);
            }
            Record::Metadata(metadata) => {
                self.metadata.insert(metadata.name, metadata.metadata);
            }
            Record::Attachment { header, .. } => self.attachments.push(header.name),
            _ => {}
        }
    }

    /// Number of messages up to now.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// The metadata of a name that have been read up to now.
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        self.metadata.get(name)
    }

    /// Names of the attachments that have been read up to now.
    pub fn attachments(&self) -> &[String] {
        &self.attachments
    }

    /// True where the file ended before its end was written.
    pub fn is_cut_off(&self) -> bool {
        self.is_cut_off
    }
}

fn damaged(messages: u64, source: McapError) -> BagError {
    BagError::Damaged { messages, source }
}
