//! A simulated cell: arms with brakes, their guards, arbiters, an unreliable network and unreliable processes.
//!
//! The network loses, repeats, delays and reorders messages; processes pause, crash and restart. The positions of
//! the arms are the truth, not the state of the protocol.
#![allow(dead_code, reason = "every test program uses a part of it")]

mod arm;
mod deadlocks;
mod process;

use elbowroom_interlock::{
    Arbiter, ArbiterEvent, ArbiterSettings, Boot, GrantsMessage, Guard, Micros, Occupancy, Outputs, RobotSettings,
    RobotSlot, SlotId, StateMessage,
};
use elbowroom_testkit::random::{split_mix, unit};

use arm::{Arm, Progress, REGIONS, STEP_MS, TICK_MS};
use deadlocks::DeadlockWatch;
use process::{ArbiterProcess, Process};

const SEND_MS: u64 = 10;

/// Faults that are planted to test whether the simulation finds them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlantedFault {
    None,
    /// Grants never expire, and silent robots are cleared at once.
    EndlessValidity,
    /// A robot that is asked to give up a slot loses it without its consent.
    UnilateralRelease,
}

/// The findings of a schedule.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Findings {
    pub double_occupancies: u64,
    /// A message sent before a clear and received after it reported the robot at a place where another robot is by now;
    /// both halt until the next message.
    pub conflicts: u64,
    /// Arms without progress in the last part, in which no fault happens, and in twenty more seconds, although no arm is
    /// preferred to them.
    pub stuck: u64,
    /// Arms with progress only in those additional seconds: many slow arms share the regions, and turn back on the way.
    pub late: u64,
    /// Arms without progress in the last part while preferred arms had progress.
    pub starved: u64,
    /// Cycles of waiting robots that could have been resolved, but were not.
    pub unresolved_deadlocks: u64,
    pub passages: u64,
    pub clears: u64,
    pub restarts: u64,
    pub second_arbiters: u64,
    pub switched_off: u64,
    pub longest_wait_ms: u64,
}

impl Findings {
    pub fn add(&mut self, other: &Self) {
        self.double_occupancies += other.double_occupancies;
        self.conflicts += other.conflicts;
        self.stuck += other.stuck;
        self.late += other.late;
        self.starved += other.starved;
        self.unresolved_deadlocks += other.unresolved_deadlocks;
        self.passages += other.passages;
        self.clears += other.clears;
        self.restarts += other.restarts;
        self.second_arbiters += other.second_arbiters;
        self.switched_off += other.switched_off;
        self.longest_wait_ms = self.longest_wait_ms.max(other.longest_wait_ms);
    }
}

#[derive(Debug, Clone)]
enum Packet {
    /// A message to the arbiter of this number.
    State(u64, StateMessage),
    Grants(GrantsMessage),
}

/// Times until which no message passes to and from a robot.
#[derive(Debug, Clone, Copy, Default)]
struct Cut {
    states_until_ms: u64,
    grants_until_ms: u64,
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
    cuts: Vec<Cut>,
    boots: u64,
    arbiters: Vec<ArbiterProcess>,
    settings: ArbiterSettings,
    packets: Vec<(u64, Packet)>,
    loss: f64,
    /// Factor by which faults are rarer.
    calm: f64,
    deadlock: DeadlockWatch,
    pub findings: Findings,
}

impl World {
    pub fn new(robots: usize, seed: u64, planted: PlantedFault) -> Self {
        let mut rng = seed;
        let has_priorities = split_mix(&mut rng).is_multiple_of(2);
        let slots = (0..REGIONS).map(SlotId);
        let mut robot = |i: usize| {
            let mut settings = RobotSettings::new(&format!("r{i}"), slots.clone());
            settings.stop_time = if planted == PlantedFault::EndlessValidity { Micros(0) } else { Micros(500_000) };
            settings.priority = if has_priorities { (split_mix(&mut rng) % 3) as i32 } else { 0 };
            settings
        };
        let mut settings = ArbiterSettings::new((0..robots).map(&mut robot).collect(), REGIONS);
        if planted == PlantedFault::EndlessValidity {
            settings.validity = Micros(0);
        }
        let is_turned = split_mix(&mut rng).is_multiple_of(2);
        let arms = (0..robots).map(|r| Arm::new(&mut rng, if is_turned { r } else { 0 })).collect();
        let processes = (0..robots).map(|_| Process::new(&mut rng)).collect();
        let process = Process::new(&mut rng);
        let loss = [0.0, 0.02, 0.3][split_mix(&mut rng) as usize % 3];
        let calm = [1.0, 3.0, 10.0][split_mix(&mut rng) as usize % 3];
        let arbiter = Arbiter::new(settings.clone(), Boot(10));
        let mut world = Self {
            rng,
            ms: 0,
            planted,
            arms,
            guards: Vec::new(),
            processes,
            trusted_at_ms: vec![0; robots],
            cuts: vec![Cut::default(); robots],
            boots: 10,
            arbiters: vec![ArbiterProcess { id: 10, arbiter, process, ends_ms: u64::MAX }],
            settings,
            packets: Vec::new(),
            loss,
            calm,
            deadlock: DeadlockWatch::default(),
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
            // The first messages after the faults must have been answered.
            if self.ms > calm + 500 && self.deadlock.is_unresolved(&self.arbiters[0].arbiter, &self.arms, self.ms) {
                self.findings.unresolved_deadlocks += 1;
            }
        }
        let late = self.count_stuck(calm);
        while self.findings.stuck > 0 && self.ms < length_ms + 20_000 {
            self.step();
            self.count_stuck(calm);
        }
        self.findings.late = late.saturating_sub(self.findings.stuck);
        self.findings.clone()
    }

    fn count_stuck(&mut self, since_ms: u64) -> u64 {
        (self.findings.starved, self.findings.stuck) = (0, 0);
        let priority = |r: usize| self.settings.robots[r].priority;
        let gets_on: Vec<bool> = self.arms.iter().map(|arm| arm.passed_at_ms >= since_ms).collect();
        for r in (0..gets_on.len()).filter(|r| !gets_on[*r]) {
            let is_starved = (0..gets_on.len()).any(|other| gets_on[other] && priority(other) > priority(r));
            *(if is_starved { &mut self.findings.starved } else { &mut self.findings.stuck }) += 1;
        }
        self.findings.stuck
    }

    fn chance(&mut self, p: f64) -> bool {
        unit(split_mix(&mut self.rng)) < p
    }

    fn between(&mut self, low: u64, high: u64) -> u64 {
        low + split_mix(&mut self.rng) % (high - low)
    }

    fn new_guard(&self, robot: usize, boot: Boot) -> Guard {
        let guard = Guard::new(RobotSlot(robot), REGIONS, 0, boot);
        if self.planted == PlantedFault::EndlessValidity { guard.validity(Micros(u64::MAX)) } else { guard }
    }

    fn fails(&mut self, p: f64) -> bool {
        let p = p / self.calm;
        self.chance(p)
    }

    /// Causes a fault now and then.
    fn fail(&mut self) {
        for r in 0..self.arms.len() {
            if self.fails(0.000_6) {
                self.processes[r].paused_until_ms = self.ms + self.between(10, 3_000);
            }
            if self.fails(0.000_3) {
                self.restart_guard(r);
            }
            if self.fails(0.000_5) {
                self.cut(r);
            }
            if self.fails(0.002) {
                self.clear_by_a_person(r);
            }
            if self.fails(0.005) {
                self.switch_off(r);
            }
        }
        if self.fails(0.000_2) {
            // The network splits.
            let members: Vec<usize> = (0..self.arms.len()).filter(|_| self.chance(0.5)).collect();
            for r in members {
                self.cut(r);
            }
        }
        if self.fails(0.000_3) {
            self.pause_arbiter();
        }
        if self.fails(0.000_2) {
            self.restart_arbiter();
        }
    }

    fn end_faults(&mut self) {
        self.loss = 0.0;
        self.cuts.fill(Cut::default());
        self.arbiters.truncate(1);
        for process in self.processes.iter_mut().chain([&mut self.arbiters[0].process]) {
            process.paused_until_ms = process.paused_until_ms.min(self.ms);
        }
    }

    /// Cuts the connection in both directions, or in one.
    fn cut(&mut self, r: usize) {
        let until_ms = self.ms + self.between(10, 3_000);
        let (states, grants) = [(true, true), (true, false), (false, true)][self.between(0, 3) as usize];
        let cut = &mut self.cuts[r];
        cut.states_until_ms = if states { until_ms } else { cut.states_until_ms };
        cut.grants_until_ms = if grants { until_ms } else { cut.grants_until_ms };
    }

    /// A person switches off the regions that the arm is in.
    fn switch_off(&mut self, r: usize) {
        let until_ms = self.ms + self.between(10, 2_000);
        let arm = &mut self.arms[r];
        for i in (0..REGIONS).filter(|i| arm.inside[*i]) {
            arm.off_until_ms[i] = until_ms;
            self.findings.switched_off += 1;
        }
    }

    /// The number of the next start. The time of day may have been set back, so it may be lower than the last one.
    fn next_boot(&mut self) -> Boot {
        self.boots += 1;
        let time = if self.chance(0.3) { 1 + self.boots / 2 } else { self.boots };
        // Two starts never have the same number.
        Boot(time * 1_000 + self.boots)
    }

    fn restart_guard(&mut self, robot: usize) {
        let boot = self.next_boot();
        self.guards[robot] = self.new_guard(robot, boot);
        let down = self.between(1, 1_000);
        self.processes[robot].down_until_ms = self.ms + down;
        // The joint values are trusted a moment later.
        self.trusted_at_ms[robot] = self.ms + down + self.between(0, 100);
        self.findings.restarts += 1;
    }

    fn restart_arbiter(&mut self) {
        let boot = self.next_boot();
        self.arbiters[0].arbiter = Arbiter::new(self.settings.clone(), boot);
        self.arbiters[0].process.down_until_ms = self.ms + self.between(1, 1_000);
        self.findings.restarts += 1;
    }

    /// Pauses the arbiter. Meanwhile somebody may start another arbiter, and later stop one of the two.
    fn pause_arbiter(&mut self) {
        let until_ms = self.ms + self.between(10, 2_000);
        self.arbiters[0].process.paused_until_ms = until_ms;
        if self.arbiters.len() > 1 || self.chance(0.5) {
            return;
        }
        let (boot, process) = (self.next_boot(), Process::new(&mut self.rng));
        let both_until_ms = until_ms + self.between(0, 300);
        let arbiter = Arbiter::new(self.settings.clone(), boot);
        let id = self.boots;
        self.arbiters.push(ArbiterProcess { id, arbiter, process, ends_ms: u64::MAX });
        let which = self.between(0, 2) as usize;
        self.arbiters[which].ends_ms = both_until_ms;
        self.findings.second_arbiters += 1;
    }

    /// A person clears a robot that they see at rest outside the regions.
    fn clear_by_a_person(&mut self, robot: usize) {
        let ArbiterProcess { arbiter, process, .. } = &mut self.arbiters[0];
        if !self.arms[robot].rests_outside() || !process.runs(self.ms) {
            return;
        }
        let now = process.clock(self.ms);
        let is_hasty = self.planted == PlantedFault::EndlessValidity;
        if arbiter.is_known(RobotSlot(robot), now) && !is_hasty {
            return;
        }
        if let Ok(outputs) = arbiter.clear(RobotSlot(robot), now) {
            self.findings.clears += 1;
            self.give_out(outputs);
        }
    }

    fn give_out(&mut self, outputs: Outputs) {
        let conflicts = outputs.events.iter().filter(|e| matches!(e, ArbiterEvent::Conflict(..))).count();
        self.findings.conflicts += conflicts as u64;
        outputs.replies.into_iter().for_each(|m| self.send(m.robot.0, &Packet::Grants(m)));
    }

    fn send(&mut self, robot: usize, packet: &Packet) {
        let cut = self.cuts[robot];
        let until_ms = if matches!(packet, Packet::State(..)) { cut.states_until_ms } else { cut.grants_until_ms };
        if self.ms < until_ms || self.chance(self.loss) {
            return;
        }
        let copies = if self.chance(0.05) { 2 } else { 1 };
        for _ in 0..copies {
            let delay = if self.chance(0.01) { self.between(5, 2_000) } else { self.between(0, 5) };
            self.packets.push((self.ms + delay, packet.clone()));
        }
    }

    fn step(&mut self) {
        if self.arbiters.len() > 1 {
            self.arbiters.retain(|arbiter| self.ms < arbiter.ends_ms);
        }
        self.deliver();
        for r in 0..self.arms.len() {
            if self.processes[r].runs(self.ms) {
                if self.ms.is_multiple_of(TICK_MS) {
                    self.tick(r);
                }
                if (self.ms + r as u64).is_multiple_of(SEND_MS) {
                    let message = self.guards[r].state(self.processes[r].clock(self.ms));
                    let ids: Vec<u64> = self.arbiters.iter().map(|arbiter| arbiter.id).collect();
                    for id in ids {
                        self.send(r, &Packet::State(id, message.clone()));
                    }
                }
            }
            self.move_arm(r);
        }
        self.count_double_occupancies();
        self.ms += STEP_MS;
    }

    fn arbiter(&mut self, id: u64) -> Option<&mut ArbiterProcess> {
        self.arbiters.iter_mut().find(|arbiter| arbiter.id == id)
    }

    fn deliver(&mut self) {
        let (ms, mut i) = (self.ms, 0);
        while i < self.packets.len() {
            let (at, packet) = &self.packets[i];
            let is_ready = *at <= ms
                && match packet {
                    Packet::State(id, _) => {
                        self.arbiters.iter().all(|a| a.id != *id || a.process.paused_until_ms <= ms)
                    }
                    Packet::Grants(m) => self.processes[m.robot.0].paused_until_ms <= ms,
                };
            if !is_ready {
                i += 1;
                continue;
            }
            match self.packets.swap_remove(i).1 {
                Packet::State(id, message) => self.arbiter_receives(id, &message),
                Packet::Grants(message) if self.processes[message.robot.0].runs(ms) => {
                    let _ = self.guards[message.robot.0].receive(&message);
                }
                Packet::Grants(_) => {}
            }
        }
    }

    fn arbiter_receives(&mut self, id: u64, message: &StateMessage) {
        let (ms, planted) = (self.ms, self.planted);
        let Some(ArbiterProcess { arbiter, process, .. }) = self.arbiter(id).filter(|a| a.process.runs(ms)) else {
            return;
        };
        let now = process.clock(ms);
        let outputs = arbiter.receive(message, now);
        for reply in &outputs.replies {
            let takes_back = planted == PlantedFault::UnilateralRelease && reply.robot == message.robot;
            if let Some(forged) = given_up(message, reply).filter(|_| takes_back) {
                arbiter.receive(&forged, now);
            }
        }
        self.give_out(outputs);
    }

    /// One tick of an arm's monitor: determines how fast the arm may move, and informs the guard.
    fn tick(&mut self, r: usize) {
        let ms = self.ms;
        let now = self.processes[r].clock(ms);
        self.arms[r].switch_on(ms);
        let (arm, guard) = (&self.arms[r], &self.guards[r]);
        let dt = 1e-3 * TICK_MS as f64;
        let is_trusted = ms >= self.trusted_at_ms[r];
        let is_inside = |i: usize| arm.sweeps(arm.stop(), i);
        let allowed = (0..REGIONS).all(|i| {
            // Rounding must not turn a robot that stops just before the border into one that cannot stop.
            let stays_out = !arm.sweeps(arm.latest_stop(dt + 1e-3), i);
            is_inside(i) || stays_out || guard.may_enter(arm.slots[i], now)
        });
        let halts = (0..REGIONS).any(|i| arm.off_until_ms[i] == 0 && guard.must_halt(arm.slots[i]));
        let accelerates = ms >= arm.rest_until_ms && is_trusted && allowed && !halts;
        let stop = if accelerates { arm.latest_stop(dt) } else { arm.stop() };
        for i in 0..REGIONS {
            let occupancy = if is_trusted { arm.occupancy(stop, i) } else { Occupancy::Unknown };
            self.guards[r].need(arm.slots[i], arm.off_until_ms[i] == 0);
            self.guards[r].observe(arm.slots[i], occupancy);
        }
        self.arms[r].accelerates = accelerates;
        self.arms[r].last_tick_ms = ms;
    }

    fn move_arm(&mut self, r: usize) {
        let rest_ms = self.between(0, 150);
        match self.arms[r].advance(self.ms, rest_ms, &mut self.rng) {
            Progress::None => {}
            Progress::Passed => self.findings.passages += 1,
            Progress::TurnedBack(waited_ms) => {
                self.findings.longest_wait_ms = self.findings.longest_wait_ms.max(waited_ms);
            }
        }
    }

    /// Counts the times at which an arm enters a slot that another arm is in.
    fn count_double_occupancies(&mut self) {
        for r in 0..self.arms.len() {
            for slot in self.arms[r].look() {
                let is_taken = self.arms.iter().enumerate().any(|(other, arm)| other != r && arm.is_in(slot));
                self.findings.double_occupancies += u64::from(is_taken);
            }
        }
    }
}

/// The message with which the robot would give up the requested slot, in the warning zone.
fn given_up(message: &StateMessage, reply: &GrantsMessage) -> Option<StateMessage> {
    let mut forged = message.clone();
    forged.sequence += 1;
    let s = reply.slots.iter().position(|answer| answer.release_requested)?;
    let slot = &mut forged.slots[s];
    (slot.released, slot.token, slot.occupancy) = (reply.slots[s].granted, None, Occupancy::Warning);
    Some(forged)
}
