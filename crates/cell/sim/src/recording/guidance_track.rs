//! Recording of a robot that a person guides.

use elbowroom_cell::shared_control::{ArmLimit, Limit};
use elbowroom_spatial::{Pose, Vec3};

/// Guidance of one robot by its operator.
#[derive(Debug, Clone, PartialEq)]
pub struct GuidanceTrack {
    /// Name of the operator.
    pub operator: String,
    /// One per tick.
    pub samples: Vec<GuidanceSample>,
}

/// A tick of a guided robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuidanceSample {
    /// Seconds since the run began, at the start of the tick.
    pub t_s: f64,
    /// The desired pose of the tool point, in the world; `None` if there is none.
    pub wanted: Option<Pose>,
    /// Its actual pose at the end of the tick.
    pub tool_in_world: Pose,
    /// Its velocity in the tick, m/s.
    pub velocity: Vec3,
    /// False at override 0.
    pub is_moving: bool,
    /// Distance between tool and surfaces at the start of the tick, m; `None` far from them.
    pub gap_m: Option<f64>,
    /// Number of surface points that decide the motion.
    pub active: usize,
    /// What kept it from following.
    pub limit: Option<ArmLimit>,
    /// What the hand feels; `None` without forces.
    pub force: Option<ForceSample>,
}

/// Forces of a guided tool in one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSample {
    /// Force on the hand at the end of the tick, N, world axes.
    pub on_hand_n: Vec3,
    /// Energy that was put in and not given back, J.
    pub energy_j: f64,
}

impl GuidanceSample {
    /// Whether the arm followed the hand, at a surface or not.
    pub fn follows(&self) -> bool {
        let of_tool = matches!(self.limit, None | Some(ArmLimit::Tool(Limit::Surface | Limit::Proof)));
        self.wanted.is_some() && self.is_moving && of_tool
    }
}

/// What a guided tool does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GuidanceState {
    /// It follows the hand.
    Free,
    /// It touches a surface, at the gap.
    Touching,
    /// It glides along a surface.
    Gliding,
    /// The arm cannot follow: its reach, a joint, or contact with something else.
    Refused,
    /// Its shaft is not at the point of entry yet, or cannot turn about it as the hand demands: the tip waits.
    AtEntry,
    /// It stands: the operator is not enabled, the input is old, or the override is 0.
    Held,
}

impl GuidanceState {
    /// Name of its beginning in `events.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "leave",
            Self::Touching => "contact",
            Self::Gliding => "glide",
            Self::Refused => "refuse",
            Self::AtEntry => "entry",
            Self::Held => "hold",
        }
    }
}
