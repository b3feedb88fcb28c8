//! LZF, the compression of PCD files: literal runs and back references.

/// Decompresses to exactly `length` bytes; `None` if the data is damaged.
pub(super) fn decompress(input: &[u8], length: usize) -> Option<Vec<u8>> {
    // Three bytes decompress to at most 264, so the declared length is checked before memory is reserved.
    if length > input.len().saturating_mul(88) + 32 {
        return None;
    }
    let mut out = Vec::with_capacity(length);
    let mut bytes = input.iter().copied();
    while let Some(control) = bytes.next() {
        if control < 32 {
            for _ in 0..=control {
                out.push(bytes.next()?);
            }
        } else {
            let mut n = usize::from(control >> 5);
            if n == 7 {
                n += usize::from(bytes.next()?);
            }
            let back = (usize::from(control & 31) << 8) + usize::from(bytes.next()?) + 1;
            let from = out.len().checked_sub(back)?;
            for i in from..from + n + 2 {
                out.push(out[i]);
            }
        }
        if out.len() > length {
            return None;
        }
    }
    (out.len() == length).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_and_overlapping_references() {
        // "ab", then 6 bytes from 2 back, then "c".
        assert_eq!(decompress(&[1, b'a', b'b', 4 << 5, 1, 0, b'c'], 9).unwrap(), b"ababababc");
        assert_eq!(decompress(&[0, b'x', 7 << 5, 3, 0], 13).unwrap(), [b'x'; 13]);
    }

    #[test]
    fn damage_is_refused() {
        for bad in [&[1, b'a'][..], &[4 << 5, 1], &[0, b'a', 4 << 5, 9], &[0, b'a', 7 << 5]] {
            assert_eq!(decompress(bad, 9), None);
        }
        assert_eq!(decompress(&[0, b'a'], 2), None);
        assert_eq!(decompress(&[0, b'a'], usize::MAX), None);
    }
}
