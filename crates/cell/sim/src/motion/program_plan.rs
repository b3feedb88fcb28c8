//! A planned program: its steps with their motions.

use std::sync::Arc;

use elbowroom_cell::trajectory::Playback;
use elbowroom_cell::{CellRegionId, PathPlanner};
use elbowroom_query::plan::KeptDirection;

use super::{GripAction, Segment};

/// A planned program.
#[derive(Debug, Clone, Default)]
pub struct ProgramPlan {
    /// Joint values before the first step, rad or m.
    pub start: Vec<f64>,
    /// Programmed override at the start, 0..1.
    pub speed_override: f64,
    /// The steps, in order.
    pub steps: Vec<PlanStep>,
}

/// One step of a plan.
#[derive(Debug, Clone)]
pub enum PlanStep {
    /// A timed move.
    Move(Arc<Segment>),
    /// A recording.
    Play(Arc<Playback>),
    /// A planned move, which may be replaced by a move with the same end.
    Planned {
        /// The path in time.
        play: Arc<Playback>,
        /// Fraction of the joints' speeds that it uses.
        speed: f64,
        /// Planner that found its path, and that searches for another one if the path is blocked.
        planner: PathPlanner,
        /// The direction that an axis of the TCP keeps on it.
        keep: Option<KeptDirection>,
    },
    /// Switches a region.
    Switch {
        /// The region.
        region: CellRegionId,
        /// On or off.
        active: bool,
    },
    /// Grips or releases an object.
    Grip(GripAction),
    /// Makes a tool the active one.
    Tool(usize),
    /// Waits, s.
    Wait(f64),
    /// Sets the programmed override, 0..1.
    Override(f64),
}

impl ProgramPlan {
    /// Whether it has a planned move.
    pub fn has_planned_moves(&self) -> bool {
        self.steps.iter().any(|s| matches!(s, PlanStep::Planned { .. }))
    }
}

impl PlanStep {
    /// Joint values at its end; `None` if it is not a move.
    pub fn end(&self) -> Option<Vec<f64>> {
        match self {
            Self::Move(segment) => Some(segment.end()),
            Self::Play(play) | Self::Planned { play, .. } => Some(play.q(play.duration())),
            _ => None,
        }
    }
}
