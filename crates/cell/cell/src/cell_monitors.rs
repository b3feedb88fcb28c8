//! The monitors of a cell, fed with the joint values of all robots at once.

use std::ops::Range;
use std::sync::Arc;

use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{
    AccessClass, Event, EventKind, Life, Monitor, OverrideReason, RegionKind, Snapshot, SourceState, SwitchError,
    TickReport,
};

use crate::configure::{self, MonitorSetup};
use crate::{Cell, CellRegionId, Frames};

/// The state of all robots of a cell at one instant: values side by side, robots in the order of the cell, rad or m.
#[derive(Debug, Clone, Copy)]
pub struct CellInstant<'a> {
    /// Time, s, at which the values are measured; also that of belts, moving objects and pose files.
    pub now_s: f64,
    /// Joint positions.
    pub q: &'a [f64],
    /// Joint velocities; empty if they are not known: see [`Snapshot::qd`]. Regions that ride on a robot then move by the
    /// difference of its last positions, and are lost in the first tick.
    pub qd: &'a [f64],
    /// Joint velocities of the programs at override 1; empty if they are not known: see [`Snapshot::intent`].
    pub intent: &'a [f64],
    /// The override set by programs or operators, 0 to 1.
    pub programmed_override: f64,
}

/// The report of a robot's monitor, and what happened in the tick.
#[derive(Debug, Clone)]
pub struct RobotTick {
    /// The report.
    pub report: TickReport,
    /// The events. The first tick includes the events of the tick before it.
    pub events: Vec<Event>,
}

/// The monitors of all robots of a cell and the interlock between them, for a host that knows every robot's state.
///
/// It allocates; a controller has a [`Monitor`] of its own, which does not.
///
/// ```
/// use elbowroom_cell::{Cell, CellInstant, CellMonitors};
/// let text = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n\
///             [robot.arm]\ndh = [{ a = 300, speed = 90 }]\nlinks = [{ sphere = { radius = 50 } }]\n\
///             [region.post]\nshape = \"sphere\"\ncentre = [0, 500, 0]\nradius = 100\nwarning = 200\nguards = [\"tcp\"]\n";
/// let mut monitors = CellMonitors::new(Cell::parse("cell.toml", text)?.into())?;
/// let mut speed_override = |now_s: f64, q: f64| {
///     let instant = CellInstant { now_s, q: &[q], qd: &[], intent: &[], programmed_override: 1.0 };
///     monitors.tick(&instant)[0].report.speed_override
/// };
/// assert_eq!(speed_override(0.0, 0.0), 1.0);
/// assert_eq!(speed_override(0.002, f64::NAN), 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct CellMonitors {
    cell: Arc<Cell>,
    setups: Vec<MonitorSetup>,
    monitors: Vec<Monitor>,
    /// The states of the robots, for what moves with them.
    states: Vec<ChainState>,
    /// Place of each robot's values.
    places: Vec<Range<usize>>,
    /// Whether a monitor must still tell the interlock where its robot is, before robots are granted regions.
    must_publish: bool,
    /// Time, s, and positions of the last tick.
    last: Option<(f64, Vec<f64>)>,
}

impl CellMonitors {
    /// Creates the monitors.
    ///
    /// # Errors
    /// As for [`configure::setups`].
    pub fn new(cell: Arc<Cell>) -> Result<Self, Diagnostic> {
        let setups = configure::setups(&cell)?;
        let monitors = configure::monitors(&cell, &setups)?;
        let mut end = 0;
        let place = |robot: &crate::CellRobot| {
            let begin = end;
            end += robot.robot.chain.dof();
            begin..end
        };
        let places = cell.robots.iter().map(place).collect();
        let states = cell.robots.iter().map(|robot| ChainState::new(&robot.robot.chain)).collect();
        let must_publish = cell.regions.iter().any(|r| matches!(r.region.kind, RegionKind::Exchange { .. }));
        Ok(Self { setups, monitors, states, places, must_publish, last: None, cell })
    }

    /// The cell.
    pub fn cell(&self) -> &Arc<Cell> {
        &self.cell
    }

    /// The monitor of each robot.
    pub fn monitors(&self) -> &[Monitor] {
        &self.monitors
    }

    /// Ticks every monitor, in the order of the robots. Whatever is wrong with the values, such as NaN or their number,
    /// ends in override 0 and its reason.
    ///
    /// In a cell with exchange regions each monitor has a tick before the first one, a period earlier at the same place, as
    /// in a run: a robot that starts inside would otherwise wait for robots without a status.
    pub fn tick(&mut self, at: &CellInstant<'_>) -> Vec<RobotTick> {
        self.place(at);
        let before = if self.must_publish { self.publish(at) } else { Vec::new() };
        let mut ticks = self.tick_all(at, at.now_s);
        for (tick, events) in ticks.iter_mut().zip(before) {
            tick.events.splice(0..0, events);
        }
        let is_whole = self.places.last().is_none_or(|place| at.q.len() >= place.end);
        self.last = (is_whole && at.now_s.is_finite()).then(|| (at.now_s, at.q.to_vec()));
        ticks
    }

    /// Ticks every monitor once before the first tick, and returns the events of each that are not about the input.
    fn publish(&mut self, at: &CellInstant<'_>) -> Vec<Vec<Event>> {
        let ticks = self.tick_all(at, at.now_s - self.cell.timing.tick_s);
        self.must_publish =
            !at.qd.is_empty() && ticks.iter().any(|t| matches!(t.report.reason, OverrideReason::Fault(_)));
        if at.qd.is_empty() {
            // Both ticks have the same positions, which does not mean that the robots rest: velocities are still not known.
            self.monitors.iter_mut().for_each(Monitor::forget_position);
        }
        let is_told = |event: &Event| !matches!(event.kind, EventKind::Fault | EventKind::Recovered);
        ticks.into_iter().map(|tick| tick.events.into_iter().filter(is_told).collect()).collect()
    }

    /// Switches a temporary region on or off in every monitor that has it, from the next tick on.
    ///
    /// # Errors
    /// [`SwitchError`] if the region is permanent or the access class is too low; then nothing changes.
    pub fn switch(&mut self, region: CellRegionId, on: bool, who: AccessClass) -> Result<(), SwitchError> {
        let region = &self.cell.regions[region.0].region;
        if region.life == Life::Permanent {
            return Err(SwitchError::Permanent(region.name.clone()));
        }
        for monitor in &mut self.monitors {
            if let Some(own) = monitor.region(&region.name) {
                monitor.switch(own, on, who)?;
            }
        }
        Ok(())
    }

    fn place(&mut self, at: &CellInstant<'_>) {
        let Self { states, places, cell, last, .. } = self;
        for ((state, place), robot) in states.iter_mut().zip(&*places).zip(&cell.robots) {
            if let Some(q) = at.q.get(place.clone()) {
                state.q.copy_from_slice(q);
            }
            match (at.qd.get(place.clone()), &*last) {
                (Some(qd), _) => state.qd.copy_from_slice(qd),
                (None, Some((then_s, then))) => {
                    let since_s = at.now_s - then_s;
                    for ((qd, q), then) in state.qd.iter_mut().zip(&state.q).zip(&then[place.clone()]) {
                        *qd = if since_s > 0.0 { (q - then) / since_s } else { f64::NAN };
                    }
                }
                // Nobody knows how fast what rides on it moves.
                (None, None) => state.qd.fill(f64::NAN),
            }
            robot.robot.chain.forward_motion(state);
        }
    }

    /// Ticks every monitor at a time, s, that may be earlier than the instant.
    fn tick_all(&mut self, at: &CellInstant<'_>, now_s: f64) -> Vec<RobotTick> {
        let frames = Frames::new(&self.cell);
        let robots = self.monitors.iter_mut().zip(&self.setups).zip(&self.places);
        let tick = |((monitor, setup), place): ((&mut Monitor, &MonitorSetup), &Range<usize>)| {
            let sources = frames.sources(&setup.sources, &self.states, at.now_s).into_iter();
            let sources: Vec<_> = sources.map(|source| SourceState { stamp_s: now_s, ..source }).collect();
            let report = monitor.tick(&snapshot(&CellInstant { now_s, ..*at }, place, &sources));
            RobotTick { report, events: monitor.events().to_vec() }
        };
        robots.map(tick).collect()
    }
}

/// What a robot's monitor reads. Values that are not there are none: then it has too few, and stops the robot.
fn snapshot<'a>(at: &CellInstant<'a>, place: &Range<usize>, sources: &'a [SourceState]) -> Snapshot<'a> {
    let values = |of_cell: &'a [f64]| of_cell.get(place.clone()).unwrap_or(&[]);
    Snapshot {
        qd: values(at.qd),
        intent: at.intent.get(place.clone()),
        programmed_override: at.programmed_override,
        sources,
        ..Snapshot::stationary(at.now_s, values(at.q))
    }
}
