//! A small scene for documentation, tests and first steps.

use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::example::arm;
use elbowroom_spatial::{Pose, Vec3};

use crate::{Object, Scene, SceneBuilder};

/// A scene of two [example arms](elbowroom_robot::example::arm), a part and a table.
///
/// `left` is at the origin and `right` 1.2 m along x; a `part` (object 0) lies on a `table` (object 1).
///
/// ```
/// let scene = elbowroom_scene::example::two_arms();
/// assert_eq!((scene.robots().len(), scene.objects().len()), (2, 2));
/// println!("{}", scene.allowed_collision_matrix().to_text(&scene));
/// ```
#[allow(clippy::missing_panics_doc)]
pub fn two_arms() -> Scene {
    let mut builder = SceneBuilder::default();
    for (name, x) in [("left", 0.0), ("right", 1.2)] {
        // The chain is constant, and a test builds it.
        if let Ok(arm) = arm() {
            builder.robot(name, arm, Pose::from_translation(Vec3::X * x));
        }
    }
    let cuboid = |name: &str, at: [f64; 3], half: [f64; 3]| Object {
        name: name.into(),
        shape: Shape::Cuboid(Cuboid { half_extents: half.into() }),
        in_world: Pose::from_translation(at.into()),
    };
    builder.object(cuboid("part", [0.6, 0.0, 0.351], [0.04, 0.04, 0.05]));
    builder.object(cuboid("table", [0.6, 0.0, 0.2], [0.15, 0.5, 0.1]));
    builder.build().expect("the example is a scene")
}
