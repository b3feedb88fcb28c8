//! Random robots and obstacles.
#![allow(dead_code, clippy::print_stdout)]

pub mod coal_job;

use std::sync::Arc;

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, tessellate};
use elbowroom_robot::{Collider, Robot, RobotId};
use elbowroom_scene::{Object, Scene};
use elbowroom_spatial::{Pose, Rotation, Vec3};
pub use elbowroom_testkit::random::Random;
use elbowroom_validity::ObstacleSet;

/// Random geometry, robots and joint vectors.
pub trait RandomGeometry {
    /// A vector with each coordinate within `size` of 0.
    fn vec3(&mut self, size: f64) -> Vec3;

    /// A rotation. Half of them are right angles about coordinate axes, which are frequent in real models.
    fn rotation(&mut self) -> Rotation;

    fn pose(&mut self, size: f64) -> Pose;

    /// A shape: one of six convex kinds, a closed mesh, or an open mesh.
    fn shape(&mut self, size: f64) -> Shape;

    /// A robot with joints that turn or slide about any axis, a mimic joint, and branches.
    fn robot(&mut self, joints: usize) -> Robot;

    /// Joint values within the limits of a robot.
    fn q(&mut self, chain: &Chain) -> Vec<f64>;
}

impl RandomGeometry for Random {
    fn vec3(&mut self, size: f64) -> Vec3 {
        Vec3::from(self.within(size))
    }

    fn rotation(&mut self) -> Rotation {
        let axis = self.vec3(1.0).try_normalize().unwrap_or(Vec3::Z);
        if self.index(2) == 0 {
            let quarter = std::f64::consts::FRAC_PI_2 * self.index(4) as f64;
            return Rotation::from_axis_angle([Vec3::X, Vec3::Y, Vec3::Z][self.index(3)], quarter);
        }
        Rotation::from_axis_angle(axis, self.between(-3.0, 3.0))
    }

    fn pose(&mut self, size: f64) -> Pose {
        Pose::new(self.rotation(), self.vec3(size))
    }

    fn shape(&mut self, size: f64) -> Shape {
        let mut h = || self.between(0.3 * size, size);
        let (x, y, z) = (h(), h(), h());
        match self.index(8) {
            0 => Shape::Sphere(Sphere { radius: x }),
            1 => Shape::Capsule(Capsule { half_length: x, radius: 0.5 * y }),
            2 => Shape::Cylinder(Cylinder { half_length: x, radius: 0.5 * y }),
            3 | 4 => Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) }),
            5 => {
                let points: Vec<_> = (0..12).map(|_| self.vec3(size)).collect();
                Shape::Hull(Arc::new(ConvexHull::from_points(&points).unwrap()))
            }
            6 => mesh(&Shape::Capsule(Capsule { half_length: x, radius: 0.5 * y }), 0),
            _ => mesh(&Shape::Cylinder(Cylinder { half_length: x, radius: y }), 7),
        }
    }

    fn robot(&mut self, joints: usize) -> Robot {
        let mut list = Vec::new();
        for i in 0..joints {
            let kind =
                [JointKind::Revolute, JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic][self.index(4)];
            let limits = if kind == JointKind::Prismatic { Limits::range(-0.2, 0.3) } else { Limits::symmetric(3.0) };
            let axis = if self.index(2) == 0 {
                [Vec3::X, Vec3::Y, -Vec3::Z][self.index(3)]
            } else {
                self.vec3(1.0).try_normalize().unwrap_or(Vec3::Z)
            };
            let parent = if i > 1 && self.index(4) == 0 { i - 1 } else { i };
            let mimic =
                (i > 2 && self.index(5) == 0).then(|| Mimic { joint: JointId(0), multiplier: -0.5, offset: 0.1 });
            list.push(Joint {
                name: format!("joint {i}"),
                kind,
                parent: LinkId(parent),
                child: LinkId(i + 1),
                origin: self.pose(0.3),
                axis,
                limits,
                mimic,
            });
        }
        let links = (0..=joints).map(|i| format!("link {i}")).collect();
        let mut robot = Robot::new(Chain::new("random", links, list).unwrap());
        for link in 0..=joints {
            let count = if link == 0 { 0 } else { 1 + self.index(2) };
            for _ in 0..count {
                let (shape, in_link) = (self.shape(0.12), self.pose(0.08));
                robot.colliders[link].push(Collider { name: String::new(), shape, in_link });
            }
        }
        robot
    }

    fn q(&mut self, chain: &Chain) -> Vec<f64> {
        let (lower, upper) = (chain.lower(), chain.upper());
        lower
            .iter()
            .zip(&upper)
            .map(|(&l, &u)| if l.is_finite() { self.between(l, u) } else { self.between(-9.0, 9.0) })
            .collect()
    }
}

/// The surface of a shape as a mesh, without its last `missing` triangles.
pub fn mesh(shape: &Shape, missing: usize) -> Shape {
    let (vertices, mut triangles) = tessellate::tessellate(shape, 2e-3);
    triangles.truncate(triangles.len() - missing);
    Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
}

/// A floor far below, and objects of all kinds around the robot.
pub fn obstacles(random: &mut Random, count: usize, spread: f64) -> Vec<(Shape, Pose)> {
    let floor = Pose::new(random.rotation(), Vec3::ZERO);
    let floor = Pose::new(floor.rotation, floor.rotation * (Vec3::Z * -1.5 * spread));
    let mut list = vec![(Shape::HalfSpace(HalfSpace), floor)];
    list.extend((0..count).map(|_| (random.shape(0.2), random.pose(spread))));
    list
}

/// Kind of the surroundings of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Spheres, capsules, cylinders and boxes.
    Primitives,
    /// Closed and open meshes, and convex hulls.
    Meshes,
    /// A cloud of points with a radius.
    Cloud,
    /// Shapes of all kinds.
    Mixed,
}

/// A floor far below, and solids or points around a robot.
pub struct Surroundings {
    solids: Vec<(Shape, Pose)>,
    points: Vec<Vec3>,
    set: ObstacleSet,
}

/// Radius of the points of a cloud, m.
const POINT_RADIUS_M: f64 = 0.01;

impl Surroundings {
    pub fn new(random: &mut Random, kind: Kind, count: usize, spread: f64) -> Self {
        let mut solids = obstacles(random, 0, spread);
        let mut points = Vec::new();
        while solids.len() + points.len() <= count {
            if kind == Kind::Cloud {
                // A patch of a wall, as seen by a camera.
                let wall = random.pose(spread);
                let mut on_wall = || Vec3::new(random.between(-0.3, 0.3), random.between(-0.3, 0.3), 0.0);
                points.extend((0..20).map(|_| wall.transform_point(on_wall())));
                continue;
            }
            let shape = random.shape(0.2);
            let is_mesh = matches!(shape, Shape::Hull(_) | Shape::Mesh(_));
            if kind == Kind::Mixed || is_mesh == (kind == Kind::Meshes) {
                solids.push((shape, random.pose(spread)));
            }
        }
        let mut set = obstacle_set(&solids);
        set.add_points(&points, POINT_RADIUS_M);
        Self { solids, points, set }
    }

    /// The obstacles with the covers of the meshes, which take long to build.
    pub fn obstacle_set(&self) -> &ObstacleSet {
        &self.set
    }

    /// All obstacles as shapes; points become balls.
    pub fn as_solids(&self) -> Vec<(Shape, Pose)> {
        let ball = |p: &Vec3| (Shape::Sphere(Sphere { radius: POINT_RADIUS_M }), Pose::from_translation(*p));
        self.solids.iter().cloned().chain(self.points.iter().map(ball)).collect()
    }
}

/// The exact scene. Every pair is tested: proofs that links are out of reach are not used.
pub fn scene(robot: &Robot, base: Pose, solids: &[(Shape, Pose)]) -> Scene {
    let mut builder = Scene::builder();
    builder.robot("robot", robot.clone(), base);
    for (i, (shape, in_world)) in solids.iter().enumerate() {
        builder.object(Object { name: format!("object {i}"), shape: shape.clone(), in_world: *in_world });
    }
    builder.prove_out_of_reach(false);
    builder.build().unwrap()
}

pub fn obstacle_set(solids: &[(Shape, Pose)]) -> ObstacleSet {
    let mut set = ObstacleSet::default();
    for (shape, pose) in solids {
        set.add_shape(shape, pose, 0.0);
    }
    set
}

pub const ROBOT: RobotId = RobotId(0);

/// Joint with index `i` of a serial chain, without limits.
pub fn single_joint(i: usize, kind: JointKind, origin: Pose, axis: Vec3) -> Joint {
    let name = format!("joint {i}");
    let limits = Limits::UNLIMITED;
    Joint { name, kind, parent: LinkId(i), child: LinkId(i + 1), origin, axis, limits, mimic: None }
}
