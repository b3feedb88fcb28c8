//! Frames of objects: links at the start, fixed frames, the world.

use elbowroom_formats::problem_set::{FixedFrame, PlanningProblem};
use elbowroom_formats::suggest;
use elbowroom_kinematics::{Chain, ChainState};
use elbowroom_spatial::Pose;

use super::messages::{ProblemKey, Result};

/// Frames of a problem with the robot at its start.
pub(super) struct Frames<'a> {
    key: ProblemKey<'a>,
    problem: &'a PlanningProblem,
    chain: &'a Chain,
    state: ChainState,
}

impl<'a> Frames<'a> {
    pub(super) fn new(key: ProblemKey<'a>, problem: &'a PlanningProblem, chain: &'a Chain, start: &[f64]) -> Self {
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(start);
        chain.forward(&mut state);
        Self { key, problem, chain, state }
    }

    /// The pose of a frame in the root link.
    pub(super) fn in_root(&self, name: &str) -> Result<Pose> {
        let frames = &self.problem.frames;
        let (name, pose) = FixedFrame::ancestor(frames, name, |name| self.chain.link(name).is_some());
        if let Some(link) = self.chain.link(name) {
            return Ok(self.state.link_in_root(link) * pose);
        }
        if name.is_empty() || name == "world" {
            return Ok(self.problem.base_in_world.inverse() * pose);
        }
        let known = self.problem.frames.iter().map(|f| f.name.as_str());
        let known = known.chain(["world"]).chain(self.chain.links().iter().map(String::as_str));
        let what = format!("the frame `{name}` is no link of the robot, and `fixed_frame_transforms` do not define it");
        Err(self.key.error(what).hint(suggest::hint(name, known)))
    }
}
