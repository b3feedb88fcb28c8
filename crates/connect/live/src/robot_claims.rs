//! One process guards a robot: whoever starts says so until its nodes run, and does not start where somebody was first.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::keys::Keys;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};
use crate::service_error::ServiceError;

/// How long a process listens whether another one guards its robots already.
const LISTENS: Duration = Duration::from_millis(300);
/// How often it says meanwhile that it will: a node says how it is as often, or more so.
const EVERY: Duration = Duration::from_millis(20);

/// Claims robots until it is dropped.
#[derive(Debug)]
pub(crate) struct RobotClaims {
    goes_on: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
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
        let first = Arc::<Mutex<Option<String>>>::default();
        let mut listening = Vec::new();
        for robot in robots {
            listening.extend(listen(network, keys, robot, boot, &first)?);
        }
        let publisher = |robot: &&str| network.publisher(&keys.claim(robot), Urgency::RealTime);
        let publishers = robots.iter().map(publisher).collect::<Result<Vec<_>, NetworkError>>()?;
        let claims = Self::publish(publishers, boot);
        if !listening.is_empty() {
            std::thread::sleep(LISTENS);
        }
        drop(listening);
        let name = first.lock().unwrap_or_else(PoisonError::into_inner).take();
        name.map_or(Ok(claims), |name| Err(ServiceError::GuardedAlready { name }))
    }

    fn publish(mut publishers: Vec<Box<dyn Publisher>>, boot: u64) -> Self {
        let (goes_on, ends) = mpsc::channel::<()>();
        let claim = move || {
            while ends.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                publishers.iter_mut().for_each(|publisher| publisher.publish(&boot.to_le_bytes()));
            }
        };
        let thread = std::thread::Builder::new().name("claims".into()).spawn(claim).ok();
        Self { goes_on: Some(goes_on), thread }
    }
}

impl Drop for RobotClaims {
    fn drop(&mut self) {
        self.goes_on = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Writes the robot's name where a node of it is heard, or the claim of a process that started before.
fn listen(
    network: &Arc<dyn Network>,
    keys: &Keys,
    robot: &str,
    boot: u64,
    first: &Arc<Mutex<Option<String>>>,
) -> Result<[Subscription; 2], NetworkError> {
    let hears = |counts: Box<dyn Fn(&[u8]) -> bool + Send + Sync>| {
        let (name, first) = (robot.to_owned(), first.clone());
        Box::new(move |bytes: &[u8]| {
            if counts(bytes) {
                first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| name.clone());
            }
        })
    };
    let is_earlier = move |bytes: &[u8]| bytes.try_into().is_ok_and(|theirs| u64::from_le_bytes(theirs) < boot);
    Ok([
        network.subscribe(&keys.status(robot), hears(Box::new(|_| true)))?,
        network.subscribe(&keys.claim(robot), hears(Box::new(is_earlier)))?,
    ])
}
