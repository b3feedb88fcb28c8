//! An arm with brakes on a path through the regions.

use elbowroom_interlock::{Occupancy, SlotId};
use elbowroom_testkit::random::{split_mix, unit};

/// Number of regions on a path, which is also the number of slots of the cell.
pub const REGIONS: usize = 3;
/// The regions on the path of every arm, m.
const BORDERS: [(f64, f64); REGIONS] = [(0.8, 1.0), (1.1, 1.3), (1.4, 1.6)];
const PATH_END_M: f64 = 2.4;
const WARNING_M: f64 = 0.5;
const BRAKE_M_S2: f64 = 5.0;
pub const STEP_MS: u64 = 1;
pub const TICK_MS: u64 = 2;
/// Time without a tick after which a controller brakes.
const WATCHDOG_MS: u64 = 20;
/// Waiting time after which an arm turns back.
const PATIENCE_MS: u64 = 1_000;

#[derive(Debug)]
pub struct Arm {
    x: f64,
    pub v: f64,
    direction: f64,
    top_speed: f64,
    pub rest_until_ms: u64,
    pub accelerates: bool,
    pub last_tick_ms: u64,
    still_since_ms: u64,
    pub passed_at_ms: u64,
    /// Slot of each region on the path.
    pub slots: [SlotId; REGIONS],
    pub inside: [bool; REGIONS],
    /// Time until which each region is switched off. A region is switched on again at the latest when the arm has left
    /// it.
    pub off_until_ms: [u64; REGIONS],
}

/// The progress of an arm in a step.
pub enum Progress {
    None,
    /// The arm has arrived at an end of its path.
    Passed,
    /// The arm has turned back after waiting for this long.
    TurnedBack(u64),
}

impl Arm {
    /// Creates an arm; `turn` rotates its order of slots.
    pub fn new(rng: &mut u64, turn: usize) -> Self {
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
            passed_at_ms: 0,
            slots: std::array::from_fn(|i| SlotId((i + turn) % REGIONS)),
            inside: [false; REGIONS],
            off_until_ms: [0; REGIONS],
        }
    }

    /// The position at which it comes to rest if it brakes now.
    pub fn stop(&self) -> f64 {
        self.x + self.direction * self.v * self.v / (2.0 * BRAKE_M_S2)
    }

    /// The farthest position at which it comes to rest if it accelerates for `time_s` (s) and until its controller
    /// notices the missing tick.
    pub fn latest_stop(&self, time_s: f64) -> f64 {
        let reaction_s = time_s + 1e-3 * (WATCHDOG_MS + TICK_MS) as f64;
        let v = (self.v + BRAKE_M_S2 * reaction_s).min(self.top_speed);
        self.x + self.direction * (v * reaction_s + v * v / (2.0 * BRAKE_M_S2))
    }

    /// Whether it is in a region or will be before it comes to rest at `stop`.
    pub fn sweeps(&self, stop: f64, region: usize) -> bool {
        let (from, to) = BORDERS[region];
        let (low, high) = (self.x.min(stop), self.x.max(stop));
        high >= from && low <= to
    }

    pub fn occupancy(&self, stop: f64, region: usize) -> Occupancy {
        let (from, to) = BORDERS[region];
        let distance = (from - self.x).max(self.x - to);
        match (distance <= 0.0, self.sweeps(stop, region), distance < WARNING_M) {
            (true, ..) => Occupancy::Inside,
            (_, true, _) => Occupancy::Committed,
            (.., true) => Occupancy::Warning,
            _ => Occupancy::Outside,
        }
    }

    /// Whether it is outside the regions of a slot and can stop outside them.
    pub fn can_stay_out(&self, slot: SlotId) -> bool {
        let regions = (0..REGIONS).filter(|i| self.slots[*i] == slot);
        regions.into_iter().all(|i| !self.sweeps(self.latest_stop(2e-3 * TICK_MS as f64), i))
    }

    /// Whether it is at rest outside all regions.
    pub fn rests_outside(&self) -> bool {
        self.v == 0.0 && BORDERS.iter().all(|(from, to)| self.x < *from || self.x > *to)
    }

    /// Moves it for one step; at an end of its path it rests for `rest_ms`.
    pub fn advance(&mut self, ms: u64, rest_ms: u64, rng: &mut u64) -> Progress {
        let dt = 1e-3 * STEP_MS as f64;
        let has_ticks = ms - self.last_tick_ms <= WATCHDOG_MS;
        self.v = if self.accelerates && has_ticks {
            (self.v + BRAKE_M_S2 * dt).min(self.top_speed)
        } else {
            (self.v - BRAKE_M_S2 * dt).max(0.0)
        };
        self.x += self.direction * self.v * dt;
        if self.v > 0.0 {
            self.still_since_ms = ms;
        }
        let ahead = if self.direction > 0.0 { PATH_END_M - self.x } else { self.x };
        let (is_at_end, still_ms) = (ahead < 0.3, ms.saturating_sub(self.still_since_ms));
        if is_at_end {
            self.rest_until_ms = self.rest_until_ms.max(ms + rest_ms);
        }
        if self.v == 0.0 && is_at_end {
            self.direction = -self.direction;
            self.passed_at_ms = ms;
            return Progress::Passed;
        }
        if self.v == 0.0 && still_ms > PATIENCE_MS && ms >= self.rest_until_ms {
            self.direction = -self.direction;
            self.still_since_ms = ms + split_mix(rng) % 500;
            return Progress::TurnedBack(still_ms);
        }
        Progress::None
    }

    /// Updates the regions that it is in; returns the slots that it has just entered.
    pub fn look(&mut self) -> impl Iterator<Item = SlotId> + use<> {
        let before = self.inside;
        self.inside = BORDERS.map(|(from, to)| self.x > from && self.x < to);
        let (inside, slots) = (self.inside, self.slots);
        (0..REGIONS).filter(move |i| inside[*i] && !before[*i]).map(move |i| slots[i])
    }

    pub fn is_in(&self, slot: SlotId) -> bool {
        (0..REGIONS).any(|i| self.slots[i] == slot && self.inside[i])
    }

    /// Switches regions on again.
    pub fn switch_on(&mut self, ms: u64) {
        for i in 0..REGIONS {
            if ms >= self.off_until_ms[i] || !self.sweeps(self.latest_stop(1e-3 * TICK_MS as f64), i) {
                self.off_until_ms[i] = 0;
            }
        }
    }
}
