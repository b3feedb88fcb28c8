//! Regions as something that ways stay out of, not only as something that the monitor stops at.

use elbowroom_formats::FormatError;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Gauge, Monitor, Source};
use elbowroom_planner::Fence;

use crate::run::frames::Frames;
use crate::{Cell, configure};

/// Ways keep at least so much from the border of a region, m: at the border the override is 0 and the robot would stand there
/// for good. At 5 mm it is a twentieth where the warning zone is 100 mm thick.
const BORDER_M: f64 = 0.005;

/// The regions that are closed to one robot, where they stand at one instant.
#[derive(Debug)]
pub(crate) struct RegionFence<'m> {
    gauge: Gauge<'m>,
    /// Per region of the configuration: its name, and what ways keep from it, m.
    each: Vec<(&'m str, f64)>,
    /// The most of that.
    most_m: f64,
}

impl<'m> RegionFence<'m> {
    /// What is closed to the robot of this monitor, as its monitor would judge it; `None` where nothing is. Ways keep a share
    /// of each region's warning zone, which is what the override falls to at least, and `least_m`, but not less than 5 mm.
    pub fn new(monitor: &'m Monitor, sources: &[Source], share: f64, least_m: f64) -> Option<Self> {
        let gauge = monitor.gauge(sources);
        let keep = |r: &'m elbowroom_monitor::Region| (share * r.warning_m).max(least_m).max(BORDER_M);
        let each: Vec<_> = monitor.configuration().regions().iter().map(|r| (r.name.as_str(), keep(r))).collect();
        let most_m = gauge.regions().iter().map(|r| each[r.0].1).fold(0.0, f64::max);
        (!gauge.regions().is_empty()).then_some(Self { gauge, each, most_m })
    }

    /// Names of the regions.
    pub fn names(&self) -> Vec<String> {
        self.gauge.regions().iter().map(|r| self.each[r.0].0.to_owned()).collect()
    }
}

impl Fence for RegionFence<'_> {
    fn room_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.gauge.place(q);
        self.gauge.distances(limit_m).map(|(_, metres)| metres).fold(f64::INFINITY, least)
    }

    fn spare_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.gauge.place(q);
        let near = self.gauge.distances(limit_m + self.most_m);
        near.map(|(region, metres)| metres - self.each[region.0].1).fold(f64::INFINITY, least)
    }

    fn travel_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        self.gauge.travel(from, to)
    }

    fn nearest(&mut self, q: &[f64]) -> String {
        self.gauge.place(q);
        let nearest = self.gauge.distances(f64::INFINITY).min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or_else(String::new, |(region, _)| format!("region `{}`", self.each[region.0].0))
    }
}

/// What is closed to a robot of a cell that has not begun: permanent forbidden regions. All robots stand at their start, this one
/// at `q`.
pub(crate) fn at_start<T>(
    cell: &Cell,
    robot: usize,
    q: &[f64],
    least_m: f64,
    plan: impl FnOnce(Option<RegionFence<'_>>) -> Result<T, FormatError>,
) -> Result<T, FormatError> {
    let setups = configure::setups(cell)?;
    let monitors = configure::monitors(cell, &setups)?;
    let standing = |(i, r): (usize, &crate::CellRobot)| {
        let mut state = ChainState::new(&r.robot.chain);
        state.q.copy_from_slice(if i == robot { q } else { &r.start });
        r.robot.chain.forward_motion(&mut state);
        state
    };
    let states: Vec<_> = cell.robots.iter().enumerate().map(standing).collect();
    let sources = Frames::new(cell).sources(&setups[robot].sources, &states, 0.0);
    plan(RegionFence::new(&monitors[robot], &sources, 0.0, least_m))
}

/// The smaller; what is no number is smaller than any.
fn least(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}
