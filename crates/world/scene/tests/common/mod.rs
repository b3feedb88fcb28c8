//! Random scenes, and direct answers to queries about them.
#![allow(dead_code)]

pub mod rx60b;

use std::sync::Arc;

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::{
    Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, separation, tessellate,
};
use elbowroom_robot::{Collider, GeometryId, Robot, RobotId, collision_pairs};

use elbowroom_scene::{Object, Scene, SceneBuilder, SceneState};
use elbowroom_spatial::{Pose, Rotation, Vec3};
pub use elbowroom_testkit::random::Random;

/// Random geometry of scenes.
pub trait RandomGeometry {
    /// A vector with each coordinate within `size` of 0.
    fn vec3(&mut self, size: f64) -> Vec3;

    fn pose(&mut self, size: f64) -> Pose;

    /// Joint values within the limits of the example arm.
    fn q(&mut self) -> [f64; 3];

    /// A shape with dimensions up to `size`; `kind` must be below 6.
    fn shape(&mut self, kind: usize, size: f64) -> Shape;
}

impl RandomGeometry for Random {
    fn vec3(&mut self, size: f64) -> Vec3 {
        Vec3::from(self.within(size))
    }

    fn pose(&mut self, size: f64) -> Pose {
        let axis = self.vec3(1.0).try_normalize().unwrap_or(Vec3::Z);
        Pose::new(Rotation::from_axis_angle(axis, self.between(-3.0, 3.0)), self.vec3(size))
    }

    fn q(&mut self) -> [f64; 3] {
        [self.between(-3.0, 3.0), self.between(-2.2, 2.2), self.between(-2.5, 2.5)]
    }

    fn shape(&mut self, kind: usize, size: f64) -> Shape {
        let mut h = || self.between(0.3 * size, size);
        let (x, y, z) = (h(), h(), h());
        match kind {
            0 => Shape::Sphere(Sphere { radius: x }),
            1 => Shape::Capsule(Capsule { half_length: x, radius: 0.5 * y }),
            2 => Shape::Cylinder(Cylinder { half_length: x, radius: 0.5 * y }),
            3 => Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) }),
            4 => Shape::Hull(Arc::new(ConvexHull::from_points(&points(self, size)).unwrap())),
            _ => {
                // Two convex parts beside each other are not convex together.
                let hull = ConvexHull::from_points(&points(self, 0.5 * size)).unwrap();
                let part = |shift: f64| hull.vertices().iter().map(move |&v| v + Vec3::X * shift);
                let count = hull.vertices().len() as u32;
                let triangles = hull.triangles().iter().flat_map(|&t| [t, t.map(|i| i + count)]).collect();
                let vertices = part(-0.7 * size).chain(part(0.7 * size)).collect();
                Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
            }
        }
    }
}

fn points(random: &mut Random, size: f64) -> Vec<Vec3> {
    (0..12).map(|_| random.vec3(size)).collect()
}

/// The example arm with meshes instead of capsules.
pub fn mesh_arm() -> Robot {
    let mut robot = elbowroom_robot::example::arm().unwrap();
    for collider in robot.colliders.iter_mut().flatten() {
        let (vertices, triangles) = tessellate::tessellate(&collider.shape, 0.004);
        collider.shape = Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()));
    }
    robot
}

/// The example arm with several colliders of all kinds per link.
pub fn mixed_arm(r: &mut Random) -> Robot {
    let mut robot = elbowroom_robot::example::arm().unwrap();
    for (link, colliders) in robot.colliders.iter_mut().enumerate() {
        let along = if link == 0 { 0.05 } else { 0.2 };
        for k in 0..3 {
            let mut in_link = r.pose(0.05);
            in_link.translation += Vec3::Z * along;
            colliders.push(Collider { name: format!("{k}"), shape: r.shape((link + 2 * k) % 6, 0.06), in_link });
        }
    }
    robot
}

/// Two different arms among objects of every kind, without edits of pairs.
pub fn scene_of(seed: u64, more: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut r = Random(seed);
    let mut builder = Scene::builder();
    builder.robot("meshes", mesh_arm(), Pose::IDENTITY);
    builder.robot("mixed", mixed_arm(&mut r), Pose::from_translation(Vec3::X * 0.75));
    for kind in 0..6 {
        let shape = r.shape(kind, 0.12);
        let mut in_world = r.pose(0.3);
        in_world.translation += Vec3::new(0.4, if kind % 2 == 0 { 0.5 } else { -0.5 }, 0.6);
        builder.object(Object { name: format!("thing {kind}"), shape, in_world });
    }
    let floor = Pose::from_translation(Vec3::Z * -0.3);
    builder.object(Object { name: "floor".into(), shape: Shape::HalfSpace(HalfSpace), in_world: floor });
    more(&mut builder);
    builder.build().unwrap()
}

/// A state with random joint values for both arms.
pub fn random_state(scene: &Scene, r: &mut Random) -> SceneState {
    let mut state = SceneState::new(scene);
    for robot in 0..scene.robots().len() {
        state.set_q(scene, RobotId(robot), &r.q()).unwrap();
    }
    state
}

/// All shapes of a link or object with their current poses.
pub fn shapes(scene: &Scene, state: &SceneState, id: GeometryId) -> Vec<(Shape, Pose)> {
    let in_world = state.pose(scene, id).unwrap();
    match id {
        GeometryId::Object(o) => vec![(scene.objects()[o.0].shape.clone(), in_world)],
        GeometryId::Link { robot, link } => scene.robots()[robot.0].robot.colliders[link.0]
            .iter()
            .map(|b| (b.shape.clone(), in_world * b.in_link))
            .collect(),
    }
}

/// Distance of two links or objects, measured between every pair of shapes.
pub fn apart(scene: &Scene, state: &SceneState, a: GeometryId, b: GeometryId) -> f64 {
    let (of_a, of_b) = (shapes(scene, state, a), shapes(scene, state, b));
    let all = of_a.iter().flat_map(|(s, p)| of_b.iter().map(move |(t, q)| separation(s, p, t, q).distance));
    all.fold(f64::INFINITY, f64::min)
}

/// Every pair by rule with its distance less its padding, measured directly.
pub fn all_distances(
    scene: &Scene,
    state: &SceneState,
    padding: impl Fn(GeometryId) -> f64,
) -> Vec<(GeometryId, GeometryId, f64)> {
    let robots: Vec<&Robot> = scene.robots().iter().map(|r| &r.robot).collect();
    let list = collision_pairs(&robots, scene.objects().len());
    list.into_iter().map(|(a, b)| (a, b, (apart(scene, state, a, b) - padding(a) - padding(b)).max(0.0))).collect()
}

pub fn link(robot: usize, link: usize) -> GeometryId {
    GeometryId::Link { robot: RobotId(robot), link: LinkId(link) }
}
