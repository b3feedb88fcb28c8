//! What is in a model: joints and limits, meshes and their faults, the generalized DH table, resolution levels.

mod levels;
mod table;

use std::path::{Path, PathBuf};

use elbowroom_formats::{FormatError, Warning, mesh, robot};
use elbowroom_kinematics::dh::Table;
use elbowroom_kinematics::{Chain, JointKind, LinkId};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_scene::Robot;
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Vec3};
use serde::Serialize;

pub use levels::Level2;

/// How to look at a model.
#[derive(Debug, Clone, Default)]
pub struct InspectOptions {
    /// An SRDF that belongs to a URDF.
    pub srdf: Option<PathBuf>,
    /// The unit of formats that state none.
    pub unit: Option<LengthUnit>,
    /// The link that the DH table ends at; default: the leaf with the most independent joints above it.
    pub tip: Option<String>,
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
    /// Resolution level L2: the volume that stands for each solid when the whole arm is guarded.
    pub levels: Vec<Level2>,
    /// What the user should know.
    pub warnings: Vec<String>,
    #[serde(skip)]
    robot: Option<Robot>,
}

/// A joint.
#[derive(Debug, Clone, Serialize)]
pub struct JointRow {
    /// Its name.
    pub name: String,
    /// `fixed`, `revolute`, `continuous` or `prismatic`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Parent link.
    pub parent: String,
    /// Child link.
    pub child: String,
    /// Lower limit, rad or m.
    pub lower: Option<f64>,
    /// Upper limit, rad or m.
    pub upper: Option<f64>,
    /// Largest speed, rad/s or m/s.
    pub velocity: Option<f64>,
    /// The joint that it follows.
    pub mimic: Option<String>,
}

/// A solid of triangles.
#[derive(Debug, Clone, Serialize)]
pub struct MeshRow {
    /// Its link; of a mesh file, its object.
    pub link: String,
    /// The object's name.
    pub name: String,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of distinct vertices.
    pub vertices: usize,
    /// True where every edge is shared by two faces of opposite direction.
    pub closed: bool,
    /// Faces without area.
    pub degenerate: usize,
    /// Faces that are there twice.
    pub duplicate: usize,
    /// True where a closed mesh has its faces turned inwards.
    pub inside_out: bool,
    /// Edge lengths of its box, in its own frame.
    pub extent_m: [f64; 3],
}

/// A row of the generalized DH table.
#[derive(Debug, Clone, Serialize)]
pub struct DhRow {
    /// The joint whose value is added to θ (turning) or d (sliding); null in fixed and auxiliary rows.
    pub joint: Option<String>,
    /// Turn about z, rad.
    pub theta: f64,
    /// Along x, m.
    pub a: f64,
    /// Along y, m.
    pub b: f64,
    /// Along z, m.
    pub d: f64,
    /// Turn about x, rad.
    pub alpha: f64,
}

impl Inspection {
    /// Looks at a URDF or a mesh file, by content.
    ///
    /// # Errors
    /// [`FormatError`] where the file, or a collision mesh it names, cannot be read; or there is no link `tip`.
    pub fn of(path: &Path, options: &InspectOptions) -> Result<Self, FormatError> {
        if is_mesh(path) { Self::of_mesh(path, options) } else { Self::of_robot(path, options) }
    }

    fn of_robot(path: &Path, options: &InspectOptions) -> Result<Self, FormatError> {
        let load = robot::LoadOptions { srdf: options.srdf.clone(), load_visuals: true, unit: options.unit };
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
        inspection.dh = table.rows.iter().map(dh_row).collect();
        inspection.dh_residual = Some(table.residual);
        inspection.levels = levels::of_robot(&loaded.robot);
        inspection.doubt_meshes();
        inspection.robot = Some(loaded.robot);
        Ok(inspection)
    }

    fn of_mesh(path: &Path, options: &InspectOptions) -> Result<Self, FormatError> {
        if options.tip.is_some() || options.srdf.is_some() {
            return Err(FormatError::new(path, None, "is a mesh: it has no links for --tip or --srdf")
                .hint("a URDF, or leave these options out"));
        }
        let loaded = mesh::load(path, options.unit)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut inspection = Self::empty(path, &stem, "mesh", &loaded.warnings);
        for object in loaded.meshes {
            let name = object.name.clone();
            let solid = object.into_trimesh(path)?;
            inspection.meshes.push(mesh_row(&name, &name, &solid));
            inspection.levels.push(levels::of_solid(&name, &Shape::Mesh(solid.into())));
            inspection.links.push(name);
        }
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
            levels: vec![],
            warnings: warnings.iter().map(ToString::to_string).collect(),
            robot: None,
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

/// Everything but URDF: a robot description is XML whose root is `robot`, or claims to be by its name.
fn is_mesh(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if matches!(extension.as_deref(), Some("urdf" | "xacro" | "xml")) {
        return false;
    }
    let head = std::fs::read(path).unwrap_or_default();
    let head = String::from_utf8_lossy(&head[..head.len().min(4096)]).into_owned();
    !(head.contains("<robot ") || head.contains("<robot>"))
}

fn tip(chain: &Chain, path: &Path, name: Option<&str>) -> Result<LinkId, FormatError> {
    let Some(name) = name else { return Ok(chain.tip()) };
    chain.link(name).ok_or_else(|| {
        FormatError::new(path, None, format!("there is no link `{name}`"))
            .hint(format!("--tip with one of {}", chain.links().join(", ")))
    })
}

fn joint_row(chain: &Chain, joint: &elbowroom_kinematics::Joint) -> JointRow {
    let bound = |v: f64| (v.is_finite() && joint.kind.moves() && joint.kind != JointKind::Continuous).then_some(v);
    JointRow {
        name: joint.name.clone(),
        kind: kind_name(joint.kind),
        parent: chain.links()[joint.parent.0].clone(),
        child: chain.links()[joint.child.0].clone(),
        lower: bound(joint.limits.lower),
        upper: bound(joint.limits.upper),
        velocity: joint.limits.velocity,
        mimic: joint.mimic.as_ref().map(|m| chain.joints()[m.joint.0].name.clone()),
    }
}

fn kind_name(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Fixed => "fixed",
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
    }
}

fn dh_row(row: &elbowroom_kinematics::dh::Row) -> DhRow {
    DhRow { joint: row.joint.clone(), theta: row.theta, a: row.a, b: row.b, d: row.d, alpha: row.alpha }
}

fn mesh_rows(robot: &Robot) -> Vec<MeshRow> {
    let bodies = robot.chain.links().iter().zip(&robot.bodies);
    let row = |link: &String, body: &elbowroom_scene::Body| match &body.shape {
        Shape::Mesh(solid) => Some(mesh_row(link, &body.name, solid)),
        _ => None,
    };
    bodies.flat_map(|(link, bodies)| bodies.iter().filter_map(|b| row(link, b)).collect::<Vec<_>>()).collect()
}

fn mesh_row(link: &str, name: &str, solid: &TriMesh) -> MeshRow {
    let report = solid.report();
    let extent: Vec3 = Shape::Mesh(solid.clone().into()).aabb(&Pose::IDENTITY).extent();
    MeshRow {
        link: link.to_owned(),
        name: name.to_owned(),
        triangles: report.triangles,
        vertices: report.vertices,
        closed: report.closed,
        degenerate: report.degenerate,
        duplicate: report.duplicate,
        inside_out: report.inside_out,
        extent_m: extent.to_array(),
    }
}
