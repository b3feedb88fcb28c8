//! Observation of a run from outside: input and output of each monitor.

use elbowroom_cell::CellRobot;
use elbowroom_monitor::{Monitor, RegionId, Snapshot, TickReport, VolumeId, ZoneArbiter};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use crate::recording::{EventRow, ObjectTrack};

/// Receives everything that changes a monitor, in the order in which it happens. It cannot change the run.
pub trait RunObserver {
    /// Called when a region of a robot's monitor was switched.
    fn switched(&mut self, robot: RobotId, region: RegionId, active: bool);

    /// Called when a volume was attached to a robot.
    fn attached(&mut self, robot: RobotId, volume: VolumeId, in_link: &Pose);

    /// Called when a volume was detached from a robot.
    fn detached(&mut self, robot: RobotId, volume: VolumeId);

    /// Called after a tick of a monitor.
    fn ticked(&mut self, tick: &ObservedTick<'_>);

    /// Called after all monitors' ticks of an instant.
    fn instant(&mut self, instant: &ObservedInstant<'_>);
}

/// A tick of a monitor.
#[derive(Debug, Clone, Copy)]
pub struct ObservedTick<'a> {
    /// The robot.
    pub robot: RobotId,
    /// Input of the monitor.
    pub snapshot: &'a Snapshot<'a>,
    /// Output of the monitor.
    pub report: &'a TickReport,
    /// The monitor after the tick.
    pub monitor: &'a Monitor,
    /// The robot with its present tool.
    pub present: &'a CellRobot,
}

/// An instant of a run.
#[derive(Debug, Clone, Copy)]
pub struct ObservedInstant<'a> {
    /// Time since the start, s.
    pub t_s: f64,
    /// The objects that move; the last pose of each is the present one.
    pub objects: &'a [ObjectTrack],
    /// Events since the previous instant.
    pub events: &'a [EventRow],
    /// The arbiter of the exchange regions.
    pub arbiter: Option<&'a ZoneArbiter>,
}
