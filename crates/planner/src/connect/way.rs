//! One robot in the exact scene, all else where it is: what is free, what looks free, what is proven.

use std::time::Instant;

use elbowroom_scene::{
    Checker, Contact, Distance, Move, Options, Scene, SceneError, SceneState, Selection, SweepOptions,
};

use super::fence::Fenced;

/// Between looks solids move no farther than about so much (rad or m) of the joint that moves them most would: what is
/// missed in between is found by the proof.
const STEP: f64 = 0.06;

/// The robot, and who watches it.
#[derive(Debug)]
pub(super) struct Way<'s> {
    scene: &'s Scene,
    robot: usize,
    checker: Checker<'s>,
    state: SceneState,
    pub sweep: SweepOptions,
    /// What else it stays out of.
    pub fenced: Option<Fenced<'s>>,
    /// Metres per rad or m of each value, see [`super::reach`].
    pub reach: Vec<f64>,
    /// The most of them.
    most: f64,
    /// Configurations that were looked at.
    pub states: u64,
    /// When it is enough.
    pub until: Instant,
    pub most_states: u64,
}

impl<'s> Way<'s> {
    pub fn new(scene: &'s Scene, robot: usize, reach: Vec<f64>) -> Self {
        let (checker, state) = (Checker::new(scene, Options::default()), SceneState::new(scene));
        let most = reach.iter().copied().fold(0.0, f64::max);
        let sweep = SweepOptions::default();
        let until = Instant::now();
        let (states, most_states) = (0, u64::MAX);
        Self { scene, robot, checker, state, sweep, fenced: None, reach, most, states, until, most_states }
    }

    /// True when the search has had what it was given.
    pub fn late(&self) -> bool {
        self.states >= self.most_states || Instant::now() >= self.until
    }

    /// Everything stands as in `state`; the robot could go to `goal`.
    pub fn stand(&mut self, state: &SceneState, goal: &[f64]) -> Result<(), SceneError> {
        self.state.clone_from(state);
        self.state.set_q(self.scene, self.robot, goal)?;
        self.states = 0;
        Ok(())
    }

    pub fn name(&self, member: elbowroom_scene::Member) -> String {
        self.scene.name(member)
    }

    /// False where the scene does not take the values: that is not free.
    fn put(&mut self, q: &[f64]) -> bool {
        self.state.set_q(self.scene, self.robot, q).is_ok()
    }

    /// Who is nearer than the clearance.
    pub fn contact(&mut self, q: &[f64]) -> Option<Contact> {
        self.put(q);
        self.nearer(self.sweep.clearance_m)
    }

    fn nearer(&mut self, metres: f64) -> Option<Contact> {
        self.checker.between(Selection::Robot(self.robot), Selection::All).within(&self.state, metres)
    }

    /// The nearest pair of the robot.
    pub fn distance(&mut self, q: &[f64]) -> Option<Distance> {
        self.put(q);
        self.checker.between(Selection::Robot(self.robot), Selection::All).distance(&self.state)
    }

    /// The metres between two members, less their margin.
    pub fn apart(&mut self, q: &[f64], contact: &Contact) -> f64 {
        self.put(q);
        let found = self.checker.between(contact.a.into(), contact.b.into()).distance(&self.state);
        found.map_or(0.0, |d| d.metres)
    }

    /// Free with what a proof needs.
    pub fn is_free(&mut self, q: &[f64]) -> bool {
        self.states += 1;
        let room = self.sweep.clearance_m + self.sweep.tolerance_m;
        // The fence first: it is soon told.
        self.fenced.as_mut().is_none_or(|f| f.is_free(q)) && self.put(q) && self.nearer(room).is_none()
    }

    /// How far solids are moved, about, as rad (or m) of the joint that moves them most.
    pub fn travel(&self, a: &[f64], b: &[f64]) -> f64 {
        let each = a.iter().zip(b).zip(&self.reach).map(|((x, y), r)| ((x - y) * r).powi(2));
        if self.most > 0.0 { each.sum::<f64>().sqrt() / self.most } else { 0.0 }
    }

    /// What each joint must turn (or slide) to move solids as far as `travel` of the one that moves them most.
    pub fn alike(&self, travel: f64) -> impl Iterator<Item = f64> + '_ {
        self.reach.iter().map(move |r| if *r > 0.0 { travel * self.most / r } else { 0.0 })
    }

    /// Looks at `b`, then between, coarsely first. True is no proof.
    pub fn looks_free(&mut self, a: &[f64], b: &[f64]) -> bool {
        if !self.is_free(b) {
            return false;
        }
        let steps = (self.travel(a, b) / STEP).ceil() as usize;
        let mut stride = steps.max(1).next_power_of_two();
        let mut q = vec![0.0; a.len()];
        while stride > 1 {
            let half = stride / 2;
            for i in (half..steps).step_by(stride) {
                lerp(a, b, i as f64 / steps as f64, &mut q);
                if !self.is_free(&q) {
                    return false;
                }
            }
            stride = half;
        }
        true
    }

    /// Straight from `a` to `b` in joint space, proven free all along.
    pub fn proven(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.fenced.as_mut().is_none_or(|f| f.proven(a, b)) && self.swept(a, b)
    }

    /// The same where `a` may be nearer to the fence than ways may, if nothing comes nearer.
    pub fn leaves(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.fenced.as_mut().is_none_or(|f| f.leaves(a, b)) && self.swept(a, b)
    }

    /// The scene's share of the proof.
    fn swept(&mut self, a: &[f64], b: &[f64]) -> bool {
        if !self.put(a) {
            return false;
        }
        let moves = [Move::Robot { robot: self.robot, to: b }];
        let mut pairs = self.checker.between(Selection::Robot(self.robot), Selection::All);
        matches!(pairs.sweep(&self.state, &moves, &self.sweep), Ok(None))
    }

    /// Looks first, as that is cheaper, and proves.
    pub fn free(&mut self, a: &[f64], b: &[f64]) -> bool {
        self.looks_free(a, b) && self.proven(a, b)
    }
}

pub(super) fn lerp(a: &[f64], b: &[f64], share: f64, out: &mut [f64]) {
    for ((o, x), y) in out.iter_mut().zip(a).zip(b) {
        *o = x + (y - x) * share;
    }
}

/// Length of the straight way, rad (and m).
pub(super) fn length(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}
