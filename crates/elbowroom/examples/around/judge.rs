//! The truth: the robot's own solids against the things where they really are, at every instant.

use elbowroom::proximity::impact::Steady;
use elbowroom::scene::{Checker, Move, Options, Scene, SceneError, SceneState, Selection, SweepOptions};
use elbowroom::spatial::Pose;

/// Watches what nobody in the cell can see.
pub struct Judge<'s> {
    scene: &'s Scene,
    state: SceneState,
    checker: Checker<'s>,
    /// When something was hit, and what.
    pub hits: Vec<(f64, String)>,
    /// The least distance so far, metres, and when.
    pub least: (f64, f64),
}

impl<'s> Judge<'s> {
    pub fn new(scene: &'s Scene, q: &[f64]) -> Result<Self, SceneError> {
        let mut state = SceneState::new(scene);
        state.set_q(scene, 0, q)?;
        let checker = Checker::new(scene, Options::default());
        Ok(Self { scene, state, checker, hits: Vec::new(), least: (f64::INFINITY, 0.0) })
    }

    /// The arm goes to `q` while the things go from one pose to another: proves that nothing is hit on the way, or notes it.
    /// The distance at its end, metres.
    pub fn go(&mut self, t: f64, q: &[f64], things: &[[Pose; 2]]) -> Result<f64, SceneError> {
        let ways: Vec<Steady> = things.iter().map(|[a, b]| Steady::linear(*a, b.translation - a.translation)).collect();
        let mut moves = vec![Move::Robot { robot: 0, to: q }];
        moves.extend(ways.iter().enumerate().map(|(object, path)| Move::Object { object, path }));
        if let Some(hit) = self.checker.sweep(&self.state, &moves, &SweepOptions::default())? {
            self.hits.push((t, format!("{} and {}", self.scene.name(hit.a), self.scene.name(hit.b))));
        }
        self.state.set_q(self.scene, 0, q)?;
        for (object, [_, end]) in things.iter().enumerate() {
            self.state.place(self.scene, object, *end)?;
        }
        let near = self.checker.between(Selection::Robot(0), Selection::Objects).distance(&self.state);
        let metres = near.map_or(f64::INFINITY, |d| d.metres);
        if metres < self.least.0 {
            self.least = (metres, t);
        }
        Ok(metres)
    }
}
