//! Robots from files: a URDF with its meshes, or a 3DS, glTF or VRML model; with an SRDF.

mod from_tree;
mod joint_candidates;
mod mesh_cache;
mod pose_difference;
mod to_tree;
mod to_urdf;
mod track_joint;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use elbowroom_kinematics as kinematics;
use elbowroom_kinematics::{Chain, JointId, LinkId};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere, TriMesh};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Vec3};

use crate::joints;
use crate::mesh::{self, MeshFormat};
use crate::nodetree::NodeTree;
use crate::srdf::Srdf;
use crate::urdf::{Geometry, LinkGeometry, UrdfModel};
use crate::warning_list::WarningList;
use crate::{Diagnostic, gltf, input, srdf, tds, urdf, vrml};
use mesh_cache::MeshCache;

pub use from_tree::MAX_LINKS;
pub use to_tree::to_tree;
pub use to_urdf::{UrdfExport, to_urdf, write_urdf};

/// Options of [`load`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// SRDF file, whose disabled pairs are added to [`Robot::disabled_pairs`].
    pub srdf: Option<PathBuf>,
    /// Whether to load visual geometry.
    pub load_visuals: bool,
    /// Unit of a 3DS model, or of meshes whose format defines none (STL, OBJ, PLY, OFF, 3DS).
    ///
    /// Default: metres. The numbers of a URDF itself are always metres.
    pub unit: Option<LengthUnit>,
    /// Joints file of a 3DS, glTF or VRML model. Default: [`joints::default_path`], if that file exists.
    pub joints: Option<PathBuf>,
    /// Further joints of a 3DS, glTF or VRML model, in the syntax of [`joints::parse_option`]. They override the file.
    pub joint: Vec<String>,
}

/// A robot, with warnings for the user.
#[derive(Debug, Clone)]
pub struct LoadedRobot {
    /// The robot, with links and joints in the order of the file.
    pub robot: Robot,
    /// The SRDF of the options. Its warnings are in `warnings`.
    pub srdf: Option<Srdf>,
    /// Warnings about the URDF, its meshes and the SRDF.
    pub warnings: Vec<Diagnostic>,
}

/// Loads a robot: a URDF with its collision meshes, or a 3DS, glTF or VRML model.
///
/// The content decides the format, then the extension. The options say whether to load the visual meshes of a URDF, and
/// an SRDF.
///
/// Each object of a mesh file becomes one collider. A mesh file is read once, however many links use it. The unit of a
/// COLLADA mesh is applied; its up axis is ignored, as in rviz and `MoveIt`.
///
/// Every node of a 3DS, glTF or VRML model becomes a link. Joints are inferred from tracks that rotate or translate a node, or
/// specified by [`LoadOptions::joints`] or [`LoadOptions::joint`]; all other nodes are fixed. A model without joints
/// gives a warning with a template of a joints file.
///
/// # Errors
/// [`Diagnostic`] for an invalid model, joints file or SRDF, and for every collision mesh that is missing or cannot be
/// read. Visual meshes only give warnings.
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
/// assert_eq!(loaded.robot.colliders[1].len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load(path: &Path, options: &LoadOptions) -> Result<LoadedRobot, Diagnostic> {
    let bytes = input::read(path)?;
    let (mut robot, mut warnings) = match tree_format(&bytes, path) {
        Some(format) => load_tree(&bytes, format, path, options)?,
        None => load_urdf(&bytes, path, options)?,
    };
    let srdf = options.srdf.as_ref().map(|file| disable_pairs(&mut robot, file, &mut warnings)).transpose()?;
    Ok(LoadedRobot { robot, srdf, warnings: warnings.finish(path) })
}

/// Adds the disabled pairs of an SRDF to a robot, and returns warnings.
///
/// # Errors
/// [`Diagnostic`] if the file cannot be read or is not an SRDF.
pub fn apply_srdf(robot: &mut Robot, path: &Path) -> Result<Vec<Diagnostic>, Diagnostic> {
    let mut warnings = WarningList::default();
    disable_pairs(robot, path, &mut warnings)?;
    Ok(warnings.finish(path))
}

/// The format of a file that [`load`] reads as a 3DS, glTF or VRML model; `None` for other files.
pub fn tree_format(bytes: &[u8], file: &Path) -> Option<MeshFormat> {
    let head = bytes[..bytes.len().min(64)].trim_ascii_start();
    if head.starts_with(b"<") {
        return None;
    }
    mesh::detect(bytes, file).ok().filter(|f| matches!(f, MeshFormat::Tds | MeshFormat::Gltf | MeshFormat::Vrml))
}

/// Parses the nodes of a 3DS, glTF or VRML model, in metres.
///
/// # Errors
/// The errors of [`tds::parse`], [`gltf::parse_tree`] and [`vrml::parse_tree`].
pub fn parse_tree(
    bytes: &[u8],
    format: MeshFormat,
    file: &Path,
    unit: Option<LengthUnit>,
) -> Result<NodeTree, Diagnostic> {
    let mut tree = match format {
        MeshFormat::Tds => tds::parse(bytes, file)?,
        MeshFormat::Vrml => vrml::parse_tree(bytes, file)?,
        _ => gltf::parse_tree(bytes, file)?,
    };
    let Some(unit) = unit else { return Ok(tree) };
    if format.states_its_unit() {
        let what = format!("states its own unit; the unit {} asked for is not applied", unit.symbol());
        tree.warnings.push(Diagnostic::new(file, None, what));
    } else {
        tree.scale(unit.to_metres(1.0));
    }
    tree.check_finite(file)?;
    Ok(tree)
}

fn load_tree(
    bytes: &[u8],
    format: MeshFormat,
    path: &Path,
    options: &LoadOptions,
) -> Result<(Robot, WarningList), Diagnostic> {
    let mut tree = parse_tree(bytes, format, path, options.unit)?;
    let mut warnings = WarningList::default();
    warnings.extend(std::mem::take(&mut tree.warnings));
    let default_path = joints::default_path(path);
    let mut specs = match &options.joints {
        Some(file) => joints::load(file)?,
        None if default_path.is_file() => joints::load(&default_path)?,
        None => Vec::new(),
    };
    let more: Vec<_> = options.joint.iter().map(|text| joints::parse_option(text)).collect::<Result<_, _>>()?;
    specs.retain(|s| !more.iter().any(|m| m.node == s.node));
    specs.extend(more);
    if let Some(w) = mesh::unit_warning(tree.aabb().extent()).filter(|_| !format.states_its_unit()) {
        warnings.push(Diagnostic { file: path.to_owned(), ..w });
    }
    let robot = from_tree::robot(tree, &specs, path, &default_path, &mut warnings)?;
    Ok((robot, warnings))
}

fn load_urdf(bytes: &[u8], urdf_path: &Path, options: &LoadOptions) -> Result<(Robot, WarningList), Diagnostic> {
    if options.joints.is_some() || !options.joint.is_empty() {
        return Err(Diagnostic::new(urdf_path, None, "is a URDF, which has its own joints")
            .hint("leave the joints out, or name a 3DS, glTF or VRML model"));
    }
    let model = urdf::parse(bytes, urdf_path)?;
    let mut robot = Robot::new(chain(&model, urdf_path)?);
    let base = urdf_path.parent().unwrap_or(Path::new(""));
    let wanted = model.links.iter().flat_map(|l| l.collisions.iter().chain(visuals_to_load(l, options)));
    let mut loader = Loader {
        urdf_path,
        meshes: MeshCache::load(wanted, base, options.unit),
        warnings: WarningList::default(),
        largest: 0.0,
    };
    loader.warnings.extend(model.warnings.clone());
    for (i, link) in model.links.iter().enumerate() {
        for solid in &link.collisions {
            robot.colliders[i].extend(loader.colliders(solid)?);
        }
        for solid in visuals_to_load(link, options) {
            match loader.colliders(solid) {
                Ok(colliders) => robot.visuals[i].extend(colliders),
                Err(e) => loader.warnings.push(e),
            }
        }
    }
    loader.check_units(&model);
    Ok((robot, loader.warnings))
}

fn visuals_to_load<'a>(link: &'a urdf::UrdfLink, options: &LoadOptions) -> &'a [LinkGeometry] {
    if options.load_visuals { &link.visuals } else { &[] }
}

/// Converts a model to a chain; links and joints keep their order.
///
/// # Errors
/// The errors of [`Chain::new`] beyond the checks of [`urdf::parse`], with the line of the joint or link that the message
/// names.
pub fn chain(model: &UrdfModel, file: &Path) -> Result<Chain, Diagnostic> {
    let links = model.links.iter().map(|l| l.name.clone()).collect();
    let joint = |j: &urdf::UrdfJoint| kinematics::Joint {
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
        Diagnostic::new(file, line, message)
    })
}

struct Loader<'a> {
    urdf_path: &'a Path,
    meshes: MeshCache,
    warnings: WarningList,
    /// The largest extent of any collider, metres.
    largest: f64,
}

impl Loader<'_> {
    fn colliders(&mut self, solid: &LinkGeometry) -> Result<Vec<Collider>, Diagnostic> {
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
            Geometry::Mesh { filename, scale } => return self.mesh_colliders(solid, filename, *scale),
        };
        shape.validate().map_err(|e| Diagnostic::new(self.urdf_path, solid.line, e))?;
        self.note_extent(shape.aabb(&Pose::IDENTITY).extent(), solid);
        Ok(vec![Collider {
            name: name.unwrap_or_else(|| kind(&solid.geometry).to_owned()),
            shape,
            in_link: solid.in_link,
        }])
    }

    fn mesh_colliders(
        &mut self,
        solid: &LinkGeometry,
        filename: &str,
        scale: Vec3,
    ) -> Result<Vec<Collider>, Diagnostic> {
        let path = self.meshes.path(filename).map(Path::to_owned).map_err(|why| {
            Diagnostic::new(self.urdf_path, solid.line, format!("the mesh `{filename}` is not found: {why}"))
                .hint("a path relative to the URDF, or package://NAME/… with a directory NAME beside the URDF or above")
        })?;
        let (solids, warnings) = self.meshes.meshes(&path, scale).map_err(|mut e| {
            e.message = format!("{} (named in {}:{})", e.message, self.urdf_path.display(), solid.line);
            e
        })?;
        self.warnings.extend(warnings);
        let extent = solids.iter().fold(elbowroom_spatial::Aabb::EMPTY, |all, (_, m)| all.union(m.aabb())).extent();
        self.note_extent(extent, solid);
        let stem = solid.name.clone().unwrap_or_else(|| input::stem(&path));
        let many = solids.len() > 1;
        let collider = |(object, mesh): &(String, Arc<TriMesh>)| Collider {
            name: if many { format!("{stem}:{object}") } else { stem.clone() },
            shape: Shape::Mesh(Arc::clone(mesh)),
            in_link: solid.in_link,
        };
        Ok(solids.iter().map(collider).collect())
    }

    fn note_extent(&mut self, extent: Vec3, solid: &LinkGeometry) {
        let largest = extent.max_element();
        self.largest = self.largest.max(largest);
        if let Some(warning) = mesh::unit_warning(extent).filter(|_| largest > 20.0) {
            self.warnings.push(Diagnostic { file: self.urdf_path.to_owned(), line: Some(solid.line), ..warning });
        }
    }

    /// Warns about a robot whose parts are all tiny, and about joints more than 20 m from their parent.
    fn check_units(&mut self, model: &UrdfModel) {
        let is_tiny = self.largest > 0.0 && self.largest < 1.0;
        if let Some(warning) = mesh::unit_warning(Vec3::splat(self.largest)).filter(|_| is_tiny) {
            self.warnings.push(Diagnostic { file: self.urdf_path.to_owned(), ..warning });
        }
        if let Some(far) = model.joints.iter().find(|j| j.origin.translation.length() > 20.0) {
            let metres = far.origin.translation.length();
            let what = format!("the joint `{}` is {metres:.4} m away from its parent: are these metres?", far.name);
            self.warnings.push(Diagnostic::new(self.urdf_path, far.line, what).hint("<origin xyz=\"…\"/> in metres"));
        }
    }
}

fn disable_pairs(robot: &mut Robot, path: &Path, warnings: &mut WarningList) -> Result<Srdf, Diagnostic> {
    let mut srdf = srdf::parse(&input::read(path)?, path)?;
    warnings.extend(std::mem::take(&mut srdf.warnings));
    if let Some(name) = srdf.robot.as_ref().filter(|name| *name != robot.chain.name()) {
        let what = format!("is for the robot `{name}`, but the URDF describes `{}`", robot.chain.name());
        warnings.push(Diagnostic::new(path, None, what).hint("the same name in both files"));
    }
    for pair in &srdf.disabled {
        let mut link = |name: &str| {
            let found = robot.chain.link(name);
            if found.is_none() {
                warnings.push_with(|| {
                    Diagnostic::new(
                        path,
                        pair.line,
                        format!("there is no link `{name}` in the URDF; the pair is ignored"),
                    )
                    .hint("the name of a link, or remove the line")
                });
            }
            found
        };
        let (Some(a), Some(b)) = (link(&pair.link1), link(&pair.link2)) else { continue };
        if a == b {
            let what = format!("the link `{}` is paired with itself; the pair is ignored", pair.link1);
            warnings.push_with(|| Diagnostic::new(path, pair.line, what).hint("two different links"));
            continue;
        }
        robot.disabled_pairs.push((a, b, pair.reason.clone()));
    }
    Ok(srdf)
}
