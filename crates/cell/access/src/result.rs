//! Result type of functions that read or write files.

use elbowroom_formats::Diagnostic;

pub(crate) type Result<T> = std::result::Result<T, Diagnostic>;
