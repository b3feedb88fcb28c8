//! Result type of the functions that read or write a sealed cell.

use elbowroom_formats::Diagnostic;

pub(super) type Result<T> = std::result::Result<T, Diagnostic>;
