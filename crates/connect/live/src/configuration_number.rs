//! Number of the configuration of a cell.

use elbowroom_cell::Cell;

/// Number by which the processes of a cell recognize that they have loaded the same configuration: the first 8 bytes of
/// its checksum.
pub fn configuration_number(cell: &Cell) -> u64 {
    cell.approval.checksum.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok()).unwrap_or(0)
}

/// The configuration number as text: the first 16 hexadecimal digits of the checksum.
pub(crate) fn configuration_digits(cell: &Cell) -> String {
    cell.approval.checksum.chars().take(16).collect()
}
