//! Refusal of a request.

use elbowroom_formats::Diagnostic;
use serde::Serialize;

/// A refused request: what is wrong, and what to write instead. Sent as JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Refusal {
    /// HTTP status.
    #[serde(skip)]
    pub(crate) status: u16,
    pub(crate) error: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) help: Option<String>,
    /// The robot that prevents the change.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) robot: Option<String>,
    /// Distance of that robot from the region, m; 0 inside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) distance_m: Option<f64>,
    /// Time after which the request may be repeated, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) wait_s: Option<f64>,
}

impl Refusal {
    pub(crate) fn new(status: u16, error: impl Into<String>) -> Self {
        Self { status, error: error.into(), help: None, robot: None, distance_m: None, wait_s: None }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// Refusal because the log cannot be written or a region is not accepted: the text says where.
impl From<Diagnostic> for Refusal {
    fn from(error: Diagnostic) -> Self {
        Self::new(500, error.to_string())
    }
}
