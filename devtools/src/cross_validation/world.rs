//! Robot of the data as a scene, alone or with two objects around it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use elbowroom_formats::mesh;
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_kinematics::LinkId;
use elbowroom_proximity::{Cuboid, Shape, TriMesh};
use elbowroom_robot::collision_pairs;
use elbowroom_robot::{Collider, GeometryId, Robot};
use elbowroom_scene::{Object, Scene, SceneState};
use elbowroom_spatial::{Aabb, Pose, Vec3};
use elbowroom_testkit::random::SplitMix;

/// Files of a robot.
pub struct Files {
    pub name: String,
    pub urdf: PathBuf,
    pub srdf: Option<PathBuf>,
}

/// Finds every robot and cell of the data, by name.
pub fn find(data: &Path) -> Vec<Files> {
    let mut found = Vec::new();
    let folders = ["urdf", "cell"].iter().filter_map(|kind| std::fs::read_dir(data.join(kind)).ok()).flatten();
    for folder in folders.flatten().map(|entry| entry.path()) {
        let files = std::fs::read_dir(&folder).into_iter().flatten().flatten().map(|entry| entry.path());
        for urdf in files.filter(|path| path.extension().is_some_and(|e| e == "urdf")) {
            let name = urdf.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let srdf = urdf.with_extension("srdf");
            // NAME.package.urdf is the same robot with package paths.
            if !name.ends_with(".package") {
                found.push(Files { name, urdf, srdf: srdf.is_file().then_some(srdf) });
            }
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

/// Loads a robot, with its SRDF if that is requested and exists.
pub fn load(files: &Files, with_srdf: bool) -> Result<Robot, String> {
    let srdf = files.srdf.clone().filter(|_| with_srdf);
    let options = LoadOptions { srdf, ..LoadOptions::default() };
    robot::load(&files.urdf, &options).map(|loaded| loaded.robot).map_err(|e| e.to_string())
}

/// Builds a scene of the robot, with its root link in the world frame, and the objects.
pub fn scene(name: &str, robot: Robot, objects: Vec<Object>) -> Result<Scene, String> {
    let mut builder = Scene::builder();
    builder.robot(name, robot, Pose::IDENTITY);
    for object in objects {
        builder.object(object);
    }
    builder.build().map_err(|e| e.to_string())
}

/// Returns a box and a mesh (a scaled link of the example robot RX60B) within reach of the robot.
pub fn objects(root: &Path, alone: &Scene) -> Result<Vec<Object>, String> {
    let around = extent(alone);
    let (middle, half) = ((around.min + around.max) * 0.5, (around.max - around.min).length() * 0.5);
    let cuboid = Cuboid { half_extents: Vec3::new(0.10, 0.15, 0.08) * half };
    let file = root.join("examples/models/rx60b/meshes/link_1.stl");
    let loaded = mesh::load(&file, None).map_err(|e| e.to_string())?;
    let part = loaded.meshes.into_iter().next().ok_or("an STL without triangles")?;
    let vertices = part.vertices.iter().map(|v| *v * half).collect();
    let solid = TriMesh::new(vertices, part.triangles).map_err(|e| e.to_string())?;
    let at = |x, y, z, rpy| {
        let shift = Vec3::new(x, y, z) * half;
        Pose::from_xyz_rpy((middle + shift).to_array(), rpy)
    };
    let object = |name: &str, shape, in_world| Object { name: name.into(), shape, in_world };
    Ok(vec![
        object("box", Shape::Cuboid(cuboid), at(0.62, 0.28, 0.10, [0.2, 0.3, 0.4])),
        object("part", Shape::Mesh(Arc::new(solid)), at(-0.40, -0.62, 0.20, [0.5, -0.2, 1.0])),
    ])
}

/// Returns the box around the robot at zero joint values.
fn extent(scene: &Scene) -> Aabb {
    let state = SceneState::new(scene);
    let mut around: Option<Aabb> = None;
    for id in scene.geometries() {
        let Some(pose) = state.pose(scene, id) else { continue };
        for collider in colliders(scene, id) {
            let next = collider.shape.aabb(&(pose * collider.in_link));
            around = Some(around.map_or(next, |a| Aabb { min: a.min.min(next.min), max: a.max.max(next.max) }));
        }
    }
    around.unwrap_or(Aabb { min: Vec3::ZERO, max: Vec3::splat(1.0) })
}

/// Returns the colliders of a geometry; the frame of an object is the frame of its shape.
pub fn colliders(scene: &Scene, id: GeometryId) -> Vec<Collider> {
    match id {
        GeometryId::Link { robot, link } => scene.robots()[robot.0].robot.colliders[link.0].clone(),
        GeometryId::Object(o) => {
            let object = &scene.objects()[o.0];
            vec![Collider { name: object.name.clone(), shape: object.shape.clone(), in_link: Pose::IDENTITY }]
        }
    }
}

/// Returns the collision pairs by the rule, without the allowed collision matrix.
pub fn by_rule(scene: &Scene) -> Vec<(GeometryId, GeometryId)> {
    let robots: Vec<&Robot> = scene.robots().iter().map(|r| &r.robot).collect();
    collision_pairs(&robots, scene.objects().len())
}

/// Returns the name of the link; empty for an object.
pub fn link_name(scene: &Scene, id: GeometryId) -> String {
    match id {
        GeometryId::Link { robot, link: LinkId(link) } => scene.robots()[robot.0].robot.chain.links()[link].clone(),
        GeometryId::Object(_) => String::new(),
    }
}

/// Returns random joint values within the limits; without limits, within half a turn or a metre in each direction.
pub fn states(robot: &Robot, count: usize) -> Vec<Vec<f64>> {
    let chain = &robot.chain;
    let mut random = SplitMix(20_261_120);
    let range = |joint: &elbowroom_kinematics::Joint| {
        let wide = if joint.kind.turns() { std::f64::consts::PI } else { 1.0 };
        let or = |v: f64, other| if v.is_finite() { v } else { other };
        (or(joint.limits.lower, -wide), or(joint.limits.upper, wide))
    };
    let ranges: Vec<(f64, f64)> = chain.active_joints().iter().map(|j| range(&chain.joints()[j.0])).collect();
    (0..count).map(|_| ranges.iter().map(|(from, to)| from + (to - from) * random.unit()).collect()).collect()
}
