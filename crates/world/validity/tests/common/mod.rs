//! Random robots and obstacles.
#![allow(dead_code, clippy::print_stdout)]

pub mod coal_job;

use std::path::PathBuf;
use std::sync::Arc;

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, tessellate};
use elbowroom_robot::{Collider, Robot, RobotId};
use elbowroom_scene::{Object, Scene};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::{linear_congruential, unit};
use elbowroom_validity::ObstacleSet;

pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        unit(linear_congruential(&mut self.0))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n - 1)
    }

    pub fn vec3(&mut self, size: f64) -> Vec3 {
        Vec3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
    }

    pub fn rotation(&mut self) -> Rotation {
        let axis = self.vec3(1.0).try_normalize().unwrap_or(Vec3::Z);
        // Right angles about coordinate axes are frequent in real models.
        if self.below(2) == 0 {
            let quarter = std::f64::consts::FRAC_PI_2 * self.below(4) as f64;
            return Rotation::from_axis_angle([Vec3::X, Vec3::Y, Vec3::Z][self.below(3)], quarter);
        }
        Rotation::from_axis_angle(axis, self.between(-3.0, 3.0))
    }

    pub fn pose(&mut self, size: f64) -> Pose {
        Pose::new(self.rotation(), self.vec3(size))
    }

    /// Convex shapes of six kinds, a closed mesh, an open one.
    pub fn shape(&mut self, size: f64) -> Shape {
        let mut h = || self.between(0.3 * size, size);
        let (x, y, z) = (h(), h(), h());
        match self.below(8) {
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

    /// Joints that turn or slide, about any axis; a mimic joint; branches.
    pub fn robot(&mut self, joints: usize) -> Robot {
        let mut list = Vec::new();
        for i in 0..joints {
            let kind =
                [JointKind::Revolute, JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic][self.below(4)];
            let limits = if kind == JointKind::Prismatic { Limits::range(-0.2, 0.3) } else { Limits::symmetric(3.0) };
            let axis = if self.below(2) == 0 {
                [Vec3::X, Vec3::Y, -Vec3::Z][self.below(3)]
            } else {
                self.vec3(1.0).try_normalize().unwrap_or(Vec3::Z)
            };
            let parent = if i > 1 && self.below(4) == 0 { i - 1 } else { i };
            let mimic =
                (i > 2 && self.below(5) == 0).then(|| Mimic { joint: JointId(0), multiplier: -0.5, offset: 0.1 });
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
            let count = if link == 0 { 0 } else { 1 + self.below(2) };
            for _ in 0..count {
                let (shape, in_link) = (self.shape(0.12), self.pose(0.08));
                robot.colliders[link].push(Collider { name: String::new(), shape, in_link });
            }
        }
        robot
    }

    /// Within the limits of a robot.
    pub fn q(&mut self, chain: &Chain) -> Vec<f64> {
        let (lower, upper) = (chain.lower(), chain.upper());
        lower
            .iter()
            .zip(&upper)
            .map(|(&l, &u)| if l.is_finite() { self.between(l, u) } else { self.between(-9.0, 9.0) })
            .collect()
    }
}

/// The surface of a shape as a mesh, without its last triangles.
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

/// What surrounds a robot.
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
                // A patch of a wall, as a camera sees it.
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

    /// With covers of the meshes, which take long.
    pub fn obstacle_set(&self) -> &ObstacleSet {
        &self.set
    }

    /// All as shapes, points as balls.
    pub fn as_solids(&self) -> Vec<(Shape, Pose)> {
        let ball = |p: &Vec3| (Shape::Sphere(Sphere { radius: POINT_RADIUS_M }), Pose::from_translation(*p));
        self.solids.iter().cloned().chain(self.points.iter().map(ball)).collect()
    }
}

/// The exact scene.
pub fn scene(robot: &Robot, base: Pose, solids: &[(Shape, Pose)]) -> Scene {
    let mut builder = Scene::builder();
    builder.robot("robot", robot.clone(), base);
    for (i, (shape, in_world)) in solids.iter().enumerate() {
        builder.object(Object { name: format!("object {i}"), shape: shape.clone(), in_world: *in_world });
    }
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

/// `$ELBOWROOM_DATA`, or `../shared/data` beside the workspace; `None` and a message where it is missing.
pub fn data() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let data = std::env::var_os("ELBOWROOM_DATA").map_or(beside, PathBuf::from);
    if data.is_dir() {
        return Some(data);
    }
    println!("skipped: no data at ../shared/data or $ELBOWROOM_DATA");
    None
}

/// The robots of the data, a URDF per folder.
pub fn robots(data: &std::path::Path) -> Vec<PathBuf> {
    let in_folder =
        |folder: &std::path::Path| std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path());
    let mut folders: Vec<PathBuf> = in_folder(&data.join("urdf")).collect();
    folders.sort();
    let is_model =
        |p: &PathBuf| p.extension().is_some_and(|e| e == "urdf") && !p.to_string_lossy().contains(".package.");
    folders.iter().filter_map(|folder| in_folder(folder).filter(is_model).min()).collect()
}

/// Joint number `i` of a serial chain, without limits.
pub fn single_joint(i: usize, kind: JointKind, origin: Pose, axis: Vec3) -> Joint {
    let name = format!("joint {i}");
    let limits = Limits::UNLIMITED;
    Joint { name, kind, parent: LinkId(i), child: LinkId(i + 1), origin, axis, limits, mimic: None }
}
