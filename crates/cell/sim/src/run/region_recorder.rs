//! Recording of the regions during a run.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRegion, CellRegionId, Frames};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{AttachError, Configuration, Life, RegionId, RegionKind, RegionSweep, VolumeId};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use super::simulated_robot::SimulatedRobot;
use crate::recording::{RegionPoses, RegionTrack, Span};

/// Margin (m) beyond the needed limit in distance measurements, so that the next measurements can be skipped.
const MARGIN_M: f64 = 0.1;
/// Penetration between ticks above which a region counts as passed through, m.
const RESOLUTION_M: f64 = 1e-6;

pub(super) struct RegionRecorder<'a> {
    cell: &'a Cell,
    setups: &'a [MonitorSetup],
    tracks: Vec<RegionTrack>,
    /// Per robot its true sweep since the last tick, not the sweep of the monitor's input.
    sweeps: Vec<RegionSweep>,
    observers: Vec<RegionObserver>,
    /// Per region whether any robot is in its warning zone in the current tick.
    warned: Vec<bool>,
    /// Time of the last tick, s.
    before_s: f64,
}

/// Observes one robot at one region.
struct RegionObserver {
    robot: RobotId,
    local: RegionId,
    region: CellRegionId,
    /// The last measured distance; `None` before the first measurement.
    measured: Option<MeasuredDistance>,
    /// A proven distance at the last tick, m; `None` if the region was inactive or at the first tick.
    before_m: Option<f64>,
    warned_since: Option<f64>,
    inside_since: Option<f64>,
}

/// A measured distance, and the motion since.
#[derive(Debug, Clone, Copy)]
struct MeasuredDistance {
    distance_m: f64,
    /// Upper bound of the motion since the measurement, m.
    travelled_m: f64,
}

/// Distances at one tick and since the last one.
#[derive(Default)]
struct TickDistances {
    /// Distance at the tick, if it could matter, m.
    distance_m: Option<f64>,
    /// Smallest distance since the last tick, m, if the robot passed through the region or its warning zone and is in
    /// it at neither tick.
    passed_m: Option<f64>,
}

impl<'a> RegionRecorder<'a> {
    pub fn new(cell: &'a Cell, setups: &'a [MonitorSetup]) -> Self {
        let tracks = cell.regions.iter().map(track).collect();
        let observers = setups
            .iter()
            .enumerate()
            .flat_map(|(robot, setup)| {
                setup.regions.iter().enumerate().map(move |(local, region)| RegionObserver {
                    robot: RobotId(robot),
                    local: RegionId(local),
                    region: *region,
                    measured: None,
                    before_m: None,
                    warned_since: None,
                    inside_since: None,
                })
            })
            .collect();
        let sweeps = setups.iter().map(|s| RegionSweep::new(&s.configuration)).collect();
        Self { cell, setups, tracks, sweeps, observers, warned: vec![false; cell.regions.len()], before_s: 0.0 }
    }

    /// Switches a region. Returns false if it had this state already.
    pub fn switch(&mut self, region: CellRegionId, t_s: f64, active: bool) -> bool {
        let list = &mut self.tracks[region.0].active;
        if list.last().is_some_and(|last| last.1 == active) {
            return false;
        }
        list.push((t_s, active));
        let of_region = self.observers.iter_mut().filter(|o| o.region == region);
        of_region.for_each(|o| (o.measured, o.before_m) = (None, None));
        true
    }

    /// Attaches a volume of a robot, as its monitor does.
    pub fn attach(&mut self, robot: RobotId, volume: VolumeId, in_link: &Pose) -> Result<(), AttachError> {
        self.forget(robot);
        self.sweeps[robot.0].attach(&self.setups[robot.0].configuration, volume, in_link)
    }

    /// Detaches a volume of a robot.
    pub fn detach(&mut self, robot: RobotId, volume: VolumeId) -> Result<(), AttachError> {
        self.forget(robot);
        self.sweeps[robot.0].detach(&self.setups[robot.0].configuration, volume)
    }

    /// Discards the measured distances, which apply to the volumes attached so far.
    fn forget(&mut self, robot: RobotId) {
        self.observers.iter_mut().filter(|o| o.robot == robot).for_each(|o| o.measured = None);
    }

    /// Observes one tick and the motion since the last one, after the monitors' ticks.
    pub fn observe(&mut self, t_s: f64, robots: &[SimulatedRobot<'_>], states: &[ChainState], frames: &Frames<'_>) {
        for (r, track) in self.cell.regions.iter().zip(&mut self.tracks) {
            if let (RegionPoses::Moving(poses), Some(follow)) = (&mut track.poses, &r.follow) {
                let anchor = frames.source(follow, states, t_s).pose * r.region.anchor;
                poses.push(anchor * r.region.shape_in_anchor);
            }
        }
        let before_s = std::mem::replace(&mut self.before_s, t_s);
        for ((sweep, setup), state) in self.sweeps.iter_mut().zip(self.setups).zip(states) {
            sweep.advance(&setup.configuration, &state.q, &frames.sources(&setup.sources, states, t_s), t_s - before_s);
        }
        self.warned.fill(false);
        for observer in &mut self.observers {
            let track = &mut self.tracks[observer.region.0];
            let region = &self.cell.regions[observer.region.0];
            let robot = observer.robot.0;
            let (sweep, config) = (&mut self.sweeps[robot], &self.setups[robot].configuration);
            let distances = if robots[robot].monitor.is_active(observer.local) {
                observer.measure(sweep, config, track, region.follow.is_some())
            } else {
                observer.before_m = None;
                TickDistances::default()
            };
            let inside = distances.distance_m.is_some_and(|d| d <= 0.0);
            let warned = inside || distances.distance_m.is_some_and(|d| d < track.warning_m);
            let passed = distances.passed_m.is_some_and(|d| d <= 0.0) && !inside;
            for d in [distances.distance_m, distances.passed_m].into_iter().flatten() {
                track.min_distance_m = Some(track.min_distance_m.map_or(d, |m| m.min(d)));
            }
            let exchange = matches!(region.region.kind, RegionKind::Exchange { .. });
            track.entered |= (inside || passed) && !(exchange && robots[robot].monitor.holds(observer.local));
            self.warned[observer.region.0] |= warned || distances.passed_m.is_some();
            // A region that was passed through was occupied for part of the tick; the recording contains the whole
            // tick.
            let tick_span = Span { robot: observer.robot, from_s: before_s, to_s: t_s };
            if distances.passed_m.is_some() && !warned && observer.warned_since.is_none() {
                track.warning_spans.push(tick_span);
            }
            if passed && observer.inside_since.is_none() {
                track.inside_spans.push(tick_span);
            }
            span(&mut observer.warned_since, warned, t_s, observer.robot, &mut track.warning_spans);
            span(&mut observer.inside_since, inside, t_s, observer.robot, &mut track.inside_spans);
        }
        for (track, _) in self.tracks.iter_mut().zip(&self.warned).filter(|w| *w.1) {
            track.warned_s += self.cell.timing.tick_s;
        }
    }

    pub fn finish(mut self, t_s: f64) -> Vec<RegionTrack> {
        for observer in &mut self.observers {
            let track = &mut self.tracks[observer.region.0];
            span(&mut observer.warned_since, false, t_s, observer.robot, &mut track.warning_spans);
            span(&mut observer.inside_since, false, t_s, observer.robot, &mut track.inside_spans);
        }
        self.tracks
    }
}

impl RegionObserver {
    /// Measures the distance if it could be below the smallest one so far or within the warning zone, and detects a
    /// passage since the last tick.
    fn measure(
        &mut self,
        sweep: &mut RegionSweep,
        config: &Configuration,
        track: &RegionTrack,
        moves: bool,
    ) -> TickDistances {
        let limit = track.min_distance_m.unwrap_or(f64::INFINITY).max(track.warning_m);
        let travel = sweep.travel_bound_of(self.local);
        let before = self.before_m.replace(0.0);
        if let (false, Some(measured)) = (moves, &mut self.measured) {
            measured.travelled_m += travel;
            let proven = measured.distance_m - measured.travelled_m;
            if proven > limit {
                self.before_m = Some(proven);
                return TickDistances::default();
            }
        }
        let distance_m = sweep.distance(config, self.local, limit + MARGIN_M);
        let now = distance_m.unwrap_or(limit + MARGIN_M);
        self.measured = Some(MeasuredDistance { distance_m: now, travelled_m: 0.0 });
        self.before_m = Some(now);
        let passed_m = before.and_then(|before| {
            let warned = now.min(before) < track.warning_m;
            let below = if warned { 0.0 } else { track.warning_m };
            if now.min(before) <= 0.0 || before + now - 2.0 * below > travel {
                return None;
            }
            let mut closest = |below| sweep.closest_approach(config, self.local, below, RESOLUTION_M);
            // A passage through the zone need not lead through the region.
            let zone = closest(below)?;
            if below > 0.0 && zone.distance_m > 0.0 { closest(0.0).or(Some(zone)) } else { Some(zone) }
        });
        TickDistances { distance_m, passed_m: passed_m.map(|c| c.distance_m) }
    }
}

fn span(since: &mut Option<f64>, now: bool, t_s: f64, robot: RobotId, spans: &mut Vec<Span>) {
    match (*since, now) {
        (None, true) => *since = Some(t_s),
        (Some(from_s), false) => {
            spans.push(Span { robot, from_s, to_s: t_s });
            *since = None;
        }
        _ => {}
    }
}

fn track(region: &CellRegion) -> RegionTrack {
    let (r, moves) = (&region.region, region.follow.is_some());
    let pose: Pose = r.anchor * r.shape_in_anchor;
    RegionTrack {
        name: r.name.clone(),
        kind: r.kind.into(),
        life: r.life,
        guards: r.guards,
        robots: region.robots.clone(),
        warning_m: r.warning_m,
        shape: r.shape.clone(),
        poses: if moves { RegionPoses::Moving(Vec::new()) } else { RegionPoses::Fixed(pose) },
        active: vec![(0.0, r.life == Life::Permanent)],
        min_distance_m: None,
        entered: false,
        warned_s: 0.0,
        warning_spans: Vec::new(),
        inside_spans: Vec::new(),
    }
}
