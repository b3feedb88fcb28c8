//! Hexadecimal text.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

/// The digits of bytes, two per byte.
pub fn encode(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Decodes `2·N` digits; `None` for anything else.
pub(crate) fn decode<const N: usize>(text: &str) -> Option<[u8; N]> {
    let digits: Vec<u8> = text.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect::<Option<_>>()?;
    let bytes: Vec<u8> = digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect();
    if digits.len() == 2 * N { bytes.try_into().ok() } else { None }
}

/// SHA-256, hex.
pub fn hash(bytes: &[u8]) -> String {
    encode(&Sha256::digest(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_round_trips_and_other_text_is_refused() {
        let bytes = [0, 1, 15, 16, 127, 128, 255];
        assert_eq!(decode(&encode(&bytes)), Some(bytes));
        for wrong in ["", "0", "000102030405", "0001020304050g", "000102030405060", "00010203040506ff", "é001020304050"]
        {
            assert_eq!(decode::<7>(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn the_hash_is_sha_256() {
        assert_eq!(hash(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
