//! Suggestions for pairs from a fixed sequence of sampled configurations.

use elbowroom_robot::{GeometryId, RSequence, RobotId, rest_pose_contacts};

use super::entry::PairEntry;
use super::matrix::AllowedCollisionMatrix;
use super::reason::Reason;
use crate::narrow_phase::{NarrowPhase, PlacedModel};
use crate::{Level, Scene, SceneState};

/// The rule of three: with N samples and no contact, P(contact) < 3 / N at this confidence.
const CONFIDENCE: f64 = 0.95;

impl AllowedCollisionMatrix {
    /// Returns this matrix with suggestions from `samples` configurations of the whole joint space.
    ///
    /// The configurations are Roberts' R-sequence over the joint limits ([`RSequence`]), equal on every call. Objects
    /// have their poses of the scene. The suggestion is [`Reason::NeverInSamples`] for pairs never in contact and
    /// [`Reason::AlwaysInContact`] for pairs always in contact. Other pairs that are in contact in the rest pose, without
    /// a collider between them, get [`Reason::TouchesAtRest`]. No pair is skipped before
    /// [`AllowedCollisionMatrix::accept_suggestions`]. The confidence assumes independent samples; the sequence is more
    /// even than independent samples.
    ///
    /// ```
    /// use elbowroom_scene::example;
    /// let scene = example::two_arms();
    /// let matrix = scene.allowed_collision_matrix().sampled(&scene, 1000);
    /// assert!(matrix.entries().iter().any(|e| e.suggestion.is_some()));
    /// assert_eq!(matrix.tested(), scene.allowed_collision_matrix().tested());
    /// ```
    #[must_use]
    pub fn sampled(&self, scene: &Scene, samples: u64) -> Self {
        let mut matrix = self.clone();
        let mut undecided: Vec<UndecidedPair> =
            self.entries().iter().enumerate().filter_map(|(i, e)| UndecidedPair::new(scene, i, e)).collect();
        let mut state = SceneState::new(scene);
        let mut narrow = NarrowPhase::new(scene);
        let sequence = RSequence::new(scene.robots.iter().map(|r| r.robot.chain.dof()).sum());
        for n in 0..samples {
            set_sample(scene, &mut state, &sequence, n);
            for pair in &mut undecided {
                let [a, b] = pair.models.map(|model| PlacedModel::new(scene, &state, model));
                let clear = narrow.separated_coarsely(&a, &b, pair.margin_m).is_some()
                    || !narrow.within(&a, &b, Level::L3, pair.margin_m);
                if clear { pair.clear = true } else { pair.contact = true }
            }
            // A pair seen both clear and in contact is neither "never" nor "always".
            undecided.retain(|p| !(p.clear && p.contact));
        }
        for entry in matrix.entries_mut() {
            entry.suggestion = None;
        }
        for pair in undecided.iter().filter(|p| p.clear || p.contact) {
            let never = Reason::NeverInSamples { samples, confidence: CONFIDENCE };
            let suggestion = if pair.contact { Reason::AlwaysInContact { samples } } else { never };
            matrix.entries_mut()[pair.entry].suggestion = Some(suggestion);
        }
        matrix.suggest_rest_pose_contacts(scene);
        matrix
    }

    /// Suggestions for pairs that touch in the rest pose and separate elsewhere.
    fn suggest_rest_pose_contacts(&mut self, scene: &Scene) {
        for (robot, r) in scene.robots.iter().enumerate() {
            let (lower, upper) = (r.robot.chain.lower(), r.robot.chain.upper());
            let rest: Vec<f64> =
                lower.iter().zip(&upper).map(|(lower, upper)| 0.0_f64.min(*upper).max(*lower)).collect();
            for found in rest_pose_contacts(&r.robot, &rest) {
                let link = |link| GeometryId::Link { robot: RobotId(robot), link };
                let Some(at) = self.position(link(found.a), link(found.b)) else { continue };
                let reason = Reason::TouchesAtRest { contacts: found.contacts, samples: found.samples };
                self.entries_mut()[at].suggestion.get_or_insert(reason);
            }
        }
    }
}

/// A pair that so far was either always clear or always in contact.
struct UndecidedPair {
    entry: usize,
    models: [usize; 2],
    margin_m: f64,
    clear: bool,
    contact: bool,
}

impl UndecidedPair {
    /// Returns `None` for pairs about which samples say nothing.
    fn new(scene: &Scene, entry: usize, e: &PairEntry) -> Option<Self> {
        if matches!(e.reason, Reason::NoJointBetween | Reason::OutOfReach { .. }) {
            return None;
        }
        let models = [scene.model_of(e.a)?, scene.model_of(e.b)?];
        Some(Self { entry, models, margin_m: e.margin_m, clear: false, contact: false })
    }
}

fn set_sample(scene: &Scene, state: &mut SceneState, sequence: &RSequence, n: u64) {
    let mut axis = 0;
    for (robot, r) in scene.robots.iter().enumerate() {
        sequence.set_state(&r.robot.chain, &mut state.chains[robot], n, axis);
        axis += r.robot.chain.dof();
        state.robot_moved(scene, RobotId(robot));
    }
}
