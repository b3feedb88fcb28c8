//! What a fixed sequence of states suggests about the pairs.

use elbowroom_kinematics::{Chain, ChainState};

use super::{PairEntry, PairMatrix, Reason};
use crate::checker::narrow::{Narrow, Placed};
use crate::{Level, Member, Scene, SceneState, pairs};

/// The rule of three: with N samples and no contact, P(contact) < 3 / N at this confidence.
const CONFIDENCE: f64 = 0.95;

impl PairMatrix {
    /// This matrix with what `samples` states of the whole joint space suggest about its pairs.
    ///
    /// The states are Roberts' R-sequence over the joint limits (±π where a joint has none, ±1 m where a slide has
    /// none): the same ones each time. Objects stand where the scene has them. Pairs never in contact get
    /// [`Reason::NeverInSamples`] as their suggestion, pairs always in contact [`Reason::AlwaysInContact`], others that are in
    /// contact at rest with no solid between them [`Reason::TouchesAtRest`]; nothing is skipped before [`PairMatrix::accept_suggestions`]. The confidence is that of independent draws; the sequence is
    /// more even than those.
    ///
    /// ```
    /// use elbowroom_scene::example;
    /// let scene = example::two_arms();
    /// let matrix = scene.pairs().sampled(&scene, 1000);
    /// assert!(matrix.entries().iter().any(|e| e.suggestion.is_some()));
    /// assert_eq!(matrix.tested(), scene.pairs().tested());
    /// ```
    #[must_use]
    pub fn sampled(&self, scene: &Scene, samples: u64) -> Self {
        let mut matrix = self.clone();
        let mut open: Vec<Open> =
            self.entries().iter().enumerate().filter_map(|(i, e)| Open::new(scene, i, e)).collect();
        let mut state = SceneState::new(scene);
        let mut narrow = Narrow::new(scene);
        let sequence = RSequence::new(scene.robots.iter().map(|r| r.robot.chain.dof()).sum());
        for n in 0..samples {
            put(scene, &mut state, &sequence, n);
            for pair in &mut open {
                let (a, b) = (Placed::new(scene, &state, pair.models[0]), Placed::new(scene, &state, pair.models[1]));
                let clear = narrow.cleared_coarsely(&a, &b, pair.margin_m).is_some()
                    || !narrow.touch(&a, &b, Level::L3, pair.margin_m);
                if clear { pair.clear = true } else { pair.hit = true }
            }
            // Seen both ways: neither never nor always.
            open.retain(|p| !(p.clear && p.hit));
        }
        for entry in matrix.entries_mut() {
            entry.suggestion = None;
        }
        for pair in open.iter().filter(|p| p.clear || p.hit) {
            let never = Reason::NeverInSamples { samples, confidence: CONFIDENCE };
            let suggestion = if pair.hit { Reason::AlwaysInContact { samples } } else { never };
            matrix.entries_mut()[pair.entry].suggestion = Some(suggestion);
        }
        matrix.suggest_at_rest(scene);
        matrix
    }
}

impl PairMatrix {
    /// Pairs that touch at rest and come apart elsewhere.
    fn suggest_at_rest(&mut self, scene: &Scene) {
        for (robot, r) in scene.robots.iter().enumerate() {
            let (lower, upper) = (r.robot.chain.lower(), r.robot.chain.upper());
            let rest: Vec<f64> =
                lower.iter().zip(&upper).map(|(lower, upper)| 0.0_f64.min(*upper).max(*lower)).collect();
            for found in pairs::resting_contacts(&r.robot, &rest) {
                let link = |link| Member::Link { robot, link };
                let Some(at) = self.position(link(found.a), link(found.b)) else { continue };
                let reason = Reason::TouchesAtRest { contacts: found.contacts, samples: found.samples };
                self.entries_mut()[at].suggestion.get_or_insert(reason);
            }
        }
    }
}

/// A pair that samples have not decided yet.
struct Open {
    entry: usize,
    models: [usize; 2],
    margin_m: f64,
    clear: bool,
    hit: bool,
}

impl Open {
    /// `None` for pairs of which there is nothing to learn.
    fn new(scene: &Scene, entry: usize, e: &PairEntry) -> Option<Self> {
        if matches!(e.reason, Reason::NoJointBetween | Reason::OutOfReach { .. }) {
            return None;
        }
        let models = [scene.model_of(e.a)?, scene.model_of(e.b)?];
        Some(Self { entry, models, margin_m: e.margin_m, clear: false, hit: false })
    }
}

fn put(scene: &Scene, state: &mut SceneState, sequence: &RSequence, n: u64) {
    let mut axis = 0;
    for (robot, r) in scene.robots.iter().enumerate() {
        sequence.put(&r.robot.chain, &mut state.chains[robot], n, axis);
        axis += r.robot.chain.dof();
        state.moved(scene, robot);
    }
}

/// Where samples are taken from, rad or m.
fn range(chain: &Chain, index: usize) -> (f64, f64) {
    let joint = &chain.joints()[chain.active_joints()[index].0];
    let most = if joint.kind.turns() { std::f64::consts::PI } else { 1.0 };
    let end = |v: f64, sign: f64| if v.is_finite() { v } else { sign * most };
    (end(joint.limits.lower, -1.0), end(joint.limits.upper, 1.0))
}

/// Evenly spread points of the unit cube in any dimension: multiples of powers of the generalized golden ratio
/// (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
pub(crate) struct RSequence {
    steps: Vec<f64>,
}

impl RSequence {
    pub(crate) fn new(dimensions: usize) -> Self {
        // The positive root of x^(d+1) = x + 1 by Newton's method, in plain arithmetic: equal on every machine.
        let mut phi = 2.0_f64;
        for _ in 0..64 {
            let power = (0..dimensions).fold(1.0, |p, _| p * phi);
            phi -= (power * phi - phi - 1.0) / ((dimensions as f64 + 1.0) * power - 1.0).max(f64::MIN_POSITIVE);
        }
        let mut step = 1.0;
        let mut next = || {
            step /= phi;
            step
        };
        Self { steps: (0..dimensions).map(|_| next()).collect() }
    }

    /// Moves a chain to point `n`, whose coordinates for it begin at `axis`.
    pub(crate) fn put(&self, chain: &Chain, state: &mut ChainState, n: u64, axis: usize) {
        for i in 0..chain.dof() {
            let (lower, upper) = range(chain, i);
            state.q[i] = lower + (upper - lower) * self.at(n, axis + i);
        }
        chain.forward(state);
    }

    /// Coordinate `axis` of point `n`, 0 ≤ x < 1.
    fn at(&self, n: u64, axis: usize) -> f64 {
        (0.5 + n as f64 * self.steps[axis]).fract()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_the_square_evenly() {
        let golden = RSequence::new(1).steps[0];
        assert!((golden - 0.618_033_988_749_895).abs() < 1e-14, "{golden}");
        let s = RSequence::new(2);
        let mut cells = [[0; 10]; 10];
        for n in 0..10_000 {
            cells[(s.at(n, 0) * 10.0) as usize][(s.at(n, 1) * 10.0) as usize] += 1;
        }
        assert!(cells.iter().flatten().all(|c| (90..=110).contains(c)), "{cells:?}");
    }
}
