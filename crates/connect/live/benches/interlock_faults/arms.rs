//! Arms whose controllers obey the overrides that arrive; their poses are the ground truth.

use std::error::Error;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_live::network::{Network, Publisher, Subscription, Urgency};
use elbowroom_live::{Clock, ControllerClient, ControllerState, Keys, boot_number, configuration_number};

use crate::cell::{AMPLITUDE, STOP_TIME_S, TICK_MS, is_in_cart, name, occupied};
use crate::switches::Switches;

/// An arm that swings.
struct Arm {
    client: Arc<Mutex<ControllerClient>>,
    joint_states: Box<dyn Publisher>,
    _answers: Subscription,
    /// Angular frequency of the swing at override 1, rad/s.
    rate: f64,
    phase: f64,
    /// The override at which the arm runs: it follows the commanded one within the stop time.
    running: f64,
    bytes: Vec<u8>,
}

fn lock(client: &Mutex<ControllerClient>) -> MutexGuard<'_, ControllerClient> {
    client.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Arm {
    fn new(cell: &Cell, robot: usize, network: &dyn Network) -> Result<Self, Box<dyn Error>> {
        let (keys, name) = (Keys::new(&cell.name), name(robot));
        let watchdog = Micros::from_seconds(cell.monitoring.laws.stale_s);
        let client = ControllerClient::new(boot_number(), configuration_number(cell)).with_watchdog(watchdog);
        let client = Arc::new(Mutex::new(client));
        let receiver = client.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            // Refused answers have come too late.
            let _ = lock(&receiver).receive(bytes);
        });
        Ok(Self {
            _answers: network.subscribe(&keys.speed_override(&name), handler)?,
            joint_states: network.publisher(&keys.joint_states(&name), Urgency::RealTime)?,
            client,
            // Neighbours never swing in step for long.
            rate: 0.8 + 0.4 * (robot as f64 * 0.618).fract(),
            phase: 0.0,
            running: 0.0,
            bytes: Vec::new(),
        })
    }

    fn q(&self) -> f64 {
        AMPLITUDE * self.phase.sin()
    }

    fn tick(&mut self, now: Micros, dt_s: f64) {
        let mut client = lock(&self.client);
        let step = dt_s / STOP_TIME_S;
        self.running += (client.speed_override(now) - self.running).clamp(-step, step);
        self.phase += self.running * self.rate * dt_s;
        let intent = AMPLITUDE * self.rate * self.phase.cos();
        let state = ControllerState {
            q: &[AMPLITUDE * self.phase.sin()],
            qd: &[intent * self.running],
            intent: &[intent],
            programmed_override: 1.0,
            ..ControllerState::default()
        };
        self.bytes.clear();
        self.bytes.extend_from_slice(client.joint_state(now, &state));
        drop(client);
        self.joint_states.publish(&self.bytes);
    }
}

/// Observations of the true poses.
#[derive(Debug, Default)]
pub struct Seen {
    /// Number of ticks of the controllers.
    pub ticks: u64,
    /// Number of ticks that began more than a period late: the arms were held up too.
    pub late_ticks: u64,
    /// Number of entries into a region, per robot.
    pub entries: Vec<u64>,
    /// Time of the last entry into a region, per robot, s.
    last_entry_s: Vec<f64>,
    /// Longest time between two entries, per robot, s.
    pub longest_s: Vec<f64>,
    /// Number of ticks in which two robots were in one region, for each two.
    pub shared: u64,
    /// Number of times that a robot has entered its temporary region while it was certainly on.
    pub entered: u64,
    /// Number of ticks in which a robot waited before its temporary region, which was certainly on.
    pub held: u64,
    inside: Vec<Option<usize>>,
    in_cart: Vec<bool>,
}

impl Seen {
    fn observe(&mut self, arms: &[Arm], switches: &Switches, now_s: f64) {
        let robots = arms.len();
        for (robot, arm) in arms.iter().enumerate() {
            let is_in_cart = is_in_cart(arm.q());
            let was_in_cart = std::mem::replace(&mut self.in_cart[robot], is_in_cart);
            let is_on = switches.is_surely_on(robot);
            self.entered += u64::from(is_on && is_in_cart && !was_in_cart);
            self.held += u64::from(is_on && !is_in_cart && arm.running == 0.0);
            let is_in = occupied(robot, robots, arm.q());
            let before = std::mem::replace(&mut self.inside[robot], is_in);
            if is_in.is_some() && is_in != before {
                self.entries[robot] += 1;
                self.longest_s[robot] = self.longest_s[robot].max(now_s - self.last_entry_s[robot]);
                self.last_entry_s[robot] = now_s;
            }
        }
        for (robot, is_in) in self.inside.iter().enumerate().filter(|(_, is_in)| is_in.is_some()) {
            let others = self.inside[robot + 1..].iter().filter(|other| *other == is_in);
            self.shared += others.count() as u64;
        }
    }
}

/// Runs the arms for this time.
pub fn run(cell: &Cell, network: &dyn Network, switches: &Switches, time: Duration) -> Result<Seen, Box<dyn Error>> {
    let robots = cell.robots.len();
    let mut arms = (0..robots).map(|robot| Arm::new(cell, robot, network)).collect::<Result<Vec<_>, _>>()?;
    let mut seen = Seen {
        entries: vec![0; robots],
        last_entry_s: vec![0.0; robots],
        longest_s: vec![0.0; robots],
        inside: vec![None; robots],
        in_cart: vec![true; robots],
        ..Seen::default()
    };
    let (clock, period, began) = (Clock::start(), Duration::from_millis(TICK_MS), Instant::now());
    let mut due = began;
    while began.elapsed() < time {
        for arm in &mut arms {
            arm.tick(clock.micros(), period.as_secs_f64());
        }
        seen.observe(&arms, switches, began.elapsed().as_secs_f64());
        seen.ticks += 1;
        due += period;
        let now = Instant::now();
        if now > due + period {
            seen.late_ticks += 1;
            due = now;
        }
        std::thread::sleep(due.saturating_duration_since(now));
    }
    // The time since the last entry counts too, so that no arm is stopped at the end unnoticed.
    for (longest_s, last_s) in seen.longest_s.iter_mut().zip(&seen.last_entry_s) {
        *longest_s = longest_s.max(began.elapsed().as_secs_f64() - last_s);
    }
    Ok(seen)
}
