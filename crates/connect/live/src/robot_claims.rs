//! One process guards a robot: whoever starts says so until its nodes run, and does not start where somebody was first.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::keys::Keys;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};
use crate::service_error::ServiceError;

/// How long a process listens before it takes its robots.
const LISTENS: Duration = Duration::from_millis(300);
/// How often it says meanwhile that it will: a node says as often how it is.
const EVERY: Duration = Duration::from_millis(20);

/// A process's claim of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Claim {
    /// When the process started, ns since 1970.
    boot: u64,
    /// It has listened long enough: whoever starts now is too late, whatever its clock says.
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

    /// Whether the process of this claim goes before one that started at `boot`. Its own claims come back to a process.
    fn precedes(self, boot: u64) -> bool {
        self.boot != boot && (self.is_taken || self.boot < boot)
    }
}

/// Claims robots until it is dropped.
pub(crate) struct RobotClaims {
    /// Names of robots of which a node, or a claim that goes before, was heard.
    heard: Receiver<String>,
    listening: Vec<Subscription>,
    _publishing: Publishing,
}

impl RobotClaims {
    /// Claims robots for the process that started at `boot`. Of two that start at once the earlier one counts.
    ///
    /// # Errors
    /// [`ServiceError::GuardedAlready`] for a robot that another process guards, or claimed before; the network's own errors.
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
                        // The other side is gone once the nodes run.
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

    /// Listens no longer: from here on the nodes of this process are heard. It claims on until they run.
    ///
    /// # Errors
    /// As [`Self::new`], for what was heard in the meantime.
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
        // Without threads the nodes do not start either.
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
