//! Events of a tick.

use crate::RegionId;

/// A change in the last tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// The region, if the event concerns one.
    pub region: Option<RegionId>,
    /// The kind of change.
    pub kind: EventKind,
}

/// Kinds of events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// The first guarded volume entered the warning zone.
    WarnIn,
    /// The last guarded volume left the warning zone.
    WarnOut,
    /// The first guarded volume touched the region.
    InsideIn,
    /// The last guarded volume left the region.
    InsideOut,
    /// A digital output was switched on.
    OutputOn(u8),
    /// A digital output was switched off.
    OutputOff(u8),
    /// The region was switched on.
    On,
    /// The region was switched off.
    Off,
    /// The robot now holds the exchange region.
    Granted,
    /// The robot released the exchange region.
    Released,
    /// The robot waits for the exchange region.
    Waiting,
    /// Robots wait for each other in a cycle and none can yield.
    Deadlock,
    /// The input became invalid.
    Fault,
    /// The input is valid again.
    Recovered,
}

impl EventKind {
    /// The name in files: `warn_in`, `output_on`, …
    pub fn name(self) -> &'static str {
        match self {
            Self::WarnIn => "warn_in",
            Self::WarnOut => "warn_out",
            Self::InsideIn => "inside_in",
            Self::InsideOut => "inside_out",
            Self::OutputOn(_) => "output_on",
            Self::OutputOff(_) => "output_off",
            Self::On => "on",
            Self::Off => "off",
            Self::Granted => "granted",
            Self::Released => "released",
            Self::Waiting => "waiting",
            Self::Deadlock => "deadlock",
            Self::Fault => "fault",
            Self::Recovered => "recovered",
        }
    }
}

/// A list of fixed capacity: events beyond the capacity are dropped, nothing is allocated.
#[derive(Debug)]
pub(crate) struct EventLog {
    events: Vec<Event>,
}

impl EventLog {
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        Self { events: Vec::with_capacity(capacity) }
    }

    pub(crate) fn clear(&mut self) {
        self.events.clear();
    }

    pub(crate) fn push(&mut self, region: Option<RegionId>, kind: EventKind) {
        if self.events.len() < self.events.capacity() {
            self.events.push(Event { region, kind });
        }
    }

    pub(crate) fn as_slice(&self) -> &[Event] {
        &self.events
    }
}
