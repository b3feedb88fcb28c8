//! Collection of the robots' messages into one cell status, for the page in a browser and for recordings.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use elbowroom_cell::{Cell, Follow, Frames};
use elbowroom_interlock::Micros;
use elbowroom_monitor::SourceState;
use elbowroom_recording::Recorder;
use elbowroom_robot::ObjectId;
use elbowroom_status::{CellStatus, EventStatus, HealthStatus, PlacedStatus, RobotStatus, ServiceStatus, SlotStatus};
use elbowroom_view::StatusFeed;

use crate::clock::Clock;
use crate::keys::Keys;
use crate::locked::locked;
use crate::measured_sources::MeasuredSources;
use crate::network::{Network, NetworkError, Subscription};
use crate::node::LOST;
use crate::ros2::CellFeed;

/// Interval between statuses of the cell. The page shows at most one picture per status, and at least 30 per second.
const PERIOD: Duration = Duration::from_millis(30);
/// Shortest rest between two statuses.
const LEAST_REST: Duration = Duration::from_millis(3);
/// A robot whose status is older than this is shown as silent.
const SILENT: Micros = Micros(500_000);
/// Most events kept between two statuses of the cell.
const MAX_EVENTS: usize = 1000;

/// Collects the messages of a cell's robots into one status. It ends when it is dropped.
pub(crate) struct CellObserver {
    _subscriptions: Vec<Subscription>,
    is_closed: Arc<AtomicBool>,
    thread: Option<JoinHandle<Option<Recorder>>>,
}

#[derive(Default)]
struct Heard {
    /// Last status per robot, and its time of arrival.
    robots: Vec<Option<(RobotStatus, Micros)>>,
    /// Last message of the arbiter, and its time of arrival.
    slots: (Vec<SlotStatus>, Micros),
    events: Vec<EventStatus>,
}

type Shared = Arc<Mutex<Heard>>;

impl CellObserver {
    /// Subscribes to all robots of the cell, in this process and in others.
    pub(crate) fn start(
        cell: &Arc<Cell>,
        [network, of_controllers]: [&Arc<dyn Network>; 2],
        clock: Clock,
        feed: Option<StatusFeed>,
        recorder: Option<Recorder>,
        ros2: Option<CellFeed>,
    ) -> Result<Self, NetworkError> {
        let shared = Shared::default();
        locked(&shared).robots.resize(cell.robots.len(), None);
        let subscriptions = subscribe(cell, network, clock, &shared)?;
        let measured = MeasuredSources::start(cell, of_controllers, clock)?;
        let is_closed = Arc::new(AtomicBool::new(false));
        let (closed, cell) = (is_closed.clone(), cell.clone());
        let run = move || {
            let mut due = Instant::now();
            while !closed.load(Ordering::SeqCst) {
                let objects = placed_objects(&cell, &measured, clock);
                let status = CellStatus { objects, ..together(&cell, clock, &shared) };
                if let Some(recorder) = &recorder {
                    recorder.status(status.clone());
                }
                if let Some(ros2) = &ros2 {
                    ros2.publish(status.clone());
                }
                if let Some(feed) = &feed {
                    feed.publish(status);
                }
                let now = Instant::now();
                due = next_due(due, now);
                std::thread::sleep(due - now);
            }
            recorder
        };
        let thread = std::thread::Builder::new().name("observer".into()).spawn(run);
        Ok(Self { _subscriptions: subscriptions, is_closed, thread: thread.ok() })
    }

    /// Ends the observer and returns the recorder.
    pub(crate) fn stop(mut self) -> Option<Recorder> {
        self.end()
    }

    fn end(&mut self) -> Option<Recorder> {
        self.is_closed.store(true, Ordering::SeqCst);
        self.thread.take()?.join().ok()?
    }
}

impl Drop for CellObserver {
    fn drop(&mut self) {
        if let Some(recorder) = self.end() {
            // Without `stop` there is no caller to report an error to.
            let _ = recorder.finish();
        }
    }
}

fn subscribe(
    cell: &Cell,
    network: &Arc<dyn Network>,
    clock: Clock,
    shared: &Shared,
) -> Result<Vec<Subscription>, NetworkError> {
    let keys = Keys::new(&cell.name);
    let mut subscriptions = Vec::new();
    for (i, robot) in cell.robots.iter().enumerate() {
        let shared = shared.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            let Ok(mut status) = serde_json::from_slice::<RobotStatus>(bytes) else { return };
            let mut heard = locked(&shared);
            let room = MAX_EVENTS.saturating_sub(heard.events.len());
            heard.events.extend(status.service.events.drain(..).take(room));
            heard.robots[i] = Some((status, clock.micros()));
        });
        subscriptions.push(network.subscribe(&keys.status(&robot.name), handler)?);
    }
    let shared = shared.clone();
    let handler = Box::new(move |bytes: &[u8]| {
        if let Ok(slots) = serde_json::from_slice(bytes) {
            locked(&shared).slots = (slots, clock.micros());
        }
    });
    subscriptions.push(network.subscribe(&keys.interlocks(), handler)?);
    Ok(subscriptions)
}

/// When the next status is due: the interval includes the time that the last one took, and missed ones are omitted. The
/// thread always rests a little.
fn next_due(due: Instant, now: Instant) -> Instant {
    (due + PERIOD).max(now + LEAST_REST)
}

/// Adds the time since arrival to the ages in a status.
fn aged(status: &RobotStatus, age_s: f64) -> RobotStatus {
    let mut status = status.clone();
    status.service.health.age_s = age_s;
    status
}

/// The objects that move by themselves, where they are now, or where they were heard last. Those that were never heard are
/// left out.
fn placed_objects(cell: &Cell, measured: &MeasuredSources, clock: Clock) -> Vec<PlacedStatus> {
    let heard = measured.last_states();
    let states: Vec<SourceState> = heard.iter().map(|state| state.unwrap_or(LOST)).collect();
    let frames = Frames::with_measured(cell, &states);
    let placed = |object: ObjectId| {
        let follow = Follow::Object(object);
        let moves = frames.measured_source(&follow).map_or_else(|| frames.is_driven(object), |i| heard[i].is_some());
        let placed = moves.then(|| frames.source(&follow, &[], clock.seconds()))?;
        Some(PlacedStatus { name: cell.objects[object.0].name.clone(), pose: (&placed.pose).into() })
    };
    (0..cell.objects.len()).map(ObjectId).filter_map(placed).collect()
}

fn together(cell: &Cell, clock: Clock, shared: &Shared) -> CellStatus {
    let mut heard = locked(shared);
    let now = clock.micros();
    let age_s = |at: Micros| (now - at).0 as f64 * 1e-6;
    let robot = |(heard, robot): (&Option<(RobotStatus, Micros)>, &elbowroom_cell::CellRobot)| match heard {
        Some((status, at)) if now - *at <= SILENT => aged(status, age_s(*at)),
        Some((status, at)) => {
            let age_s = age_s(*at);
            let reason = format!("no status for {age_s:.1} s");
            RobotStatus { speed_override: 0.0, reason, region: None, ..aged(status, age_s) }
        }
        None => RobotStatus {
            robot: robot.name.clone(),
            q: robot.start.clone(),
            reason: "no status yet; shown at its start".to_owned(),
            service: ServiceStatus {
                health: HealthStatus { age_s: clock.seconds(), ..HealthStatus::default() },
                ..ServiceStatus::default()
            },
            ..RobotStatus::default()
        },
    };
    let (slots, said_at) = &heard.slots;
    let slots = slots.iter().map(|slot| SlotStatus { age_s: age_s(*said_at), ..slot.clone() }).collect();
    CellStatus {
        t_s: clock.seconds(),
        cell: cell.name.clone(),
        checksum: cell.approval.checksum.clone(),
        robots: heard.robots.iter().zip(&cell.robots).map(robot).collect(),
        objects: Vec::new(),
        slots,
        events: std::mem::take(&mut heard.events),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statuses_are_periodic_and_late_ones_are_not_made_up_for() {
        let begin = Instant::now();
        let after = |ms: u64| begin + Duration::from_millis(ms);
        assert_eq!(next_due(begin, after(3)), after(30));
        assert_eq!(next_due(after(30), after(55)), after(60));
        assert_eq!(next_due(after(60), after(200)), after(203));
    }
}
