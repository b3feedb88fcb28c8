//! Judge: where the robots and the regions truly are, from the robots' joint values and the time of day.

use std::sync::{Arc, Mutex, PoisonError};

use elbowroom_live::Keys;
use elbowroom_live::messages::JointState;
use elbowroom_live::network::{Network, NetworkError, Subscription};
use elbowroom_status::RobotStatus;

use crate::motion::{ROBOTS, TOUCH_M, carriage, region, since};

/// Depth that a delay of the judge's own messages may feign, m: 5 ms at the largest speeds.
const FEIGNED_M: f64 = 0.006;
/// Speed (m/s) below which a robot counts as at rest.
const REST_M_S: f64 = 0.005;

/// What the judge has seen of one robot.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    pub states: u64,
    /// Metres travelled.
    pub travelled_m: f64,
    /// Times at which it came to touch the region by its own motion.
    pub entries: u64,
    /// Times at which the region came to the robot at rest.
    pub reached_at_rest: u64,
    /// Statuses after which it stopped because the source was lost, or had jumped.
    pub losses: u64,
    /// Least distance at which it moved towards the region, m.
    pub nearest_m: f64,
    last_q: Option<f64>,
    is_inside: bool,
    is_lost: bool,
}

impl Seen {
    fn state(&mut self, robot: usize, q: f64, qd: f64, t_s: f64) {
        let away = carriage(robot, q) - region(robot, t_s);
        let distance_m = away.length() - TOUCH_M;
        let moves_towards = qd * away.z < 0.0 && qd.abs() > REST_M_S;
        if moves_towards {
            self.nearest_m = self.nearest_m.min(distance_m);
        }
        let is_inside = distance_m < -FEIGNED_M;
        if is_inside && !self.is_inside {
            *(if moves_towards { &mut self.entries } else { &mut self.reached_at_rest }) += 1;
        }
        // It counts as outside again at a distance, so that a touch is counted once.
        self.is_inside = is_inside || self.is_inside && distance_m < FEIGNED_M;
        self.travelled_m += self.last_q.map_or(0.0, |last| (q - last).abs());
        self.last_q = Some(q);
        self.states += 1;
    }

    fn status(&mut self, status: &RobotStatus) {
        let is_lost = ["is lost", "jumped"].iter().any(|why| status.reason.contains(why));
        self.losses += u64::from(is_lost && !self.is_lost);
        self.is_lost = is_lost;
    }
}

pub struct Judge {
    seen: Arc<Mutex<Vec<Seen>>>,
    _subscriptions: Vec<Subscription>,
}

impl Judge {
    pub fn start(keys: &Keys, network: &dyn Network, epoch_us: u64) -> Result<Self, NetworkError> {
        let seen = Arc::new(Mutex::new(vec![Seen { nearest_m: f64::INFINITY, ..Seen::default() }; ROBOTS.len()]));
        let mut subscriptions = Vec::new();
        for (robot, name) in ROBOTS.iter().enumerate() {
            let of_states = seen.clone();
            let handler = Box::new(move |bytes: &[u8]| {
                let (mut state, t_s) = (JointState::default(), since(epoch_us));
                if state.decode(bytes).is_ok() {
                    let mut seen = of_states.lock().unwrap_or_else(PoisonError::into_inner);
                    seen[robot].state(robot, state.q[0], state.qd.first().copied().unwrap_or(0.0), t_s);
                }
            });
            subscriptions.push(network.subscribe(&keys.joint_states(name), handler)?);
            let of_statuses = seen.clone();
            let handler = Box::new(move |bytes: &[u8]| {
                if let Ok(status) = serde_json::from_slice(bytes) {
                    of_statuses.lock().unwrap_or_else(PoisonError::into_inner)[robot].status(&status);
                }
            });
            subscriptions.push(network.subscribe(&keys.status(name), handler)?);
        }
        Ok(Self { seen, _subscriptions: subscriptions })
    }

    pub fn seen(&self) -> Vec<Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
