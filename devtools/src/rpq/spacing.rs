//! Measurements at one distance between the two robots.

use super::measure::{Query, Run, Setting};

/// All that was measured at one distance between the bases.
pub struct Spacing {
    pub distance_m: f64,
    /// Number of pairs of links, and how many of them the matrix proves out of reach.
    pub pairs: (usize, usize),
    pub runs: Vec<Run>,
}

impl Spacing {
    pub fn run(&self, query: Query, setting: Setting) -> Option<&Run> {
        self.runs.iter().find(|run| run.query == query && run.setting == setting)
    }

    pub fn contact_share(&self) -> f64 {
        let answers = self.run(Query::Collision, Setting::FULL).map_or(&[][..], |run| &run.answers);
        answers.iter().sum::<f64>() / answers.len().max(1) as f64
    }
}
