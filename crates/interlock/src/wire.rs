//! The bytes of the messages: little-endian, with a version and a checksum, at most [`MAX_BYTES`].
//!
//! | bytes | state | grants |
//! | --- | --- | --- |
//! | 2 | `ER` | the same |
//! | 1 | version, 1 | the same |
//! | 1 | kind, 1 | kind, 2 |
//! | 2 | robot | robot |
//! | 2 | number of slots | the same |
//! | 8 × 4 | boot, sequence, configuration, arbiter | arbiter, serial, robot's boot, echo |
//! | per slot | 1 occupancy, 1 wants, 16 token, 16 released | 16 granted, 1 release requested, 1 halt |
//! | 4 | CRC-32 of all before | the same |
//!
//! No token is 16 zero bytes, as the start 0 is none.

use elbowroom_monitor::{Occupancy, RobotSlot};
use thiserror::Error;

use crate::{Boot, GrantsMessage, SlotAnswer, SlotReport, StateMessage, Token};

/// More slots than this are not written.
pub const MAX_SLOTS: usize = 256;
/// Length of the longest message.
pub const MAX_BYTES: usize = 8 + 32 + MAX_SLOTS * 34 + 4;

const MAGIC: [u8; 2] = *b"ER";
const VERSION: u8 = 1;

/// A message of either kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Message {
    /// From a guard.
    State(StateMessage),
    /// From the arbiter.
    Grants(GrantsMessage),
}

/// Why bytes are no message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum WireError {
    /// Not as long as it says, or longer than any message.
    #[error("the message has {0} bytes, which its number of slots does not explain")]
    Length(usize),
    /// Of something else.
    #[error("the bytes are no message of an interlock")]
    Magic,
    /// Of another version of the protocol.
    #[error(
        "the message is of version {0} of the protocol, this is version {VERSION}: run the same release on all controllers"
    )]
    Version(u8),
    /// Damaged.
    #[error("the checksum of the message is wrong")]
    Checksum,
    /// A value that no guard and no arbiter writes.
    #[error("the message has a value that means nothing")]
    Value,
}

/// The bytes of a message; `None` where it has more than [`MAX_SLOTS`] slots or its robot's index does not fit in two bytes.
pub fn encode(message: &Message) -> Option<Vec<u8>> {
    let (kind, robot, slots, words) = match message {
        Message::State(m) => (1, m.robot, m.slots.len(), [m.boot.0, m.sequence, m.checksum, m.arbiter.0]),
        Message::Grants(m) => (2, m.robot, m.slots.len(), [m.arbiter.0, m.serial, m.robot_boot.0, m.echo]),
    };
    let (robot, count) = (u16::try_from(robot.0).ok()?, u16::try_from(slots).ok().filter(|_| slots <= MAX_SLOTS)?);
    let mut bytes = Vec::with_capacity(MAX_BYTES);
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&[VERSION, kind]);
    bytes.extend_from_slice(&robot.to_le_bytes());
    bytes.extend_from_slice(&count.to_le_bytes());
    bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    match message {
        Message::State(m) => m.slots.iter().for_each(|slot| write_report(slot, &mut bytes)),
        Message::Grants(m) => m.slots.iter().for_each(|slot| write_answer(slot, &mut bytes)),
    }
    bytes.extend_from_slice(&crc32fast::hash(&bytes).to_le_bytes());
    Some(bytes)
}

/// The message of these bytes.
///
/// # Errors
/// Why they are none. No bytes panic.
pub fn decode(bytes: &[u8]) -> Result<Message, WireError> {
    let length = WireError::Length(bytes.len());
    if bytes.len() > MAX_BYTES {
        return Err(length);
    }
    let (content, crc) = bytes.split_last_chunk::<4>().ok_or(length)?;
    let mut reader = Reader { rest: content };
    if reader.take::<2>().ok_or(length)? != MAGIC {
        return Err(WireError::Magic);
    }
    let [version, kind] = reader.take().ok_or(length)?;
    if version != VERSION {
        return Err(WireError::Version(version));
    }
    if crc32fast::hash(content).to_le_bytes() != *crc {
        return Err(WireError::Checksum);
    }
    reader.message(kind).ok_or(WireError::Value).and_then(|m| if reader.rest.is_empty() { Ok(m) } else { Err(length) })
}

fn write_token(token: Option<Token>, bytes: &mut Vec<u8>) {
    let Token { boot, number } = token.unwrap_or(Token { boot: Boot::NONE, number: 0 });
    bytes.extend_from_slice(&boot.0.to_le_bytes());
    bytes.extend_from_slice(&number.to_le_bytes());
}

fn write_report(report: &SlotReport, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&[report.occupancy as u8, u8::from(report.wants)]);
    write_token(report.token, bytes);
    write_token(report.released, bytes);
}

fn write_answer(answer: &SlotAnswer, bytes: &mut Vec<u8>) {
    write_token(answer.granted, bytes);
    bytes.extend_from_slice(&[u8::from(answer.release_requested), u8::from(answer.halt)]);
}

/// Bytes that no guard and no arbiter writes.
struct Meaningless;

/// The bytes that are not read yet.
struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*first)
    }

    fn message(&mut self, kind: u8) -> Option<Message> {
        let robot = RobotSlot(usize::from(u16::from_le_bytes(self.take()?)));
        let count = usize::from(u16::from_le_bytes(self.take()?));
        let [a, b, c, d] = [self.word()?, self.word()?, self.word()?, self.word()?];
        if count > MAX_SLOTS {
            return None;
        }
        match kind {
            1 => {
                let slots = (0..count).map(|_| self.report()).collect::<Option<_>>()?;
                let (boot, arbiter) = (Boot(a), Boot(d));
                Some(Message::State(StateMessage { robot, boot, sequence: b, checksum: c, arbiter, slots }))
            }
            2 => {
                let slots = (0..count).map(|_| self.answer()).collect::<Option<_>>()?;
                let (arbiter, robot_boot) = (Boot(a), Boot(c));
                Some(Message::Grants(GrantsMessage { arbiter, serial: b, robot, robot_boot, echo: d, slots }))
            }
            _ => None,
        }
    }

    fn word(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn flag(&mut self) -> Option<bool> {
        match self.take()? {
            [0] => Some(false),
            [1] => Some(true),
            _ => None,
        }
    }

    /// A token that may be none.
    fn token(&mut self) -> Result<Option<Token>, Meaningless> {
        match (self.word().ok_or(Meaningless)?, self.word().ok_or(Meaningless)?) {
            (0, 0) => Ok(None),
            (0, _) => Err(Meaningless),
            (boot, number) => Ok(Some(Token { boot: Boot(boot), number })),
        }
    }

    fn report(&mut self) -> Option<SlotReport> {
        let occupancy = match self.take()? {
            [0] => Occupancy::Unknown,
            [1] => Occupancy::Outside,
            [2] => Occupancy::Warning,
            [3] => Occupancy::Committed,
            [4] => Occupancy::Inside,
            _ => return None,
        };
        Some(SlotReport { occupancy, wants: self.flag()?, token: self.token().ok()?, released: self.token().ok()? })
    }

    fn answer(&mut self) -> Option<SlotAnswer> {
        Some(SlotAnswer { granted: self.token().ok()?, release_requested: self.flag()?, halt: self.flag()? })
    }
}
