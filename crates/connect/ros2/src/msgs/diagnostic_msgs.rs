//! Diagnostics.

use std::fmt::Display;

use super::std_msgs::Header;
use crate::message::{Byte, message};

message! {
    /// A value with its name.
    KeyValue = "diagnostic_msgs/msg/KeyValue" {
        /// The name.
        key: String,
        /// The value.
        value: String,
    }
}

message! {
    /// The status of one component.
    DiagnosticStatus = "diagnostic_msgs/msg/DiagnosticStatus" {
        /// [`DiagnosticStatus::OK`] and the like.
        level: Byte,
        /// The component.
        name: String,
        /// Description in words.
        message: String,
        /// The hardware.
        hardware_id: String,
        /// Values.
        values: Vec<KeyValue>,
    }
}

message! {
    /// The status of several components.
    DiagnosticArray = "diagnostic_msgs/msg/DiagnosticArray" {
        /// Time.
        header: Header,
        /// The components.
        status: Vec<DiagnosticStatus>,
    }
}

impl DiagnosticStatus {
    /// The component works.
    pub const OK: Byte = Byte(0);
    /// The component works, with a restriction.
    pub const WARN: Byte = Byte(1);
    /// The component does not work.
    pub const ERROR: Byte = Byte(2);
    /// The component no longer reports.
    pub const STALE: Byte = Byte(3);
}

impl KeyValue {
    /// Creates a value with its name.
    pub fn new(key: &str, value: impl Display) -> Self {
        Self { key: key.to_owned(), value: format!("{value}") }
    }
}
