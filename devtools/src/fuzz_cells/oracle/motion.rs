//! Motion of robots and regions from one tick to the next.

use std::borrow::Cow;

use elbowroom_cell::Cell;
use elbowroom_sim::Recording;

use super::arm::Arm;
use super::frame::Frame;
use super::guarded::{Guarded, Presence};
use super::held_parts::{Grip, grips};
use super::mounted::MountedTools;
use super::place::Place;
use super::track::is_steady;

/// Positions of all robots at all ticks, and the regions.
pub struct OracleMotion<'a> {
    pub cell: &'a Cell,
    pub recording: &'a Recording,
    pub arms: &'a [Arm],
    pub places: Vec<Place>,
    pub times: Vec<f64>,
    /// Joint values per tick and robot.
    pub q: Vec<Vec<Vec<f64>>>,
    /// Frames in the world per tick, robot and link.
    frames: Vec<Vec<Vec<Frame>>>,
    /// Mounted tools per robot.
    tools: Vec<MountedTools>,
    /// Objects in the hands of robots.
    pub grips: Vec<Grip>,
}

impl<'a> OracleMotion<'a> {
    pub fn new(cell: &'a Cell, recording: &'a Recording, arms: &'a [Arm]) -> Self {
        let ticks = recording.robots.iter().map(|r| r.samples.len()).min().unwrap_or(0);
        let at = |k: usize| recording.robots.iter().map(|r| r.samples[k].q.clone()).collect();
        let times = recording.robots.first().map_or(Vec::new(), |r| r.samples.iter().map(|s| s.t_s).collect());
        let places = (0..cell.regions.len()).map(|r| Place::new(cell, r, Some(recording))).collect();
        let tools = cell.robots.iter().map(|robot| MountedTools::new(robot, recording)).collect();
        let grips = grips(cell, recording, arms);
        let q: Vec<Vec<Vec<f64>>> = (0..ticks).map(at).collect();
        let frames = q.iter().map(|joints| frames(arms, joints)).collect();
        Self { cell, recording, arms, places, times, q, frames, tools, grips }
    }

    pub fn ticks(&self) -> usize {
        self.q.len()
    }

    /// Whether a region was active from tick `k` to the next.
    pub fn is_active(&self, region: usize, k: usize) -> bool {
        let list = &self.recording.regions[region].active;
        list.iter().rev().find(|(t_s, _)| *t_s <= self.times[k] + 1e-9).is_some_and(|(_, on)| *on)
    }

    /// The ticks at which a robot exchanges a tool, grips an object or puts it down, in order and without the first tick.
    pub fn hand_changes(&self, robot: usize) -> Vec<usize> {
        let grips = self.grips.iter().filter(|g| g.robot == robot).flat_map(|g| [g.from, g.to]);
        let in_time = |k: &usize| (1..self.ticks()).contains(k);
        let mut changes: Vec<usize> = self.tools[robot].changes().chain(grips).filter(in_time).collect();
        changes.sort_unstable();
        changes.dedup();
        changes
    }

    /// The ticks at which something comes into the hand: a tool, or an object.
    pub fn hand_gains(&self, robot: usize) -> Vec<usize> {
        let grips = self.grips.iter().filter(|g| g.robot == robot).map(|g| g.from);
        self.tools[robot].changes().chain(grips).collect()
    }

    /// Returns the spans, as first tick and tick after the last, in which a robot has the same tools and objects.
    pub fn hand_spans(&self, robot: usize) -> Vec<(usize, usize)> {
        let changes = self.hand_changes(robot);
        let begins = std::iter::once(0).chain(changes.clone());
        begins.zip(changes.into_iter().chain([self.ticks()])).filter(|(from, to)| from < to).collect()
    }

    /// Returns the spans, as first tick and tick after the last, in which a region is active and a robot has the same
    /// tools and objects.
    pub fn spans(&self, region: usize, robot: usize) -> Vec<(usize, usize)> {
        let mut spans = Vec::new();
        let changes = self.hand_changes(robot);
        let mut from = None;
        for k in 0..=self.ticks() {
            let is_active = k < self.ticks() && self.is_active(region, k);
            if !is_active || changes.contains(&k) {
                spans.extend(from.take().map(|from| (from, k)));
            }
            if is_active {
                from = from.or(Some(k));
            }
        }
        spans
    }

    /// Whether a solid is on its robot at a tick: a tool may be off its flange, an object is held for a while.
    pub fn has(&self, robot: usize, guarded: &Guarded, k: usize) -> bool {
        match &guarded.presence {
            Presence::Always => true,
            Presence::Tool(tool) => self.tools[robot].has(*tool, k),
            Presence::Ticks(ticks) => ticks.contains(&k),
        }
    }

    /// Returns the frame of a region at a tick.
    pub fn region_at(&self, region: usize, k: usize) -> Frame {
        self.places[region].at(self.times[k], self.frames(k))
    }

    /// Returns the time (s) at a fraction `u` of the way from tick `k` to the next.
    pub fn time_s(&self, k: usize, u: f64) -> f64 {
        self.times[k] + u * self.recording.tick_s
    }

    /// False if a region accelerates, or its belt changes its speed, so late that the robot could not have stopped
    /// before a fraction `u` of the way from tick `k` to the next.
    pub fn is_foreseen(&self, region: usize, robot: usize, (k, u): (usize, f64)) -> bool {
        let place = &self.places[region];
        let (stop_s, tick_s) = (self.stop_s(robot), self.recording.tick_s);
        let t_s = self.time_s(k, u);
        if place.carrier.changes_speed(t_s - stop_s, t_s) {
            return false;
        }
        let first = k.saturating_sub((stop_s / tick_s).ceil() as usize + 1);
        let last = (k + 1).min(self.ticks() - 1);
        let frames: Vec<_> = (first..=last).map(|k| self.region_at(region, k)).collect();
        place.is_fixed() || place.carrier.is_belt() || is_steady(&frames, tick_s)
    }

    /// Returns the longest time (s) that a robot may take to obey and to stop from full speed.
    fn stop_s(&self, robot: usize) -> f64 {
        let limits = &self.cell.robots[robot].limits;
        let slowest = limits.iter().map(|l| l.velocity / l.stop).fold(0.0, f64::max);
        slowest + self.cell.monitoring.stopping_reaction_s.unwrap_or(0.0) + 2.0 * self.recording.tick_s
    }

    /// Whether a robot moves from tick `k` to the next.
    pub fn moves(&self, robot: usize, k: usize) -> bool {
        k + 1 < self.ticks() && self.q[k][robot].iter().zip(&self.q[k + 1][robot]).any(|(a, b)| (a - b).abs() > 1e-9)
    }

    /// Returns the frames of all robots' links at a tick.
    pub fn frames(&self, k: usize) -> &[Vec<Frame>] {
        &self.frames[k]
    }

    /// Returns the frames of all robots' links at a fraction `u` of the way from tick `k` to the next.
    pub fn frames_between(&self, k: usize, u: f64) -> Cow<'_, [Vec<Frame>]> {
        match self.q.get(k + 1) {
            Some(next) if u != 0.0 => {
                let mix = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a + (b - a) * u).collect();
                let joints: Vec<Vec<f64>> = self.q[k].iter().zip(next).map(mix).collect();
                Cow::Owned(frames(self.arms, &joints))
            }
            _ => Cow::Borrowed(self.frames(k)),
        }
    }
}

fn frames(arms: &[Arm], joints: &[Vec<f64>]) -> Vec<Vec<Frame>> {
    arms.iter().zip(joints).map(|(arm, q)| arm.frames(q)).collect()
}
