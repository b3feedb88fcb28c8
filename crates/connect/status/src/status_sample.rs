//! Per-tick data for the status, copied without allocation.

use elbowroom_monitor::{
    Event, ExchangeState, Monitor, OverrideReason, RegionId, Snapshot, TickReport, VirtualTcp, VolumeId,
};
use elbowroom_spatial::Pose;

/// Most events kept between two statuses; further ones are only counted.
const MAX_EVENTS: usize = 256;

/// Number of regions that may be added while the cell runs before a sample needs more memory.
pub const SPARE_REGIONS: usize = 64;

/// Per-tick data for a [`RobotStatus`](crate::RobotStatus): plain copies in preallocated memory.
#[derive(Debug, Clone, PartialEq)]
pub struct StatusSample {
    pub(crate) q: Vec<f64>,
    pub(crate) report: TickReport,
    pub(crate) regions: Vec<RegionSample>,
    pub(crate) virtual_tcps: Vec<VirtualTcp>,
    /// The tool centre point of the mounted tool.
    tcp: Option<VolumeId>,
    events: Vec<Event>,
    lost_events: usize,
}

/// A region in a tick.
#[allow(clippy::struct_excessive_bools, reason = "each is a state of its own")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RegionSample {
    pub(crate) active: bool,
    pub(crate) inside: bool,
    pub(crate) warned: bool,
    pub(crate) closed: bool,
    pub(crate) exchange: Option<ExchangeState>,
    pub(crate) in_world: Pose,
}

impl RegionSample {
    fn of(monitor: &Monitor, region: RegionId) -> Self {
        Self {
            active: monitor.is_active(region),
            inside: monitor.is_inside(region),
            warned: monitor.is_warned(region),
            closed: monitor.is_closed(region),
            exchange: monitor.exchange_state(region),
            in_world: monitor.region_in_world(region),
        }
    }
}

impl StatusSample {
    /// Creates an empty sample with memory for this monitor.
    pub fn new(monitor: &Monitor) -> Self {
        let regions = monitor.configuration().regions().len() + SPARE_REGIONS;
        let nothing = TickReport {
            stamp_s: 0.0,
            speed_override: 0.0,
            reason: OverrideReason::Free,
            governing: None,
            outputs: 0,
            measured_pairs: 0,
        };
        Self {
            q: Vec::with_capacity(monitor.configuration().chain().dof()),
            report: nothing,
            regions: Vec::with_capacity(regions),
            virtual_tcps: Vec::with_capacity(regions),
            tcp: None,
            events: Vec::with_capacity(MAX_EVENTS),
            lost_events: 0,
        }
    }

    /// Copies the result of a tick. Does not allocate.
    pub fn fill(&mut self, monitor: &Monitor, snapshot: &Snapshot<'_>, report: &TickReport) {
        self.q.clear();
        self.q.extend(snapshot.q.iter().take(self.q.capacity()));
        self.report = *report;
        self.regions.clear();
        let count = monitor.configuration().regions().len();
        self.regions.extend((0..count).map(|r| RegionSample::of(monitor, RegionId(r))));
        self.virtual_tcps.clear();
        self.virtual_tcps.extend(monitor.virtual_tcps(snapshot).take(self.virtual_tcps.capacity()));
        self.tcp = monitor.tcp();
    }

    /// Copies the result of a tick without joint values.
    pub fn fill_without_input(&mut self, report: &TickReport) {
        self.report = *report;
        self.q.clear();
        self.regions.clear();
        self.virtual_tcps.clear();
        self.tcp = None;
    }

    /// The tool centre point of the tool that was mounted in the tick; `None` without a tool, or without input.
    pub fn tcp(&self) -> Option<VolumeId> {
        self.tcp
    }

    /// Joint positions; empty without input.
    pub fn joint_positions(&self) -> &[f64] {
        &self.q
    }

    /// Adds the events of a tick, so that no event is lost between two statuses. Does not allocate.
    pub fn add_events(&mut self, monitor: &Monitor) {
        for event in monitor.events() {
            if self.events.len() < MAX_EVENTS { self.events.push(*event) } else { self.lost_events += 1 }
        }
    }

    /// Renumbers the regions of the events that were not taken yet, after the regions have changed. Does not allocate.
    pub fn renumber(&mut self, new: impl Fn(RegionId) -> Option<RegionId>) {
        self.events.iter_mut().for_each(|event| event.region = event.region.and_then(&new));
    }

    /// Takes the events since the last call, and the number of events that were dropped.
    pub fn take_events(&mut self) -> (impl Iterator<Item = Event> + '_, usize) {
        let lost = std::mem::take(&mut self.lost_events);
        (self.events.drain(..), lost)
    }
}
