//! Answers to a query, one state after another.

use elbowroom_scene::{
    Checker, CheckerOptions, CheckerStats, Detail, PairContact, PairDistance, Scene, SceneState, Selection,
};
use elbowroom_spatial::Vec3;

use super::{QueryKind, QueryPairs, QueryRow};

/// Answers a query about one state after another, as [`evaluate_query`](super::evaluate_query) does within a block.
///
/// It learns which pairs are likely to collide. The answers are the same, except which of several pairs in contact is
/// named; `evaluate_query` starts with a checker that has learned nothing after every [`BLOCK`](super::BLOCK) states.
///
/// ```
/// use elbowroom_query::{QueryChecker, QueryKind, QueryPairs};
/// use elbowroom_scene::{CheckerOptions, SceneState, example};
/// let scene = example::two_arms();
/// let mut checker = QueryChecker::new(&scene, CheckerOptions::default(), &QueryPairs::all());
/// let row = checker.row(&SceneState::new(&scene), QueryKind::Distance);
/// assert!(!row.collides && row.distance_m.unwrap() > 0.0);
/// ```
#[derive(Debug, Clone)]
pub struct QueryChecker<'s> {
    checker: Checker<'s>,
    sides: Vec<[Selection; 2]>,
}

impl<'s> QueryChecker<'s> {
    /// Creates a checker of a scene that has learned nothing.
    pub fn new(scene: &'s Scene, options: CheckerOptions, pairs: &QueryPairs) -> Self {
        Self { checker: Checker::new(scene, options), sides: pairs.sides().to_vec() }
    }

    /// The scene.
    pub fn scene(&self) -> &'s Scene {
        self.checker.scene()
    }

    /// Counters of the answers so far.
    pub fn stats(&self) -> CheckerStats {
        self.checker.stats()
    }

    /// Whether the scene has a pair to test between the two sides of any pair.
    pub fn has_pair(&mut self, state: &SceneState) -> bool {
        self.sides.iter().any(|&[a, b]| !self.checker.between(a, b).is_empty(state))
    }

    fn within(&mut self, state: &SceneState, metres: f64) -> Option<PairContact> {
        self.sides.iter().find_map(|&[a, b]| self.checker.between(a, b).within(state, metres))
    }

    fn nearest(&mut self, state: &SceneState) -> Option<PairDistance> {
        let each = self.sides.iter().filter_map(|&[a, b]| self.checker.between(a, b).distance(state));
        // A NaN distance counts as contact.
        let order = |d: &PairDistance| if d.metres.is_nan() { f64::NEG_INFINITY } else { d.metres };
        each.min_by(|a, b| order(a).total_cmp(&order(b)))
    }

    /// The row of one state; its index is 0. [`QueryKind::Contacts`], [`QueryKind::Time`] and [`QueryKind::Limits`] are
    /// answered like [`QueryKind::Point`].
    pub fn row(&mut self, state: &SceneState, kind: QueryKind) -> QueryRow {
        match kind {
            QueryKind::Collision => {
                let Some(contact) = self.within(state, 0.0) else { return self.nothing() };
                QueryRow {
                    collides: true,
                    distance_m: Some(0.0),
                    pair: Some((contact.a, contact.b)),
                    witness: self.witness_of_contact(state, contact),
                    point_in_a: None,
                    index: 0,
                    level: contact.level,
                }
            }
            QueryKind::Point | QueryKind::Contacts | QueryKind::Time | QueryKind::Limits => self.collision_point(state),
            QueryKind::Distance => self.distance(state).unwrap_or_else(|| self.nothing()),
            QueryKind::Tolerance(t) => {
                if self.within(state, t).is_none() {
                    return self.nothing();
                }
                let nothing = self.nothing();
                let row = self.distance(state).unwrap_or(nothing);
                QueryRow { collides: true, ..row }
            }
        }
    }

    /// The collision point of the first sides that have one: `a` is the link that collides.
    fn collision_point(&mut self, state: &SceneState) -> QueryRow {
        let mut of_sides = |&[a, b]: &[Selection; 2]| self.checker.between(a, b).collision_point(state, Detail::Exact);
        let Some(point) = self.sides.iter().find_map(&mut of_sides) else { return self.nothing() };
        QueryRow {
            collides: true,
            distance_m: Some(0.0),
            pair: Some((point.link, point.other)),
            witness: Some((point.on_link, point.on_other)),
            point_in_a: state
                .pose(self.checker.scene(), point.link)
                .map(|pose| pose.inverse_transform_point(point.on_link)),
            ..self.nothing()
        }
    }

    /// The row without a pair.
    fn nothing(&self) -> QueryRow {
        let level = self.checker.last_level();
        QueryRow { index: 0, collides: false, distance_m: None, pair: None, witness: None, point_in_a: None, level }
    }

    /// The row of a distance query; `None` without pairs.
    fn distance(&mut self, state: &SceneState) -> Option<QueryRow> {
        let d = self.nearest(state)?;
        let row = row_of(&d);
        if row.collides || d.lower_bound > 0.0 {
            return Some(row);
        }
        // Below the accuracy of the distance, the collision test decides, so that all kinds of queries agree.
        let Some(contact) = self.within(state, 0.0) else { return Some(row) };
        let pair = Some((contact.a, contact.b));
        let witness = if row.pair == pair { row.witness } else { self.witness_of_contact(state, contact) };
        Some(QueryRow { collides: true, distance_m: Some(0.0), pair, witness, ..row })
    }

    /// A row for each pair no farther apart than a distance (m), the nearest first.
    pub fn rows_within(&mut self, state: &SceneState, margin_m: f64) -> impl Iterator<Item = QueryRow> {
        let mut rows: Vec<QueryRow> = Vec::new();
        for &[a, b] in &self.sides {
            let push = |d: PairDistance| {
                // Sides may overlap.
                if !rows.iter().any(|row| row.pair == Some((d.a, d.b))) {
                    rows.push(row_of(&d));
                }
            };
            self.checker.between(a, b).distances_within(state, margin_m, push);
        }
        rows.sort_by(|a, b| a.distance_m.unwrap_or(0.0).total_cmp(&b.distance_m.unwrap_or(0.0)));
        rows.into_iter()
    }

    /// Witness points of two geometries in contact.
    fn witness_of_contact(&mut self, state: &SceneState, contact: PairContact) -> Option<(Vec3, Vec3)> {
        let found = self.checker.between(contact.a.into(), contact.b.into()).distance(state);
        found.map(|d| (d.on_a, d.on_b))
    }
}

/// The row of a distance; its index is 0.
fn row_of(d: &PairDistance) -> QueryRow {
    QueryRow {
        index: 0,
        // A NaN distance counts as contact.
        collides: !(d.metres > 0.0),
        distance_m: Some(d.metres.max(0.0)),
        pair: Some((d.a, d.b)),
        witness: Some((d.on_a, d.on_b)),
        point_in_a: None,
        level: d.level,
    }
}
