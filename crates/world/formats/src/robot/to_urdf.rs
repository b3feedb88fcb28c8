//! Converts a robot to a URDF with STL meshes.

use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

use elbowroom_kinematics::{Chain, Joint, JointKind, LinkId};
use elbowroom_proximity::{Shape, tessellate::tessellate};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};

use crate::mesh_data::MeshData;
use crate::srdf::{DisabledPair, Srdf};
use crate::xml::escaped;
use crate::{Diagnostic, WholeFile, stl};

/// Limit that replaces the limit of an unlimited prismatic joint, m. A URDF requires a limit.
const UNLIMITED_M: f64 = 1e6;

/// A URDF, its SRDF and its meshes.
#[derive(Debug, Clone, Default)]
pub struct UrdfExport {
    /// Text of the URDF.
    pub urdf: String,
    /// Text of an SRDF with the disabled pairs; `None` if no pairs are disabled.
    pub srdf: Option<String>,
    /// Mesh files, with their names relative to the URDF.
    pub meshes: Vec<(String, MeshData)>,
}

/// Converts a robot to a URDF: links, joints, limits, mimics, and geometry.
///
/// The geometry is written as exact primitives or triangle meshes, for collision and as visuals. A capsule becomes a
/// cylinder and two spheres, which every URDF reader supports. `name` is the name of the robot.
///
/// ```
/// use elbowroom_formats::robot;
/// use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
/// use elbowroom_robot::Robot;
/// let row = ClassicalRow {
///     joint: "turn".into(), kind: JointKind::Revolute, a: 0.3, alpha: 0.0, d: 0.5, theta: 0.0,
///     limits: Limits::symmetric(2.5),
/// };
/// let export = robot::to_urdf(&Robot::new(Chain::from_dh("one", &[row])?), "one");
/// let model = elbowroom_formats::urdf::parse(export.urdf.as_bytes(), "one.urdf".as_ref())?;
/// assert_eq!(model.joints[0].limits.upper, 2.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_urdf(robot: &Robot, name: &str) -> UrdfExport {
    let mut export = UrdfExport { srdf: srdf(robot, name), ..UrdfExport::default() };
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = urdf(robot, name, &mut out, &mut export.meshes);
    export.urdf = out;
    export
}

/// Writes a robot as `DIR/NAME.urdf` with its meshes in `DIR/meshes`, and `DIR/NAME.srdf` if pairs are disabled.
///
/// Returns the files, the URDF first.
///
/// # Errors
/// [`Diagnostic`] if a file cannot be written.
pub fn write_urdf(robot: &Robot, dir: &Path, name: &str) -> Result<Vec<PathBuf>, Diagnostic> {
    let export = to_urdf(robot, name);
    let cannot = |path: &Path| {
        let path = path.to_owned();
        move |e: std::io::Error| {
            Diagnostic::new(&path, None, format!("cannot be written: {e}")).hint("a folder that you may write to")
        }
    };
    std::fs::create_dir_all(dir.join("meshes").join(plain_name(name))).map_err(cannot(dir))?;
    let mut files = vec![dir.join(format!("{name}.urdf"))];
    WholeFile::write(&files[0], |out| out.write_all(export.urdf.as_bytes())).map_err(cannot(&files[0]))?;
    if let Some(srdf) = &export.srdf {
        let path = dir.join(format!("{name}.srdf"));
        WholeFile::write(&path, |out| out.write_all(srdf.as_bytes())).map_err(cannot(&path))?;
        files.push(path);
    }
    for (file, mesh) in &export.meshes {
        let path = dir.join(file);
        WholeFile::write(&path, |mut out| stl::write_binary(&mut out, std::slice::from_ref(mesh)))
            .map_err(cannot(&path))?;
        files.push(path);
    }
    Ok(files)
}

fn urdf(robot: &Robot, name: &str, out: &mut String, meshes: &mut Vec<(String, MeshData)>) -> fmt::Result {
    let chain = &robot.chain;
    writeln!(out, "<?xml version=\"1.0\"?>\n<robot name=\"{}\">", escaped(name))?;
    // Each robot has its own folder of meshes, so that several robots can be written to the same directory.
    let folder = plain_name(name);
    for (i, link) in chain.links().iter().enumerate() {
        let collisions =
            elements(&robot.colliders[i], &MeshFiles { folder: &folder, prefix: "", index: i, link }, meshes);
        let visuals = match &robot.visuals[i][..] {
            [] => collisions.clone(),
            visuals => elements(visuals, &MeshFiles { folder: &folder, prefix: "visual_", index: i, link }, meshes),
        };
        if collisions.is_empty() && visuals.is_empty() {
            writeln!(out, "  <link name=\"{}\"/>", escaped(link))?;
            continue;
        }
        writeln!(out, "  <link name=\"{}\">", escaped(link))?;
        for (element, elements) in [("visual", &visuals), ("collision", &collisions)] {
            for GeometryElement { name, in_link, geometry } in elements {
                writeln!(
                    out,
                    "    <{element} name=\"{}\">{}<geometry>{geometry}</geometry></{element}>",
                    escaped(name),
                    origin(in_link)
                )?;
            }
        }
        writeln!(out, "  </link>")?;
    }
    for joint in chain.joints() {
        joint_element(chain, joint, out)?;
    }
    writeln!(out, "</robot>")
}

/// One `<collision>` or `<visual>`.
#[derive(Clone)]
struct GeometryElement {
    name: String,
    in_link: Pose,
    geometry: String,
}

/// Names of the mesh files of a link.
struct MeshFiles<'a> {
    /// Folder of the robot below `meshes`.
    folder: &'a str,
    /// Prefix of the link's name: empty, or `visual_`.
    prefix: &'a str,
    /// Index of the link, which makes the names unique.
    index: usize,
    link: &'a str,
}

impl MeshFiles<'_> {
    /// Path of the file of one collider, relative to the URDF.
    fn path(&self, collider: usize) -> String {
        let Self { folder, prefix, index, .. } = self;
        let link = plain_name(self.link);
        let number = if collider == 0 { String::new() } else { format!("_{}", collider + 1) };
        format!("meshes/{folder}/{index:02}_{prefix}{link}{number}.stl")
    }
}

fn elements(
    colliders: &[Collider],
    files: &MeshFiles<'_>,
    meshes: &mut Vec<(String, MeshData)>,
) -> Vec<GeometryElement> {
    let mut elements = Vec::new();
    for (b, collider) in colliders.iter().enumerate() {
        let mut element = |in_link: Pose, geometry: String| {
            elements.push(GeometryElement { name: collider.name.clone(), in_link, geometry });
        };
        match &collider.shape {
            Shape::Cuboid(c) => {
                let [x, y, z] = (c.half_extents * 2.0).to_array();
                element(collider.in_link, format!("<box size=\"{x:?} {y:?} {z:?}\"/>"));
            }
            Shape::Sphere(s) => element(collider.in_link, sphere(s.radius)),
            Shape::Cylinder(c) => element(collider.in_link, cylinder(c.radius, c.half_length)),
            Shape::Capsule(c) => {
                element(collider.in_link, cylinder(c.radius, c.half_length));
                for z in [c.half_length, -c.half_length] {
                    element(collider.in_link * Pose::from_translation(Vec3::Z * z), sphere(c.radius));
                }
            }
            // A URDF cannot contain unbounded geometry.
            Shape::HalfSpace(_) => {}
            Shape::Hull(_) | Shape::Mesh(_) => {
                let (vertices, triangles) = tessellate(&collider.shape, 0.0);
                let file = files.path(b);
                element(collider.in_link, format!("<mesh filename=\"{file}\"/>"));
                meshes.push((file, MeshData { name: collider.name.clone(), vertices, triangles }));
            }
        }
    }
    elements
}

/// Converts a name to a part of a file name.
fn plain_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    name.chars().map(plain).take(80).collect()
}

fn sphere(radius: f64) -> String {
    format!("<sphere radius=\"{radius:?}\"/>")
}

fn cylinder(radius: f64, half_length: f64) -> String {
    format!("<cylinder radius=\"{radius:?}\" length=\"{:?}\"/>", 2.0 * half_length)
}

fn joint_element(chain: &Chain, joint: &Joint, out: &mut String) -> fmt::Result {
    let kind = match joint.kind {
        JointKind::Fixed => "fixed",
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
    };
    let link = |id: elbowroom_kinematics::LinkId| escaped(&chain.links()[id.0]);
    writeln!(out, "  <joint name=\"{}\" type=\"{kind}\">", escaped(&joint.name))?;
    writeln!(out, "    <parent link=\"{}\"/><child link=\"{}\"/>", link(joint.parent), link(joint.child))?;
    writeln!(out, "    {}", origin(&joint.origin))?;
    if joint.kind.moves() {
        let [x, y, z] = joint.axis.to_array();
        writeln!(out, "    <axis xyz=\"{x:?} {y:?} {z:?}\"/>")?;
        let limits = &joint.limits;
        write!(out, "    <limit")?;
        if joint.kind != JointKind::Continuous {
            let end = |x: f64| x.clamp(-UNLIMITED_M, UNLIMITED_M);
            write!(out, " lower=\"{:?}\" upper=\"{:?}\"", end(limits.lower), end(limits.upper))?;
        }
        // The attributes are required; 0 means unknown.
        let (effort, velocity) = (limits.effort.unwrap_or(0.0), limits.velocity.unwrap_or(0.0));
        write!(out, " effort=\"{effort:?}\" velocity=\"{velocity:?}\"")?;
        if let Some(acceleration) = limits.acceleration {
            write!(out, " acceleration=\"{acceleration:?}\"")?;
        }
        writeln!(out, "/>")?;
        if let Some(mimic) = joint.mimic {
            let name = escaped(&chain.joints()[mimic.joint.0].name);
            let (multiplier, offset) = (mimic.multiplier, mimic.offset);
            writeln!(out, "    <mimic joint=\"{name}\" multiplier=\"{multiplier:?}\" offset=\"{offset:?}\"/>")?;
        }
    }
    writeln!(out, "  </joint>")
}

fn origin(pose: &Pose) -> String {
    let ([x, y, z], [roll, pitch, yaw]) = (pose.translation.to_array(), pose.rotation.to_rpy());
    format!("<origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>")
}

fn srdf(robot: &Robot, name: &str) -> Option<String> {
    if robot.disabled_pairs.is_empty() {
        return None;
    }
    let links = robot.chain.links();
    let pair = |(a, b, reason): &(LinkId, LinkId, String)| DisabledPair {
        link1: links[a.0].clone(),
        link2: links[b.0].clone(),
        reason: reason.clone(),
        line: 0,
    };
    let disabled = robot.disabled_pairs.iter().map(pair).collect();
    Some(Srdf { robot: Some(name.to_owned()), disabled, ..Srdf::default() }.text(&[]))
}
