//! Controller that sends joint states at a fixed rate, and measures how long their answers take.

use std::error::Error;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_live::messages::OverrideAnswer;
use elbowroom_live::network::{Network, Urgency};
use elbowroom_live::{Clock, ControllerClient, ControllerState, Keys, boot_number, configuration_number};

use crate::cell::{MIDDLE, SWINGS};
use crate::measured::Measured;

/// Time that is not counted: connections are made, the first answers arrive.
const WARM_UP: Duration = Duration::from_secs(2);
/// Longest time until the first answer.
const FIRST_ANSWER: Duration = Duration::from_secs(30);
/// Number of joint states whose send times are kept.
const REMEMBERED: usize = 4096;

/// State shared by the thread of the ticks and that of the network.
struct Shared {
    client: ControllerClient,
    sent_us: Vec<u64>,
    /// The highest number that was answered.
    answered: u64,
    is_counting: bool,
    /// The first number that is counted.
    first: u64,
    measured: Measured,
}

fn lock(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    fn take(&mut self, bytes: &[u8], now: Micros) {
        let Ok(answer) = OverrideAnswer::decode(bytes) else { return };
        // Answers to a silent controller repeat a number: only the first one is timed.
        if self.client.receive(bytes).is_err() || answer.echo <= self.answered {
            return;
        }
        self.answered = answer.echo;
        if self.is_counting && answer.echo >= self.first {
            let sent_us = self.sent_us[answer.echo as usize % REMEMBERED];
            self.measured.latencies.add_us(now.0.saturating_sub(sent_us));
        }
    }
}

/// Measures for `seconds` at `rate_hz`, over a network to the node.
pub fn measure(
    cell: &Cell,
    robot: &str,
    network: &dyn Network,
    seconds: u64,
    rate_hz: u64,
) -> Result<Measured, Box<dyn Error>> {
    let (keys, clock) = (Keys::new(&cell.name), Clock::start());
    let watchdog = Micros::from_seconds(cell.monitoring.laws.stale_s);
    let shared = Arc::new(Mutex::new(Shared {
        client: ControllerClient::new(boot_number(), configuration_number(cell)).with_watchdog(watchdog),
        sent_us: vec![0; REMEMBERED],
        answered: 0,
        is_counting: false,
        first: 0,
        measured: Measured { robot: robot.to_owned(), ..Measured::default() },
    }));
    let answers = shared.clone();
    let handler = Box::new(move |bytes: &[u8]| {
        let now = clock.micros();
        lock(&answers).take(bytes, now);
    });
    let _subscription = network.subscribe(&keys.speed_override(robot), handler)?;
    let mut joint_states = network.publisher(&keys.joint_states(robot), Urgency::RealTime)?;

    let period = Duration::from_micros(1_000_000 / rate_hz);
    let (mut swings, mut bytes) = (Swings::default(), Vec::new());
    let began = Instant::now();
    let mut due = began;
    let mut counting: Option<Instant> = None;
    let mut number = 0;
    loop {
        let late = Instant::now().saturating_duration_since(due);
        let mut s = lock(&shared);
        let now = clock.micros();
        if counting.is_none() {
            counting = (began.elapsed() > WARM_UP && s.answered > 0).then(Instant::now);
            (s.is_counting, s.first) = (counting.is_some(), number + 1);
            if counting.is_none() && began.elapsed() > FIRST_ANSWER {
                return Err(format!("{robot}: no answer in {} s", FIRST_ANSWER.as_secs()).into());
            }
        }
        if let Some(since) = counting {
            if since.elapsed() >= Duration::from_secs(seconds) {
                break;
            }
            s.measured.sent += 1;
            s.measured.missed += u64::from(s.client.answer(now).is_none());
            s.measured.lateness.add_us(late.as_micros() as u64);
        }
        number += 1;
        let speed_override = s.client.speed_override(now);
        swings.advance(speed_override, period.as_secs_f64());
        bytes.clear();
        bytes.extend_from_slice(s.client.joint_state(now, &swings.state()));
        s.sent_us[number as usize % REMEMBERED] = clock.micros().0;
        drop(s);
        joint_states.publish(&bytes);
        due += period;
        // A controller that was held up does not send the missed joint states.
        due = due.max(Instant::now());
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    // The last answers are still on their way.
    std::thread::sleep(Duration::from_millis(100));
    let measured = lock(&shared).measured.clone();
    Ok(measured)
}

/// Joints that swing, as fast as the override permits.
#[derive(Default)]
struct Swings {
    time_s: f64,
    q: Vec<f64>,
    qd: Vec<f64>,
    intent: Vec<f64>,
}

impl Swings {
    fn advance(&mut self, speed_override: f64, dt_s: f64) {
        self.time_s += speed_override * dt_s;
        self.q.clear();
        self.qd.clear();
        self.intent.clear();
        for ((amplitude, rate), middle) in SWINGS.iter().zip(MIDDLE) {
            let phase = rate * self.time_s;
            self.q.push(middle + amplitude * phase.sin());
            let intent = amplitude * rate * phase.cos();
            self.intent.push(intent);
            self.qd.push(intent * speed_override);
        }
    }

    fn state(&self) -> ControllerState<'_> {
        ControllerState {
            q: &self.q,
            qd: &self.qd,
            intent: &self.intent,
            programmed_override: 1.0,
            ..ControllerState::default()
        }
    }
}
