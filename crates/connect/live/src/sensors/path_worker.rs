//! Searches for paths of one robot, on a thread of its own: meanwhile its path is checked as before.

use std::sync::mpsc::{Receiver, Sender};

use elbowroom_monitor::SourceState;
use elbowroom_sim::replanning::{PathReplanner, SearchRequest, SearchResult};

use super::robot_regions::RobotRegions;
use crate::messages::AttachedVolume;

/// A search, and the regions that bound it.
pub(super) struct SearchJob {
    pub request: SearchRequest,
    pub sources: Vec<SourceState>,
    /// Per region of the robot whether it is on.
    pub active: Vec<bool>,
    pub attached: Vec<AttachedVolume>,
}

/// Searches until nobody asks any more.
pub(super) fn work(
    mut replanner: PathReplanner<'_>,
    mut regions: RobotRegions,
    jobs: &Receiver<SearchJob>,
    results: &Sender<(SearchRequest, SearchResult)>,
) {
    for SearchJob { request, sources, active, attached } in jobs {
        regions.update(&active, &attached);
        let result = replanner.search(&request, &regions.closed(sources));
        if results.send((request, result)).is_err() {
            return;
        }
    }
}
