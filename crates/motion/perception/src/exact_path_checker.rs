//! Exact collision check of a path: the robot's colliders against the observed prisms.

use std::sync::Arc;

use elbowroom_planner::{CheckError, MappedJoints, Path};
use elbowroom_proximity::Shape;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneError, SceneState, SweepOptions};
use elbowroom_spatial::Pose;

use crate::executor_state::HoldReason;
use crate::mapped_arm::MappedArm;
use crate::obstacle_update::Prism;

/// Checks paths continuously against the observed prisms and the fixed objects of the cell.
#[derive(Debug, Clone)]
pub struct ExactPathChecker {
    arm: Arc<MappedArm>,
    fixtures: Vec<Object>,
    /// Scene with the arm only.
    alone: Scene,
}

impl ExactPathChecker {
    /// Creates a checker for an arm among fixed objects.
    ///
    /// # Errors
    /// Colliders that the scene rejects.
    pub fn new(arm: Arc<MappedArm>, fixtures: Vec<Object>) -> Result<Self, SceneError> {
        let mut builder = Scene::builder();
        builder.robot("arm", arm.robot.clone(), arm.base_in_world);
        let alone = builder.build()?;
        alone.with_objects(fixtures.clone())?;
        Ok(Self { arm, fixtures, alone })
    }

    /// Checks the straight joint-space segments between points (map joint values, radians), the joints that the
    /// map does not have as in `held`, against the observed footprints of the prisms, without their predicted motion.
    ///
    /// # Errors
    /// A separation distance below `clearance_m`, or one that could not be proven to be above it.
    pub fn check(
        &self,
        prisms: &[Prism],
        held: &[f64],
        points: &[[f64; 3]],
        clearance_m: f64,
    ) -> Result<(), HoldReason> {
        let failed = |what: String| HoldReason::CheckFailed(what);
        let mut objects = self.fixtures.clone();
        for prism in prisms {
            let solid = prism.observed_solid().map_err(|e| failed(e.to_string()))?;
            let shape = Shape::Hull(Arc::new(solid));
            objects.push(Object { name: prism.id.to_string(), shape, in_world: Pose::IDENTITY });
        }
        let scene = self.alone.with_objects(objects).map_err(|e| failed(e.to_string()))?;
        let mut state = SceneState::new(&scene);
        state.set_q(&scene, RobotId(0), held).map_err(|e| failed(e.to_string()))?;
        let points: Vec<[f64; 3]> = points.iter().map(|q| self.arm.convention.from_planar(*q)).collect();
        let joints = MappedJoints { robot: RobotId(0), joints: self.arm.joints };
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let options = SweepOptions { clearance_m, ..SweepOptions::default() };
        let found = Path::check_polyline(&points, &mut checker, &state, joints, &options);
        found.map_err(|e: CheckError| failed(e.to_string()))
    }
}
