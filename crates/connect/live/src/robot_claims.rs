//! Claims of robots: a process claims its robots until its nodes run, and does not start if another process was first.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::keys::Keys;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};
use crate::service_error::ServiceError;

/// Time for which a process listens before it takes its robots.
const LISTENS: Duration = Duration::from_millis(300);
/// Interval at which a process repeats its claims; a node publishes its status as often.
const EVERY: Duration = Duration::from_millis(20);

/// A process's claim of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Claim {
    /// Time of the start of the process, ns since 1970.
    boot: u64,
    /// Whether the process has listened long enough: a process that starts now is then too late, whatever its clock says.
    is_taken: bool,
}

impl Claim {
    fn encode(self) -> [u8; 9] {
        let mut bytes = [u8::from(self.is_taken); 9];
        bytes[..8].copy_from_slice(&self.boot.to_le_bytes());
        bytes
    }

    fn decode(bytes: &[u8]) -> Option<Self> {
        let bytes: [u8; 9] = bytes.try_into().ok()?;
        let (boot, taken) = bytes.split_at(8);
        Some(Self { boot: u64::from_le_bytes(boot.try_into().ok()?), is_taken: taken != [0] })
    }

    /// Whether this claim takes precedence over a process that started at `boot`. A process also receives its own claims.
    fn precedes(self, boot: u64) -> bool {
        self.boot != boot && (self.is_taken || self.boot < boot)
    }
}

/// Claims robots until it is dropped.
pub(crate) struct RobotClaims {
    /// Names of robots for which a node, or a claim that takes precedence, was received.
    heard: Receiver<String>,
    listening: Vec<Subscription>,
    _publishing: Publishing,
}

impl RobotClaims {
    /// Claims robots for the process that started at `boot`. If two processes start at once, the earlier one gets them.
    ///
    /// # Errors
    /// [`ServiceError::GuardedAlready`] for a robot that another process guards, or claimed before; the network's own
    /// errors.
    pub(crate) fn new(
        network: &Arc<dyn Network>,
        keys: &Keys,
        robots: &[&str],
        boot: u64,
    ) -> Result<Self, ServiceError> {
        let (hears, heard) = mpsc::channel();
        let mut listening = Vec::new();
        for robot in robots {
            let hears = |counts: fn(&[u8], u64) -> bool| {
                let (name, hears) = ((*robot).to_owned(), hears.clone());
                Box::new(move |bytes: &[u8]| {
                    if counts(bytes, boot) {
                        // The receiver is gone once the nodes run.
                        let _ = hears.send(name.clone());
                    }
                })
            };
            listening.push(network.subscribe(&keys.status(robot), hears(|_, _| true))?);
            let precedes = |bytes: &[u8], boot| Claim::decode(bytes).is_some_and(|claim| claim.precedes(boot));
            listening.push(network.subscribe(&keys.claim(robot), hears(precedes))?);
        }
        let publisher = |robot: &&str| network.publisher(&keys.claim(robot), Urgency::RealTime);
        let publishers = robots.iter().map(publisher).collect::<Result<Vec<_>, NetworkError>>()?;
        let claims = Self { heard, listening, _publishing: Publishing::start(publishers, boot) };
        let patience = if robots.is_empty() { Duration::ZERO } else { LISTENS };
        claims.heard.recv_timeout(patience).map_or(Ok(()), |name| Err(ServiceError::GuardedAlready { name }))?;
        Ok(claims)
    }

    /// Stops listening, because from now on the nodes of this process publish too. The claims continue until the nodes run.
    ///
    /// # Errors
    /// As [`Self::new`], for messages that were received in the meantime.
    pub(crate) fn settle(&mut self) -> Result<(), ServiceError> {
        self.listening.clear();
        self.heard.try_recv().map_or(Ok(()), |name| Err(ServiceError::GuardedAlready { name }))
    }
}

/// Publishes claims until it is dropped.
struct Publishing {
    goes_on: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Publishing {
    fn start(mut publishers: Vec<Box<dyn Publisher>>, boot: u64) -> Self {
        let ((goes_on, ends), begin) = (mpsc::channel::<()>(), Instant::now());
        let publish = move || {
            while ends.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                let claim = Claim { boot, is_taken: begin.elapsed() >= LISTENS }.encode();
                for publisher in &mut publishers {
                    publisher.publish(&claim);
                }
            }
        };
        // If no thread can start, the nodes do not start either.
        let thread = std::thread::Builder::new().name("claims".into()).spawn(publish).ok();
        Self { goes_on: Some(goes_on), thread }
    }
}

impl Drop for Publishing {
    fn drop(&mut self) {
        self.goes_on = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_earlier_process_goes_before_and_one_that_has_its_robots_before_all() {
        let claim = |boot: u64, is_taken: bool| Claim { boot, is_taken };
        for (boot, is_taken) in [(0, false), (7, true), (u64::MAX, false)] {
            assert_eq!(Claim::decode(&claim(boot, is_taken).encode()), Some(claim(boot, is_taken)));
        }
        assert_eq!(Claim::decode(&[0; 8]), None);
        assert!(claim(4, false).precedes(5) && !claim(6, false).precedes(5));
        assert!(claim(6, true).precedes(5), "the other computer's clock is ahead");
        assert!(!claim(5, false).precedes(5) && !claim(5, true).precedes(5), "the own one");
    }
}
