//! Result type of functions that read or write files.

use elbowroom_formats::FormatError;

pub(crate) type Result<T> = std::result::Result<T, FormatError>;
