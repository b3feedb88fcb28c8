//! Ground truth: the robot's own solids against the true obstacles, at every instant.

use elbowroom::proximity::ccd::ConstantTwist;
use elbowroom::robot::{ObjectId, RobotId};
use elbowroom::scene::{Checker, CheckerOptions, Scene, SceneError, SceneState, Selection, SweepMove, SweepOptions};
use elbowroom::spatial::Pose;

/// Evaluates the ground truth, which the pipeline does not see.
pub struct GroundTruthChecker<'s> {
    scene: &'s Scene,
    state: SceneState,
    checker: Checker<'s>,
    /// Collisions: time and names.
    pub hits: Vec<(f64, String)>,
    /// Smallest distance so far, metres, and its time.
    pub least: (f64, f64),
}

impl<'s> GroundTruthChecker<'s> {
    pub fn new(scene: &'s Scene, q: &[f64]) -> Result<Self, SceneError> {
        let mut state = SceneState::new(scene);
        state.set_q(scene, RobotId(0), q)?;
        let checker = Checker::new(scene, CheckerOptions::default());
        Ok(Self { scene, state, checker, hits: Vec::new(), least: (f64::INFINITY, 0.0) })
    }

    /// Moves the arm to `q` and the obstacles between two poses: checks the motion continuously and records a
    /// collision. Returns the distance at its end, metres.
    pub fn advance(&mut self, t: f64, q: &[f64], poses: &[[Pose; 2]]) -> Result<f64, SceneError> {
        let twists: Vec<ConstantTwist> =
            poses.iter().map(|[a, b]| ConstantTwist::linear(*a, b.translation - a.translation)).collect();
        let mut moves = vec![SweepMove::Robot { robot: RobotId(0), to: q }];
        moves.extend(
            twists.iter().enumerate().map(|(object, path)| SweepMove::Object { object: ObjectId(object), path }),
        );
        if let Some(hit) = self.checker.sweep(&self.state, &moves, &SweepOptions::default())? {
            self.hits.push((t, format!("{} and {}", self.scene.name(hit.a), self.scene.name(hit.b))));
        }
        self.state.set_q(self.scene, RobotId(0), q)?;
        for (object, [_, end]) in poses.iter().enumerate() {
            self.state.place(self.scene, ObjectId(object), *end)?;
        }
        let near = self.checker.between(Selection::Robot(RobotId(0)), Selection::Objects).distance(&self.state);
        let metres = near.map_or(f64::INFINITY, |d| d.metres);
        if metres < self.least.0 {
            self.least = (metres, t);
        }
        Ok(metres)
    }
}
