//! Changes of the allowed collision matrix between selections, such as a part with everything, or a robot with an object.

use elbowroom_robot::{Exclusion, GeometryId, Robot, RobotId};

use crate::allowed_collision_matrix::Reason;
use crate::{MatrixError, PairEdit, Scene, Selection};

/// A change of all pairs between two selections.
#[derive(Debug, Clone, PartialEq)]
pub struct PairRule {
    /// First side. A robot means its links, without the objects attached to them.
    pub a: Selection,
    /// Second side.
    pub b: Selection,
    /// The change of each pair.
    pub edit: PairEdit,
}

/// Changes of the allowed collision matrix between selections.
///
/// The changes apply in order: a later one overrides an earlier one. Two objects also form a pair here; its rules apply
/// while one of them is attached to a robot.
///
/// ```
/// use elbowroom_robot::{GeometryId, ObjectId};
/// use elbowroom_scene::{PairEdit, PairRule, PairRules, Selection};
/// let [part, table] = [0, 1].map(ObjectId);
/// let edit = PairEdit::Skip("it is gripped".into());
/// let rules = PairRules::from_iter([PairRule { a: Selection::Object(part), b: Selection::All, edit }]);
/// assert_eq!(rules.skipped(GeometryId::Object(table), GeometryId::Object(part)), Some("it is gripped"));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PairRules(Vec<PairRule>);

impl FromIterator<PairRule> for PairRules {
    fn from_iter<T: IntoIterator<Item = PairRule>>(rules: T) -> Self {
        Self(rules.into_iter().collect())
    }
}

impl Extend<PairRule> for PairRules {
    fn extend<T: IntoIterator<Item = PairRule>>(&mut self, rules: T) {
        self.0.extend(rules);
    }
}

impl IntoIterator for PairRules {
    type Item = PairRule;
    type IntoIter = std::vec::IntoIter<PairRule>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl PairRule {
    fn applies(&self, a: GeometryId, b: GeometryId) -> bool {
        let between = |x, y| self.a.contains(x, None) && self.b.contains(y, None);
        between(a, b) || between(b, a)
    }
}

impl PairRules {
    /// True if the list is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The reason why the pair is skipped; `None` if the last rule for it tests it, or if no rule names it.
    pub fn skipped(&self, a: GeometryId, b: GeometryId) -> Option<&str> {
        match self.last_state(a, b) {
            Some(PairEdit::Skip(reason)) => Some(reason),
            _ => None,
        }
    }

    /// True if a rule skips or tests the pair.
    pub fn decide(&self, a: GeometryId, b: GeometryId) -> bool {
        self.last_state(a, b).is_some()
    }

    /// The last rule for the pair that skips or tests it.
    fn last_state(&self, a: GeometryId, b: GeometryId) -> Option<&PairEdit> {
        self.last(a, b, |edit| matches!(edit, PairEdit::Skip(_) | PairEdit::Test(_)))
    }

    fn last(&self, a: GeometryId, b: GeometryId, is_kind: impl Fn(&PairEdit) -> bool) -> Option<&PairEdit> {
        self.0.iter().rev().find(|rule| is_kind(&rule.edit) && rule.applies(a, b)).map(|rule| &rule.edit)
    }

    /// Applies the rules within one robot to its disabled pairs, for checks of the robot without a scene.
    ///
    /// Disables the pairs of links that the rules skip, and enables the pairs that the SRDF disables and a rule tests.
    /// Adjacent links stay untested.
    pub fn edit_robot(&self, id: RobotId, robot: &mut Robot) {
        if self.is_empty() {
            return;
        }
        let links: Vec<_> = robot.links_with_colliders().collect();
        for (i, &a) in links.iter().enumerate() {
            for &b in &links[i + 1..] {
                let geometry = |link| GeometryId::Link { robot: id, link };
                let same = |p: &(_, _, String)| (p.0, p.1) == (a, b) || (p.0, p.1) == (b, a);
                match self.last_state(geometry(a), geometry(b)) {
                    Some(PairEdit::Skip(reason)) if robot.links_can_meet(a, b) => {
                        robot.disabled_pairs.push((a, b, reason.clone()));
                    }
                    Some(PairEdit::Test(_)) if matches!(robot.exclusion(a, b), Some(Exclusion::Srdf(_))) => {
                        robot.disabled_pairs.retain(|p| !same(p));
                    }
                    _ => {}
                }
            }
        }
    }

    /// Edits the matrix of a scene.
    ///
    /// Adjacent links stay untested, and pairs that are out of reach keep their proof if a rule tests them.
    pub(crate) fn edit_scene(&self, scene: &mut Scene) -> Result<(), MatrixError> {
        if self.is_empty() {
            return Ok(());
        }
        let mut matrix = scene.matrix.clone();
        let ids: Vec<GeometryId> = scene.geometries().collect();
        for (i, &a) in ids.iter().enumerate() {
            for &b in &ids[i + 1..] {
                let objects = matches!((a, b), (GeometryId::Object(_), GeometryId::Object(_)));
                let known = matrix.get(a, b).map(|e| e.reason.clone());
                let edit = self.last_state(a, b).filter(|edit| match (edit, &known) {
                    (PairEdit::Skip(_), Some(reason)) => *reason != Reason::Adjacent,
                    (PairEdit::Test(_), Some(reason)) => matches!(reason, Reason::Srdf(_)),
                    (_, Some(_)) => false,
                    (_, None) => objects,
                });
                let has_entry = objects || matrix.get(a, b).is_some();
                let numbers = [
                    self.last(a, b, |edit| matches!(edit, PairEdit::Margin(_))),
                    self.last(a, b, |edit| matches!(edit, PairEdit::Weight(_))),
                ];
                for edit in edit.into_iter().chain(numbers.into_iter().flatten().filter(|_| has_entry)) {
                    matrix.edit(scene, a, b, edit.clone())?;
                }
            }
        }
        scene.matrix = matrix;
        Ok(())
    }
}
