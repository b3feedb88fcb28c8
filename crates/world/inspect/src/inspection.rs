//! Inspection of a model: its contents as one document.

use std::path::{Path, PathBuf};

use elbowroom_formats::srdf::Srdf;
use elbowroom_formats::{Diagnostic, mesh, robot};
use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Vec3};
use serde::Serialize;

use crate::dh::DhConvention;
use crate::dh_tables::DhTables;
use crate::enclosing_volume::{self, EnclosingVolume};
use crate::pairs::{self, PairRow};
use crate::pose_solutions::PoseSolutions;
use crate::resolution_levels::{self, LinkLevels};
use crate::rows::{JointRow, MeshRow, joint_row, mesh_row, mesh_rows};
use crate::surface_point::SurfacePoint;
use crate::units::{self, SuspectUnit, suspect_units};

/// Options of an inspection.
#[derive(Debug, Clone, Default)]
pub struct InspectOptions {
    /// SRDF file for a URDF.
    pub srdf: Option<PathBuf>,
    /// Unit for formats that state none.
    pub unit: Option<LengthUnit>,
    /// Joints file of a 3DS, glTF or VRML model. Default: the file beside the model.
    pub joints: Option<PathBuf>,
    /// Further joints of a 3DS, glTF or VRML model, in the syntax of the command line.
    pub joint: Vec<String>,
    /// Last link of the DH table. Default: the leaf with the most independent joints.
    pub tip: Option<String>,
    /// DH tables in the text output, in this order. Empty: the generalized table. JSON has all tables.
    pub dh: Vec<DhConvention>,
    /// Whether to omit slow results: resolution levels, pairs, and visual meshes.
    pub brief: bool,
}

/// Kind of content of a model file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelKind {
    /// A robot with links and joints.
    Robot,
    /// Objects of triangles.
    Mesh,
}

/// Contents of a model. Lengths in metres, angles in radians; unlimited or unknown values are `null` in JSON.
#[derive(Debug, Clone, Serialize)]
pub struct Inspection {
    /// Path of the file.
    pub model: PathBuf,
    /// Name of the model.
    pub name: String,
    /// Whether the model is a robot or a mesh.
    #[serde(rename = "what")]
    pub kind: ModelKind,
    /// Names of the links; for a mesh file, names of its objects.
    pub links: Vec<String>,
    /// The joints, including fixed ones.
    pub joints: Vec<JointRow>,
    /// Number of degrees of freedom.
    pub dof: usize,
    /// One entry per collision mesh.
    pub meshes: Vec<MeshRow>,
    /// Number of link pairs that the SRDF disables.
    pub disabled_pairs: usize,
    /// The DH tables of the chain to the tip.
    #[serde(flatten)]
    pub dh: DhTables,
    /// Resolution level L2: the enclosing volume of each solid for whole-arm guarding.
    pub levels: Vec<EnclosingVolume>,
    /// The levels of each link, including coarse, middle and fine triangles. Empty if omitted.
    pub resolution: Vec<LinkLevels>,
    /// The allowed collision matrix, one entry per pair of links with colliders. Empty for a mesh, and if omitted.
    pub pairs: Vec<PairRow>,
    /// Suspected unit errors.
    pub suspect_units: Vec<SuspectUnit>,
    /// Warnings.
    pub warnings: Vec<String>,
    #[serde(skip)]
    source: Source,
}

/// What a file contains.
#[derive(Debug, Clone)]
enum Source {
    Robot {
        robot: Box<Robot>,
        /// The SRDF of the options.
        srdf: Option<Srdf>,
    },
    Mesh {
        solids: Vec<(String, Vec<Collider>)>,
    },
}

impl Inspection {
    /// Inspects a URDF, a 3DS, glTF or VRML model, or a mesh file.
    ///
    /// Files with the extension `urdf`, `xacro` or `xml` count as robots; for other files the content decides.
    ///
    /// # Errors
    /// [`Diagnostic`] if the file or one of its collision meshes cannot be read, or if the link `tip` does not exist.
    pub fn of(path: &Path, options: &InspectOptions) -> Result<Self, Diagnostic> {
        if is_mesh(path) { Self::of_mesh(path, options) } else { Self::of_robot(path, options) }
    }

    fn of_robot(path: &Path, options: &InspectOptions) -> Result<Self, Diagnostic> {
        let load = robot::LoadOptions {
            srdf: options.srdf.clone(),
            load_visuals: !options.brief,
            unit: options.unit,
            joints: options.joints.clone(),
            joint: options.joint.clone(),
        };
        let loaded = robot::load(path, &load)?;
        let chain = &loaded.robot.chain;
        let tip = tip(chain, path, options.tip.as_deref())?;
        let mut inspection = Self::empty(path, chain.name(), ModelKind::Robot, &loaded.warnings);
        inspection.links = chain.links().to_vec();
        inspection.joints = chain.joints().iter().map(|j| joint_row(chain, j)).collect();
        inspection.dof = chain.dof();
        inspection.meshes = mesh_rows(&loaded.robot);
        inspection.disabled_pairs = loaded.robot.disabled_pairs.len();
        inspection.dh = DhTables::of(chain, tip, &options.dh);
        inspection.add_suspect_units(suspect_units(&loaded.robot));
        inspection.warn_of_meshes();
        if !options.brief {
            inspection.levels = enclosing_volume::of_robot(&loaded.robot);
            let links = chain.links().iter().cloned().zip(loaded.robot.colliders.iter().cloned());
            inspection.resolution = resolution_levels::of_links(&links.collect::<Vec<_>>());
            inspection.pairs = pairs::of_robot(path, &loaded.robot)?;
            inspection.warn_of_pairs();
        }
        inspection.source = Source::Robot { robot: loaded.robot.into(), srdf: loaded.srdf };
        Ok(inspection)
    }

    fn of_mesh(path: &Path, options: &InspectOptions) -> Result<Self, Diagnostic> {
        if options.tip.is_some() || options.srdf.is_some() {
            return Err(Diagnostic::new(path, None, "is a mesh: it has no links for --tip or --srdf")
                .hint("a URDF or a 3DS, glTF or VRML model, or leave these options out"));
        }
        let loaded = mesh::load(path, options.unit)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut inspection = Self::empty(path, &stem, ModelKind::Mesh, &loaded.warnings);
        let format = std::fs::read(path).ok().and_then(|bytes| mesh::detect(&bytes, path).ok());
        let mut solids = Vec::new();
        for object in loaded.meshes {
            let name = object.name.clone();
            let solid = object.into_trimesh(path)?;
            inspection.meshes.push(mesh_row(&name, &name, &solid));
            inspection.add_suspect_units(units::of_mesh(&name, solid.aabb().extent(), format));
            let collider = Collider { name: name.clone(), shape: Shape::Mesh(solid.into()), in_link: Pose::IDENTITY };
            solids.push((name.clone(), vec![collider]));
            inspection.links.push(name);
        }
        if !options.brief {
            inspection.levels = solids.iter().map(|(name, s)| enclosing_volume::of_solid(name, &s[0].shape)).collect();
            inspection.resolution = resolution_levels::of_links(&solids);
        }
        inspection.source = Source::Mesh { solids };
        inspection.warn_of_meshes();
        Ok(inspection)
    }

    fn empty(path: &Path, name: &str, kind: ModelKind, warnings: &[Diagnostic]) -> Self {
        Self {
            model: path.to_owned(),
            name: name.to_owned(),
            kind,
            links: vec![],
            joints: vec![],
            dof: 0,
            meshes: vec![],
            disabled_pairs: 0,
            dh: DhTables::default(),
            levels: vec![],
            resolution: vec![],
            pairs: vec![],
            suspect_units: vec![],
            warnings: warnings.iter().map(ToString::to_string).collect(),
            source: Source::Mesh { solids: vec![] },
        }
    }

    fn add_suspect_units(&mut self, suspects: impl IntoIterator<Item = SuspectUnit>) {
        for suspect in suspects {
            self.warnings.push(suspect.reason.clone());
            self.suspect_units.push(suspect);
        }
    }

    /// Warns about pairs that collide in every sampled state, or at rest.
    fn warn_of_pairs(&mut self) {
        for p in self.pairs.iter().filter(|p| p.tested && (p.always || p.at_rest)) {
            let often = match &p.suggestion {
                Some(reason) if p.at_rest => format!("are {reason}: a query at rest answers collision"),
                _ => "touch in every sampled state: every query answers collision".to_owned(),
            };
            let hint = format!(
                "<disable_collisions link1=\"{}\" link2=\"{}\" reason=\"Default\"/> in an SRDF, and --srdf FILE, if \
                 they are built so",
                p.a, p.b
            );
            self.warnings.push(format!("links `{}` and `{}` {often}\n  write: {hint}", p.a, p.b));
        }
    }

    /// Warns about faults of meshes.
    fn warn_of_meshes(&mut self) {
        for m in &self.meshes {
            if m.inside_out {
                self.warnings.push(format!("`{}`: its faces are oriented inwards", m.name));
            }
            if m.degenerate > 0 {
                self.warnings.push(format!("`{}`: {} faces have no area", m.name, m.degenerate));
            }
        }
        let open = self.meshes.iter().filter(|m| !m.closed).count();
        if open > 0 {
            let all = self.meshes.len();
            self.warnings.push(format!("{open} of {all} meshes are open: containment in them is not detected"));
        }
    }

    /// The text of an SRDF for the robot: pairs that need no test, with reasons.
    ///
    /// `None` for a mesh, or if [`pairs`](Self::pairs) is empty.
    pub fn srdf(&self) -> Option<String> {
        let Source::Robot { srdf, .. } = &self.source else { return None };
        let given = srdf.clone().unwrap_or_default();
        (!self.pairs.is_empty()).then(|| pairs::srdf(&self.name, &self.pairs, given))
    }

    /// The robot, if the model is one.
    pub fn robot(&self) -> Option<&Robot> {
        match &self.source {
            Source::Robot { robot, .. } => Some(robot),
            Source::Mesh { .. } => None,
        }
    }

    /// All joint values with which a link (the tip if `None`) is at a pose in the root link: x, y, z (m), roll, pitch, yaw
    /// (rad).
    ///
    /// # Errors
    /// [`Diagnostic`] if the model is a mesh or has no such link.
    pub fn pose_solutions(&self, link: Option<&str>, pose: [f64; 6]) -> Result<PoseSolutions, Diagnostic> {
        let chain = &self.need_robot("a pose")?.chain;
        Ok(PoseSolutions::of(chain, tip(chain, &self.model, link)?, pose))
    }

    /// The chain that ends in a point (m) of a link, in the link's frame. The text shows its tables of these conventions.
    ///
    /// # Errors
    /// [`Diagnostic`] if the model is a mesh, has no such link, or the point is not finite.
    pub fn surface_point(&self, link: &str, point: Vec3, dh: &[DhConvention]) -> Result<SurfacePoint, Diagnostic> {
        let robot = self.need_robot("a point of a link")?;
        let link = tip(&robot.chain, &self.model, Some(link))?;
        SurfacePoint::of(robot, link, point, dh).map_err(|e| Diagnostic::new(&self.model, None, e))
    }

    fn need_robot(&self, what: &str) -> Result<&Robot, Diagnostic> {
        self.robot().ok_or_else(|| {
            Diagnostic::new(&self.model, None, format!("is a mesh: it has no joints for {what}")).hint("a robot")
        })
    }

    /// The objects of a mesh file, with their names.
    pub fn solids(&self) -> &[(String, Vec<Collider>)] {
        match &self.source {
            Source::Robot { .. } => &[],
            Source::Mesh { solids } => solids,
        }
    }
}

/// Writes the text of an SRDF for a robot: pairs that need no test, with reasons, and the groups and states of `given`.
///
/// # Errors
/// [`Diagnostic`] with `file` if a scene refuses the robot.
pub fn srdf(file: &Path, robot: &Robot, given: Srdf) -> Result<String, Diagnostic> {
    Ok(pairs::srdf(robot.chain.name(), &pairs::of_robot(file, robot)?, given))
}

/// True for all files except a URDF, and a 3DS, glTF or VRML file that is a robot.
///
/// A URDF has the root `robot` in its first 4096 bytes, or its extension.
fn is_mesh(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if matches!(extension.as_deref(), Some("urdf" | "xacro" | "xml")) {
        return false;
    }
    let bytes = std::fs::read(path).unwrap_or_default();
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]).into_owned();
    !(head.contains("<robot ") || head.contains("<robot>") || is_robot_tree(&bytes, path))
}

/// True for a node tree that is a robot; false for a whole scene.
fn is_robot_tree(bytes: &[u8], path: &Path) -> bool {
    robot::tree_format(bytes, path).is_some_and(|format| {
        robot::parse_tree(bytes, format, path, None).is_ok_and(|t| t.nodes.len() <= robot::MAX_LINKS)
    })
}

fn tip(chain: &Chain, path: &Path, name: Option<&str>) -> Result<LinkId, Diagnostic> {
    let Some(name) = name else { return Ok(chain.tip()) };
    chain.link(name).ok_or_else(|| {
        Diagnostic::new(path, None, format!("there is no link `{name}`"))
            .hint(format!("one of {}", chain.links().join(", ")))
    })
}
