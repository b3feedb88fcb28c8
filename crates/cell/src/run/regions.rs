//! What happens at the regions during a run.

use elbowroom_kinematics::{Chain, ChainState};
use elbowroom_monitor::{Kind, Life, Monitor, RegionId};
use elbowroom_scene::pairs::motion_bound;
use elbowroom_spatial::Pose;

use super::frames::Frames;
use crate::configure::Setup;
use crate::{Cell, RegionPoses, RegionTrack, Span};

/// Distances up to this (m) beyond what is needed are measured, so that the next look can wait.
const MARGIN: f64 = 0.1;

pub(super) struct Regions<'a> {
    cell: &'a Cell,
    tracks: Vec<RegionTrack>,
    watches: Vec<Watch>,
    /// Whether any robot is in the warning zone, per region; of the present tick.
    warned: Vec<bool>,
}

/// One robot at one region.
struct Watch {
    robot: usize,
    local: RegionId,
    region: usize,
    /// (index in q, m per unit), for the farthest reaching volume.
    levers: Vec<(usize, f64)>,
    /// Joint values at the last look, and a proven distance then.
    looked: Option<(Vec<f64>, f64)>,
    warned_since: Option<f64>,
    inside_since: Option<f64>,
}

impl<'a> Regions<'a> {
    pub fn new(cell: &'a Cell, setups: &[Setup]) -> Self {
        let tracks = cell.regions.iter().map(|r| track(&r.region, r.follow.is_some())).collect();
        let watches = setups
            .iter()
            .enumerate()
            .flat_map(|(robot, setup)| {
                let levers = levers(setup);
                setup.regions.iter().enumerate().map(move |(local, region)| Watch {
                    robot,
                    local: RegionId(local),
                    region: *region,
                    levers: levers.clone(),
                    looked: None,
                    warned_since: None,
                    inside_since: None,
                })
            })
            .collect();
        Self { cell, tracks, watches, warned: vec![false; cell.regions.len()] }
    }

    /// Switches a region; false where it was so already.
    pub fn switch(&mut self, region: usize, t_s: f64, active: bool) -> bool {
        let list = &mut self.tracks[region].active;
        if list.last().is_some_and(|last| last.1 == active) {
            return false;
        }
        list.push((t_s, active));
        self.watches.iter_mut().filter(|w| w.region == region).for_each(|w| w.looked = None);
        true
    }

    /// Takes note of one tick, after the monitors' ticks.
    pub fn look(&mut self, t_s: f64, monitors: &[Monitor], states: &[ChainState], frames: &Frames<'_>) {
        for (r, track) in self.cell.regions.iter().zip(&mut self.tracks) {
            if let (RegionPoses::Moving(poses), Some(follow)) = (&mut track.poses, &r.follow) {
                let anchor = frames.source(follow, states, t_s).pose * r.region.anchor;
                poses.push(anchor * r.region.shape_in_anchor);
            }
        }
        self.warned.fill(false);
        for watch in &mut self.watches {
            let track = &mut self.tracks[watch.region];
            let moves = self.cell.regions[watch.region].follow.is_some();
            let distance = watch.distance(&monitors[watch.robot], &states[watch.robot].q, track, moves);
            let inside = distance.is_some_and(|d| d <= 0.0);
            let warned = inside || distance.is_some_and(|d| d < track.warning_m);
            if let Some(d) = distance {
                track.min_distance_m = Some(track.min_distance_m.map_or(d, |m| m.min(d)));
            }
            let exchange = matches!(self.cell.regions[watch.region].region.kind, Kind::Exchange { .. });
            track.entered |= inside && !(exchange && monitors[watch.robot].holds(watch.local));
            self.warned[watch.region] |= warned;
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
    /// The distance, where it could be less than what is known, or within the warning zone.
    fn distance(&mut self, monitor: &Monitor, q: &[f64], track: &RegionTrack, moves: bool) -> Option<f64> {
        if !monitor.is_active(self.local) {
            return None;
        }
        let limit = track.min_distance_m.unwrap_or(f64::INFINITY).max(track.warning_m);
        if let (false, Some((then, gap))) = (moves, &self.looked) {
            let moved: f64 = self.levers.iter().map(|(j, lever)| lever * (q[*j] - then[*j]).abs()).sum();
            if gap - moved > limit {
                return None;
            }
        }
        let measured = monitor.distance(self.local, limit + MARGIN);
        self.looked = Some((q.to_vec(), measured.unwrap_or(limit + MARGIN)));
        measured
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
fn levers(setup: &Setup) -> Vec<(usize, f64)> {
    let chain: &Chain = setup.configuration.chain();
    let mut most: Vec<(usize, f64)> = Vec::new();
    for volume in setup.configuration.volumes() {
        let box_in_link = volume.shape.aabb(&volume.in_link);
        let radius = box_in_link.min.abs().max(box_in_link.max.abs()).length();
        let mut own: Vec<(usize, f64)> = Vec::new();
        for (joint, lever) in motion_bound(chain, volume.link, radius, &chain.path(volume.link)) {
            // Joints that follow one another have its index, and add up.
            match own.iter_mut().find(|o| o.0 == joint) {
                Some(o) => o.1 += lever,
                None => own.push((joint, lever)),
            }
        }
        for (joint, lever) in own {
            match most.iter_mut().find(|m| m.0 == joint) {
                Some(m) => m.1 = m.1.max(lever),
                None => most.push((joint, lever)),
            }
        }
    }
    most
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
