//! Common Data Representation: the bytes of a ROS 2 message (OMG XCDR version 1, little-endian, plain types).
//!
//! The first four bytes, the encapsulation, name the encoding; every number is aligned to its size, counted from the
//! end of the encapsulation. A string is its length with a closing zero, then its bytes; a sequence is its length, then
//! its elements.

/// First bytes of every payload: plain CDR, little-endian, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Why bytes are not a message of the expected type.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// The payload does not begin with the four bytes of plain CDR, little-endian.
    #[error("the payload begins with {0:02x?}, not with the 00 01 of little-endian CDR")]
    Encapsulation(Vec<u8>),
    /// The bytes end inside a value.
    #[error("the message ends at byte {at}, inside a value of {needed} bytes")]
    End {
        /// Position of the value, counted from the end of the encapsulation.
        at: usize,
        /// Size of the value, bytes.
        needed: usize,
    },
    /// A sequence claims more elements than there are bytes for.
    #[error("a sequence at byte {at} claims {count} elements, and only {remaining} bytes follow")]
    Count {
        /// Position of the sequence.
        at: usize,
        /// The claimed number of elements.
        count: u32,
        /// Number of bytes that follow.
        remaining: usize,
    },
    /// A string is not UTF-8, or has no closing zero.
    #[error("the string at byte {at} is not UTF-8 text with a closing zero")]
    Text {
        /// Position of the string.
        at: usize,
    },
    /// A truth value is neither 0 nor 1.
    #[error("the truth value at byte {at} is {value}, not 0 or 1")]
    Bool {
        /// Position of the value.
        at: usize,
        /// Its byte.
        value: u8,
    },
    /// Bytes follow the message.
    #[error("{0} bytes follow the message")]
    Trailing(usize),
}

/// Writes values one after another.
#[derive(Debug)]
pub struct Writer<'a> {
    bytes: &'a mut Vec<u8>,
    /// Position of the first value, after the encapsulation: alignment counts from here.
    origin: usize,
}

impl<'a> Writer<'a> {
    /// Appends the encapsulation to a buffer; the values follow.
    pub fn new(bytes: &'a mut Vec<u8>) -> Self {
        bytes.extend(ENCAPSULATION);
        Self { origin: bytes.len(), bytes }
    }

    /// Pads to a multiple of `size`.
    fn align(&mut self, size: usize) {
        let used = (self.bytes.len() - self.origin) % size;
        if used > 0 {
            self.bytes.resize(self.bytes.len() + size - used, 0);
        }
    }

    /// Writes a number, aligned to its size.
    pub fn number<const N: usize>(&mut self, little_endian: [u8; N]) {
        self.align(N);
        self.bytes.extend(little_endian);
    }

    /// Writes bytes unchanged.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Writes the length of a sequence, and returns it.
    ///
    /// Lengths above 2³² - 1 would be cut to it; no sequence here comes near.
    pub fn count(&mut self, count: usize) -> usize {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        self.number(count.to_le_bytes());
        count as usize
    }

    /// Writes a string, up to its first zero, which would end it for readers in C.
    pub fn text(&mut self, text: &str) {
        let text = text.split('\0').next().unwrap_or_default();
        self.count(text.len() + 1);
        self.bytes(text.as_bytes());
        self.bytes.push(0);
    }
}

/// Reads values from bytes of unknown origin: a claimed length is used only if the bytes are there.
#[derive(Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    /// Creates a reader of a payload; it starts after the encapsulation.
    ///
    /// # Errors
    /// [`CdrError::Encapsulation`].
    pub fn new(payload: &'a [u8]) -> Result<Self, CdrError> {
        match payload {
            [0, 1, _, _, bytes @ ..] => Ok(Self { bytes, at: 0 }),
            _ => Err(CdrError::Encapsulation(payload[..payload.len().min(4)].to_vec())),
        }
    }

    /// Position, counted from the end of the encapsulation.
    pub fn at(&self) -> usize {
        self.at
    }

    /// Number of bytes that follow.
    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Reads bytes unchanged.
    ///
    /// # Errors
    /// [`CdrError::End`].
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], CdrError> {
        let taken = self.bytes.get(self.at..).and_then(|rest| rest.get(..count));
        let taken = taken.ok_or(CdrError::End { at: self.at, needed: count })?;
        self.at += count;
        Ok(taken)
    }

    /// Reads a number, aligned to its size.
    ///
    /// # Errors
    /// [`CdrError::End`].
    pub fn number<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        let padding = (N - self.at % N) % N;
        let at = self.at;
        self.take(padding)?;
        let taken = self.take(N)?;
        taken.try_into().map_err(|_| CdrError::End { at, needed: N })
    }

    /// Reads the length of a sequence whose elements have at least `least` bytes each.
    ///
    /// # Errors
    /// [`CdrError::Count`] if there are not enough bytes for that many.
    pub fn count(&mut self, least: usize) -> Result<usize, CdrError> {
        let at = self.at;
        let count = u32::from_le_bytes(self.number()?);
        let remaining = self.remaining();
        if count as usize > remaining / least.max(1) {
            return Err(CdrError::Count { at, count, remaining });
        }
        Ok(count as usize)
    }

    /// Reads a string; some writers give an empty string the length 0.
    ///
    /// # Errors
    /// [`CdrError::Text`].
    pub fn text(&mut self) -> Result<&'a str, CdrError> {
        let at = self.at;
        let length = self.count(1)?;
        let bytes = self.take(length)?;
        let text = match bytes {
            [] => Some(&[][..]),
            [text @ .., 0] => Some(text),
            _ => None,
        };
        text.and_then(|text| std::str::from_utf8(text).ok()).ok_or(CdrError::Text { at })
    }

    /// Checks that nothing follows, except for the padding that some writers add.
    ///
    /// # Errors
    /// [`CdrError::Trailing`].
    pub fn end(self) -> Result<(), CdrError> {
        let remaining = self.remaining();
        if remaining > 3 { Err(CdrError::Trailing(remaining)) } else { Ok(()) }
    }
}
