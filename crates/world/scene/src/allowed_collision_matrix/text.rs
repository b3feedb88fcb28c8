//! The allowed collision matrix as text: with names instead of indices, one pair per line, in a fixed order.

use std::collections::HashSet;

use elbowroom_robot::GeometryId;
use serde::{Deserialize, Serialize};

use super::entry::{PairEntry, PairNumber, PairState};
use super::matrix::AllowedCollisionMatrix;
use super::reason::Reason;
use crate::{MatrixError, Scene};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EntryRow {
    a: String,
    b: String,
    state: String,
    margin_m: f64,
    weight: f64,
    reason: Reason,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    suggestion: Option<Reason>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MatrixFile {
    version: i64,
    #[serde(default)]
    pairs: Vec<EntryRow>,
}

const HEAD: &str = "# Allowed collision matrix: state is tested or skipped, margin_m in metres, larger weights are tested first.\n\
    # Change a state with reason = { by_hand = \"why\" }.\nversion = 1\npairs = [\n";

impl AllowedCollisionMatrix {
    /// Writes TOML that [`AllowedCollisionMatrix::from_text`] reads. Equal matrices give equal texts.
    pub fn to_text(&self, scene: &Scene) -> String {
        let mut text = String::from(HEAD);
        let by_hand = self.object_entries().filter(|e| matches!(e.reason, Reason::ByHand(_)));
        for e in self.entries().iter().chain(by_hand) {
            let row = EntryRow {
                a: scene.name(e.a),
                b: scene.name(e.b),
                state: e.state.to_string(),
                margin_m: e.margin_m,
                weight: e.weight,
                reason: e.reason.clone(),
                suggestion: e.suggestion.clone(),
            };
            // Strings and numbers always have a TOML form.
            if let Ok(value) = toml::Value::try_from(&row) {
                text.push_str("  ");
                text.push_str(&value.to_string());
                text.push_str(",\n");
            }
        }
        text.push_str("]\n");
        text
    }

    /// Returns the scene's matrix, changed by the entries of the text. Pairs missing in the text keep the scene's entry.
    ///
    /// Reasons that follow from the model (default, adjacent, no joint between, SRDF, out of reach) are checked against
    /// the model: a matrix of another model is refused.
    ///
    /// # Errors
    /// [`MatrixError`] if the text is not an allowed collision matrix, or belongs to another scene.
    pub fn from_text(scene: &Scene, text: &str) -> Result<Self, MatrixError> {
        let file: MatrixFile = toml::from_str(text).map_err(|e| MatrixError::Syntax(e.to_string().trim().into()))?;
        if file.version != 1 {
            return Err(MatrixError::Version(file.version));
        }
        let mut matrix = scene.model_matrix.clone();
        let mut seen = HashSet::new();
        for row in file.pairs {
            let (a, b) = (geometry(scene, &row.a)?, geometry(scene, &row.b)?);
            let objects = matches!((a, b), (GeometryId::Object(_), GeometryId::Object(_)));
            let is_pair = !objects || matches!(row.reason, Reason::ByHand(_));
            let Some(entry) = matrix.entry_mut(a, b, row.margin_m).filter(|_| is_pair) else {
                return Err(MatrixError::NoSuchPair { a: row.a, b: row.b });
            };
            if !seen.insert((entry.a, entry.b)) {
                return Err(MatrixError::Twice { a: row.a, b: row.b });
            }
            apply(entry, row)?;
        }
        Ok(matrix)
    }
}

fn apply(entry: &mut PairEntry, row: EntryRow) -> Result<(), MatrixError> {
    for (what, value) in [(PairNumber::Margin, row.margin_m), (PairNumber::Weight, row.weight)] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(MatrixError::Number { a: row.a, b: row.b, what, value });
        }
    }
    let state = match row.state.as_str() {
        "tested" => PairState::Tested,
        "skipped" => PairState::Skipped,
        other => return Err(MatrixError::Syntax(format!("state `{other}`; write tested or skipped"))),
    };
    if !agrees(entry, state, &row.reason, row.margin_m) {
        return Err(MatrixError::Contradiction {
            a: row.a,
            b: row.b,
            state,
            reason: row.reason.to_string(),
            model: entry.reason.to_string(),
        });
    }
    entry.state = state;
    entry.margin_m = row.margin_m;
    entry.weight = row.weight;
    entry.suggestion = row.suggestion;
    // If both have a proof, the model's proof is the current one.
    if !matches!((&entry.reason, &row.reason), (Reason::OutOfReach { .. }, Reason::OutOfReach { .. })) {
        entry.reason = row.reason;
    }
    Ok(())
}

/// True if the model allows the state and the reason of the text.
fn agrees(model: &PairEntry, state: PairState, reason: &Reason, margin_m: f64) -> bool {
    let tested = state == PairState::Tested;
    let free = matches!(model.reason, Reason::Default | Reason::OutOfReach { .. });
    match reason {
        Reason::ByHand(_) => true,
        Reason::Default => tested && free,
        Reason::NeverInSamples { .. } | Reason::AlwaysInContact { .. } | Reason::TouchesAtRest { .. } => {
            !tested && free
        }
        Reason::OutOfReach { .. } => {
            !tested && matches!(model.reason, Reason::OutOfReach { least_m } if least_m > margin_m)
        }
        Reason::Adjacent | Reason::NoJointBetween | Reason::Srdf(_) => !tested && *reason == model.reason,
        Reason::Attached(_) | Reason::MayTouch(_) => false,
    }
}

fn geometry(scene: &Scene, name: &str) -> Result<GeometryId, MatrixError> {
    if let Some(id) = scene.geometry(name).filter(|id| scene.has_shape(*id)) {
        return Ok(id);
    }
    let names = || scene.geometries().map(|id| scene.name(id));
    let tail = |n: &str| n.rsplit('/').next().unwrap_or(n).to_lowercase();
    let near: Vec<String> = names().filter(|n| tail(n) == tail(name)).take(3).collect();
    let (list, lead) =
        if near.is_empty() { (names().take(8).collect(), "the scene has") } else { (near, "did you mean") };
    Err(MatrixError::UnknownName { name: name.into(), hint: format!("{lead} {}", list.join(", ")) })
}
