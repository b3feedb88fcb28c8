//! A whole robot: a URDF with its meshes, or a 3DS or glTF model; and the SRDF that goes with it.

mod ask;
mod from_tree;
mod meshes;
mod motion;
mod to_tree;
mod to_urdf;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use elbowroom_kinematics as kinematics;
use elbowroom_kinematics::{Chain, JointId, LinkId};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere, TriMesh};
use elbowroom_scene::{Body, Robot};
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Vec3};

use crate::error::Warnings;
use crate::joints;
use crate::mesh::{self, Format};
use crate::nodetree::NodeTree;
use crate::urdf::{Geometry, Model, Solid};
use crate::{FormatError, Warning, gltf, source, srdf, tds, urdf};
use meshes::Meshes;

pub use from_tree::MOST_LINKS;
pub use to_tree::to_tree;
pub use to_urdf::{UrdfExport, to_urdf, write_urdf};

/// How to load a robot.
#[derive(Debug, Clone, Default)]
pub struct LoadOptions {
    /// Its SRDF, whose disabled pairs go into [`Robot::disabled_pairs`].
    pub srdf: Option<PathBuf>,
    /// Whether to load what is only looked at.
    pub load_visuals: bool,
    /// The unit of a 3DS model, or of meshes whose format states none (STL, OBJ, PLY, OFF, 3DS); the default is metres.
    /// The numbers of a URDF itself are always metres.
    pub unit: Option<LengthUnit>,
    /// The file of joints of a 3DS or glTF model; the default is [`joints::beside`] it, where that exists.
    pub joints: Option<PathBuf>,
    /// More joints of such a model, as [`joints::parse_option`] reads them. For a node that the file names, too, these
    /// count.
    pub joint: Vec<String>,
}

/// A robot, and what its user should know.
#[derive(Debug, Clone)]
pub struct LoadedRobot {
    /// Links and joints in the order of the file.
    pub robot: Robot,
    /// Of the URDF, its meshes and the SRDF.
    pub warnings: Vec<Warning>,
}

/// Loads a robot: a URDF with its collision meshes, or a 3DS or glTF model, told apart by content first and extension
/// second; as asked with the visual meshes of a URDF, and an SRDF.
///
/// Each object of a mesh file becomes one body. A mesh file is read once however many links use it. The unit of a
/// COLLADA mesh is applied and its up axis is not, as in rviz and `MoveIt`.
///
/// Of a 3DS or glTF model every node becomes a link. Joints are where its tracks turn or slide a node, and where
/// [`LoadOptions::joints`] or [`LoadOptions::joint`] say so; all other nodes are fixed. Where nothing moves, a warning says
/// what is ambiguous.
///
/// # Errors
/// Whatever is wrong with the model, its joints or the SRDF, and every collision mesh that is missing or cannot be read;
/// visual meshes only warn.
///
/// ```
/// use elbowroom_formats::robot::{self, LoadOptions};
/// # let dir = tempfile::tempdir()?;
/// let path = dir.path().join("slide.urdf");
/// std::fs::write(&path, r#"<robot name="slide">
///   <link name="rail"/>
///   <link name="cart"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
///   <joint name="x" type="prismatic">
///     <parent link="rail"/> <child link="cart"/> <limit lower="0" upper="2" velocity="1" effort="0"/>
///   </joint>
/// </robot>"#)?;
/// let loaded = robot::load(&path, &LoadOptions::default())?;
/// assert_eq!(loaded.robot.chain.dof(), 1);
/// assert_eq!(loaded.robot.bodies[1].len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load(path: &Path, options: &LoadOptions) -> Result<LoadedRobot, FormatError> {
    let bytes = source::read(path)?;
    let (mut robot, mut warnings) = match tree_format(&bytes, path) {
        Some(format) => load_tree(&bytes, format, path, options)?,
        None => load_urdf(&bytes, path, options)?,
    };
    if let Some(srdf_path) = &options.srdf {
        disable_pairs(&mut robot, srdf_path, &mut warnings)?;
    }
    Ok(LoadedRobot { robot, warnings: warnings.finish(path) })
}

/// Adds the pairs that an SRDF disables to a robot that came from elsewhere. Returns what the user should know.
///
/// # Errors
/// [`FormatError`] where the file cannot be read or is no SRDF.
pub fn apply_srdf(robot: &mut Robot, path: &Path) -> Result<Vec<Warning>, FormatError> {
    let mut warnings = Warnings::default();
    disable_pairs(robot, path, &mut warnings)?;
    Ok(warnings.finish(path))
}

/// Whether [`load`] takes a file for a 3DS or glTF model, and for which.
pub fn tree_format(bytes: &[u8], file: &Path) -> Option<Format> {
    let head = bytes[..bytes.len().min(64)].trim_ascii_start();
    if head.starts_with(b"<") {
        return None;
    }
    mesh::detect(bytes, file).ok().filter(|f| matches!(f, Format::Tds | Format::Gltf))
}

/// The nodes of a 3DS or glTF model, in metres.
///
/// # Errors
/// What the readers refuse.
pub fn parse_tree(
    bytes: &[u8],
    format: Format,
    file: &Path,
    unit: Option<LengthUnit>,
) -> Result<NodeTree, FormatError> {
    let mut tree = if format == Format::Tds { tds::parse(bytes, file)? } else { gltf::parse_tree(bytes, file)? };
    let Some(unit) = unit else { return Ok(tree) };
    if format.states_its_unit() {
        let what = format!("states its own unit; the unit {} asked for is not applied", unit.symbol());
        tree.warnings.push(Warning::new(file, None, what));
    } else {
        tree.scale(unit.to_metres(1.0));
    }
    tree.check_finite(file)?;
    Ok(tree)
}

fn load_tree(
    bytes: &[u8],
    format: Format,
    path: &Path,
    options: &LoadOptions,
) -> Result<(Robot, Warnings), FormatError> {
    let mut tree = parse_tree(bytes, format, path, options.unit)?;
    let mut warnings = Warnings::default();
    warnings.extend(std::mem::take(&mut tree.warnings));
    let beside = joints::beside(path);
    let mut specs = match &options.joints {
        Some(file) => joints::load(file)?,
        None if beside.is_file() => joints::load(&beside)?,
        None => Vec::new(),
    };
    let more: Vec<_> = options.joint.iter().map(|text| joints::parse_option(text)).collect::<Result<_, _>>()?;
    specs.retain(|s| !more.iter().any(|m| m.node == s.node));
    specs.extend(more);
    if let Some(w) = mesh::units_suspicion(tree.aabb().extent()).filter(|_| !format.states_its_unit()) {
        warnings.push(Warning { file: path.to_owned(), ..w });
    }
    let robot = from_tree::robot(tree, &specs, (path, &beside), &mut warnings)?;
    Ok((robot, warnings))
}

fn load_urdf(bytes: &[u8], urdf_path: &Path, options: &LoadOptions) -> Result<(Robot, Warnings), FormatError> {
    if options.joints.is_some() || !options.joint.is_empty() {
        return Err(FormatError::new(urdf_path, None, "is a URDF, which has its own joints")
            .hint("leave the joints out, or name a 3DS or glTF model"));
    }
    let model = urdf::parse(bytes, urdf_path)?;
    let mut robot = Robot::new(chain(&model, urdf_path)?);
    let base = urdf_path.parent().unwrap_or(Path::new(""));
    let wanted = model.links.iter().flat_map(|l| l.collisions.iter().chain(shown(l, options)));
    let mut loader = Loader {
        urdf_path,
        meshes: Meshes::load(wanted, base, options.unit),
        warnings: Warnings::default(),
        largest: 0.0,
    };
    loader.warnings.extend(model.warnings.clone());
    for (i, link) in model.links.iter().enumerate() {
        for solid in &link.collisions {
            robot.bodies[i].extend(loader.bodies(solid)?);
        }
        for solid in shown(link, options) {
            match loader.bodies(solid) {
                Ok(bodies) => robot.visuals[i].extend(bodies),
                Err(e) => loader.warnings.push(e.into()),
            }
        }
    }
    loader.doubt_units(&model);
    Ok((robot, loader.warnings))
}

fn shown<'a>(link: &'a urdf::Link, options: &LoadOptions) -> &'a [Solid] {
    if options.load_visuals { &link.visuals } else { &[] }
}

/// The chain of a model; links and joints keep their order.
///
/// # Errors
/// What the kinematics room refuses beyond the checks of [`urdf::parse`]; the line is that of the joint or link that
/// the refusal names.
pub fn chain(model: &Model, file: &Path) -> Result<Chain, FormatError> {
    let links = model.links.iter().map(|l| l.name.clone()).collect();
    let joint = |j: &urdf::Joint| kinematics::Joint {
        name: j.name.clone(),
        kind: j.kind,
        parent: LinkId(j.parent),
        child: LinkId(j.child),
        origin: j.origin,
        axis: j.axis,
        limits: j.limits,
        mimic: j.mimic.map(|m| kinematics::Mimic {
            joint: JointId(m.joint),
            multiplier: m.multiplier,
            offset: m.offset,
        }),
    };
    Chain::new(model.name.clone(), links, model.joints.iter().map(joint).collect()).map_err(|e| {
        let message = e.to_string();
        let named = |name: &str| message.contains(&format!("`{name}`"));
        let joint = model.joints.iter().find(|j| named(&j.name)).map(|j| j.line);
        let line = joint.or_else(|| model.links.iter().find(|l| named(&l.name)).map(|l| l.line));
        FormatError::new(file, line, message)
    })
}

struct Loader<'a> {
    urdf_path: &'a Path,
    meshes: Meshes,
    warnings: Warnings,
    /// The largest extent of any body, metres.
    largest: f64,
}

impl Loader<'_> {
    fn bodies(&mut self, solid: &Solid) -> Result<Vec<Body>, FormatError> {
        let name = solid.name.clone();
        let kind = |g: &Geometry| match g {
            Geometry::Box(_) => "box",
            Geometry::Sphere { .. } => "sphere",
            Geometry::Cylinder { .. } => "cylinder",
            Geometry::Capsule { .. } => "capsule",
            Geometry::Mesh { .. } => "mesh",
        };
        let shape = match &solid.geometry {
            Geometry::Box(size) => Shape::Cuboid(Cuboid { half_extents: *size * 0.5 }),
            Geometry::Sphere { radius } => Shape::Sphere(Sphere { radius: *radius }),
            Geometry::Cylinder { radius, length } => {
                Shape::Cylinder(Cylinder { half_length: length * 0.5, radius: *radius })
            }
            Geometry::Capsule { radius, length } => {
                Shape::Capsule(Capsule { half_length: length * 0.5, radius: *radius })
            }
            Geometry::Mesh { filename, scale } => return self.mesh_bodies(solid, filename, *scale),
        };
        shape.validate().map_err(|e| FormatError::new(self.urdf_path, solid.line, e.to_string()))?;
        self.note_extent(shape.aabb(&Pose::IDENTITY).extent(), solid);
        Ok(vec![Body { name: name.unwrap_or_else(|| kind(&solid.geometry).to_owned()), shape, in_link: solid.in_link }])
    }

    fn mesh_bodies(&mut self, solid: &Solid, filename: &str, scale: Vec3) -> Result<Vec<Body>, FormatError> {
        let path = self.meshes.path(filename).map(Path::to_owned).map_err(|why| {
            FormatError::new(self.urdf_path, solid.line, format!("the mesh `{filename}` is not found: {why}"))
                .hint("a path relative to the URDF, or package://NAME/… with a directory NAME beside the URDF or above")
        })?;
        let (solids, warnings) = self.meshes.solids(&path, scale).map_err(|mut e| {
            e.what = format!("{} (named in {}:{})", e.what, self.urdf_path.display(), solid.line);
            e
        })?;
        self.warnings.extend(warnings);
        let extent = solids.iter().fold(elbowroom_spatial::Aabb::EMPTY, |all, (_, m)| all.union(m.aabb())).extent();
        self.note_extent(extent, solid);
        let stem = solid.name.clone().unwrap_or_else(|| source::stem(&path));
        let many = solids.len() > 1;
        let body = |(object, mesh): &(String, Arc<TriMesh>)| Body {
            name: if many { format!("{stem}:{object}") } else { stem.clone() },
            shape: Shape::Mesh(Arc::clone(mesh)),
            in_link: solid.in_link,
        };
        Ok(solids.iter().map(body).collect())
    }

    fn note_extent(&mut self, extent: Vec3, solid: &Solid) {
        let largest = extent.max_element();
        self.largest = self.largest.max(largest);
        if let Some(doubt) = mesh::units_suspicion(extent).filter(|_| largest > 20.0) {
            self.warnings.push(Warning { file: self.urdf_path.to_owned(), line: Some(solid.line), ..doubt });
        }
    }

    /// Small parts are ordinary; a robot of which all parts are tiny is not. Nor is an arm with joints 20 m apart.
    fn doubt_units(&mut self, model: &Model) {
        let is_tiny = self.largest > 0.0 && self.largest < 1.0;
        if let Some(doubt) = mesh::units_suspicion(Vec3::splat(self.largest)).filter(|_| is_tiny) {
            self.warnings.push(Warning { file: self.urdf_path.to_owned(), ..doubt });
        }
        if let Some(far) = model.joints.iter().find(|j| j.origin.translation.length() > 20.0) {
            let metres = far.origin.translation.length();
            let what = format!("the joint `{}` is {metres:.4} m away from its parent: are these metres?", far.name);
            self.warnings.push(Warning::new(self.urdf_path, far.line, what).hint("<origin xyz=\"…\"/> in metres"));
        }
    }
}

fn disable_pairs(robot: &mut Robot, path: &Path, warnings: &mut Warnings) -> Result<(), FormatError> {
    let srdf = srdf::parse(&source::read(path)?, path)?;
    warnings.extend(srdf.warnings);
    if let Some(name) = srdf.robot.filter(|name| name != robot.chain.name()) {
        let what = format!("is for the robot `{name}`, but the URDF describes `{}`", robot.chain.name());
        warnings.push(Warning::new(path, None, what).hint("the same name in both files"));
    }
    for pair in srdf.disabled {
        let mut link = |name: &str| {
            let found = robot.chain.link(name);
            if found.is_none() {
                warnings.push_with(|| {
                    Warning::new(
                        path,
                        pair.line,
                        format!("there is no link `{name}` in the URDF; the pair is passed over"),
                    )
                    .hint("the name of a link, or remove the line")
                });
            }
            found
        };
        let (Some(a), Some(b)) = (link(&pair.link1), link(&pair.link2)) else { continue };
        if a == b {
            let what = format!("the link `{}` is paired with itself; the pair is passed over", pair.link1);
            warnings.push_with(|| Warning::new(path, pair.line, what).hint("two different links"));
            continue;
        }
        robot.disabled_pairs.push((a, b, pair.reason));
    }
    Ok(())
}
