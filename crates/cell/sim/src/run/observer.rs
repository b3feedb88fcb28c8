//! Observing a run from outside: what each monitor was given, and what it answered.

use elbowroom_cell::CellRobot;
use elbowroom_monitor::{Monitor, RegionId, Snapshot, TickReport, VolumeId, ZoneArbiter};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use crate::recording::{EventRow, ObjectTrack};

/// Sees everything that changes a monitor, in the order in which it happens. It cannot change the run.
pub trait RunObserver {
    /// A region of a robot's monitor was switched.
    fn switched(&mut self, robot: RobotId, region: RegionId, active: bool);

    /// A volume was attached to a robot.
    fn attached(&mut self, robot: RobotId, volume: VolumeId, in_link: &Pose);

    /// A volume was detached from a robot.
    fn detached(&mut self, robot: RobotId, volume: VolumeId);

    /// A monitor has ticked.
    fn ticked(&mut self, tick: &ObservedTick<'_>);

    /// All monitors have ticked that do at this instant.
    fn instant(&mut self, instant: &ObservedInstant<'_>);
}

/// A tick of a monitor.
#[derive(Debug, Clone, Copy)]
pub struct ObservedTick<'a> {
    /// The robot.
    pub robot: RobotId,
    /// What the monitor was given.
    pub snapshot: &'a Snapshot<'a>,
    /// What it answered.
    pub report: &'a TickReport,
    /// The monitor after the tick.
    pub monitor: &'a Monitor,
    /// The robot with the tool that it has at present.
    pub present: &'a CellRobot,
}

/// An instant of a run.
#[derive(Debug, Clone, Copy)]
pub struct ObservedInstant<'a> {
    /// Time since the start, s.
    pub t_s: f64,
    /// The objects that move, each with its pose now as the last one.
    pub objects: &'a [ObjectTrack],
    /// What has happened since the instant before.
    pub events: &'a [EventRow],
    /// The arbiter of the exchange regions.
    pub arbiter: Option<&'a ZoneArbiter>,
}
