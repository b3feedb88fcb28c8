//! Times.

use crate::message::message;

message! {
    /// A time since the epoch.
    Time = "builtin_interfaces/msg/Time" {
        /// Whole seconds.
        sec: i32,
        /// Nanoseconds in the second.
        nanosec: u32,
    }
}

message! {
    /// A length of time.
    Duration = "builtin_interfaces/msg/Duration" {
        /// Whole seconds.
        sec: i32,
        /// Nanoseconds in the second.
        nanosec: u32,
    }
}

const NANOSECONDS: i64 = 1_000_000_000;

impl Time {
    /// Converts nanoseconds since the epoch; a value out of range becomes the nearest time in range.
    pub fn from_nanoseconds(ns: i64) -> Self {
        let (sec, nanosec) = (ns.div_euclid(NANOSECONDS), ns.rem_euclid(NANOSECONDS));
        match i32::try_from(sec) {
            Ok(sec) => Self { sec, nanosec: nanosec as u32 },
            Err(_) if sec < 0 => Self { sec: i32::MIN, nanosec: 0 },
            Err(_) => Self { sec: i32::MAX, nanosec: 999_999_999 },
        }
    }

    /// Nanoseconds since the epoch.
    pub fn nanoseconds(&self) -> i64 {
        i64::from(self.sec) * NANOSECONDS + i64::from(self.nanosec)
    }
}

impl Duration {
    /// Converts nanoseconds.
    pub fn from_nanoseconds(ns: i64) -> Self {
        let Time { sec, nanosec } = Time::from_nanoseconds(ns);
        Self { sec, nanosec }
    }
}
