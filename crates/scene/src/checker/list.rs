//! The pairs of one selection, ready to be gone through.

use std::collections::HashMap;

use elbowroom_proximity::mesh::Hint;

use crate::world_box::round_up;
use crate::{Member, PairState, Reason, Scene, SceneState, Selection, weight};

/// A pair, and what was learned of it.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    /// Indices of models.
    pub a: u32,
    pub b: u32,
    /// Metres.
    pub margin: f64,
    /// Proven distance, metres; 0 where nothing is. Infinite where the user has ruled the pair out.
    pub least: f64,
    /// Place in the order of the hierarchy.
    pub rank: u32,
    pub weight: f64,
    /// Which solids were nearest, and where.
    pub hint: (u32, u32, Hint),
}

impl Pair {
    /// Two members of which nothing is known; `None` where one has no solid.
    pub fn of(scene: &Scene, (a, b): (Member, Member), margin: f64) -> Option<Self> {
        let (a, b) = (scene.model_of(a)? as u32, scene.model_of(b)? as u32);
        Some(Self { a, b, margin, least: 0.0, rank: 0, weight: 1.0, hint: (0, 0, Hint::default()) })
    }
}

/// What a test of boxes takes of a pair, packed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sides {
    pub a: u32,
    pub b: u32,
    /// Metres, rounded up.
    pub margin: f32,
    /// The matrix may know something.
    pub proven: bool,
}

/// Pairs between the same two carriers.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Indices of boxes of a state: of a robot, or of an object by itself.
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
    /// For which arrangement of attached objects it was made.
    pub arrangement: Option<u64>,
    pub pairs: Vec<Pair>,
    /// One per pair.
    pub sides: Vec<Sides>,
    pub blocks: Vec<Block>,
    /// The pair that was nearest last time.
    pub nearest: Option<usize>,
}

impl PairList {
    pub fn new(key: (Selection, Selection)) -> Self {
        Self { key, arrangement: None, pairs: Vec::new(), sides: Vec::new(), blocks: Vec::new(), nearest: None }
    }

    /// Makes the list anew; what was learned of pairs that stay is kept.
    pub fn arrange(&mut self, scene: &Scene, state: &SceneState) {
        let known: HashMap<(u32, u32), Pair> = self.pairs.drain(..).map(|p| ((p.a, p.b), p)).collect();
        self.nearest = None;
        self.arrangement = Some(state.arrangement);
        self.of_matrix(scene, state);
        self.of_objects(scene, state);
        self.rank(scene, state);
        for p in &mut self.pairs {
            if let Some(old) = known.get(&(p.a, p.b)) {
                (p.weight, p.hint) = (old.weight, old.hint);
            }
        }
        self.block(scene, state);
    }

    pub fn selects(&self, state: &SceneState, a: Member, b: Member) -> bool {
        let (one, other) = self.key;
        let holds = |s: Selection, m: Member| {
            let carrier = if let Member::Object(_) = m { state.carrier(m).map(|c| c.0) } else { None };
            s.holds(m, carrier)
        };
        (holds(one, a) && holds(other, b)) || (holds(one, b) && holds(other, a))
    }

    /// A pair was told to be in contact.
    pub fn learn(&mut self, contact: usize) {
        let told = self.pairs[contact].weight;
        self.pairs.iter_mut().for_each(|p| p.weight = weight::lowered(p.weight));
        self.pairs[contact].weight = weight::raised(told);
    }

    fn of_matrix(&mut self, scene: &Scene, state: &SceneState) {
        for e in scene.pairs.entries() {
            if !self.selects(state, e.a, e.b) {
                continue;
            }
            let least = match state.pair(scene, e.a, e.b) {
                Some((PairState::Tested, _)) => 0.0,
                Some((_, Reason::OutOfReach { least_m })) => least_m,
                Some((_, Reason::NeverInSamples { .. })) => f64::INFINITY,
                _ => continue,
            };
            self.push(scene, (e.a, e.b), e.margin_m, least, e.weight);
        }
    }

    /// Two objects: where one is attached, or where nothing else is asked for.
    fn of_objects(&mut self, scene: &Scene, state: &SceneState) {
        let asked = self.key.0.is_objects() && self.key.1.is_objects();
        let held = |o: usize| state.attached[o].is_some();
        let objects = scene.objects.len();
        for i in (0..objects).filter(|i| asked || held(*i)) {
            // The pair of two that are held comes once.
            for j in (0..objects).filter(|j| *j != i && (*j > i || !(asked || held(*j)))) {
                let (a, b) = (Member::Object(i.min(j)), Member::Object(i.max(j)));
                let tested = match state.pair(scene, a, b) {
                    Some((state, _)) => state == PairState::Tested,
                    None => asked,
                };
                if tested && self.selects(state, a, b) {
                    let margin = [i, j].map(|o| scene.models[scene.first_object + o].padding_m).iter().sum();
                    self.push(scene, (a, b), margin, 0.0, 1.0);
                }
            }
        }
    }

    fn push(&mut self, scene: &Scene, (a, b): (Member, Member), margin: f64, least: f64, weight: f64) {
        self.pairs.extend(Pair::of(scene, (a, b), margin).map(|p| Pair { least, weight, ..p }));
    }

    /// Root-most pairs first; the matrix' order among equals.
    fn rank(&mut self, scene: &Scene, state: &SceneState) {
        let depth = |model: u32| {
            let carrier = state.carrier(scene.models[model as usize].member);
            carrier.map(|(robot, link)| weight::depth(&scene.robots, Member::Link { robot, link }))
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

    fn block(&mut self, scene: &Scene, state: &SceneState) {
        let whole = |model: u32| match state.carrier(scene.models[model as usize].member) {
            Some((robot, _)) => scene.models.len() + robot,
            None => model as usize,
        };
        let carriers = |p: &Pair| (whole(p.a).min(whole(p.b)), whole(p.a).max(whole(p.b)));
        self.pairs.sort_by_key(|p| (carriers(p), p.rank));
        let sides = |p: &Pair| Sides { a: p.a, b: p.b, margin: round_up(p.margin), proven: p.least > 0.0 };
        self.sides = self.pairs.iter().map(sides).collect();
        self.blocks.clear();
        for (i, p) in self.pairs.iter().enumerate() {
            let (a, b) = carriers(p);
            match self.blocks.last_mut() {
                Some(last) if (last.a, last.b) == (a, b) => {
                    last.end = i + 1;
                    last.margin = last.margin.max(p.margin);
                }
                _ => self.blocks.push(Block { a, b, start: i, end: i + 1, margin: p.margin }),
            }
        }
    }
}
