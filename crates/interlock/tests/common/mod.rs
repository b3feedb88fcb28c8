//! A simulated cell: arms with brakes, their guards, an arbiter, a network that loses, repeats, delays and reorders messages, and
//! processes that pause, crash and restart. The truth is where the arms are, not what the protocol believes.
#![allow(dead_code, reason = "every test program uses a part of it")]

use elbowroom_interlock::{
    Arbiter, ArbiterSettings, Boot, GrantsMessage, Guard, Micros, RobotSettings, StateMessage, Token,
};
use elbowroom_monitor::{Occupancy, RobotSlot, SlotId};
use elbowroom_testkit::random::{split_mix, unit};

/// Regions on the path of every arm, m.
const REGIONS: [(f64, f64); 2] = [(0.8, 1.0), (1.1, 1.3)];
const PATH_END_M: f64 = 2.1;
const WARNING_M: f64 = 0.5;
const BRAKE_M_S2: f64 = 5.0;
const STEP_MS: u64 = 1;
const TICK_MS: u64 = 2;
const SEND_MS: u64 = 10;
/// A controller brakes when it has had no tick for this long.
const WATCHDOG_MS: u64 = 20;
/// An arm that has waited for this long turns back.
const PATIENCE_MS: u64 = 1_000;

/// Faults that are built in to see whether the simulation finds them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlantedFault {
    None,
    /// Grants never expire, and silent robots are cleared at once.
    EndlessValidity,
    /// A report without a grant counts as one that gives it up, whichever it was.
    TokensUnchecked,
    /// A robot that is asked to give a slot up loses it without its consent.
    UnilateralRelease,
}

/// What a schedule showed.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Findings {
    pub double_occupancies: u64,
    /// Arms that did not get on in the last part, in which no fault happens.
    pub stuck: u64,
    pub passages: u64,
    pub clears: u64,
    pub restarts: u64,
    pub longest_wait_ms: u64,
}

#[derive(Debug)]
struct Arm {
    x: f64,
    v: f64,
    direction: f64,
    top_speed: f64,
    rest_until_ms: u64,
    accelerates: bool,
    last_tick_ms: u64,
    still_since_ms: u64,
    inside: [bool; 2],
    passed_at_ms: u64,
}

#[derive(Debug)]
struct Process {
    down_until_ms: u64,
    paused_until_ms: u64,
    offset: u64,
    /// Rate of the clock, 1 ± 0.5 %.
    rate: f64,
}

impl Process {
    fn new(rng: &mut u64) -> Self {
        let rate = 0.995 + 0.01 * unit(split_mix(rng));
        Self { down_until_ms: 0, paused_until_ms: 0, offset: split_mix(rng) % 1_000_000_000, rate }
    }

    fn runs(&self, ms: u64) -> bool {
        ms >= self.down_until_ms && ms >= self.paused_until_ms
    }

    fn clock(&self, ms: u64) -> Micros {
        Micros(self.offset + (ms as f64 * 1e3 * self.rate) as u64)
    }
}

#[derive(Debug, Clone)]
enum Packet {
    State(StateMessage),
    Grants(GrantsMessage),
}

/// One simulated cell.
pub struct World {
    rng: u64,
    ms: u64,
    planted: PlantedFault,
    arms: Vec<Arm>,
    guards: Vec<Guard>,
    processes: Vec<Process>,
    trusted_at_ms: Vec<u64>,
    cut_until_ms: Vec<u64>,
    boots: u64,
    arbiter: Arbiter,
    settings: ArbiterSettings,
    arbiter_process: Process,
    packets: Vec<(u64, Packet)>,
    loss: f64,
    /// Faults are this much rarer.
    calm: f64,
    pub findings: Findings,
}

impl World {
    pub fn new(robots: usize, seed: u64, planted: PlantedFault) -> Self {
        let mut rng = seed;
        let robot = |i: usize| {
            let mut settings = RobotSettings::new(&format!("r{i}"), [SlotId(0), SlotId(1)]);
            settings.stop_time = if planted == PlantedFault::EndlessValidity { Micros(0) } else { Micros(500_000) };
            settings
        };
        let mut settings = ArbiterSettings::new((0..robots).map(robot).collect(), 2);
        if planted == PlantedFault::EndlessValidity {
            settings.validity = Micros(0);
        }
        let arms = (0..robots).map(|_| Arm::new(&mut rng)).collect();
        let processes = (0..robots).map(|_| Process::new(&mut rng)).collect();
        let arbiter_process = Process::new(&mut rng);
        let loss = [0.0, 0.02, 0.3][split_mix(&mut rng) as usize % 3];
        let calm = [1.0, 3.0, 10.0][split_mix(&mut rng) as usize % 3];
        let mut world = Self {
            rng,
            ms: 0,
            planted,
            arms,
            guards: Vec::new(),
            processes,
            trusted_at_ms: vec![0; robots],
            cut_until_ms: vec![0; robots],
            boots: 10,
            arbiter: Arbiter::new(settings.clone(), Boot(10)),
            settings,
            arbiter_process,
            packets: Vec::new(),
            loss,
            calm,
            findings: Findings::default(),
        };
        world.guards = (0..robots).map(|r| world.new_guard(r, Boot(10))).collect();
        world
    }

    /// Runs a schedule of this many milliseconds; in the last 40 % nothing fails.
    pub fn run(&mut self, length_ms: u64) -> Findings {
        let calm = length_ms * 6 / 10;
        while self.ms < length_ms {
            if self.ms < calm {
                self.fail();
            } else if self.ms == calm {
                self.end_faults();
            }
            self.step();
        }
        let since = |arm: &Arm| length_ms.saturating_sub(arm.passed_at_ms);
        self.findings.stuck = self.arms.iter().filter(|arm| since(arm) > length_ms - calm).count() as u64;
        self.findings.clone()
    }

    fn chance(&mut self, p: f64) -> bool {
        unit(split_mix(&mut self.rng)) < p
    }

    fn between(&mut self, low: u64, high: u64) -> u64 {
        low + split_mix(&mut self.rng) % (high - low)
    }

    fn new_guard(&self, robot: usize, boot: Boot) -> Guard {
        let guard = Guard::new(RobotSlot(robot), 2, 0, boot);
        if self.planted == PlantedFault::EndlessValidity { guard.validity(Micros(u64::MAX)) } else { guard }
    }

    fn fails(&mut self, p: f64) -> bool {
        let p = p / self.calm;
        self.chance(p)
    }

    /// Lets something fail, now and then.
    fn fail(&mut self) {
        for r in 0..self.arms.len() {
            if self.fails(0.000_6) {
                self.processes[r].paused_until_ms = self.ms + self.between(10, 3_000);
            }
            if self.fails(0.000_3) {
                self.restart_guard(r);
            }
            if self.fails(0.000_5) {
                self.cut_until_ms[r] = self.ms + self.between(10, 3_000);
            }
            if self.fails(0.002) {
                self.clear_by_a_person(r);
            }
        }
        if self.fails(0.000_3) {
            self.arbiter_process.paused_until_ms = self.ms + self.between(10, 2_000);
        }
        if self.fails(0.000_2) {
            self.restart_arbiter();
        }
    }

    fn end_faults(&mut self) {
        self.loss = 0.0;
        self.cut_until_ms.fill(0);
        for process in self.processes.iter_mut().chain([&mut self.arbiter_process]) {
            process.paused_until_ms = process.paused_until_ms.min(self.ms);
        }
    }

    /// The time of day may have been set back: the number of the start may be lower than the last.
    fn next_boot(&mut self) -> Boot {
        self.boots += 1;
        let time = if self.chance(0.3) { 1 + self.boots / 2 } else { self.boots };
        // No two starts take the same number.
        Boot(time * 1_000 + self.boots)
    }

    fn restart_guard(&mut self, robot: usize) {
        let boot = self.next_boot();
        self.guards[robot] = self.new_guard(robot, boot);
        let down = self.between(1, 1_000);
        self.processes[robot].down_until_ms = self.ms + down;
        // Its joints are trusted a moment later.
        self.trusted_at_ms[robot] = self.ms + down + self.between(0, 100);
        self.findings.restarts += 1;
    }

    fn restart_arbiter(&mut self) {
        let boot = self.next_boot();
        self.arbiter = Arbiter::new(self.settings.clone(), boot);
        self.arbiter_process.down_until_ms = self.ms + self.between(1, 1_000);
        self.findings.restarts += 1;
    }

    /// A person clears a robot that they see at rest outside of the regions.
    fn clear_by_a_person(&mut self, robot: usize) {
        let arm = &self.arms[robot];
        let is_outside = REGIONS.iter().all(|(from, to)| arm.x < *from || arm.x > *to);
        if arm.v == 0.0 && is_outside && self.arbiter_process.runs(self.ms) {
            let now = self.arbiter_process.clock(self.ms);
            let is_hasty = self.planted == PlantedFault::EndlessValidity;
            if self.arbiter.is_known(RobotSlot(robot), now) && !is_hasty {
                return;
            }
            if let Ok(outputs) = self.arbiter.clear(RobotSlot(robot), now) {
                self.findings.clears += 1;
                outputs.replies.into_iter().for_each(|m| self.send(m.robot.0, &Packet::Grants(m)));
            }
        }
    }

    fn send(&mut self, robot: usize, packet: &Packet) {
        if self.ms < self.cut_until_ms[robot] || self.chance(self.loss) {
            return;
        }
        let copies = if self.chance(0.05) { 2 } else { 1 };
        for _ in 0..copies {
            let delay = if self.chance(0.01) { self.between(5, 2_000) } else { self.between(0, 5) };
            self.packets.push((self.ms + delay, packet.clone()));
        }
    }

    fn step(&mut self) {
        self.deliver();
        for r in 0..self.arms.len() {
            if self.processes[r].runs(self.ms) {
                if self.ms.is_multiple_of(TICK_MS) {
                    self.tick(r);
                }
                if (self.ms + r as u64).is_multiple_of(SEND_MS) {
                    let message = self.guards[r].state(self.processes[r].clock(self.ms));
                    self.send(r, &Packet::State(message));
                }
            }
            self.move_arm(r);
        }
        self.count_double_occupancies();
        self.ms += STEP_MS;
    }

    fn deliver(&mut self) {
        let mut i = 0;
        while i < self.packets.len() {
            let (at, packet) = &self.packets[i];
            let is_ready = *at <= self.ms
                && match packet {
                    Packet::State(_) => self.arbiter_process.paused_until_ms <= self.ms,
                    Packet::Grants(m) => self.processes[m.robot.0].paused_until_ms <= self.ms,
                };
            if !is_ready {
                i += 1;
                continue;
            }
            match self.packets.swap_remove(i).1 {
                Packet::State(message) => self.arbiter_receives(message),
                Packet::Grants(message) if self.processes[message.robot.0].runs(self.ms) => {
                    let _ = self.guards[message.robot.0].receive(&message);
                }
                Packet::Grants(_) => {}
            }
        }
    }

    fn arbiter_receives(&mut self, mut message: StateMessage) {
        if !self.arbiter_process.runs(self.ms) {
            return;
        }
        let last = Token { boot: Boot(u64::MAX), number: u64::MAX };
        if self.planted == PlantedFault::TokensUnchecked {
            for slot in message.slots.iter_mut().filter(|s| s.token.is_none() && !s.occupancy.occupies()) {
                slot.released = Some(last);
            }
        }
        let now = self.arbiter_process.clock(self.ms);
        let outputs = self.arbiter.receive(&message, now);
        for reply in outputs.replies {
            let takes_back = self.planted == PlantedFault::UnilateralRelease && reply.robot == message.robot;
            if let Some(forged) = given_up(&message, &reply).filter(|_| takes_back) {
                self.arbiter.receive(&forged, now);
            }
            self.send(reply.robot.0, &Packet::Grants(reply));
        }
    }

    /// One tick of the monitor of an arm: how fast it may move, and what the guard is to know of it.
    fn tick(&mut self, r: usize) {
        let now = self.processes[r].clock(self.ms);
        let arm = &self.arms[r];
        let dt = 1e-3 * TICK_MS as f64;
        let wants_to_move = self.ms >= arm.rest_until_ms && self.ms >= self.trusted_at_ms[r];
        let is_inside = |s: usize| arm.sweeps(arm.stop(), s);
        let allowed = (0..2).all(|s| {
            // Rounding must not make a robot that stops just before the border one that cannot stop.
            let stays_out = !arm.sweeps(arm.latest_stop(dt + 1e-3), s);
            is_inside(s) || stays_out || self.guards[r].may_enter(SlotId(s), now)
        });
        let halts = (0..2).any(|s| self.guards[r].must_halt(SlotId(s)) && !is_inside(s));
        let accelerates = wants_to_move && allowed && !halts;
        let stop = if accelerates { arm.latest_stop(dt) } else { arm.stop() };
        let occupancy = [0, 1].map(|s| arm.occupancy(stop, s));
        self.arms[r].accelerates = accelerates;
        self.arms[r].last_tick_ms = self.ms;
        for (s, occupancy) in occupancy.into_iter().enumerate() {
            let trusted = self.ms >= self.trusted_at_ms[r];
            self.guards[r].observe(SlotId(s), if trusted { occupancy } else { Occupancy::Unknown });
        }
    }

    fn move_arm(&mut self, r: usize) {
        let ms = self.ms;
        let rest = self.between(0, 150);
        let arm = &mut self.arms[r];
        let dt = 1e-3 * STEP_MS as f64;
        let has_ticks = ms - arm.last_tick_ms <= WATCHDOG_MS;
        arm.v = if arm.accelerates && has_ticks {
            (arm.v + BRAKE_M_S2 * dt).min(arm.top_speed)
        } else {
            (arm.v - BRAKE_M_S2 * dt).max(0.0)
        };
        arm.x += arm.direction * arm.v * dt;
        let ahead = if arm.direction > 0.0 { PATH_END_M - arm.x } else { arm.x };
        if arm.v > 0.0 {
            arm.still_since_ms = ms;
        }
        let is_at_end = ahead < 0.3;
        if is_at_end {
            arm.rest_until_ms = arm.rest_until_ms.max(ms + rest);
        }
        if arm.v == 0.0 && is_at_end {
            arm.direction = -arm.direction;
            arm.passed_at_ms = ms;
            self.findings.passages += 1;
        } else if arm.v == 0.0 && ms.saturating_sub(arm.still_since_ms) > PATIENCE_MS && ms >= arm.rest_until_ms {
            self.findings.longest_wait_ms = self.findings.longest_wait_ms.max(ms - arm.still_since_ms);
            arm.direction = -arm.direction;
            arm.still_since_ms = ms + split_mix(&mut self.rng) % 500;
        }
    }

    /// Counts the moments at which two arms begin to be in one region.
    fn count_double_occupancies(&mut self) {
        for (s, (from, to)) in REGIONS.iter().enumerate() {
            let before = self.arms.iter().filter(|arm| arm.inside[s]).count();
            for arm in &mut self.arms {
                arm.inside[s] = arm.x > *from && arm.x < *to;
            }
            let after = self.arms.iter().filter(|arm| arm.inside[s]).count();
            self.findings.double_occupancies += u64::from(after > 1 && after > before);
        }
    }
}

/// The message with which the robot would give up what it is asked for, in the warning zone.
fn given_up(message: &StateMessage, reply: &GrantsMessage) -> Option<StateMessage> {
    let mut forged = message.clone();
    forged.sequence += 1;
    let s = reply.slots.iter().position(|answer| answer.release_requested)?;
    let slot = &mut forged.slots[s];
    (slot.released, slot.token, slot.occupancy) = (reply.slots[s].granted, None, Occupancy::Warning);
    Some(forged)
}

impl Arm {
    fn new(rng: &mut u64) -> Self {
        let forward = split_mix(rng).is_multiple_of(2);
        Self {
            x: if forward { 0.0 } else { PATH_END_M },
            v: 0.0,
            direction: if forward { 1.0 } else { -1.0 },
            top_speed: 0.5 + unit(split_mix(rng)),
            rest_until_ms: split_mix(rng) % 500,
            accelerates: false,
            last_tick_ms: 0,
            still_since_ms: 0,
            inside: [false; 2],
            passed_at_ms: 0,
        }
    }

    /// Where it rests if it brakes now.
    fn stop(&self) -> f64 {
        self.x + self.direction * self.v * self.v / (2.0 * BRAKE_M_S2)
    }

    /// Where it rests at the latest if it speeds up for a time (s) and until its controller notices that no tick came.
    fn latest_stop(&self, time_s: f64) -> f64 {
        let reaction_s = time_s + 1e-3 * (WATCHDOG_MS + TICK_MS) as f64;
        let v = (self.v + BRAKE_M_S2 * reaction_s).min(self.top_speed);
        self.x + self.direction * (v * reaction_s + v * v / (2.0 * BRAKE_M_S2))
    }

    /// Whether it is in a region or will be before it rests at `stop`.
    fn sweeps(&self, stop: f64, s: usize) -> bool {
        let (from, to) = REGIONS[s];
        let (low, high) = (self.x.min(stop), self.x.max(stop));
        high >= from && low <= to
    }

    fn occupancy(&self, stop: f64, s: usize) -> Occupancy {
        let (from, to) = REGIONS[s];
        let distance = (from - self.x).max(self.x - to);
        match (distance <= 0.0, self.sweeps(stop, s), distance < WARNING_M) {
            (true, ..) => Occupancy::Inside,
            (_, true, _) => Occupancy::Committed,
            (.., true) => Occupancy::Warning,
            _ => Occupancy::Outside,
        }
    }
}
