//! The exact scene: the robot's own solids against the prisms that were seen.

use std::sync::Arc;

use elbowroom_planner::{CheckError, MappedJoints, Path};
use elbowroom_proximity::Shape;
use elbowroom_scene::{Checker, Object, Options, Scene, SceneError, SceneState, SweepOptions};
use elbowroom_spatial::Pose;

use super::known::hull;
use super::{Prism, Reason, WatchedArm};

/// Proves that a way is free of the prisms and of what stands in the cell for good, continuously.
#[derive(Debug, Clone)]
pub struct Exact {
    arm: Arc<WatchedArm>,
    fixtures: Vec<Object>,
    /// The arm alone.
    alone: Scene,
}

impl Exact {
    /// For an arm among solid things that do not move.
    ///
    /// # Errors
    /// Solids of the arm that cannot be.
    pub fn new(arm: Arc<WatchedArm>, fixtures: Vec<Object>) -> Result<Self, SceneError> {
        let mut builder = Scene::builder();
        builder.robot("arm", arm.robot.clone(), arm.base_in_world);
        let alone = builder.build()?;
        alone.with_objects(fixtures.clone())?;
        Ok(Self { arm, fixtures, alone })
    }

    /// Checks the straight ways between points (planar joint values, radians), the other joints as in `held`, against the
    /// prisms as they were seen, without where they are going.
    ///
    /// # Errors
    /// Something is nearer than `clearance_m`, or that it is not could not be proven.
    pub fn check(&self, prisms: &[Prism], held: &[f64], points: &[[f64; 3]], clearance_m: f64) -> Result<(), Reason> {
        let not = |what: String| Reason::NotProven(what);
        let mut objects = self.fixtures.clone();
        for prism in prisms {
            let solid = hull(&prism.footprint_m, [prism.z_from_m, prism.z_to_m]).map_err(|e| not(e.to_string()))?;
            let shape = Shape::Hull(Arc::new(solid));
            objects.push(Object { name: prism.id.to_string(), shape, in_world: Pose::IDENTITY });
        }
        let scene = self.alone.with_objects(objects).map_err(|e| not(e.to_string()))?;
        let mut state = SceneState::new(&scene);
        state.set_q(&scene, 0, held).map_err(|e| not(e.to_string()))?;
        let points: Vec<[f64; 3]> = points.iter().map(|q| self.arm.signs.from_planar(*q)).collect();
        let joints = MappedJoints { robot: 0, joints: self.arm.joints };
        let mut checker = Checker::new(&scene, Options::default());
        let options = SweepOptions { clearance_m, ..SweepOptions::default() };
        let found = Path::check_through(&points, &mut checker, &state, joints, &options);
        found.map_err(|e: CheckError| not(e.to_string()))
    }
}
