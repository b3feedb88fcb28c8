//! What is in a model: joints and limits, meshes and their faults, DH tables, resolution levels.

mod deviation;
mod dh;
mod edges;
mod levels;
mod pairs;
mod picture;
mod quadric;
mod resolution;
mod rows;
mod simplify;
mod table;
mod units;

use std::path::{Path, PathBuf};

use elbowroom_formats::{FormatError, Warning, mesh, robot};
use elbowroom_kinematics::dh::Table;
use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_scene::{Body, Robot};
use elbowroom_spatial::Pose;
use elbowroom_spatial::units::LengthUnit;
use serde::Serialize;

pub use dh::{ClassicalDh, DhConvention, DhRow, DhRow4, DirectDh, DirectRow, ModifiedDh};
pub use levels::Level2;
pub use pairs::PairRow;
pub use resolution::{BoxRow, CapsuleRow, HullRow, LinkLevels, ObbRow, TrianglesRow};
pub use rows::{JointRow, MeshRow};
pub use units::{UnitDoubt, unit_doubts};

use crate::resting;
use rows::{joint_row, mesh_row, mesh_rows};

/// How to look at a model.
#[derive(Debug, Clone, Default)]
pub struct InspectOptions {
    /// An SRDF that belongs to a URDF.
    pub srdf: Option<PathBuf>,
    /// The unit of formats that state none.
    pub unit: Option<LengthUnit>,
    /// The file of joints of a 3DS or glTF model; default: the one beside it.
    pub joints: Option<PathBuf>,
    /// More joints of such a model, as on the command line.
    pub joint: Vec<String>,
    /// The link that the DH table ends at; default: the leaf with the most independent joints above it.
    pub tip: Option<String>,
    /// The DH tables of the text for people, in this order; empty: the generalized one. JSON has them all.
    pub dh: Vec<DhConvention>,
    /// Leave out what takes time: resolution levels, pairs, and what is only looked at.
    pub brief: bool,
}

/// What is in a model. Lengths are metres, angles radians; what is unlimited or unknown is `null` in JSON.
///
/// ```
/// use elbowroom_cell::inspect::{InspectOptions, Inspection};
/// # let dir = tempfile::tempdir()?;
/// # let path = dir.path().join("slide.urdf");
/// # std::fs::write(&path, r#"<robot name="slide"><link name="rail"/><link name="cart"/>
/// #   <joint name="x" type="prismatic"><parent link="rail"/><child link="cart"/>
/// #   <limit lower="0" upper="2" velocity="1" effort="0"/></joint></robot>"#)?;
/// let inspection = Inspection::of(&path, &InspectOptions::default())?;
/// assert_eq!(inspection.links, ["rail", "cart"]);
/// assert!(inspection.dh_residual.unwrap() < 1e-12);
/// println!("{inspection}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct Inspection {
    /// The file.
    pub model: PathBuf,
    /// The model's name.
    pub name: String,
    /// `robot` or `mesh`.
    pub what: &'static str,
    /// Names of the links; of a mesh file, of its objects.
    pub links: Vec<String>,
    /// The joints, fixed ones included.
    pub joints: Vec<JointRow>,
    /// Degrees of freedom.
    pub dof: usize,
    /// One entry per object that counts for collision.
    pub meshes: Vec<MeshRow>,
    /// Link pairs that the SRDF disables.
    pub disabled_pairs: usize,
    /// The link that the table ends at; null for a mesh.
    pub dh_tip: Option<String>,
    /// The generalized DH table `T = Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)`.
    pub dh: Vec<DhRow>,
    /// Largest difference between the product of the rows and forward kinematics; null for a mesh.
    pub dh_residual: Option<f64>,
    /// The table in the classical convention, where all b are 0; null for a mesh.
    pub dh_classical: Option<ClassicalDh>,
    /// The table in the modified convention (Craig); null for a mesh.
    pub dh_modified: Option<ModifiedDh>,
    /// The table with a row for each frame of the model; null for a mesh.
    pub dh_direct: Option<DirectDh>,
    /// Resolution level L2: the volume that stands for each solid when the whole arm is guarded.
    pub levels: Vec<Level2>,
    /// The same levels and more, per link, with coarse, middle and fine triangles. Empty where they were left out.
    pub resolution: Vec<LinkLevels>,
    /// The pair matrix, an entry per pair of links with solids. Empty for a mesh, and where it was left out.
    pub pairs: Vec<PairRow>,
    /// Units suspected wrong.
    pub unit_doubts: Vec<UnitDoubt>,
    /// What the user should know.
    pub warnings: Vec<String>,
    #[serde(skip)]
    dh_shown: Vec<DhConvention>,
    #[serde(skip)]
    robot: Option<Robot>,
    /// The objects of a mesh file.
    #[serde(skip)]
    solids: Vec<(String, Vec<Body>)>,
}

impl Inspection {
    /// Looks at a URDF, a 3DS or glTF model, or a mesh file, by content.
    ///
    /// # Errors
    /// [`FormatError`] where the file, or a collision mesh it names, cannot be read; or there is no link `tip`.
    pub fn of(path: &Path, options: &InspectOptions) -> Result<Self, FormatError> {
        if is_mesh(path) { Self::of_mesh(path, options) } else { Self::of_robot(path, options) }
    }

    fn of_robot(path: &Path, options: &InspectOptions) -> Result<Self, FormatError> {
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
        let table = Table::extract(chain, tip);
        let mut inspection = Self::empty(path, chain.name(), "robot", &loaded.warnings);
        inspection.links = chain.links().to_vec();
        inspection.joints = chain.joints().iter().map(|j| joint_row(chain, j)).collect();
        inspection.dof = chain.dof();
        inspection.meshes = mesh_rows(&loaded.robot);
        inspection.disabled_pairs = loaded.robot.disabled_pairs.len();
        inspection.dh_tip = Some(chain.links()[tip.0].clone());
        inspection.dh = dh::generalized(&table);
        inspection.dh_residual = Some(table.residual);
        inspection.dh_classical = Some(ClassicalDh::of(&table));
        inspection.dh_modified = Some(ModifiedDh::of(chain, tip));
        inspection.dh_direct = Some(DirectDh::of(chain, tip));
        if !options.dh.is_empty() {
            inspection.dh_shown.clone_from(&options.dh);
        }
        inspection.doubt_units(unit_doubts(&loaded.robot));
        inspection.doubt_meshes();
        if !options.brief {
            inspection.levels = levels::of_robot(&loaded.robot);
            let links = chain.links().iter().cloned().zip(loaded.robot.bodies.iter().cloned());
            inspection.resolution = resolution::of_links(&links.collect::<Vec<_>>());
            inspection.pairs = pairs::of_robot(path, &loaded.robot)?;
            inspection.doubt_pairs();
        }
        inspection.robot = Some(loaded.robot);
        Ok(inspection)
    }

    fn of_mesh(path: &Path, options: &InspectOptions) -> Result<Self, FormatError> {
        if options.tip.is_some() || options.srdf.is_some() {
            return Err(FormatError::new(path, None, "is a mesh: it has no links for --tip or --srdf")
                .hint("a URDF or a 3DS or glTF model, or leave these options out"));
        }
        let loaded = mesh::load(path, options.unit)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut inspection = Self::empty(path, &stem, "mesh", &loaded.warnings);
        let format = std::fs::read(path).ok().and_then(|bytes| mesh::detect(&bytes, path).ok());
        let mut solids = Vec::new();
        for object in loaded.meshes {
            let name = object.name.clone();
            let solid = object.into_trimesh(path)?;
            inspection.meshes.push(mesh_row(&name, &name, &solid));
            inspection.doubt_units(units::of_mesh(&name, solid.aabb().extent(), format));
            let body = Body { name: name.clone(), shape: Shape::Mesh(solid.into()), in_link: Pose::IDENTITY };
            solids.push((name.clone(), vec![body]));
            inspection.links.push(name);
        }
        if !options.brief {
            inspection.levels = solids.iter().map(|(name, s)| levels::of_solid(name, &s[0].shape)).collect();
            inspection.resolution = resolution::of_links(&solids);
        }
        inspection.solids = solids;
        inspection.doubt_meshes();
        Ok(inspection)
    }

    fn empty(path: &Path, name: &str, what: &'static str, warnings: &[Warning]) -> Self {
        Self {
            model: path.to_owned(),
            name: name.to_owned(),
            what,
            links: vec![],
            joints: vec![],
            dof: 0,
            meshes: vec![],
            disabled_pairs: 0,
            dh_tip: None,
            dh: vec![],
            dh_residual: None,
            dh_classical: None,
            dh_modified: None,
            dh_direct: None,
            levels: vec![],
            resolution: vec![],
            pairs: vec![],
            unit_doubts: vec![],
            warnings: warnings.iter().map(ToString::to_string).collect(),
            dh_shown: vec![DhConvention::Generalized],
            robot: None,
            solids: vec![],
        }
    }

    fn doubt_units(&mut self, doubts: impl IntoIterator<Item = UnitDoubt>) {
        for doubt in doubts {
            self.warnings.push(doubt.reason.clone());
            self.unit_doubts.push(doubt);
        }
    }

    /// Pairs that would make every state a collision, or the state at rest.
    fn doubt_pairs(&mut self) {
        for p in self.pairs.iter().filter(|p| p.tested && (p.always || p.at_rest)) {
            let often = match &p.suggestion {
                Some(reason) if p.at_rest => format!("are {reason}: a query at rest answers collision"),
                _ => "touch in every state that was looked at: every query answers collision".to_owned(),
            };
            let hint = resting::disable(&p.a, &p.b, "--srdf FILE");
            self.warnings.push(format!("links `{}` and `{}` {often}\n  write: {hint}", p.a, p.b));
        }
    }

    /// Faults of meshes, in words.
    fn doubt_meshes(&mut self) {
        for m in &self.meshes {
            if m.inside_out {
                self.warnings.push(format!("`{}`: its faces are turned inwards", m.name));
            }
            if m.degenerate > 0 {
                self.warnings.push(format!("`{}`: {} faces have no area", m.name, m.degenerate));
            }
        }
        let open = self.meshes.iter().filter(|m| !m.closed).count();
        if open > 0 {
            let all = self.meshes.len();
            self.warnings.push(format!("{open} of {all} meshes are open: what lies wholly inside them is not noticed"));
        }
    }

    /// The robot, where the model is one.
    pub fn robot(&self) -> Option<&Robot> {
        self.robot.as_ref()
    }
}

/// Everything but URDF, 3DS and glTF: a robot description is XML whose root is `robot`, or claims to be by its name.
fn is_mesh(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if matches!(extension.as_deref(), Some("urdf" | "xacro" | "xml")) {
        return false;
    }
    let bytes = std::fs::read(path).unwrap_or_default();
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]).into_owned();
    !(head.contains("<robot ") || head.contains("<robot>") || is_robot_tree(&bytes, path))
}

/// Not a whole scene, which no robot is.
fn is_robot_tree(bytes: &[u8], path: &Path) -> bool {
    robot::tree_format(bytes, path).is_some_and(|format| {
        robot::parse_tree(bytes, format, path, None).is_ok_and(|t| t.nodes.len() <= robot::MOST_LINKS)
    })
}

fn tip(chain: &Chain, path: &Path, name: Option<&str>) -> Result<LinkId, FormatError> {
    let Some(name) = name else { return Ok(chain.tip()) };
    chain.link(name).ok_or_else(|| {
        FormatError::new(path, None, format!("there is no link `{name}`"))
            .hint(format!("--tip with one of {}", chain.links().join(", ")))
    })
}
