//! Occupancy as NumPy files.

use crate::OccupancyBitmap;

/// Header of a `.npy` file of `uint8`, C order (NumPy's format, version 1.0).
pub(crate) fn header(shape: &[usize]) -> Vec<u8> {
    let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
    // A Python tuple of one number ends with a comma.
    let sizes = sizes.join(", ") + if shape.len() == 1 { "," } else { "" };
    let text = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({sizes}), }}");
    // Magic, version, length; then the text, padded so that the data begins at a multiple of 64 bytes.
    let before = 10;
    let padded = (before + text.len() + 1).next_multiple_of(64) - before;
    let mut out = Vec::with_capacity(before + padded);
    out.extend_from_slice(b"\x93NUMPY\x01\x00");
    out.extend_from_slice(&(padded as u16).to_le_bytes());
    out.extend_from_slice(text.as_bytes());
    out.resize(before + padded - 1, b' ');
    out.push(b'\n');
    out
}

impl OccupancyBitmap {
    /// Writes a `.npy` file: `uint8`, C order, axes θ1, θ2, θ3; 0 is free, 1 is blocked.
    ///
    /// ```
    /// use elbowroom_cspace::{OccupancyBitmap, RowSpan};
    /// let mut occupancy = OccupancyBitmap::new([2, 3, 5]);
    /// occupancy.block(RowSpan { row: 5, first: 4, last: 4 });
    /// let npy = occupancy.to_npy();
    /// assert!(npy.starts_with(b"\x93NUMPY\x01\x00"));
    /// assert_eq!(npy.len(), 128 + 30);
    /// assert_eq!(npy[128..].iter().position(|&b| b == 1), Some(29));
    /// ```
    pub fn to_npy(&self) -> Vec<u8> {
        let [a, b, c] = self.shape();
        let mut out = header(&[a, b, c]);
        out.reserve(a * b * c);
        for row in 0..a * b {
            let words = self.row(row);
            out.extend((0..c).map(|k| (words[k / 64] >> (k % 64) & 1) as u8));
        }
        out
    }
}
