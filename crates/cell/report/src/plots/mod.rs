//! The plots: distances and override, figure 12 of the paper, then timing and joints.

mod avoidance;
mod cooperation;
mod distances;
mod figure;
mod figure12;
mod grids;
mod guidance;
mod joints;
mod overrides;
mod plot;
mod timing;

use elbowroom_robot::RobotId;
use elbowroom_sim::Recording;

use crate::scene::ReportScene;

pub use figure::{Drawing, Figure};

/// All plots, in the order of the page; `planned` is the run without the monitor, for comparison.
pub fn all(scene: &ReportScene, runs: &[(&str, &Recording)], planned: Option<&Recording>) -> Vec<Figure> {
    let mut figures = Vec::new();
    if let Some((_, first)) = runs.first() {
        let planned = planned.filter(|_| first.monitored);
        figures.extend((0..first.robots.len()).map(RobotId).filter_map(|r| distances::chart(scene, first, planned, r)));
    }
    figures.extend(overrides::all(runs));
    figures.extend(figure12::all(scene, runs));
    for run in 0..runs.len() {
        figures.extend(avoidance::all(runs, run));
        figures.extend(guidance::all(runs, run));
        figures.extend(cooperation::all(runs, run));
        figures.extend(timing::chart(runs, run));
        figures.extend(grids::chart(runs, run));
        figures.extend(joints::chart(scene, runs, run));
    }
    figures
}
