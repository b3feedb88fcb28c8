//! What happens at the regions during a run.

use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Configuration, Kind, Life, Monitor, RegionId, Sweep};
use elbowroom_spatial::Pose;

use super::frames::Frames;
use crate::configure::Setup;
use crate::motion::levers_of;
use crate::{Cell, RegionPoses, RegionTrack, Span};

/// Distances up to this (m) beyond what is needed are measured, so that the next look can wait.
const MARGIN: f64 = 0.1;
/// Between ticks, a region counts as passed where it is touched by more than this, m.
const RESOLUTION_M: f64 = 1e-6;

pub(super) struct Regions<'a> {
    cell: &'a Cell,
    setups: &'a [Setup],
    tracks: Vec<RegionTrack>,
    /// Per robot its way from the tick before: as it is, not as its monitor was told.
    sweeps: Vec<Sweep>,
    watches: Vec<Watch>,
    /// Whether any robot is in the warning zone, per region; of the present tick.
    warned: Vec<bool>,
    /// Time of the tick before, s.
    before_s: f64,
}

/// One robot at one region.
struct Watch {
    robot: usize,
    local: RegionId,
    region: usize,
    /// Travelled since the distance was measured, m, and that distance.
    looked: Option<(f64, f64)>,
    /// A proven distance in the tick before, m; `None` where the region was not active or there was no tick.
    before_m: Option<f64>,
    warned_since: Option<f64>,
    inside_since: Option<f64>,
}

/// What a watch saw of one tick and of the way to it.
#[derive(Default)]
struct Sight {
    /// Distance now, where it could matter, m.
    distance_m: Option<f64>,
    /// Least distance on the way, where that is in the region or its zone and the ends are not, m.
    passed_m: Option<f64>,
}

impl<'a> Regions<'a> {
    pub fn new(cell: &'a Cell, setups: &'a [Setup]) -> Self {
        let tracks = cell.regions.iter().map(|r| track(&r.region, r.follow.is_some())).collect();
        let watches = setups
            .iter()
            .enumerate()
            .flat_map(|(robot, setup)| {
                setup.regions.iter().enumerate().map(move |(local, region)| Watch {
                    robot,
                    local: RegionId(local),
                    region: *region,
                    looked: None,
                    before_m: None,
                    warned_since: None,
                    inside_since: None,
                })
            })
            .collect();
        let sweeps = setups.iter().map(|s| Sweep::new(&s.configuration)).collect();
        Self { cell, setups, tracks, sweeps, watches, warned: vec![false; cell.regions.len()], before_s: 0.0 }
    }

    /// Switches a region; false where it was so already.
    pub fn switch(&mut self, region: usize, t_s: f64, active: bool) -> bool {
        let list = &mut self.tracks[region].active;
        if list.last().is_some_and(|last| last.1 == active) {
            return false;
        }
        list.push((t_s, active));
        let of_region = self.watches.iter_mut().filter(|w| w.region == region);
        of_region.for_each(|w| (w.looked, w.before_m) = (None, None));
        true
    }

    /// Takes note of one tick and of the way to it, after the monitors' ticks.
    pub fn look(&mut self, t_s: f64, monitors: &[Monitor], states: &[ChainState], frames: &Frames<'_>) {
        for (r, track) in self.cell.regions.iter().zip(&mut self.tracks) {
            if let (RegionPoses::Moving(poses), Some(follow)) = (&mut track.poses, &r.follow) {
                let anchor = frames.source(follow, states, t_s).pose * r.region.anchor;
                poses.push(anchor * r.region.shape_in_anchor);
            }
        }
        let before_s = std::mem::replace(&mut self.before_s, t_s);
        for ((sweep, setup), state) in self.sweeps.iter_mut().zip(self.setups).zip(states) {
            sweep.go(&setup.configuration, &state.q, &frames.sources(&setup.sources, states, t_s), t_s - before_s);
        }
        self.warned.fill(false);
        for watch in &mut self.watches {
            let track = &mut self.tracks[watch.region];
            let region = &self.cell.regions[watch.region];
            let (sweep, config) = (&mut self.sweeps[watch.robot], &self.setups[watch.robot].configuration);
            let sight = if monitors[watch.robot].is_active(watch.local) {
                watch.look(sweep, config, track, region.follow.is_some())
            } else {
                watch.before_m = None;
                Sight::default()
            };
            let inside = sight.distance_m.is_some_and(|d| d <= 0.0);
            let warned = inside || sight.distance_m.is_some_and(|d| d < track.warning_m);
            let passed = sight.passed_m.is_some_and(|d| d <= 0.0) && !inside;
            for d in [sight.distance_m, sight.passed_m].into_iter().flatten() {
                track.min_distance_m = Some(track.min_distance_m.map_or(d, |m| m.min(d)));
            }
            let exchange = matches!(region.region.kind, Kind::Exchange { .. });
            track.entered |= (inside || passed) && !(exchange && monitors[watch.robot].holds(watch.local));
            self.warned[watch.region] |= warned || sight.passed_m.is_some();
            // Whoever only passes was there for a part of the tick; nobody knows it closer than that.
            let stay = Span { robot: watch.robot, from_s: before_s, to_s: t_s };
            if sight.passed_m.is_some() && !warned && watch.warned_since.is_none() {
                track.warning_spans.push(stay);
            }
            if passed && watch.inside_since.is_none() {
                track.inside_spans.push(stay);
            }
            span(&mut watch.warned_since, warned, t_s, watch.robot, &mut track.warning_spans);
            span(&mut watch.inside_since, inside, t_s, watch.robot, &mut track.inside_spans);
        }
        for (track, _) in self.tracks.iter_mut().zip(&self.warned).filter(|w| *w.1) {
            track.warned_s += self.cell.tick_s;
        }
    }

    pub fn finish(mut self, t_s: f64) -> Vec<RegionTrack> {
        for watch in &mut self.watches {
            let track = &mut self.tracks[watch.region];
            span(&mut watch.warned_since, false, t_s, watch.robot, &mut track.warning_spans);
            span(&mut watch.inside_since, false, t_s, watch.robot, &mut track.inside_spans);
        }
        self.tracks
    }
}

impl Watch {
    /// The distance, where it could be less than what is known, or within the warning zone; and what was passed on the way.
    fn look(&mut self, sweep: &mut Sweep, config: &Configuration, track: &RegionTrack, moves: bool) -> Sight {
        let limit = track.min_distance_m.unwrap_or(f64::INFINITY).max(track.warning_m);
        let travel = sweep.travel(self.local);
        let before = self.before_m.replace(0.0);
        if let (false, Some((travelled, gap))) = (moves, &mut self.looked) {
            *travelled += travel;
            let proven = *gap - *travelled;
            if proven > limit {
                self.before_m = Some(proven);
                return Sight::default();
            }
        }
        let distance_m = sweep.distance(config, self.local, limit + MARGIN);
        let now = distance_m.unwrap_or(limit + MARGIN);
        self.looked = Some((0.0, now));
        self.before_m = Some(now);
        let passed_m = before.and_then(|before| {
            let warned = now.min(before) < track.warning_m;
            let below = if warned { 0.0 } else { track.warning_m };
            if now.min(before) <= 0.0 || before + now - 2.0 * below > travel {
                return None;
            }
            let mut least = |below| sweep.least(config, self.local, below, RESOLUTION_M);
            // In the zone is not yet in the region.
            let zone = least(below)?;
            if below > 0.0 && zone.distance_m > 0.0 { least(0.0).or(Some(zone)) } else { Some(zone) }
        });
        Sight { distance_m, passed_m: passed_m.map(|l| l.distance_m) }
    }
}

fn span(since: &mut Option<f64>, now: bool, t_s: f64, robot: usize, spans: &mut Vec<Span>) {
    match (*since, now) {
        (None, true) => *since = Some(t_s),
        (Some(from_s), false) => {
            spans.push(Span { robot, from_s, to_s: t_s });
            *since = None;
        }
        _ => {}
    }
}

/// Per joint the farthest that any volume moves per unit.
pub(super) fn levers(setup: &Setup) -> Vec<(usize, f64)> {
    let levers = levers_of(setup.configuration.chain(), setup.configuration.volumes());
    levers.into_iter().enumerate().filter(|(_, lever)| *lever != 0.0).collect()
}

fn track(r: &elbowroom_monitor::Region, moves: bool) -> RegionTrack {
    let pose: Pose = r.anchor * r.shape_in_anchor;
    RegionTrack {
        name: r.name.clone(),
        kind: r.kind.name(),
        life: r.life.name(),
        guards: r.guards,
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
