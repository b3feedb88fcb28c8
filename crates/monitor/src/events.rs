//! What changed in a tick.

use crate::RegionId;

/// Something that changed in the last tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// The region concerned, where one is.
    pub region: Option<RegionId>,
    /// What happened.
    pub kind: EventKind,
}

/// What can happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// A guarded volume came into the warning zone.
    WarnIn,
    /// The last guarded volume left the warning zone.
    WarnOut,
    /// A guarded volume touched the region.
    InsideIn,
    /// The last guarded volume left the region.
    InsideOut,
    /// A digital output rose.
    OutputOn(u8),
    /// A digital output fell.
    OutputOff(u8),
    /// The region was switched on.
    On,
    /// The region was switched off.
    Off,
    /// The robot now holds the exchange region.
    Granted,
    /// The robot gave the exchange region back.
    Released,
    /// The robot waits for the exchange region.
    Waiting,
    /// Robots wait for each other in a circle and none can yield.
    Deadlock,
    /// The input stopped being trustworthy.
    Fault,
    /// The input is trustworthy again.
    Recovered,
}

impl EventKind {
    /// Its name in files: `warn_in`, `output_on`, …
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

/// A list of fixed capacity: what does not fit is counted, never allocated.
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
