//! The allowed collision matrix of one robot.

use elbowroom_formats::FormatError;
use elbowroom_robot::{GeometryId, Robot};
use elbowroom_scene::{PairState, Reason, Scene};
use elbowroom_spatial::Pose;
use serde::Serialize;

/// One entry of the allowed collision matrix.
#[derive(Debug, Clone, Serialize)]
pub struct PairRow {
    /// One link.
    pub a: String,
    /// The other.
    pub b: String,
    /// Whether collision queries test the pair.
    pub tested: bool,
    /// The reason.
    pub reason: String,
    /// Suggestion from sampling for a tested pair: never, always, or at rest in contact.
    pub suggestion: Option<String>,
    /// Weight; pairs of larger weight are tested first.
    pub weight: f64,
    /// Security margin, m.
    pub margin_m: f64,
    /// Reason without details, by which rows are counted.
    #[serde(skip)]
    pub kind: &'static str,
    /// True where all samples are in contact.
    #[serde(skip)]
    pub always: bool,
    /// True for a contact at rest without a collider in between.
    #[serde(skip)]
    pub at_rest: bool,
}

/// Number of sampled states.
const SAMPLES: u64 = 1000;

pub(super) fn of_robot(file: &std::path::Path, robot: &Robot) -> Result<Vec<PairRow>, FormatError> {
    let mut builder = Scene::builder();
    builder.prove_out_of_reach(true).robot("", robot.clone(), Pose::IDENTITY);
    let scene = builder.build().map_err(|e| FormatError::new(file, None, e.to_string()))?;
    let name = |id: GeometryId| match id {
        GeometryId::Link { link, .. } => robot.chain.links()[link.0].clone(),
        GeometryId::Object(_) => String::new(),
    };
    let row = |e: &elbowroom_scene::PairEntry| PairRow {
        a: name(e.a),
        b: name(e.b),
        tested: e.state == PairState::Tested,
        reason: e.reason.to_string(),
        suggestion: e.suggestion.as_ref().map(ToString::to_string),
        weight: e.weight,
        margin_m: e.margin_m,
        kind: kind(&e.reason),
        at_rest: matches!(e.suggestion, Some(Reason::TouchesAtRest { .. })),
        always: matches!(e.suggestion, Some(Reason::AlwaysInContact { .. })),
    };
    Ok(scene.allowed_collision_matrix().sampled(&scene, SAMPLES).entries().iter().map(row).collect())
}

fn kind(reason: &Reason) -> &'static str {
    match reason {
        Reason::Default => "not excluded",
        Reason::Adjacent => "adjacent",
        Reason::NoJointBetween => "no joint between",
        Reason::Srdf(_) => "disabled in the SRDF",
        Reason::OutOfReach { .. } => "out of reach of each other: proven",
        Reason::NeverInSamples { .. } => "never in samples",
        Reason::AlwaysInContact { .. } => "always in contact",
        Reason::TouchesAtRest { .. } => "in contact at rest",
        Reason::ByHand(_) => "by hand",
        Reason::Attached(_) | Reason::MayTouch(_) => "attached",
    }
}
