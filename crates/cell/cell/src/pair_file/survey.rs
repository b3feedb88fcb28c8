//! Survey of a model's pairs by sampling and geometry, as a file to decide on.

use std::path::Path;

use elbowroom_formats::Diagnostic;
use elbowroom_scene::{PairEntry, PairState, Reason};

use super::counts::PairCounts;
use super::{Note, PairFile, PairRow};
use crate::{OutOfReachProofs, QueryModel};

/// Number of sampled configurations, equal to the default of `MoveIt`'s Setup Assistant.
const SAMPLES: u64 = 10_000;

impl PairFile {
    /// Surveys the pairs of a model by 10,000 configurations of its joint space and by its geometry, for the file
    /// `path`.
    ///
    /// Rows that a person has written in the previous file stay, and take precedence.
    ///
    /// With `accept`, pairs that are in contact in all samples are skipped; otherwise they are tested, and their row
    /// states the finding. Pairs in contact in no sample are tested after all others (weight 0). Samples are no proof,
    /// so the answers stay the same.
    ///
    /// # Errors
    /// [`Diagnostic`] if a scene refuses the model, or a row of the previous file does not fit the model.
    pub fn survey(
        path: &Path,
        model: &QueryModel,
        before: Option<&Self>,
        accept: bool,
    ) -> Result<(Self, PairCounts), Diagnostic> {
        let mut model = model.clone();
        let by_hand = |row: &&PairRow| !matches!(row.note, Note::Found(_));
        let rows: Vec<PairRow> = before.iter().flat_map(|b| b.rows.iter().filter(by_hand).cloned()).collect();
        let mut survey = Self { file: path.to_owned(), rows, comments: Vec::new() };
        model.add_rules(survey.rules(&model)?);
        let scene = model.scene(OutOfReachProofs::Compute)?;
        let sampled = scene.allowed_collision_matrix().sampled(&scene, SAMPLES);
        let mut counts = PairCounts::default();
        for entry in sampled.entries() {
            if model.rules.decide(entry.a, entry.b) {
                counts.by_hand += 1;
            } else {
                survey.add(entry, &model, accept, &mut counts);
            }
        }
        Ok((survey, counts))
    }

    fn add(&mut self, entry: &PairEntry, model: &QueryModel, accept: bool, counts: &mut PairCounts) {
        let sides = [entry.a, entry.b].map(|id| model.geometry_name(id));
        let mut found = |state, weight, note: String| {
            let sides = sides.clone();
            self.rows.push(PairRow { line: 1, sides, state, weight, note: Note::Found(note) });
        };
        let tested = entry.state == PairState::Tested;
        match (&entry.reason, &entry.suggestion) {
            (Reason::Adjacent | Reason::Srdf(_), _) => {
                found(PairState::Skipped, None, entry.reason.to_string());
                counts.excluded += 1;
            }
            // These pairs get no rows: an object that is attached to a robot later meets the robot's base, and every
            // scene makes its own proofs.
            (reason @ Reason::NoJointBetween, _) => {
                self.comment(&sides, reason);
                counts.excluded += 1;
            }
            (reason @ Reason::OutOfReach { .. }, _) => {
                self.comment(&sides, reason);
                counts.out_of_reach += 1;
            }
            (_, Some(why @ Reason::AlwaysInContact { .. })) if tested => {
                let state = if accept { PairState::Skipped } else { PairState::Tested };
                found(state, None, why.to_string());
                counts.always += 1;
            }
            (_, Some(why @ Reason::NeverInSamples { .. })) if tested => {
                found(PairState::Tested, Some(0.0), why.to_string());
                counts.never += 1;
            }
            (_, Some(why)) if tested => {
                found(PairState::Tested, None, why.to_string());
                counts.at_rest += 1;
            }
            _ => counts.others += 1,
        }
    }

    fn comment(&mut self, [a, b]: &[String; 2], reason: &Reason) {
        self.comments.push(format!("{a} and {b}: {reason}").replace(char::is_control, " "));
    }
}
