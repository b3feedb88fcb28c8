//! Last events, with numbers.

use std::collections::VecDeque;

use elbowroom_status::EventStatus;
use serde::Serialize;

/// Number of events that are kept.
const MAX_EVENTS: usize = 500;

/// The last events. Their numbers increase, so that a page can be sent the events that it does not have.
#[derive(Debug, Default)]
pub(crate) struct EventLog {
    events: VecDeque<EventStatus>,
    /// Number of the next event.
    next: u64,
}

/// An event with its number.
#[derive(Debug, Serialize)]
pub(crate) struct NumberedEvent<'a> {
    number: u64,
    #[serde(flatten)]
    event: &'a EventStatus,
}

impl EventLog {
    pub(crate) fn extend(&mut self, events: Vec<EventStatus>) {
        self.next += events.len() as u64;
        self.events.extend(events);
        let excess = self.events.len().saturating_sub(MAX_EVENTS);
        self.events.drain(..excess);
    }

    /// Number of the next event.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// The kept events from this number on.
    pub(crate) fn since(&self, number: u64) -> Vec<NumberedEvent<'_>> {
        let first = self.next - self.events.len() as u64;
        let skip = number.saturating_sub(first) as usize;
        let numbered = self.events.iter().zip(first..).map(|(event, number)| NumberedEvent { number, event });
        numbered.skip(skip).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(t_s: f64) -> EventStatus {
        EventStatus { t_s, robot: String::new(), region: String::new(), event: "warn_in".into() }
    }

    #[test]
    fn the_last_events_keep_their_numbers() {
        let mut log = EventLog::default();
        assert!(log.since(0).is_empty());
        log.extend((0..MAX_EVENTS + 10).map(|i| event(i as f64)).collect());
        assert_eq!(log.next(), 510);
        let all = log.since(0);
        assert_eq!((all.len(), all[0].number, all[0].event.t_s), (500, 10, 10.0));
        let last = log.since(508);
        assert_eq!(last.iter().map(|e| e.number).collect::<Vec<_>>(), [508, 509]);
        assert!(log.since(510).is_empty() && log.since(9000).is_empty());
    }
}
