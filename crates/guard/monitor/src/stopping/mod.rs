//! The stopping-distance law: the largest override from which a stop still ends before a region.
//!
//! The travel of a volume is bounded in two ways; the smaller bound counts. Both hold for every program that keeps
//! to the accelerations of [`StoppingSettings`](crate::StoppingSettings).
//! - **By program time**: until the robot is at rest, the program advances by at most some time u. Within u no joint
//!   deviates from the straight line `q′·u` by more than `A·u²/2`. This bound is tighter for a robot that passes by
//!   or leaves.
//! - **By the stop**: after braking has begun, no joint travels farther than `a·n²/2`, whatever the program does.
//!   This bound is tighter for a robot that moves straight towards a region.
//!
//! `docs/laws.md`, section 7, derives the bounds.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::{Pose, Vec3};

use crate::attached_volumes::AttachedVolumes;
use crate::braking_check::{Braking, BrakingCheck};
use crate::carried_volume::{Approach, CarriedVolume, VolumeMotion, WorldAxis};
use crate::laws::{stop_time, stopping_program_time};
use crate::override_history::{OverrideHistory, OverrideRange, PendingMotion, StopTime};
use crate::region_approach::RegionApproach;
use crate::{Configuration, StoppingSettings, VolumeId};

/// Safety factor of the reaction time. While a robot slows down, it still executes earlier, higher overrides.
/// Without this margin the proof fails from time to time, and the override falls to 0 and rises again.
const REACTION_FACTOR: f64 = 2.0;
/// Halvings of the interval in which the largest override is searched.
const BISECTION_STEPS: u32 = 16;

/// The state of the law in one tick; allocated once.
#[derive(Debug)]
pub(crate) struct StoppingLaw {
    settings: StoppingSettings,
    /// Bound α of the rate of change of the stop time, by program time.
    growth: f64,
    axes: Vec<WorldAxis>,
    volumes: Vec<CarriedVolume>,
    /// Largest travel of each volume in any direction until the robot is at rest, m.
    reach_m: Vec<f64>,
    /// Joint speeds of the program at override 1.
    program: JointSpeeds,
    /// Actual joint speeds.
    real: JointSpeeds,
    /// False if the program's speeds are only inferred from the actual ones.
    program_is_known: bool,
    history: OverrideHistory,
    /// Time from the snapshot to the start of a stop that is requested in the next tick, s.
    horizon_s: f64,
    /// Upper bound of the time until the robot is at rest, s.
    rest_after_s: f64,
    /// Time over which velocities were derived from positions, s.
    uncertain_s: f64,
    /// Upper bound of the program time since the joint values last changed, s.
    unchanged_s: f64,
    /// Motion until the override of this tick takes effect.
    pending: PendingMotion,
    braking: BrakingCheck,
}

/// Joint speeds and their stop time.
#[derive(Debug)]
struct JointSpeeds {
    speed: Vec<f64>,
    stop_s: f64,
}

/// Phases of a motion that ends at rest; times in s.
#[derive(Debug, Clone, Copy)]
struct StopPhases {
    /// Program time until braking starts.
    run: f64,
    /// Stop time when braking starts.
    stop: f64,
    /// Program time until rest.
    total: f64,
}

/// Input of a tick.
pub(crate) struct StoppingInput<'a> {
    /// The chain at the actual velocities.
    pub(crate) now: &'a ChainState,
    /// The chain at the velocities of the program at override 1.
    pub(crate) intent: &'a ChainState,
    pub(crate) program_is_known: bool,
    pub(crate) now_s: f64,
    pub(crate) stamp_s: f64,
    pub(crate) programmed_override: f64,
    /// Time over which the actual velocities were derived from positions, s; 0 if they were given.
    pub(crate) uncertain_s: f64,
    /// Upper bound of the program time since the joint values last changed, s.
    pub(crate) unchanged_s: f64,
    pub(crate) volume_in_world: &'a [Pose],
    pub(crate) attached: &'a AttachedVolumes,
}

/// A volume near a region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StoppingQuery {
    pub(crate) volume: usize,
    pub(crate) approach: Approach,
    /// Distance that the volume may still travel, m.
    pub(crate) free_m: f64,
    /// The approach of the region by its own motion.
    pub(crate) region: RegionApproach,
}

impl StoppingQuery {
    /// The query with a margin (m) subtracted from the free distance.
    pub(crate) fn with_margin(self, margin_m: f64) -> Self {
        Self { free_m: self.free_m - margin_m, ..self }
    }
}

impl StoppingLaw {
    pub(crate) fn new(config: &Configuration, settings: &StoppingSettings) -> Self {
        let chain = &config.chain;
        let at_rest = || JointSpeeds { speed: vec![0.0; chain.dof()], stop_s: 0.0 };
        Self {
            growth: stop_time(&settings.joint_acceleration, &settings.joint_deceleration),
            axes: WorldAxis::all(chain),
            volumes: config.volumes.iter().map(|v| CarriedVolume::new(chain, v)).collect(),
            reach_m: vec![f64::INFINITY; config.volumes.len()],
            program: at_rest(),
            real: at_rest(),
            program_is_known: false,
            history: OverrideHistory::new(settings.reaction_s, config.laws.stale_s),
            horizon_s: 0.0,
            rest_after_s: 0.0,
            uncertain_s: 0.0,
            unchanged_s: 0.0,
            pending: PendingMotion::default(),
            braking: BrakingCheck::default(),
            settings: settings.clone(),
        }
    }

    /// Sets the pose in its link at which a volume was attached.
    pub(crate) fn attach(&mut self, config: &Configuration, volume: VolumeId, in_link: &Pose) {
        self.volumes[volume.0].set_in_link(&config.chain, in_link);
    }

    /// Records a commanded override.
    pub(crate) fn record_override(&mut self, now_s: f64, speed_override: f64) {
        self.history.push(now_s, speed_override);
    }

    /// The overrides that the robot may be executing.
    pub(crate) fn override_range(&self, now_s: f64) -> OverrideRange {
        self.history.range(now_s)
    }

    /// True if the robot brakes less than stated.
    pub(crate) fn brakes_too_little(&self) -> bool {
        self.braking.failed()
    }

    /// Begins a tick.
    pub(crate) fn begin(&mut self, config: &Configuration, tick: &StoppingInput<'_>) {
        let StoppingInput { now, intent, .. } = *tick;
        let (decelerations, accelerations) = (&self.settings.joint_deceleration, &self.settings.joint_acceleration);
        let growth = self.growth;
        // A derived velocity is uncertain by the acceleration times the time over which it was derived.
        let max_speed = |speed: &f64, a: &f64| speed.abs() + a * tick.uncertain_s;
        for (to, (v, a)) in self.real.speed.iter_mut().zip(now.qd.iter().zip(accelerations)) {
            *to = max_speed(v, a);
        }
        for (to, v) in self.program.speed.iter_mut().zip(&intent.qd) {
            *to = v.abs();
        }
        self.real.stop_s = stop_time(&self.real.speed, decelerations);
        self.program.stop_s = stop_time(&self.program.speed, decelerations);
        self.program_is_known = tick.program_is_known;
        (self.uncertain_s, self.unchanged_s) = (tick.uncertain_s, tick.unchanged_s);
        let until_effect_s = tick.now_s - tick.stamp_s + self.settings.reaction_s;
        self.horizon_s = until_effect_s + self.settings.period_s;
        let full_stop_s = self.program.stop_s;
        let running = match self.real.stop_s {
            n if n < 1e-9 => 0.0,
            n => (n / full_stop_s.max(1e-12)).min(1.0),
        };
        let stop_time_after = |run_s: f64| StopTime { full_stop_s: full_stop_s + growth * run_s, growth };
        self.pending = self.history.pending_motion(tick.stamp_s, tick.now_s, running, stop_time_after);
        let (commanded, commanded_since_s) = self.history.largest();
        self.braking.update(Braking {
            stamp_s: tick.stamp_s,
            stop_s: stop_time(&now.qd, decelerations),
            commanded,
            commanded_since_s,
            full_stop_s: if self.program_is_known { full_stop_s } else { f64::INFINITY },
            uncertain_s: tick.uncertain_s,
        });
        for axis in &mut self.axes {
            axis.place(config, now);
        }
        let motion = VolumeMotion { intent, now, uncertain_s: tick.uncertain_s };
        let volumes = self.volumes.iter_mut().zip(tick.volume_in_world).enumerate();
        for (_, (volume, in_world)) in volumes.filter(|(v, _)| tick.attached.contains(*v)) {
            volume.update(config, &self.axes, &self.settings, in_world, &motion);
        }
        self.update_reach(tick.programmed_override, tick.attached);
    }

    /// The approach of a volume along the unit vector `towards` (world), along which no point of the volume moves faster
    /// than `program_speed` and `real_speed`, m/s.
    pub(crate) fn approach(&self, volume: usize, towards: Vec3, program_speed: f64, real_speed: f64) -> Approach {
        let (acceleration, deceleration) = self.volumes[volume].rates_along(&self.axes, &self.settings, towards);
        let real_speed = real_speed + acceleration * self.uncertain_s;
        Approach { program_speed, real_speed, acceleration, deceleration }
    }

    /// Like [`StoppingLaw::approach`], in any direction.
    pub(crate) fn approach_any_direction(&self, volume: usize) -> Approach {
        self.volumes[volume].any_direction()
    }

    /// [`StoppingLaw::limit`] if it is below `enough`; cheaper if it is not.
    pub(crate) fn limit_below(&self, query: &StoppingQuery, enough: f64, max: f64) -> Option<f64> {
        // The limit is rounded down.
        let resolution = max / f64::from(1 << BISECTION_STEPS);
        if self.fits(query, &self.phases((enough + resolution).min(max))) && self.is_safe(query, max) {
            return None;
        }
        Some(self.limit(query, max)).filter(|limit| *limit < enough)
    }

    /// The largest override up to `max` at which the volume stops within the free distance.
    fn limit(&self, query: &StoppingQuery, max: f64) -> f64 {
        let fits = |c: f64| self.fits(query, &self.phases(c));
        let limit = if fits(max) {
            max
        } else if fits(0.0) {
            bisect(max, fits)
        } else {
            return 0.0;
        };
        if self.is_safe(query, limit) { limit } else { 0.0 }
    }

    /// True if a stop that is requested in this tick ends outside.
    pub(crate) fn stops_outside(&self, query: &StoppingQuery) -> bool {
        self.is_safe(query, 0.0)
    }

    /// Largest travel (m) of a volume in any direction until the robot is at rest.
    pub(crate) fn reach_m(&self, volume: usize) -> f64 {
        self.reach_m[volume]
    }

    /// Upper bound of the time (s) until the robot is at rest.
    pub(crate) fn rest_after_s(&self) -> f64 {
        self.rest_after_s
    }

    /// True if the volume cannot travel `distance_m` (m) in any direction.
    pub(crate) fn is_out_of_reach(&self, volume: usize, distance_m: f64) -> bool {
        self.reach_m[volume] < distance_m
    }

    /// True if the program's speeds are known, not only inferred.
    pub(crate) fn program_is_known(&self) -> bool {
        self.program_is_known
    }

    /// Updates the largest travel of each attached volume for a programmed override of at most `max`.
    fn update_reach(&mut self, max: f64, attached: &AttachedVolumes) {
        let phases = [self.phases(max), self.pending_phases(max)];
        let real = self.real_phases();
        let stop_s = phases.iter().fold(real.stop, |longest: f64, p| longest.max(p.stop));
        self.rest_after_s = self.horizon_s + stop_s;
        for volume in (0..self.volumes.len()).filter(|v| attached.contains(*v)) {
            let approach = self.volumes[volume].any_direction();
            let travel = |phases: &StopPhases| self.travel(volume, &approach, phases, &self.program);
            let mut reach_m = travel(&phases[0]).max(travel(&phases[1]));
            if !self.program_is_known {
                let approach = Approach { program_speed: approach.real_speed, ..approach };
                reach_m = reach_m.max(self.travel(volume, &approach, &real, &self.real));
            }
            self.reach_m[volume] = reach_m;
        }
    }

    /// Phases of a stop from the override `c`.
    fn phases(&self, c: f64) -> StopPhases {
        self.stop_after(REACTION_FACTOR * c * self.horizon_s + self.unchanged_s, c)
    }

    /// Phases of a stop if the robot executes the pending overrides, and `c` afterwards.
    fn pending_phases(&self, c: f64) -> StopPhases {
        let faster = self.pending.speed_override.max(c);
        self.stop_after(self.pending.program_s + faster * self.settings.period_s + self.unchanged_s, faster)
    }

    fn stop_after(&self, run_s: f64, sigma: f64) -> StopPhases {
        let full_stop_s = self.program.stop_s + self.growth * run_s;
        StopPhases {
            run: run_s,
            stop: sigma * full_stop_s,
            total: run_s + stopping_program_time(sigma, full_stop_s, self.growth),
        }
    }

    /// Phases of a stop if only the actual speeds are known: all joints accelerate until the stop begins.
    fn real_phases(&self) -> StopPhases {
        let run_s = self.horizon_s + self.unchanged_s;
        let stop_s = self.real.stop_s + self.growth * run_s;
        StopPhases { run: run_s, stop: stop_s, total: run_s + stop_s }
    }

    /// True if the pending motion, followed by the override `c` and a stop, ends within the free distance.
    fn is_safe(&self, query: &StoppingQuery, c: f64) -> bool {
        if self.program_is_known {
            return self.fits(query, &self.pending_phases(c));
        }
        let phases = self.real_phases();
        let approach = Approach { program_speed: query.approach.real_speed, ..query.approach };
        let region_travel = query.region.travel_m(self.horizon_s + phases.stop);
        self.travel(query.volume, &approach, &phases, &self.real) + region_travel <= query.free_m
    }

    fn fits(&self, query: &StoppingQuery, phases: &StopPhases) -> bool {
        let region_travel = query.region.travel_m(self.horizon_s + phases.stop);
        // A travel of NaN fails the comparison: it does not fit.
        self.travel(query.volume, &query.approach, phases, &self.program) + region_travel <= query.free_m
    }

    /// Bounds the travel of a volume: the smaller of the two bounds, m.
    fn travel(&self, volume: usize, approach: &Approach, phases: &StopPhases, speeds: &JointSpeeds) -> f64 {
        let volume = &self.volumes[volume];
        let acceleration = &self.settings.joint_acceleration;
        let joint_travel = |j: usize, u: f64| speeds.speed[j] * u + 0.5 * acceleration[j] * u * u;
        let u = phases.total;
        let by_program = approach.program_speed * u
            + 0.5 * approach.acceleration * u * u
            + volume.curvature_offset(|j| joint_travel(j, u));
        let (u, stop) = (phases.run, 0.5 * phases.stop * phases.stop);
        let by_stop = approach.program_speed.max(0.0) * u
            + 0.5 * approach.acceleration * u * u
            + approach.deceleration * stop
            + volume.curvature_offset(|j| joint_travel(j, u) + self.settings.joint_deceleration[j] * stop);
        by_program.min(by_stop)
    }
}

/// The largest value below `max` for which `fits` holds, to within `max / 2^BISECTION_STEPS`. Assumes that `fits`
/// holds for 0.
fn bisect(max: f64, fits: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, max);
    for _ in 0..BISECTION_STEPS {
        let middle = 0.5 * (low + high);
        if fits(middle) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests;
