//! Framing of MCAP, read from bytes of unknown origin: a claimed length is used only if the bytes are there.
//!
//! The crate `mcap` writes the recordings. Its reader (0.26) panics on lengths that do not fit their record, so files
//! are read here: the few kinds of records that a replay needs.

use std::io::{self, Read};

use ruzstd::decoding::StreamingDecoder;

use crate::damage::{Damage, MAX_BYTES};

/// First bytes of a file.
pub(crate) const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n'];

/// A record that a replay needs.
pub(crate) enum Record<'a> {
    Schema {
        id: u16,
        name: &'a str,
    },
    Channel {
        id: u16,
        schema: u16,
        topic: &'a str,
    },
    Message {
        channel: u16,
        time_ns: u64,
        payload: &'a [u8],
    },
    Chunk(Vec<u8>),
    Metadata {
        name: &'a str,
        values: Vec<(&'a str, &'a str)>,
    },
    Attachment {
        name: &'a str,
    },
    /// The end of the data; an index may follow.
    End,
    Other,
}

/// A record of a file, not parsed yet.
pub(crate) enum Framed {
    Record {
        opcode: u8,
        body: Vec<u8>,
    },
    /// The file ends inside a record, or where another record should begin.
    CutOff,
}

/// Reads the next record of a file.
pub(crate) fn next(file: &mut impl Read) -> Result<Framed, Damage> {
    let mut head = Vec::new();
    read_into(file, 9, &mut head)?;
    let [opcode, length @ ..] = &head[..] else { return Ok(Framed::CutOff) };
    let Ok(length) = <[u8; 8]>::try_from(length) else { return Ok(Framed::CutOff) };
    let length = u64::from_le_bytes(length);
    if length > MAX_BYTES {
        return Err(Damage::LongRecord(length));
    }
    let mut body = Vec::new();
    read_into(file, length, &mut body)?;
    let is_whole = body.len() as u64 == length;
    Ok(if is_whole { Framed::Record { opcode: *opcode, body } } else { Framed::CutOff })
}

/// Reads `count` bytes; memory grows with the bytes that are there, not with the claimed count.
fn read_into(file: &mut impl Read, count: u64, to: &mut Vec<u8>) -> Result<(), Damage> {
    file.take(count).read_to_end(to).map(|_| ()).map_err(Damage::Unreadable)
}

/// Parses a record from its opcode and its body.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, Damage> {
    let mut fields = Fields(body);
    Ok(match opcode {
        0x03 => {
            let id = u16::from_le_bytes(fields.number()?);
            Record::Schema { id, name: fields.text()? }
        }
        0x04 => {
            let id = u16::from_le_bytes(fields.number()?);
            let schema = u16::from_le_bytes(fields.number()?);
            Record::Channel { id, schema, topic: fields.text()? }
        }
        0x05 => {
            let channel = u16::from_le_bytes(fields.number()?);
            let _sequence: [u8; 4] = fields.number()?;
            let time_ns = u64::from_le_bytes(fields.number()?);
            let _published: [u8; 8] = fields.number()?;
            Record::Message { channel, time_ns, payload: fields.0 }
        }
        0x06 => Record::Chunk(chunk(&mut fields)?),
        0x09 => {
            let _times: [u8; 16] = fields.number()?;
            Record::Attachment { name: fields.text()? }
        }
        0x0c => {
            let name = fields.text()?;
            let length = u32::from_le_bytes(fields.number()?);
            let mut map = Fields(fields.take(length as usize)?);
            let mut values = Vec::new();
            while !map.0.is_empty() {
                values.push((map.text()?, map.text()?));
            }
            Record::Metadata { name, values }
        }
        0x0f => Record::End,
        _ => Record::Other,
    })
}

/// Splits the first record off the contents of a chunk: opcode, body, rest.
pub(crate) fn first(contents: &[u8]) -> Result<(u8, &[u8], &[u8]), Damage> {
    let mut fields = Fields(contents);
    let [opcode] = fields.number()?;
    let length = u64::from_le_bytes(fields.number()?);
    let body = fields.take(usize::try_from(length).unwrap_or(usize::MAX))?;
    Ok((opcode, body, fields.0))
}

/// Decompresses the contents of a chunk and checks them against their checksum.
fn chunk(fields: &mut Fields<'_>) -> Result<Vec<u8>, Damage> {
    let _times: [u8; 16] = fields.number()?;
    let size = u64::from_le_bytes(fields.number()?);
    let checksum = u32::from_le_bytes(fields.number()?);
    let compression = fields.text()?;
    let compressed_size = u64::from_le_bytes(fields.number()?);
    let compressed = fields.take(usize::try_from(compressed_size).unwrap_or(usize::MAX))?;
    if size > MAX_BYTES {
        return Err(Damage::LongChunk(size));
    }
    let mut contents = Vec::new();
    match compression {
        "" => contents.extend_from_slice(compressed),
        "lz4" => {
            let damage = |source| Damage::Compressed { format: "LZ4", source };
            let decoder = lz4::Decoder::new(compressed).map_err(damage)?;
            // One byte more than claimed, to notice contents that are too long.
            decoder.take(size + 1).read_to_end(&mut contents).map_err(damage)?;
        }
        "zstd" => {
            let damage = |source| Damage::Compressed { format: "Zstandard", source };
            let decoder = StreamingDecoder::new(compressed).map_err(|e| damage(io::Error::other(e.to_string())))?;
            decoder.take(size + 1).read_to_end(&mut contents).map_err(damage)?;
        }
        other => return Err(Damage::Compression(other.to_owned())),
    }
    if contents.len() as u64 != size {
        return Err(Damage::ChunkLength { found: contents.len(), claimed: size });
    }
    // 0 means that the writer computed no checksum.
    if checksum != 0 && crc32fast::hash(&contents) != checksum {
        return Err(Damage::Checksum);
    }
    Ok(contents)
}

/// The fields of a record, one after the other.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Damage> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Damage::ShortRecord)?;
        self.0 = rest;
        Ok(taken)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], Damage> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(Damage::ShortRecord)?;
        self.0 = rest;
        Ok(*taken)
    }

    fn text(&mut self) -> Result<&'a str, Damage> {
        let length = u32::from_le_bytes(self.number()?);
        std::str::from_utf8(self.take(length as usize)?).map_err(|_| Damage::Text)
    }
}
