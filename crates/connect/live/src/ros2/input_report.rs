//! Report on the input of a robot, for people.

use std::sync::{Arc, Mutex, MutexGuard};

use elbowroom_interlock::Micros;
use elbowroom_ros2::msgs::diagnostic_msgs::{DiagnosticStatus, KeyValue};

use super::input_error::RosInputError;
use crate::locked::locked;

/// Age up to which a message counts as present.
const PRESENT: Micros = Micros(1_000_000);
/// Shortest time between two reported reasons.
const QUIET: Micros = Micros(100_000);

/// Results of the messages of one topic. Clones share the report.
#[derive(Debug, Clone)]
pub(super) struct InputReport {
    robot: String,
    topic: String,
    counts: Arc<Mutex<Counts>>,
}

#[derive(Debug, Default)]
struct Counts {
    taken: u64,
    refused: u64,
    last_taken: Option<Micros>,
    last_refused: Option<(String, Micros)>,
    /// The last reported reason.
    said: Option<(String, Micros)>,
}

impl InputReport {
    pub(super) fn new(robot: &str, topic: &str) -> Self {
        Self { robot: robot.to_owned(), topic: topic.to_owned(), counts: Arc::default() }
    }

    fn lock(&self) -> MutexGuard<'_, Counts> {
        locked(&self.counts)
    }

    /// Counts a message. Returns a line to report if the reason is new.
    pub(super) fn count(&self, result: &Result<(), RosInputError>, now: Micros) -> Option<String> {
        let mut counts = self.lock();
        let Err(why) = result else {
            counts.taken += 1;
            counts.last_taken = Some(now);
            return None;
        };
        counts.refused += 1;
        let why = why.to_string();
        let is_said = counts.said.as_ref().is_some_and(|(said, at)| *said == why || now - *at < QUIET);
        let line = (!is_said).then(|| {
            counts.said = Some((why.clone(), now));
            format!("{}: a message on {} does not count: {why}", self.robot, self.topic)
        });
        counts.last_refused = Some((why, now));
        line
    }

    /// Makes the status for `/diagnostics`: an error while no message is accepted.
    pub(super) fn diagnostic(&self, now: Micros) -> DiagnosticStatus {
        let counts = self.lock();
        let is_present = |at: Micros| now - at <= PRESENT;
        let refused = counts.last_refused.as_ref().filter(|(_, at)| is_present(*at));
        let (level, message) = match (counts.last_taken.is_some_and(is_present), refused) {
            (true, None) => (DiagnosticStatus::OK, "arrives".to_owned()),
            (true, Some((why, _))) => (DiagnosticStatus::WARN, format!("some messages do not count: {why}")),
            (false, Some((why, _))) => (DiagnosticStatus::ERROR, format!("no message counts: {why}")),
            (false, None) => (DiagnosticStatus::ERROR, "nothing arrives".to_owned()),
        };
        DiagnosticStatus {
            level,
            name: format!("elbowroom: {} input", self.robot),
            message,
            hardware_id: self.robot.clone(),
            values: vec![
                KeyValue::new("topic", &self.topic),
                KeyValue::new("taken", counts.taken),
                KeyValue::new("refused", counts.refused),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_is_said_once_and_the_level_follows_the_present() {
        let report = InputReport::new("left", "/joint_states");
        let level = |now| report.diagnostic(Micros(now)).level;
        assert_eq!(level(0), DiagnosticStatus::ERROR);
        let refused = Err(RosInputError::NoAttachment);
        assert!(
            report.count(&refused, Micros(0)).is_some_and(|line| line.contains("left: a message on /joint_states"))
        );
        assert_eq!(report.count(&refused, Micros(5_000_000)), None);
        assert_eq!(report.count(&Ok(()), Micros(5_100_000)), None);
        assert_eq!(
            (level(5_200_000), level(6_050_000), level(9_000_000)),
            (DiagnosticStatus::WARN, DiagnosticStatus::OK, DiagnosticStatus::ERROR)
        );
    }
}
