//! The workspace of sweeps, kept from one sweep to the next.

use elbowroom_robot::RobotId;

use super::moves::SweepMove;
use super::options::{SweepHit, SweepOptions};
use super::search::SweepSearch;
use super::trajectory::SweepTrajectory;
use crate::checker::core::CheckerCore;
use crate::checker::pair_list::PairList;
use crate::{Level, Scene, SceneError, SceneState};

/// Trajectory and search of sweeps: created at the first sweep, then kept.
#[derive(Debug)]
pub(crate) struct Sweeper {
    trajectory: SweepTrajectory,
    search: SweepSearch,
}

impl Sweeper {
    pub fn new(scene: &Scene, level: Level) -> Self {
        Self { trajectory: SweepTrajectory::new(scene, level), search: SweepSearch::default() }
    }

    /// Sweeps from the start state along the moves.
    pub fn sweep(
        &mut self,
        core: &mut CheckerCore,
        list: &mut PairList,
        start: &SceneState,
        moves: &[SweepMove],
        options: &SweepOptions,
    ) -> Result<Option<SweepHit>, SceneError> {
        self.trajectory.start(core.scene, start, moves)?;
        Ok(self.search.run(core, list, &mut self.trajectory, moves, options))
    }

    /// Sweeps one robot from the start state along waypoints.
    pub fn sweep_path<Q: AsRef<[f64]>>(
        &mut self,
        core: &mut CheckerCore,
        list: &mut PairList,
        start: &SceneState,
        robot: RobotId,
        waypoints: &[Q],
        options: &SweepOptions,
    ) -> Result<Option<(usize, SweepHit)>, SceneError> {
        for q in waypoints {
            start.check_q(core.scene, robot, q.as_ref())?;
        }
        for (segment, q) in waypoints.iter().enumerate() {
            let moves = [SweepMove::Robot { robot, to: q.as_ref() }];
            match segment.checked_sub(1) {
                None => self.trajectory.start(core.scene, start, &moves)?,
                Some(last) => self.trajectory.next_segment(core.scene, robot, waypoints[last].as_ref(), q.as_ref()),
            }
            if let Some(hit) = self.search.run(core, list, &mut self.trajectory, &moves, options) {
                return Ok(Some((segment, hit)));
            }
        }
        Ok(None)
    }
}
