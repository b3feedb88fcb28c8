//! The pairs of one query, prepared for the broad phase.

use std::collections::HashMap;

use elbowroom_robot::{GeometryId, ObjectId};

use crate::allowed_collision_matrix::OBJECTS_WEIGHT;
use crate::narrow_phase::PairWarmStart;
use crate::world_box::round_up;
use crate::{PairState, Reason, Scene, SceneState, Selection, pair_weight};

/// A pair with its learned weight and warm start.
#[derive(Debug, Clone)]
pub(crate) struct GeometryPair {
    /// Indices of models.
    pub a: u32,
    pub b: u32,
    /// Security margin, metres.
    pub margin: f64,
    /// Proven least distance, metres; 0 without a proof. Infinite if the user has excluded the pair.
    pub proven_least_m: f64,
    /// Position in the order of the hierarchy.
    pub rank: u32,
    /// Learned likelihood that the pair collides: collision and tolerance queries test high weights first.
    pub weight: f64,
    pub warm_start: PairWarmStart,
}

impl GeometryPair {
    /// A pair without a proof; `None` if one of the geometries has no shape.
    pub fn of(scene: &Scene, a: GeometryId, b: GeometryId, margin: f64) -> Option<Self> {
        let (a, b) = (scene.model_of(a)? as u32, scene.model_of(b)? as u32);
        Some(Self { a, b, margin, proven_least_m: 0.0, rank: 0, weight: 1.0, warm_start: PairWarmStart::default() })
    }
}

/// Data of a pair for the broad phase, packed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PackedPair {
    pub a: u32,
    pub b: u32,
    /// Margin, metres, rounded up.
    pub margin: f32,
    /// True if the least distance has a proof.
    pub proven: bool,
}

/// Pairs between the same two carriers: robots, or unattached objects.
#[derive(Debug, Clone)]
pub(crate) struct CarrierBlock {
    /// Indices of boxes of a state: the box of a robot, or of an unattached object.
    pub a: usize,
    pub b: usize,
    pub start: usize,
    pub end: usize,
    /// Largest margin, metres.
    pub margin: f64,
}

#[derive(Debug, Clone)]
pub(crate) struct PairList {
    pub key: (Selection, Selection),
    /// The arrangement of attached objects for which the list was built.
    pub arrangement: Option<u64>,
    pub pairs: Vec<GeometryPair>,
    /// One element per pair.
    pub packed: Vec<PackedPair>,
    pub blocks: Vec<CarrierBlock>,
    /// The nearest pair of the last query.
    pub nearest: Option<usize>,
}

impl PairList {
    pub fn new(key: (Selection, Selection)) -> Self {
        Self { key, arrangement: None, pairs: Vec::new(), packed: Vec::new(), blocks: Vec::new(), nearest: None }
    }

    /// Rebuilds the list for the attachments of a state, and keeps the learned data of pairs that remain.
    pub fn rebuild(&mut self, scene: &Scene, state: &SceneState) {
        let known: HashMap<(u32, u32), GeometryPair> = self.pairs.drain(..).map(|p| ((p.a, p.b), p)).collect();
        self.nearest = None;
        self.arrangement = Some(state.arrangement);
        self.add_matrix_pairs(scene, state);
        self.add_object_pairs(scene, state);
        self.rank(scene, state);
        for p in &mut self.pairs {
            if let Some(old) = known.get(&(p.a, p.b)) {
                (p.weight, p.warm_start) = (old.weight, old.warm_start);
            }
        }
        self.make_blocks(scene, state);
    }

    pub fn selects(&self, state: &SceneState, a: GeometryId, b: GeometryId) -> bool {
        let (one, other) = self.key;
        let contains = |s: Selection, id: GeometryId| {
            let carrier = if let GeometryId::Object(_) = id { state.carrier(id).map(|c| c.0) } else { None };
            s.contains(id, carrier)
        };
        (contains(one, a) && contains(other, b)) || (contains(one, b) && contains(other, a))
    }

    /// Updates the weights after a pair was reported in contact.
    pub fn learn(&mut self, contact: usize) {
        let before = self.pairs[contact].weight;
        self.pairs.iter_mut().for_each(|p| p.weight = pair_weight::lowered(p.weight));
        self.pairs[contact].weight = pair_weight::raised(before);
    }

    fn add_matrix_pairs(&mut self, scene: &Scene, state: &SceneState) {
        for e in scene.matrix.entries() {
            if !self.selects(state, e.a, e.b) {
                continue;
            }
            let proven_least_m = match state.pair(scene, e.a, e.b) {
                Some((PairState::Tested, _)) => 0.0,
                Some((_, Reason::OutOfReach { least_m })) => least_m,
                Some((_, Reason::NeverInSamples { .. })) => f64::INFINITY,
                _ => continue,
            };
            self.push(scene, e.a, e.b, e.margin_m, proven_least_m, e.weight);
        }
    }

    /// Adds pairs of two objects: those with an attached object, or all if the query names objects only.
    fn add_object_pairs(&mut self, scene: &Scene, state: &SceneState) {
        let named = self.key.0.is_objects() && self.key.1.is_objects();
        let attached = |o: usize| state.attached[o].is_some();
        let objects = scene.objects.len();
        for i in (0..objects).filter(|i| named || attached(*i)) {
            // A pair of two attached objects is added once.
            for j in (0..objects).filter(|j| *j != i && (*j > i || !(named || attached(*j)))) {
                let [a, b] = [i.min(j), i.max(j)].map(|o| GeometryId::Object(ObjectId(o)));
                let tested = match state.pair(scene, a, b) {
                    Some((state, _)) => state == PairState::Tested,
                    None => named,
                };
                if tested && self.selects(state, a, b) {
                    let entry = scene.matrix.get(a, b);
                    let margin_m = entry.map_or_else(|| scene.padding_m(a) + scene.padding_m(b), |e| e.margin_m);
                    self.push(scene, a, b, margin_m, 0.0, entry.map_or(OBJECTS_WEIGHT, |e| e.weight));
                }
            }
        }
    }

    fn push(&mut self, scene: &Scene, a: GeometryId, b: GeometryId, margin: f64, proven_least_m: f64, weight: f64) {
        self.pairs.extend(GeometryPair::of(scene, a, b, margin).map(|p| GeometryPair { proven_least_m, weight, ..p }));
    }

    /// Orders the pairs by the hierarchy: nearest to a base first; ties are in the order of the matrix.
    fn rank(&mut self, scene: &Scene, state: &SceneState) {
        let depth = |model: u32| {
            let carrier = state.carrier(scene.models[model as usize].id);
            carrier.map(|(robot, link)| pair_weight::link_depth(&scene.robots, robot, link))
        };
        self.pairs.sort_by_cached_key(|p| {
            let (a, b) = (depth(p.a), depth(p.b));
            let first = a.into_iter().chain(b).min().unwrap_or(usize::MAX);
            (first, a.unwrap_or(0).max(b.unwrap_or(0)))
        });
        for (rank, p) in self.pairs.iter_mut().enumerate() {
            p.rank = rank as u32;
        }
    }

    fn make_blocks(&mut self, scene: &Scene, state: &SceneState) {
        let carrier_box = |model: u32| match state.carrier(scene.models[model as usize].id) {
            Some((robot, _)) => scene.models.len() + robot.0,
            None => model as usize,
        };
        let carriers = |p: &GeometryPair| {
            let [a, b] = [p.a, p.b].map(carrier_box);
            (a.min(b), a.max(b))
        };
        self.pairs.sort_by_key(|p| (carriers(p), p.rank));
        let packed = |p: &GeometryPair| PackedPair {
            a: p.a,
            b: p.b,
            margin: round_up(p.margin),
            proven: p.proven_least_m > 0.0,
        };
        self.packed = self.pairs.iter().map(packed).collect();
        self.blocks.clear();
        for (i, p) in self.pairs.iter().enumerate() {
            let (a, b) = carriers(p);
            match self.blocks.last_mut() {
                Some(last) if (last.a, last.b) == (a, b) => {
                    last.end = i + 1;
                    last.margin = last.margin.max(p.margin);
                }
                _ => self.blocks.push(CarrierBlock { a, b, start: i, end: i + 1, margin: p.margin }),
            }
        }
    }
}
