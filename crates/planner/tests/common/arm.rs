//! The arm of the joint map as a robot of a scene.

use elbowroom_cspace::{Axis, Grid, Obstacle, PlanarArm};
use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Capsule, Shape, Sphere};
use elbowroom_scene::{Body, Object, Robot, Scene};
use elbowroom_spatial::{Pose, Vec3};

pub const ARM: PlanarArm = PlanarArm::KR125_SIZED;

pub fn grid(step_degrees: f64) -> Grid {
    let axis = |name: &str, min, max| Axis::from_degrees(name, min, max, step_degrees).unwrap();
    Grid::new([axis("base", -170.0, 170.0), axis("shoulder", -90.0, 90.0), axis("elbow", -120.0, 150.0)]).unwrap()
}

fn robot(grid: &Grid) -> Robot {
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
    let links = ["foot", "column", "upper", "fore"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("arm", links, (0..3).map(joint).collect()).unwrap());
    let body = |shape, in_link| Body { name: String::new(), shape, in_link };
    let capsule = |length: f64, radius| Shape::Capsule(Capsule { half_length: 0.5 * length, radius });
    let along_x = Pose::from_xyz_rpy([0.5 * ARM.fore_length_m, 0.0, 0.0], [0.0, std::f64::consts::FRAC_PI_2, 0.0]);
    let along_z = Pose::from_translation(Vec3::Z * 0.5 * ARM.upper_length_m);
    robot.bodies[2].push(body(capsule(ARM.upper_length_m, ARM.upper_radius_m), along_z));
    robot.bodies[3].push(body(capsule(ARM.fore_length_m, ARM.fore_radius_m), along_x));
    let wrist = Pose::from_translation(Vec3::X * ARM.fore_length_m);
    robot.bodies[3].push(body(Shape::Sphere(Sphere { radius: ARM.wrist_radius_m }), wrist));
    robot
}

/// The arm among obstacles.
pub fn scene(grid: &Grid, obstacles: &[Obstacle]) -> Scene {
    let mut builder = Scene::builder();
    builder.robot("arm", robot(grid), Pose::IDENTITY);
    for (n, obstacle) in obstacles.iter().enumerate() {
        let (shape, in_world) = obstacle.shape();
        builder.object(Object { name: format!("obstacle {n}"), shape, in_world });
    }
    builder.build().unwrap()
}
