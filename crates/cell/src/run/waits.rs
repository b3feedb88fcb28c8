//! Who stands for whom at the end of a run: circles that the board of exchange regions alone does not see, as one robot
//! may hold what the other needs while it carries a region that keeps the first one out.

use elbowroom_monitor::{Board, Kind, RobotSlot};

use super::ending::Halt;
use super::outcome::stopped_at;
use crate::configure::Setup;
use crate::{Cell, Deadlock, Follow, RobotTrack};

/// Per robot that stands unfinished: the region that keeps it, and the robots that would have to go first.
#[derive(Debug)]
pub(super) struct Waits<'a> {
    cell: &'a Cell,
    tracks: &'a [RobotTrack],
    kept_out: Vec<Option<(usize, Vec<usize>)>>,
}

impl<'a> Waits<'a> {
    pub fn new(
        cell: &'a Cell,
        setups: &[Setup],
        board: Option<&Board>,
        halts: &[Halt],
        tracks: &'a [RobotTrack],
    ) -> Self {
        let wait = |robot: usize| {
            let track = &tracks[robot];
            let region = track.samples.last()?.region?;
            let stands = halts[robot].stopped && !track.finished;
            stands.then(|| (region, keepers(cell, &setups[robot], board, robot, region)))
        };
        Self { cell, tracks, kept_out: (0..tracks.len()).map(wait).collect() }
    }

    /// The circles that are not among those that are known.
    pub fn circles(&self, known: &[Deadlock]) -> Vec<Deadlock> {
        let mut told: Vec<bool> =
            self.tracks.iter().map(|t| known.iter().any(|d| d.robots.contains(&t.name))).collect();
        let mut found = Vec::new();
        for robot in 0..self.kept_out.len() {
            let reached = self.reached(robot);
            if told[robot] || !reached[robot] {
                continue;
            }
            // Whoever is reached and reaches back is in the circle.
            let circle: Vec<usize> =
                (0..reached.len()).filter(|other| reached[*other] && self.reached(*other)[robot]).collect();
            for r in &circle {
                told[*r] = true;
            }
            found.push(self.deadlock(&circle));
        }
        found
    }

    /// Robots that have to go before this one can.
    fn reached(&self, from: usize) -> Vec<bool> {
        let mut reached = vec![false; self.kept_out.len()];
        let mut open = vec![from];
        while let Some(robot) = open.pop() {
            for &next in self.kept_out[robot].iter().flat_map(|w| &w.1) {
                if !reached[next] {
                    reached[next] = true;
                    open.push(next);
                }
            }
        }
        reached
    }

    fn deadlock(&self, circle: &[usize]) -> Deadlock {
        let mut regions: Vec<String> = Vec::new();
        for (region, _) in circle.iter().filter_map(|r| self.kept_out[*r].as_ref()) {
            let name = &self.cell.regions[*region].region.name;
            if !regions.contains(name) {
                regions.push(name.clone());
            }
        }
        let since = circle.iter().filter_map(|r| stopped_at(&self.tracks[*r])).fold(0.0, f64::max);
        Deadlock { t_s: since, robots: circle.iter().map(|r| self.tracks[*r].name.clone()).collect(), regions }
    }
}

/// The robots that keep this one out of a region: who carries it, or who holds it or is in it.
fn keepers(cell: &Cell, setup: &Setup, board: Option<&Board>, robot: usize, region: usize) -> Vec<usize> {
    let carrier = match cell.regions[region].follow {
        Some(Follow::Robot { robot, .. }) => Some(robot),
        _ => None,
    };
    let local = setup.regions.iter().position(|r| *r == region);
    let kind = local.map(|i| setup.configuration.regions()[i].kind);
    let (Some(Kind::Exchange { slot }), Some(board)) = (kind, board) else { return carrier.into_iter().collect() };
    let holds = |r: &usize| board.holder(slot) == Some(RobotSlot(*r)) || board.stay(slot, RobotSlot(*r)).occupies();
    (0..board.robots()).filter(|r| *r != robot && (holds(r) || Some(*r) == carrier)).collect()
}
