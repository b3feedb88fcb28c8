//! A run: programs on one clock, in simulated time, under the monitor.

mod avoid;
mod deadlock;
mod delay;
mod ending;
mod faults;
pub(crate) mod frames;
mod needs;
mod outcome;
mod regions;
mod waits;

use std::sync::Arc;
use std::time::Instant;

use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{AccessClass, Board, EventKind, Kind, Monitor, Reason, Snapshot, Source, VirtualTcp};
use elbowroom_scene::{FirstContact, FirstContacts, Member, ObjectStep};

use crate::configure::{self, Setup};
use crate::fence::RegionFence;
use crate::motion::{Clock, plan};
use crate::{
    Cell, Collision, EventRow, Leg, Mover, ObjectTrack, Recording, RobotEnding, RobotTrack, Sample, TickTimes,
};
use avoid::Evasive;
use deadlock::Deadlocks;
use delay::Delay;
use ending::{Ending, Halt};
pub use faults::{InputFault, InputFaultKind};
use frames::Frames;
use needs::Needs;
use regions::Regions;
use waits::Waits;

/// How to run a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOptions {
    /// False: the monitor watches but nobody obeys it (`--no-monitor`).
    pub monitored: bool,
    /// False: robots with `[avoidance]` keep to their programs, whatever comes (`--no-avoidance`).
    pub evasive: bool,
    /// Programs run this many times, times their own `repeat`.
    pub repeat: u32,
    /// Fault injection: robots (by index) whose controller falls silent at a time (s), standing where they are.
    pub vanish: Vec<(usize, f64)>,
    /// Fault injection: what the robots' monitors are told instead of the truth. Where two faults of one robot overlap,
    /// the first in this list counts.
    pub faults: Vec<InputFault>,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self { monitored: true, evasive: true, repeat: 1, vanish: Vec::new(), faults: Vec::new() }
    }
}

/// What a run gives.
#[derive(Debug, Clone)]
pub struct RunOutcome {
    /// All that happened.
    pub recording: Recording,
    /// What the user should know of the programs: speeds that joints do not allow, and the like.
    pub notes: Vec<Warning>,
}

impl RunOutcome {
    /// True where something collided, a forbidden region was entered, or robots wait for each other for ever: exit
    /// status 1.
    pub fn bad_news(&self) -> bool {
        let r = &self.recording;
        r.robots.iter().any(|r| !r.collisions.is_empty())
            || r.regions.iter().any(|r| r.entered && r.kind != "monitored")
            || !r.deadlocks.is_empty()
    }
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub t_s: f64,
    /// Robots whose programs have finished.
    pub finished: usize,
    /// All robots.
    pub robots: usize,
}

/// Runs the programs of a cell.
///
/// All robots' states of one instant are known before the first monitor looks, so frames that regions follow have no
/// latency; the override of a tick acts on the motion from this tick to the next.
///
/// # Errors
/// [`FormatError`] at the line of a step that cannot be done. Nothing has moved then.
pub fn simulate(cell: &Cell, options: &RunOptions) -> Result<RunOutcome, FormatError> {
    simulate_with(cell, options, &mut |_| {})
}

/// [`simulate`], telling now and then how far it has come.
///
/// # Errors
/// As for [`simulate`].
pub fn simulate_with(
    cell: &Cell,
    options: &RunOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<RunOutcome, FormatError> {
    let mut notes = Vec::new();
    let mut clocks = Vec::new();
    let setups = configure::setups(cell)?;
    let board = configure::board(cell);
    let monitors = configure::monitors_at(cell, &setups, board.as_ref())?;
    let mut needs = Vec::new();
    for (i, robot) in cell.robots.iter().enumerate() {
        let plan = plan(cell, i, options.repeat, &mut notes)?;
        // A robot that evades leaves its program: what it will need is not known.
        let keeps_to_plan =
            options.monitored && !(options.evasive && cell.avoidance.get(i).is_some_and(Option::is_some));
        let board = board.as_deref().filter(|_| keeps_to_plan);
        needs.push(board.and_then(|board| Needs::of_plan(i, &setups[i], &plan, board)));
        clocks.push(Clock::new(plan, robot.limits.clone()));
    }
    let scene = crate::query::Subject::of_cell(cell).scene(false)?;
    let evasive = if options.evasive { Evasive::of_cell(cell, &scene, &clocks)? } else { Vec::new() };
    let mut run = Run::new(cell, options, &setups, monitors, clocks, evasive);
    (run.board, run.needs) = (board, needs);
    let mut tick = 0_u64;
    loop {
        let t_s = instant(tick, cell.tick_s);
        if tick.is_multiple_of(256) {
            let finished = run.clocks.iter().filter(|c| c.finished()).count();
            progress(Progress { t_s, finished, robots: run.clocks.len() });
        }
        if tick == 0 {
            run.announce();
        }
        run.tick(t_s);
        if run.ended(t_s) {
            notes.extend(run.evasive.iter().flatten().filter_map(|e| e.trouble(cell)));
            return Ok(RunOutcome { recording: run.finish(t_s), notes });
        }
        run.advance();
        tick += 1;
    }
}

struct Run<'a> {
    cell: &'a Cell,
    options: &'a RunOptions,
    setups: &'a [Setup],
    monitors: Vec<Monitor>,
    /// Where exchange regions are granted.
    board: Option<Arc<Board>>,
    /// Per robot what its program needs of them; `None` for one that declares nothing.
    needs: Vec<Option<Needs>>,
    deadlocks: Deadlocks,
    /// Per robot the point that asked for the smallest override in the last tick.
    governing: Vec<Option<VirtualTcp>>,
    clocks: Vec<Clock>,
    /// Per robot; `None` for one that keeps to its program.
    evasive: Vec<Option<Evasive<'a>>>,
    states: Vec<ChainState>,
    scratch: Vec<ChainState>,
    frames: Frames<'a>,
    inputs: faults::Inputs<'a>,
    regions: Regions<'a>,
    checker: FirstContacts<'a>,
    tracks: Vec<RobotTrack>,
    objects: Vec<ObjectTrack>,
    /// When collisions were last looked for, s.
    looked_s: f64,
    halts: Vec<Halt>,
    /// Override that each robot obeys until the next tick.
    obeyed: Vec<f64>,
    delays: Vec<Delay>,
    events: Vec<EventRow>,
    ending: Ending,
    tick_ns: Vec<u64>,
}

impl<'a> Run<'a> {
    fn new(
        cell: &'a Cell,
        options: &'a RunOptions,
        setups: &'a [Setup],
        monitors: Vec<Monitor>,
        clocks: Vec<Clock>,
        mut evasive: Vec<Option<Evasive<'a>>>,
    ) -> Self {
        evasive.resize_with(cell.robots.len(), || None);
        let states: Vec<_> = cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
        let track = |r: &crate::CellRobot| RobotTrack {
            name: r.name.clone(),
            joints: r.joint_names(),
            samples: Vec::new(),
            finished: false,
            stopped_s: 0.0,
            min_override: 1.0,
            collisions: Vec::new(),
            avoidance: None,
            ending: RobotEnding::default(),
        };
        Self {
            board: None,
            needs: Vec::new(),
            deadlocks: Deadlocks::new(cell.robots.len()),
            governing: vec![None; cell.robots.len()],
            options,
            setups,
            scratch: states.clone(),
            states,
            frames: Frames::new(cell),
            inputs: faults::Inputs::new(&options.faults, cell.robots.len()),
            regions: Regions::new(cell, setups),
            checker: FirstContacts::new(
                cell.robots.iter().map(|r| (&r.robot, r.base_in_world)).collect(),
                &cell.objects,
            )
            .moving(&cell.movers.iter().map(|m| m.object).collect::<Vec<_>>()),
            tracks: cell.robots.iter().map(track).collect(),
            objects: cell.movers.iter().map(|m| moving_track(cell, m)).collect(),
            looked_s: 0.0,
            halts: vec![Halt::default(); cell.robots.len()],
            obeyed: vec![0.0; cell.robots.len()],
            delays: cell.robots.iter().map(|_| Delay::new(cell.laws.obeyed_after_s)).collect(),
            events: Vec::new(),
            ending: Ending::new(cell),
            tick_ns: Vec::new(),
            monitors,
            clocks,
            evasive,
            cell,
        }
    }

    fn vanished(&self, robot: usize, t_s: f64) -> bool {
        self.options.vanish.iter().any(|(r, from)| *r == robot && t_s >= *from)
    }

    fn event(&mut self, t_s: f64, robot: usize, region: &str, event: &'static str) {
        let robot = self.cell.robots[robot].name.clone();
        self.events.push(EventRow { t_s, robot, region: region.to_owned(), event });
    }

    /// Every robot says where it stands before the first looks at a region that they exchange: one that starts inside
    /// would otherwise wait for robots that have not spoken yet, and count as having entered.
    fn announce(&mut self) {
        if !self.cell.regions.iter().any(|r| matches!(r.region.kind, Kind::Exchange { .. })) {
            return;
        }
        self.look_at_robots(0.0);
        self.declare_needs();
        for i in 0..self.clocks.len() {
            if self.vanished(i, 0.0) {
                continue;
            }
            let sources = self.frames.sources(&self.setups[i].sources, &self.states, 0.0);
            let before = -self.cell.tick_s;
            let sources: Vec<_> = sources.into_iter().map(|s| Source { stamp_s: before, ..s }).collect();
            let (state, clock) = (&self.states[i], &self.clocks[i]);
            let snapshot = Snapshot {
                now_s: before,
                stamp_s: before,
                q: &state.q,
                qd: &state.qd,
                qdd: &state.qdd,
                programmed_override: clock.programmed_override(),
                intent: Some(clock.intent()),
                sources: &sources,
            };
            self.monitors[i].tick(&snapshot);
            self.log_events(i, 0.0);
        }
    }

    /// One instant: everything is looked at, nothing moves.
    fn tick(&mut self, t_s: f64) {
        self.apply_switches(t_s);
        self.look_at_robots(t_s);
        self.declare_needs();
        for i in 0..self.clocks.len() {
            if self.vanished(i, t_s) { self.record_vanished(i, t_s) } else { self.monitor(i, t_s) }
        }
        self.regions.look(t_s, &self.monitors, &self.states, &self.frames);
        if let Some(board) = &self.board {
            self.deadlocks.look(t_s, board, &self.halts);
        }
        self.collide(t_s);
    }

    fn declare_needs(&mut self) {
        let Some(board) = &self.board else { return };
        for (needs, clock) in self.needs.iter_mut().zip(&self.clocks) {
            if let Some(needs) = needs {
                needs.declare(clock, board);
            }
        }
    }

    fn look_at_robots(&mut self, t_s: f64) {
        for (i, clock) in self.clocks.iter().enumerate() {
            let state = &mut self.states[i];
            state.q.copy_from_slice(&clock.point().q);
            // Nobody knows more of a vanished robot than that it stands.
            let gone = self.options.vanish.iter().any(|(r, from)| *r == i && t_s >= *from);
            let scale = if gone { 0.0 } else { 1.0 };
            state.qd.iter_mut().zip(clock.velocity()).for_each(|(to, v)| *to = v * scale);
            state.qdd.iter_mut().zip(clock.acceleration()).for_each(|(to, v)| *to = v * scale);
            if let Some(evasive) = self.evasive[i].as_ref().filter(|e| !e.is_on_path()) {
                evasive.look(state);
                state.qd.iter_mut().chain(&mut state.qdd).for_each(|v| *v *= scale);
            }
            self.cell.robots[i].robot.chain.forward_motion(state);
        }
    }

    fn apply_switches(&mut self, t_s: f64) {
        for robot in 0..self.clocks.len() {
            for (region, active) in self.clocks[robot].take_switches() {
                if !self.regions.switch(region, t_s, active) {
                    continue;
                }
                let cell = self.cell;
                self.event(t_s, robot, &cell.regions[region].region.name, if active { "on" } else { "off" });
                for (setup, monitor) in self.setups.iter().zip(&mut self.monitors) {
                    let Some(local) = setup.regions.iter().position(|r| *r == region) else { continue };
                    // The cell file let no permanent region be switched, so nothing can refuse.
                    let _ = monitor.switch(elbowroom_monitor::RegionId(local), active, AccessClass::Programmer);
                }
            }
        }
    }

    fn monitor(&mut self, i: usize, t_s: f64) {
        let sources = self.frames.sources(&self.setups[i].sources, &self.states, t_s);
        let clock = &self.clocks[i];
        let state = &self.states[i];
        let snapshot = Snapshot {
            now_s: t_s,
            stamp_s: t_s,
            q: &state.q,
            qd: &state.qd,
            qdd: &state.qdd,
            programmed_override: clock.programmed_override(),
            intent: Some(self.evasive[i].as_ref().map_or(clock.intent(), |e| e.intent(clock))),
            sources: &sources,
        };
        let Some(snapshot) = self.inputs.pass(i, &snapshot) else { return self.record_unheard(i, t_s) };
        let begin = Instant::now();
        let report = self.monitors[i].tick(&snapshot);
        self.tick_ns.push(begin.elapsed().as_nanos() as u64);
        let obeyed = if self.options.monitored { report.speed_override } else { clock.programmed_override() };
        self.obeyed[i] = obeyed;
        self.log_events(i, t_s);
        // Governing is who makes the robot slower than its program asks.
        let governs = self.options.monitored.then(|| report.reason.region()).flatten();
        let region = governs.map(|r| self.setups[i].regions[r.0]);
        self.governing[i] = report.governing;
        let distance_m = region.and(report.governing).map(|g| g.distance_m);
        let reason = if self.options.monitored { report.reason } else { Reason::Free };
        self.record(i, t_s, obeyed, region, distance_m, reason);
        if let Some(event) = self.halts[i].update(&self.clocks[i], obeyed) {
            let region = region.map_or("", |r| self.cell.regions[r].region.name.as_str());
            self.event(t_s, i, region, event);
        }
        if self.halts[i].stopped {
            self.tracks[i].stopped_s += self.cell.tick_s;
        }
    }

    fn log_events(&mut self, i: usize, t_s: f64) {
        let robot = &self.cell.robots[i].name;
        for e in self.monitors[i].events() {
            // Switching is told once, by whoever switched.
            if matches!(e.kind, EventKind::On | EventKind::Off) {
                continue;
            }
            let region = e.region.map(|r| self.cell.regions[self.setups[i].regions[r.0]].region.name.clone());
            let region = region.unwrap_or_default();
            self.events.push(EventRow { t_s, robot: robot.clone(), region, event: e.kind.name() });
        }
    }

    fn record_vanished(&mut self, i: usize, t_s: f64) {
        self.obeyed[i] = 0.0;
        self.record(i, t_s, 0.0, None, None, Reason::Fault(elbowroom_monitor::Fault::Stale));
    }

    /// Nothing reached the monitor, so it said nothing.
    fn record_unheard(&mut self, i: usize, t_s: f64) {
        if self.options.monitored && !self.inputs.goes_on(i, t_s) {
            self.obeyed[i] = 0.0;
        }
        self.record(i, t_s, self.obeyed[i], None, None, Reason::Fault(elbowroom_monitor::Fault::Stale));
    }

    fn record(&mut self, i: usize, t_s: f64, o: f64, region: Option<usize>, distance_m: Option<f64>, reason: Reason) {
        let (tcp, tcp_speed) = self.frames.tcp(i, &self.states[i]);
        // Off its path a robot does not move by its program's time.
        let astray = self.evasive[i].as_ref().is_some_and(|e| !e.is_on_path());
        let rate = if astray { 1.0 } else { self.clocks[i].rate() };
        if let Some(evasive) = &mut self.evasive[i] {
            evasive.record();
        }
        let programmed_speed = if rate > 1e-3 {
            tcp_speed / rate
        } else {
            let scratch = &mut self.scratch[i];
            scratch.q.copy_from_slice(&self.states[i].q);
            scratch.qd.copy_from_slice(&self.clocks[i].point().first);
            self.cell.robots[i].robot.chain.forward_motion(scratch);
            self.frames.tcp(i, &self.scratch[i]).1
        };
        let track = &mut self.tracks[i];
        track.min_override = track.min_override.min(o);
        let q = self.states[i].q.clone();
        track.samples.push(Sample {
            t_s,
            q,
            tcp,
            tcp_speed,
            programmed_speed,
            speed_override: o,
            region,
            distance_m,
            reason,
        });
    }

    fn collide(&mut self, t_s: f64) {
        let Self { checker, states, tracks, objects, cell, looked_s, .. } = self;
        let states: Vec<&ChainState> = states.iter().collect();
        let before = std::mem::replace(looked_s, t_s);
        let legs: Vec<Leg<'_>> = cell.movers.iter().map(|m| m.between(before, t_s)).collect();
        let steps: Vec<ObjectStep<'_>> = cell
            .movers
            .iter()
            .zip(&legs)
            .map(|(m, leg)| ObjectStep { object: m.object, path: leg, jumps: leg.jumps() })
            .collect();
        objects.iter_mut().zip(&cell.movers).for_each(|(track, m)| track.poses.push(m.pose(t_s)));
        let name = |m: Member| match m {
            Member::Object(o) => cell.objects[o].name.clone(),
            Member::Link { robot, link } => {
                let r = &cell.robots[robot];
                format!("{}/{}", r.name, r.robot.chain.links()[link.0])
            }
        };
        checker.check(&states, &steps, |FirstContact { a, b, fraction }| {
            // The tick's own time where it is now, not a hair beside it.
            let t_s = if fraction < 1.0 { before + fraction * (t_s - before) } else { t_s };
            let collision = Collision { t_s, a: name(a), b: name(b) };
            let robot = |m: Member| if let Member::Link { robot, .. } = m { Some(robot) } else { None };
            // Both robots of a pair touched: each one's list tells it.
            let mut concerned: Vec<usize> = [robot(a), robot(b)].into_iter().flatten().collect();
            concerned.dedup();
            for robot in concerned {
                tracks[robot].collisions.push(collision.clone());
            }
        });
    }

    fn ended(&mut self, t_s: f64) -> bool {
        let gone = |i: &usize| self.options.vanish.iter().any(|(r, from)| r == i && t_s >= *from);
        let here: Vec<usize> = (0..self.clocks.len()).filter(|i| !gone(i)).collect();
        if here.iter().all(|i| self.finished(*i)) || t_s >= self.cell.max_s {
            return true;
        }
        let on_path = |i: usize| self.evasive[i].as_ref().is_none_or(Evasive::is_on_path);
        let waiting = here.iter().any(|i| self.clocks[*i].waiting() && on_path(*i));
        let carried = self.frames.anything_travels(t_s);
        self.ending.nothing_moved(t_s, &self.states, waiting || carried)
    }

    fn finished(&self, robot: usize) -> bool {
        self.clocks[robot].finished() && self.evasive[robot].as_ref().is_none_or(Evasive::is_on_path)
    }

    fn advance(&mut self) {
        let dt = self.cell.tick_s;
        let t_s = self.tracks.first().and_then(|t| t.samples.last()).map_or(0.0, |s| s.t_s);
        for i in 0..self.clocks.len() {
            if self.vanished(i, t_s) {
                continue;
            }
            let Self { cell, clocks, evasive, states, obeyed, delays, monitors, frames, setups, .. } = self;
            let Some(evasive) = &mut evasive[i] else {
                delays[i].tell(t_s, obeyed[i]);
                delays[i].advance(&mut clocks[i], t_s, dt);
                continue;
            };
            let regions = |share: f64| {
                let sources = frames.sources(&setups[i].sources, states, t_s);
                RegionFence::new(&monitors[i], &sources, share, 0.0)
            };
            if let Some(event) = evasive.advance(cell, &mut clocks[i], states, t_s, obeyed[i], regions) {
                self.event(t_s, i, "", event);
            }
        }
    }

    fn finish(mut self, t_s: f64) -> Recording {
        let mut robots = std::mem::take(&mut self.tracks);
        for (i, track) in robots.iter_mut().enumerate() {
            track.finished = self.finished(i);
        }
        let mut deadlocks = self
            .board
            .as_ref()
            .map_or_else(Vec::new, |board| self.deadlocks.finish(t_s, board, self.cell, self.setups, &self.monitors));
        deadlocks.extend(
            Waits::new(self.cell, self.setups, self.board.as_deref(), &self.halts, &robots).circles(&deadlocks),
        );
        for (i, track) in robots.iter_mut().enumerate() {
            // Those of one tick come in the order of the pairs.
            track.collisions.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
            let region = track.samples.last().and_then(|s| s.region).map(|r| self.cell.regions[r].region.name.as_str());
            let deadlocked = deadlocks.iter().any(|d| d.robots.contains(&track.name));
            let governing = self.governing[i].as_ref();
            track.ending = outcome::ending(track, deadlocked, region, governing, &self.setups[i].configuration);
        }
        for (track, evasive) in robots.iter_mut().zip(self.evasive) {
            track.avoidance = evasive.map(Evasive::finish);
        }
        Recording {
            cell: self.cell.name.clone(),
            checksum: self.cell.checksum.clone(),
            tick_s: self.cell.tick_s,
            duration_s: t_s,
            monitored: self.options.monitored,
            robots,
            regions: self.regions.finish(t_s),
            objects: self.objects,
            deadlocks,
            events: self.events,
            tick_ns: tick_times(self.tick_ns),
        }
    }
}

fn moving_track(cell: &Cell, mover: &Mover) -> ObjectTrack {
    ObjectTrack { name: cell.objects[mover.object].name.clone(), poses: Vec::new() }
}

/// Time of a tick, s, without the digits that only rounding put there.
fn instant(tick: u64, tick_s: f64) -> f64 {
    (tick as f64 * tick_s * 1e9).round() / 1e9
}

fn tick_times(mut ns: Vec<u64>) -> TickTimes {
    ns.sort_unstable();
    let at =
        |share: f64| ns.get(((ns.len() as f64 * share) as usize).min(ns.len().saturating_sub(1))).copied().unwrap_or(0);
    TickTimes { p50: at(0.5), p99: at(0.99), max: ns.last().copied().unwrap_or(0), count: ns.len() }
}
