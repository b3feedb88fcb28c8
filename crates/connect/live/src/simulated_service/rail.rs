//! Carriages that obey the overrides of their controllers; where they are is the truth.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use elbowroom_testkit::random::SplitMix;

use super::cell::{RAIL_M, REACTION_MS, SPEED_M_S, STALE_MS, STOP_TIME_S, SimulatedCell, name};
use super::process_clock::ProcessClock;
use crate::client::{ControllerClient, ControllerState};
use crate::clock::Clock;
use crate::configuration_number::configuration_number;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, Publisher, Subscription, Urgency};

/// Interval between two joint states, ms.
const TICK_MS: u64 = 10;
/// Deceleration, m/s².
const BRAKE_M_S2: f64 = SPEED_M_S / STOP_TIME_S;
/// Acceleration, m/s².
const ACCELERATION_M_S2: f64 = 3.0;
/// Time at rest after which a program goes elsewhere, ms.
const PATIENCE_MS: u64 = 3_000;

/// A carriage, its program and its controller.
pub(super) struct Carriage {
    pub(super) q: f64,
    pub(super) v: f64,
    pub(super) target: f64,
    direction: f64,
    /// Overrides of the last milliseconds, which do not count yet.
    commands: VecDeque<f64>,
    still_ms: u64,
    /// Number of targets that were reached.
    pub(super) arrivals: u64,
    controller: Controller,
}

/// A start of a controller.
struct Controller {
    client: Arc<Mutex<ControllerClient>>,
    clock: Clock,
    joint_states: Box<dyn Publisher>,
    bytes: Vec<u8>,
    _answers: Subscription,
}

impl Controller {
    fn new(cell: &SimulatedCell, rail: usize, network: &dyn Network, clock: ProcessClock, boot: u64) -> Self {
        let (keys, name) = (Keys::new(&cell.cell.name), name(rail));
        let watchdog = elbowroom_interlock::Micros(1_000 * STALE_MS);
        let client = ControllerClient::new(boot, configuration_number(&cell.cell)).with_watchdog(watchdog);
        let client = Arc::new(Mutex::new(client));
        let obeying = client.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            // A late answer, or one of another node, is not obeyed.
            let _ = locked(&obeying).receive(bytes);
        });
        Self {
            client,
            clock: Clock::simulated(clock),
            joint_states: network.publisher(&keys.joint_states(&name), Urgency::RealTime).expect("a key"),
            bytes: Vec::new(),
            _answers: network.subscribe(&keys.speed_override(&name), handler).expect("a key"),
        }
    }
}

impl Carriage {
    pub(super) fn new(
        cell: &SimulatedCell,
        rail: usize,
        q: f64,
        network: &dyn Network,
        (clock, boot): (ProcessClock, u64),
    ) -> Self {
        Self {
            q,
            v: 0.0,
            target: q,
            direction: 1.0,
            commands: VecDeque::from(vec![0.0; REACTION_MS as usize]),
            still_ms: 0,
            arrivals: 0,
            controller: Controller::new(cell, rail, network, clock, boot),
        }
    }

    /// Its controller starts again.
    pub(super) fn restart(
        &mut self,
        cell: &SimulatedCell,
        rail: usize,
        network: &dyn Network,
        (clock, boot): (ProcessClock, u64),
    ) {
        self.controller = Controller::new(cell, rail, network, clock, boot);
    }

    /// Moves it by a millisecond, and sends a joint state from time to time.
    pub(super) fn step(&mut self, ms: u64, random: &mut SplitMix) {
        let now = self.controller.clock.micros();
        let commanded = locked(&self.controller.client).speed_override(now);
        self.commands.push_back(commanded);
        // A lower override counts when the reaction time has passed, and so does a higher one.
        let obeyed = self.commands.pop_front().unwrap_or(0.0);
        let wanted = obeyed * self.programmed().abs();
        let most = self.v.abs();
        let speed = if wanted < most {
            (most - 1e-3 * BRAKE_M_S2).max(wanted)
        } else {
            (most + 1e-3 * ACCELERATION_M_S2).min(wanted)
        };
        self.v = self.direction * speed;
        self.q = (self.q + 1e-3 * self.v).clamp(0.0, RAIL_M);
        self.choose(random);
        if ms.is_multiple_of(TICK_MS) {
            self.send();
        }
    }

    /// The velocity of the program at full override, m/s: it brakes before its target.
    fn programmed(&self) -> f64 {
        let left_m = (self.target - self.q) * self.direction;
        self.direction * (2.0 * 0.5 * BRAKE_M_S2 * left_m.max(0.0)).sqrt().min(SPEED_M_S)
    }

    /// Chooses another target at the old one, or after waiting in vain; only at rest, as a program does.
    fn choose(&mut self, random: &mut SplitMix) {
        self.still_ms = if self.v.abs() < 0.02 { self.still_ms + 1 } else { 0 };
        let is_there = (self.target - self.q) * self.direction < 0.005;
        if self.still_ms > 0 && is_there || self.still_ms > PATIENCE_MS {
            self.arrivals += u64::from(is_there && self.still_ms < PATIENCE_MS);
            self.v = 0.0;
            self.still_ms = 0;
            self.target = 0.05 + random.unit() * (RAIL_M - 0.1);
            self.direction = if self.target >= self.q { 1.0 } else { -1.0 };
        }
    }

    fn send(&mut self) {
        let intent = self.programmed();
        let Controller { client, clock, joint_states, bytes, .. } = &mut self.controller;
        let state = ControllerState {
            q: &[self.q],
            qd: &[self.v],
            intent: &[intent],
            programmed_override: 1.0,
            ..ControllerState::default()
        };
        bytes.clear();
        bytes.extend_from_slice(locked(client).joint_state(clock.micros(), &state));
        joint_states.publish(bytes);
    }
}
