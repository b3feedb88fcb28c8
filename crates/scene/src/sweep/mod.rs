//! When does anything first touch while robots go from one configuration to another? Proven, not sampled.
//!
//! One search over the time of the motion for all pairs together ([`search`]), on two legs: how far apart the members of
//! a pair are at some instant, and how much nearer they can come until another ([`speed`], derived in README.md).

mod answer;
mod levers;
mod search;
mod speed;
mod travel;

use elbowroom_proximity::impact::Path;

use crate::checker::{Core, PairList};
use crate::{Scene, SceneError, SceneState};
use search::Search;
use travel::Travel;

pub use answer::{Impact, SweepOptions};

/// Something that moves while the time of a motion goes from 0 to 1.
#[derive(Clone, Copy)]
pub enum Move<'m> {
    /// A robot, from where the start state has it: every joint value at a constant rate, all joints at once,
    /// `q(t) = q(0) + (to − q(0))·t`. What it carries comes along.
    Robot {
        /// Index of the robot.
        robot: usize,
        /// Joint values at the end, rad or m.
        to: &'m [f64],
    },
    /// An object that no robot carries. Where the start state has it does not count: the path says where it is.
    Object {
        /// Index of the object.
        object: usize,
        /// How it moves: [`Steady`](elbowroom_proximity::impact::Steady), or any other path that bounds its speed.
        path: &'m dyn Path,
    },
}

impl std::fmt::Debug for Move<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Robot { robot, to } => f.debug_struct("Robot").field("robot", robot).field("to", to).finish(),
            Self::Object { object, .. } => f.debug_struct("Object").field("object", object).finish_non_exhaustive(),
        }
    }
}

/// What sweeps take beside the checker's own: made at the first one, used again.
#[derive(Debug)]
pub(crate) struct Sweeper {
    travel: Travel,
    search: Search,
}

impl Sweeper {
    pub fn new(scene: &Scene, level: crate::Level) -> Self {
        Self { travel: Travel::new(scene, level), search: Search::default() }
    }

    /// From the start state along the moves.
    pub fn sweep(
        &mut self,
        core: &mut Core,
        list: &mut PairList,
        start: &SceneState,
        moves: &[Move],
        options: &SweepOptions,
    ) -> Result<Option<Impact>, SceneError> {
        self.travel.depart(core.scene, start, moves)?;
        Ok(self.search.run(core, list, &mut self.travel, moves, options))
    }

    /// One robot from the start state along waypoints.
    pub fn sweep_path<Q: AsRef<[f64]>>(
        &mut self,
        core: &mut Core,
        list: &mut PairList,
        start: &SceneState,
        robot: usize,
        waypoints: &[Q],
        options: &SweepOptions,
    ) -> Result<Option<(usize, Impact)>, SceneError> {
        for q in waypoints {
            start.check_q(core.scene, robot, q.as_ref())?;
        }
        for (segment, q) in waypoints.iter().enumerate() {
            let moves = [Move::Robot { robot, to: q.as_ref() }];
            match segment.checked_sub(1) {
                None => self.travel.depart(core.scene, start, &moves)?,
                Some(last) => self.travel.go_on(core.scene, robot, (waypoints[last].as_ref(), q.as_ref())),
            }
            if let Some(hit) = self.search.run(core, list, &mut self.travel, &moves, options) {
                return Ok(Some((segment, hit)));
            }
        }
        Ok(None)
    }
}
