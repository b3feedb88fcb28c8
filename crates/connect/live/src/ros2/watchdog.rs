//! Watchdog process: stops the controllers of a service that is silent.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_ros2::Message;
use elbowroom_ros2::msgs::control_msgs::SpeedScalingFactor;
use elbowroom_ros2::rmw_zenoh::{Attachment, Gid, Qos, Topic};

use super::session::{RosPublisher, RosSample, RosSession};
use super::settings::{Ros2Error, Ros2Robot, Ros2Settings};
use super::worker::Worker;
use crate::event_handler::EventHandler;
use crate::locked::locked;
use crate::network::{NetworkError, Subscription, Urgency};

/// Name of the node.
const NODE: &str = "elbowroom_watchdog";
/// Interval at which the factor 0 is repeated while the service is silent.
const REPEAT: Duration = Duration::from_millis(100);
/// Longest interval of checks for silence.
const POLL: Duration = Duration::from_millis(5);

/// Publishes the factor 0 for each robot whose service has been silent for longer than a bound. It ends when it is dropped.
pub struct Watchdog {
    is_closed: Arc<AtomicBool>,
    _worker: Worker,
}

impl Watchdog {
    /// Starts to watch these robots; all robots of the cell but the mechanisms if `robots` is empty.
    ///
    /// # Errors
    /// The setting that cannot be used.
    pub fn start(
        cell: &Cell,
        settings: &Ros2Settings,
        robots: &[String],
        bound: Duration,
        on_event: Option<EventHandler>,
    ) -> Result<Self, Ros2Error> {
        settings.check(cell)?;
        let known = || cell.robots.iter().map(|r| r.name.clone());
        if let Some(name) = robots.iter().find(|name| !known().any(|k| k == **name)) {
            return Err(Ros2Error::Unknown { name: name.clone(), known: known().collect() });
        }
        let watched: Vec<String> = if robots.is_empty() {
            cell.guarded_robots().map(|robot| cell.robots[robot.0].name.clone()).collect()
        } else {
            known().filter(|name| robots.contains(name)).collect()
        };
        let watched: Vec<Ros2Robot> = watched
            .into_iter()
            .map(|name| settings.robot(&name).cloned().unwrap_or_else(|| Ros2Robot::of(&name)))
            .collect();
        let is_closed = Arc::new(AtomicBool::new(false));
        let (closed, distribution, report) = (is_closed.clone(), settings.distribution, on_event.clone());
        let worker = Worker::start(settings, NODE, on_event, move |session| {
            let topic = |robot: &Ros2Robot| Topic::of::<SpeedScalingFactor>(&robot.speed_scaling, distribution);
            let watched = watched.into_iter().map(|robot| Watched::start(session, &topic(&robot), robot.robot));
            let mut watched = watched.collect::<Result<Vec<_>, _>>()?;
            while !closed.load(Ordering::SeqCst) {
                for robot in &mut watched {
                    robot.step(bound, report.as_ref());
                }
                std::thread::sleep(POLL.min(bound / 4));
            }
            Ok(())
        });
        Ok(Self { is_closed, _worker: worker })
    }
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::SeqCst);
    }
}

/// One watched robot.
struct Watched {
    robot: String,
    heard: Arc<Mutex<Instant>>,
    publisher: RosPublisher,
    /// Time at which the factor 0 was sent last; `None` while the service is heard.
    sent: Option<Instant>,
    _subscription: Subscription,
}

impl Watched {
    fn start(session: &RosSession, topic: &Topic, robot: String) -> Result<Self, NetworkError> {
        let publisher = session.publisher(topic, Qos::latched(), Urgency::RealTime)?;
        // Without a message yet, the bound begins now.
        let heard = Arc::new(Mutex::new(Instant::now()));
        let (own, shared) = (publisher.gid(), heard.clone());
        let handler = move |sample: RosSample<'_>| {
            if is_of_service(sample, own) {
                *locked(&shared) = Instant::now();
            }
        };
        let subscription = session.subscribe(topic, Qos::latched(), false, Box::new(handler))?;
        Ok(Self { robot, heard, publisher, sent: None, _subscription: subscription })
    }

    fn step(&mut self, bound: Duration, on_event: Option<&EventHandler>) {
        let silence = locked(&self.heard).elapsed();
        let report = |what: &str| {
            if let Some(on_event) = on_event {
                on_event(&format!("{}: {what}", self.robot));
            }
        };
        match self.sent {
            None if silence > bound => report("the service is silent: speed scaling 0"),
            Some(_) if silence <= bound => {
                report("the service is heard again");
                self.sent = None;
                return;
            }
            Some(at) if at.elapsed() >= REPEAT => {}
            _ => return,
        }
        self.publisher.publish(&SpeedScalingFactor { factor: 0.0 }.encode());
        self.sent = Some(Instant::now());
    }
}

/// Whether a sample is a valid factor of another publisher.
fn is_of_service(sample: RosSample<'_>, own: Gid) -> bool {
    let source = sample.attachment.and_then(|bytes| Attachment::decode(bytes).ok()).map(|a| a.source);
    let is_factor = || SpeedScalingFactor::decode(sample.payload).is_ok_and(|m| (0.0..=1.0).contains(&m.factor));
    source.is_some_and(|source| source != own) && is_factor()
}
