//! An example arm among obstacles, for documentation, tests and benchmarks.

use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, GridAxisError, PlanarArm, TooManyCells};
use elbowroom_kinematics::{Chain, ChainError, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Capsule, Shape, Sphere};
use elbowroom_robot::{Collider, Robot};
use elbowroom_scene::{Object, Scene, SceneError};
use elbowroom_spatial::{Pose, Vec3};

/// An arm with the dimensions of a KUKA KR125.
pub const ARM: PlanarArm = PlanarArm::KR125_SIZED;

/// Returns the grid of the arm's three joints with the given step in degrees.
///
/// # Errors
/// The step is invalid.
pub fn grid(step_degrees: f64) -> Result<Grid, ExampleError> {
    let axis = |name: &str, min, max| GridAxis::from_degrees(name, min, max, step_degrees);
    Ok(Grid::new([axis("base", -170.0, 170.0)?, axis("shoulder", -90.0, 90.0)?, axis("elbow", -120.0, 150.0)?])?)
}

/// Returns the arm as a robot for a scene, with the limits of a grid.
///
/// # Errors
/// Two joints of the grid share a name.
pub fn robot(grid: &Grid) -> Result<Robot, ChainError> {
    let origins = [Vec3::ZERO, Vec3::new(ARM.offset_m, 0.0, ARM.height_m), Vec3::new(0.0, 0.0, ARM.upper_length_m)];
    let axes = [Vec3::Z, Vec3::Y, Vec3::Y];
    let joint = |i: usize| Joint {
        name: grid.axes()[i].joint().to_owned(),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(origins[i]),
        axis: axes[i],
        limits: Limits::range(grid.axes()[i].min(), grid.axes()[i].max()),
        mimic: None,
    };
    let links = ["base", "column", "upper", "fore"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("arm", links, (0..3).map(joint).collect())?);
    let collider = |shape, in_link| Collider { name: String::new(), shape, in_link };
    let capsule = |length: f64, radius| Shape::Capsule(Capsule { half_length: 0.5 * length, radius });
    let along_x = Pose::from_xyz_rpy([0.5 * ARM.fore_length_m, 0.0, 0.0], [0.0, std::f64::consts::FRAC_PI_2, 0.0]);
    let along_z = Pose::from_translation(Vec3::Z * 0.5 * ARM.upper_length_m);
    let wrist = Pose::from_translation(Vec3::X * ARM.fore_length_m);
    robot.colliders[2].push(collider(capsule(ARM.upper_length_m, ARM.upper_radius_m), along_z));
    robot.colliders[3].push(collider(capsule(ARM.fore_length_m, ARM.fore_radius_m), along_x));
    robot.colliders[3].push(collider(Shape::Sphere(Sphere { radius: ARM.wrist_radius_m }), wrist));
    Ok(robot)
}

/// Returns the scene of the arm among obstacles.
///
/// ```
/// use elbowroom_planner::example;
/// let (name, obstacles) = example::cells().swap_remove(1);
/// let scene = example::scene(&example::grid(2.0)?, &obstacles)?;
/// assert_eq!((name, scene.objects().len()), ("floor, table, two posts", 4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Two joints of the grid share a name.
pub fn scene(grid: &Grid, obstacles: &[ConvexObstacle]) -> Result<Scene, ExampleError> {
    let mut builder = Scene::builder();
    builder.robot("arm", robot(grid)?, Pose::IDENTITY);
    for (n, obstacle) in obstacles.iter().enumerate() {
        let (shape, in_world) = obstacle.shape();
        builder.object(Object { name: format!("obstacle {n}"), shape, in_world });
    }
    Ok(builder.build()?)
}

/// Why an example cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExampleError {
    /// The step is invalid.
    #[error(transparent)]
    GridAxis(#[from] GridAxisError),
    /// The step is too small.
    #[error(transparent)]
    Cells(#[from] TooManyCells),
    /// The grid's joints do not form a chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// The obstacles do not form a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Returns three workspaces of the arm: nearly empty, usual, narrow.
pub fn cells() -> Vec<(&'static str, Vec<ConvexObstacle>)> {
    let floor = || cuboid([0.0, 0.0, -0.6], 0.0, [3.0, 3.0, 0.1]);
    let usual = [
        floor(),
        cuboid([1.5, 0.0, 0.2], 0.3, [0.4, 0.6, 0.05]),
        cuboid([1.2, -1.2, 1.0], 0.0, [0.08, 0.08, 1.5]),
        cuboid([-0.2, 1.6, 1.0], 0.0, [0.08, 0.08, 1.5]),
    ];
    let narrow = [
        floor(),
        cuboid([1.5, 0.5, 0.3], 0.4, [0.7, 0.04, 0.9]),
        cuboid([1.5, -0.7, 1.6], -0.5, [0.7, 0.04, 0.7]),
        cuboid([-0.9, 0.9, 0.8], 2.3, [0.5, 0.04, 1.4]),
        cuboid([0.0, 0.0, 2.9], 0.7, [3.0, 0.1, 0.1]),
        ball([1.7, -0.1, 1.3], 0.15),
        ball([-1.2, -1.0, 1.0], 0.4),
        ball([0.3, 1.7, 0.4], 0.2),
    ];
    let of = |all: &[Option<ConvexObstacle>]| all.iter().flatten().cloned().collect();
    vec![
        ("one ball", of(&[ball([1.3, 0.4, 0.9], 0.3)])),
        ("floor, table, two posts", of(&usual)),
        ("walls with gaps, a beam overhead, balls", of(&narrow)),
    ]
}

// The constants are valid obstacles; a test counts the obstacles.
fn ball(at: [f64; 3], radius: f64) -> Option<ConvexObstacle> {
    ConvexObstacle::sphere(at.into(), radius).ok()
}

fn cuboid(at: [f64; 3], yaw: f64, half: [f64; 3]) -> Option<ConvexObstacle> {
    ConvexObstacle::cuboid(Pose::from_xyz_rpy(at, [0.0, 0.0, yaw]), Vec3::from(half)).ok()
}

#[cfg(test)]
mod tests {
    #[test]
    fn all_obstacles_are_there() {
        assert_eq!(super::cells().iter().map(|cell| cell.1.len()).collect::<Vec<_>>(), [1, 4, 8]);
    }
}
