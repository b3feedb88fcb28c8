//! A picture file: PNG (ISO/IEC 15948) of eight bits per channel.
//!
//! Deflate (RFC 1951) with its fixed codes and one kind of match, the pixel before, is enough for areas of one colour.

use std::io::{self, Write};

/// Writes rows of red, green, blue.
pub(super) fn write(mut out: impl Write, width: usize, height: usize, rgb: &[u8]) -> io::Result<()> {
    let size = |n: usize| u32::try_from(n).map(u32::to_be_bytes).map_err(io::Error::other);
    out.write_all(b"\x89PNG\r\n\x1a\n")?;
    let header = [&size(width)?[..], &size(height)?, &[8, 2, 0, 0, 0]].concat();
    chunk(&mut out, *b"IHDR", &header)?;
    // Each row begins with its filter: none.
    let raw: Vec<u8> =
        rgb.chunks_exact(3 * width.max(1)).flat_map(|row| std::iter::once(&0).chain(row)).copied().collect();
    chunk(&mut out, *b"IDAT", &zlib(&raw))?;
    chunk(&mut out, *b"IEND", &[])?;
    out.flush()
}

fn chunk(out: &mut impl Write, kind: [u8; 4], data: &[u8]) -> io::Result<()> {
    out.write_all(&u32::try_from(data.len()).map_err(io::Error::other)?.to_be_bytes())?;
    let body = [&kind[..], data].concat();
    out.write_all(&body)?;
    out.write_all(&crc32(&body).to_be_bytes())
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

fn adler32(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    b << 16 | a
}

fn zlib(raw: &[u8]) -> Vec<u8> {
    let mut bits = Bits { bytes: vec![0x78, 0x01], buffer: 0, filled: 0 };
    bits.push(0b011, 3); // the last block, fixed codes
    let mut at = 0;
    while at < raw.len() {
        let run = (at..raw.len().min(at + 258)).take_while(|i| *i >= 3 && raw[*i] == raw[i - 3]).count();
        // Lengths from 3 to 10 have a code of their own without extra bits, 258 has the last.
        let length = match run {
            258 => 258,
            3.. => run.min(10),
            _ => 0,
        };
        if length == 0 {
            bits.symbol(u32::from(raw[at]));
            at += 1;
        } else {
            bits.symbol(if length == 258 { 285 } else { 254 + length as u32 });
            bits.code(2, 5); // three bytes back
            at += length;
        }
    }
    bits.symbol(256);
    bits.push(0, 7);
    bits.bytes.extend(adler32(raw).to_be_bytes());
    bits.bytes
}

struct Bits {
    bytes: Vec<u8>,
    buffer: u32,
    filled: u32,
}

impl Bits {
    /// Low bit first.
    fn push(&mut self, value: u32, count: u32) {
        self.buffer |= value << self.filled;
        self.filled += count;
        while self.filled >= 8 {
            self.bytes.push(self.buffer as u8);
            self.buffer >>= 8;
            self.filled -= 8;
        }
    }

    /// High bit first, as Huffman codes are.
    fn code(&mut self, code: u32, count: u32) {
        self.push(code.reverse_bits() >> (32 - count), count);
    }

    /// The fixed codes of literals and lengths (RFC 1951, 3.2.6).
    fn symbol(&mut self, symbol: u32) {
        match symbol {
            0..=143 => self.code(0x30 + symbol, 8),
            144..=255 => self.code(0x190 + symbol - 144, 9),
            256..=279 => self.code(symbol - 256, 7),
            _ => self.code(0xc0 + symbol - 280, 8),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_standards() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
        assert_eq!(adler32(b"Wikipedia"), 0x11e6_0398);
    }

    #[test]
    fn areas_of_one_colour_take_little_room() {
        let mut file = Vec::new();
        write(&mut file, 100, 100, &vec![200; 30_000]).unwrap();
        assert!(file.starts_with(b"\x89PNG") && file.len() < 1500, "{}", file.len());
    }
}
