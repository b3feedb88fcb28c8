//! Status codes, and the text of the last error of each thread.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use elbowroom::Diagnostic;
use elbowroom::scene::SceneError;

/// What a function returns: `elbowroom_status` in C.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The call succeeded.
    Ok = 0,
    /// A pointer is NULL that must not be.
    NullPointer = 1,
    /// A number, a length, an index or a text is not valid.
    InvalidValue = 2,
    /// No robot, link, object or region has this name.
    UnknownName = 3,
    /// A file is missing or refused.
    File = 4,
    /// An array is too short for the result.
    TooShort = 5,
    /// A fault of the library.
    Panic = 6,
    /// An earlier fault of the library left the checker in an unknown state.
    Poisoned = 7,
}

/// Why a call failed.
#[derive(Debug)]
pub(crate) struct Failure {
    pub status: Status,
    pub text: String,
}

impl Failure {
    pub fn null(name: &str) -> Self {
        Self { status: Status::NullPointer, text: format!("`{name}` is NULL") }
    }

    pub fn invalid(text: impl Into<String>) -> Self {
        Self { status: Status::InvalidValue, text: text.into() }
    }

    pub fn unknown(text: impl Into<String>) -> Self {
        Self { status: Status::UnknownName, text: text.into() }
    }
}

impl From<Diagnostic> for Failure {
    fn from(diagnostic: Diagnostic) -> Self {
        Self { status: Status::File, text: diagnostic.to_string() }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::invalid(error.to_string())
    }
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// The text of the last call that failed on this thread; empty before.
pub(crate) fn last_error() -> *const c_char {
    // While a thread ends, its text is gone.
    LAST_ERROR.try_with(|text| text.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// The text of [`last_error`], for tests.
#[cfg(test)]
pub(crate) fn last_text() -> String {
    LAST_ERROR.with_borrow(|text| text.to_string_lossy().into_owned())
}

fn remember(text: &str) {
    let text = c_text(text);
    // While a thread ends there is nowhere to keep it.
    let _ = LAST_ERROR.try_with(|last| last.replace(text));
}

/// A text as C has it; a NUL inside becomes U+FFFD.
pub(crate) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}

/// Runs the body of a function: its failure is remembered, and a panic ends here.
pub(crate) fn guarded(body: impl FnOnce() -> Result<(), Failure>) -> Status {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(failure)) => {
            remember(&failure.text);
            failure.status
        }
        Err(payload) => {
            let what = payload.downcast_ref::<String>().map(String::as_str);
            let what = what.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("without a message");
            remember(&format!(
                "fault of the library: {what}\n  write: a report of this fault, with the file that was loaded"
            ));
            // Dropping a payload may panic again.
            std::mem::forget(payload);
            Status::Panic
        }
    }
}

/// The version of the library.
pub(crate) const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => c"",
};
