//! The plots: figure 12 of the paper, then override, distance, timing and joints.

mod avoidance;
mod figure;
mod figure12;
mod joints;
mod overrides;
mod perception;
mod plot;
mod timing;

use elbowroom_sim::Recording;

use crate::scene::ReportScene;

pub use figure::Figure;
pub use perception::all as perception;

/// All plots, in the order of the page.
pub fn all(scene: &ReportScene, runs: &[(&str, &Recording)]) -> Vec<Figure> {
    let mut figures = figure12::all(scene, runs);
    figures.extend(overrides::all(runs));
    for run in 0..runs.len() {
        figures.extend(avoidance::all(runs, run));
        figures.extend(timing::chart(runs, run));
        figures.extend(joints::chart(scene, runs, run));
    }
    figures
}
