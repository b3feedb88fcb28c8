//! The table as NumPy reads it.

use crate::Table;

impl Table {
    /// The table as a `.npy` file: `uint8`, C order, axes θ1, θ2, θ3; 0 is free, 1 blocked (NumPy's format, version 1.0).
    ///
    /// ```
    /// use elbowroom_cspace::{Span, Table};
    /// let mut table = Table::new([2, 3, 5]);
    /// table.block(Span { row: 5, first: 4, last: 4 });
    /// let npy = table.to_npy();
    /// assert!(npy.starts_with(b"\x93NUMPY\x01\x00"));
    /// assert_eq!(npy.len(), 128 + 30);
    /// assert_eq!(npy[128..].iter().position(|&b| b == 1), Some(29));
    /// ```
    pub fn to_npy(&self) -> Vec<u8> {
        let [a, b, c] = self.shape();
        let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({a}, {b}, {c}), }}");
        // Magic, version, length; then the text, padded so that the numbers begin at a multiple of 64.
        let before = 10;
        let padded = (before + header.len() + 1).next_multiple_of(64) - before;
        let mut out = Vec::with_capacity(before + padded + a * b * c);
        out.extend_from_slice(b"\x93NUMPY\x01\x00");
        out.extend_from_slice(&(padded as u16).to_le_bytes());
        out.extend_from_slice(header.as_bytes());
        out.resize(before + padded - 1, b' ');
        out.push(b'\n');
        for row in 0..a * b {
            let words = self.row(row);
            out.extend((0..c).map(|k| (words[k / 64] >> (k % 64) & 1) as u8));
        }
        out
    }
}
