//! Events and tick times of a run, for the recording and for the observer of the run.

use elbowroom_cell::Cell;
use elbowroom_cell::configure::MonitorSetup;
use elbowroom_monitor::{EventKind, Monitor, RegionId, VolumeId, ZoneArbiter};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use super::observer::{ObservedInstant, ObservedTick, RunObserver};
use crate::recording::{EventRow, ObjectTrack, RunEvent};

/// Events of a run, durations of the monitors' ticks, and the observer.
pub(super) struct Journal<'a> {
    cell: &'a Cell,
    pub events: Vec<EventRow>,
    pub tick_ns: Vec<u64>,
    /// `None` if the run has no observer.
    observer: Option<&'a mut dyn RunObserver>,
    /// Number of events that the observer has seen.
    observed_events: usize,
}

impl<'a> Journal<'a> {
    pub fn new(cell: &'a Cell, observer: Option<&'a mut dyn RunObserver>) -> Self {
        Self { cell, events: Vec::new(), tick_ns: Vec::new(), observer, observed_events: 0 }
    }

    pub fn event(&mut self, t_s: f64, robot: RobotId, region: &str, event: RunEvent) {
        let robot = self.cell.robots[robot.0].name.clone();
        self.events.push(EventRow { t_s, robot, region: region.to_owned(), event });
    }

    /// Records the events of a robot's monitor in its last tick.
    pub fn monitor_events(&mut self, t_s: f64, robot: RobotId, monitor: &Monitor, setup: &MonitorSetup) {
        for e in monitor.events() {
            // Switching is reported once, by the switch itself.
            if matches!(e.kind, EventKind::On | EventKind::Off) {
                continue;
            }
            let cell = self.cell;
            let region = e.region.map_or("", |r| &cell.regions[setup.regions[r.0].0].region.name);
            self.event(t_s, robot, region, RunEvent::Monitor(e.kind));
        }
    }

    pub fn ticked(&mut self, tick: &ObservedTick<'_>) {
        if let Some(observer) = &mut self.observer {
            observer.ticked(tick);
        }
    }

    pub fn switched(&mut self, robot: RobotId, region: RegionId, active: bool) {
        if let Some(observer) = &mut self.observer {
            observer.switched(robot, region, active);
        }
    }

    pub fn attached(&mut self, robot: RobotId, volume: VolumeId, in_link: &Pose) {
        if let Some(observer) = &mut self.observer {
            observer.attached(robot, volume, in_link);
        }
    }

    pub fn detached(&mut self, robot: RobotId, volume: VolumeId) {
        if let Some(observer) = &mut self.observer {
            observer.detached(robot, volume);
        }
    }

    /// Reports an instant to the observer, after all monitors' ticks of this instant.
    pub fn instant(&mut self, t_s: f64, objects: &[ObjectTrack], arbiter: Option<&ZoneArbiter>) {
        let Some(observer) = &mut self.observer else { return };
        observer.instant(&ObservedInstant { t_s, objects, events: &self.events[self.observed_events..], arbiter });
        self.observed_events = self.events.len();
    }
}
