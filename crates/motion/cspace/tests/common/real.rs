//! Real robots with meshes, and obstacles around them.
#![allow(dead_code, reason = "each test file uses a part")]

use std::sync::Arc;

use elbowroom_proximity::{Cylinder, Shape, Sphere};
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;

use crate::common::robots::{box_mesh, cuboid};

/// Folders of the robots.
pub const ROBOTS: [&str; 4] = ["kuka_kr150_2", "staubli_tx60", "ur5e", "abb_irb2400"];

/// Length from base to tip along the links, metres.
pub fn reach(robot: &Robot) -> f64 {
    let chain = &robot.chain;
    chain.path(chain.tip()).iter().map(|j| chain.joints()[j.0].origin.translation.length()).sum()
}

/// A table, a column, a sphere, an obstacle over the base axis, and a small rotated mesh.
pub fn obstacles(reach: f64) -> Vec<(Shape, Pose)> {
    let at = |x: f64, y: f64, z: f64| [x * reach, y * reach, z * reach];
    let place = |x, y, z, rpy| Pose::from_xyz_rpy(at(x, y, z), rpy);
    vec![
        cuboid(at(0.5, 0.0, 0.1), [0.0, 0.0, 0.3], at(0.2, 0.4, 0.2)),
        (
            Shape::Cylinder(Cylinder { half_length: 0.4 * reach, radius: 0.05 * reach }),
            place(0.2, -0.45, 0.4, [0.1, 0.0, 0.0]),
        ),
        (Shape::Sphere(Sphere { radius: 0.08 * reach }), place(-0.35, 0.3, 0.5, [0.0; 3])),
        (Shape::Mesh(Arc::new(box_mesh(0.1 * reach))), place(0.02, 0.01, 0.95, [0.5, 0.3, 0.2])),
        (Shape::Mesh(Arc::new(box_mesh(0.12 * reach))), place(-0.5, -0.2, 0.25, [0.5, 0.3, 0.2])),
    ]
}
