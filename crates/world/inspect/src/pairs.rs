//! The allowed collision matrix of one robot.

use std::fmt;

use elbowroom_formats::Diagnostic;
use elbowroom_formats::srdf::{DisabledPair, Srdf};
use elbowroom_robot::{GeometryId, Robot};
use elbowroom_scene::{PairState, Reason, Scene};
use elbowroom_spatial::Pose;
use serde::Serialize;

/// One entry of the allowed collision matrix.
#[derive(Debug, Clone, Serialize)]
pub struct PairRow {
    /// Name of the first link.
    pub a: String,
    /// Name of the second link.
    pub b: String,
    /// Whether collision queries test the pair.
    pub tested: bool,
    /// Why the pair is tested or not.
    pub reason: String,
    /// Suggestion from sampling for a tested pair: never in contact, always in contact, or in contact at rest.
    pub suggestion: Option<String>,
    /// Weight; pairs of larger weight are tested first.
    pub weight: f64,
    /// Security margin, m.
    pub margin_m: f64,
    /// Reason without details; rows are counted by it.
    #[serde(skip)]
    pub kind: ReasonKind,
    /// True if the pair is in contact in all samples.
    #[serde(skip)]
    pub always: bool,
    /// True for a contact at rest without a collider in between.
    #[serde(skip)]
    pub at_rest: bool,
}

/// Why a pair is tested or not, without details.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ReasonKind {
    /// Nothing excludes the pair.
    NotExcluded,
    /// Adjacent links.
    Adjacent,
    /// No joint between the links moves.
    NoJointBetween,
    /// Disabled in the SRDF.
    Srdf,
    /// Proven to be out of reach of each other.
    OutOfReach,
    /// Never in contact in the samples.
    NeverInSamples,
    /// In contact in all samples.
    AlwaysInContact,
    /// In contact at rest.
    TouchesAtRest,
    /// Set by hand.
    ByHand,
    /// Attached, or allowed to touch an attached object.
    Attached,
}

impl ReasonKind {
    /// The name as in the table of an inspection: `not excluded`, `adjacent`, …
    pub fn name(self) -> &'static str {
        match self {
            Self::NotExcluded => "not excluded",
            Self::Adjacent => "adjacent",
            Self::NoJointBetween => "no joint between",
            Self::Srdf => "disabled in the SRDF",
            Self::OutOfReach => "out of reach of each other: proven",
            Self::NeverInSamples => "never in samples",
            Self::AlwaysInContact => "always in contact",
            Self::TouchesAtRest => "in contact at rest",
            Self::ByHand => "by hand",
            Self::Attached => "attached",
        }
    }
}

impl fmt::Display for ReasonKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl From<&Reason> for ReasonKind {
    fn from(reason: &Reason) -> Self {
        match reason {
            Reason::Default => Self::NotExcluded,
            Reason::Adjacent => Self::Adjacent,
            Reason::NoJointBetween => Self::NoJointBetween,
            Reason::Srdf(_) => Self::Srdf,
            Reason::OutOfReach { .. } => Self::OutOfReach,
            Reason::NeverInSamples { .. } => Self::NeverInSamples,
            Reason::AlwaysInContact { .. } => Self::AlwaysInContact,
            Reason::TouchesAtRest { .. } => Self::TouchesAtRest,
            Reason::ByHand(_) => Self::ByHand,
            Reason::Attached(_) | Reason::MayTouch(_) => Self::Attached,
        }
    }
}

/// Writes the SRDF that a robot should have, in the form of MoveIt's Setup Assistant.
///
/// It disables pairs that are adjacent, proven to be out of reach of each other, in contact in all samples, or disabled
/// in the present SRDF. Pairs that touch at rest, or never in the samples, become comments: a person must decide whether
/// to disable them. Groups, states and other contents are copied from `given`.
pub(super) fn srdf(robot: &str, pairs: &[PairRow], given: Srdf) -> String {
    let reason = |row: &PairRow| match (row.kind, row.always) {
        (ReasonKind::Adjacent | ReasonKind::NoJointBetween, _) => Some("Adjacent"),
        (ReasonKind::OutOfReach, _) => Some("Never"),
        (ReasonKind::Srdf, _) => Some("User"),
        (ReasonKind::NotExcluded | ReasonKind::TouchesAtRest, true) => Some("Default"),
        _ => None,
    };
    let disabled = |row: &PairRow| {
        let reason = reason(row)?.to_owned();
        Some(DisabledPair { link1: row.a.clone(), link2: row.b.clone(), reason, line: 0 })
    };
    let open = pairs.iter().filter(|row| reason(row).is_none());
    let comment = |row: &PairRow| {
        let suggestion = row.suggestion.as_ref()?;
        Some(format!("{} and {}: {suggestion}; tested", row.a, row.b))
    };
    let disabled = pairs.iter().filter_map(disabled).collect();
    Srdf { robot: Some(robot.to_owned()), disabled, ..given }.text(&open.filter_map(comment).collect::<Vec<_>>())
}

/// Number of sampled states.
const SAMPLES: u64 = 1000;

pub(super) fn of_robot(file: &std::path::Path, robot: &Robot) -> Result<Vec<PairRow>, Diagnostic> {
    let mut builder = Scene::builder();
    builder.prove_out_of_reach(true).robot("", robot.clone(), Pose::IDENTITY);
    let scene = builder.build().map_err(|e| Diagnostic::new(file, None, e))?;
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
        kind: ReasonKind::from(&e.reason),
        at_rest: matches!(e.suggestion, Some(Reason::TouchesAtRest { .. })),
        always: matches!(e.suggestion, Some(Reason::AlwaysInContact { .. })),
    };
    Ok(scene.allowed_collision_matrix().sampled(&scene, SAMPLES).entries().iter().map(row).collect())
}
