//! The pair matrix of one robot: which links are looked at against each other, and why not.

use elbowroom_formats::FormatError;
use elbowroom_scene::{PairState, Reason, Robot, Scene};
use serde::Serialize;

use crate::query::Subject;

/// One entry of the pair matrix.
#[derive(Debug, Clone, Serialize)]
pub struct PairRow {
    /// One link.
    pub a: String,
    /// The other.
    pub b: String,
    /// Whether collision queries look at it.
    pub tested: bool,
    /// Why.
    pub reason: String,
    /// What samples of the joint space suggest where the pair is tested: that it never touches, always does, or does at rest.
    pub suggestion: Option<String>,
    /// Pairs of larger weight are looked at first.
    pub weight: f64,
    /// Distance that counts as contact, m.
    pub margin_m: f64,
    /// The first word of the reason, by which rows are counted.
    #[serde(skip)]
    pub kind: &'static str,
    /// Samples found it in contact each time.
    #[serde(skip)]
    pub always: bool,
    /// In contact at rest, with no solid between.
    #[serde(skip)]
    pub at_rest: bool,
}

/// States of the joint space that are looked at for suggestions.
const SAMPLES: u64 = 1000;

pub(super) fn of_robot(file: &std::path::Path, robot: &Robot) -> Result<Vec<PairRow>, FormatError> {
    let subject = Subject::of_robot(file, robot.clone());
    let scene: Scene = subject.scene(true)?;
    let row = |e: &elbowroom_scene::PairEntry| PairRow {
        a: subject.member_name(e.a),
        b: subject.member_name(e.b),
        tested: e.state == PairState::Tested,
        reason: e.reason.to_string(),
        suggestion: e.suggestion.as_ref().map(ToString::to_string),
        weight: e.weight,
        margin_m: e.margin_m,
        kind: kind(&e.reason),
        at_rest: matches!(e.suggestion, Some(Reason::TouchesAtRest { .. })),
        always: matches!(e.suggestion, Some(Reason::AlwaysInContact { .. })),
    };
    Ok(scene.pairs().sampled(&scene, SAMPLES).entries().iter().map(row).collect())
}

fn kind(reason: &Reason) -> &'static str {
    match reason {
        Reason::Default => "nothing speaks against it",
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
