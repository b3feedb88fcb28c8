//! Result type of the functions that read or write a sealed cell.

use elbowroom_formats::FormatError;

pub(super) type Result<T> = std::result::Result<T, FormatError>;
