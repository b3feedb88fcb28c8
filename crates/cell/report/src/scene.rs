//! Geometry of the 3-D scene.

use elbowroom_cell::{Cell, CellFixture};
use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_monitor::Volume;
use elbowroom_proximity::{Cylinder, Shape, Sphere, repair::merge_targets, tessellate::tessellate};
use elbowroom_robot::{Collider, ObjectId, Robot, RobotId};
use elbowroom_scene::Object;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::palette;

/// Largest chord error of curved surfaces, m.
pub(crate) const CHORD_ERROR_M: f64 = 1e-3;
/// Levels along the longest side of a shield: smaller details are not drawn.
const SHIELD_LEVELS: f64 = 100.0;
/// Radius of the ball at a point of entry, m, and of the line through it.
const ENTRY_RADIUS_M: f64 = 4e-3;
const SHAFT_RADIUS_M: f64 = 8e-4;
/// Length of the line, from the tip back, m.
const SHAFT_LENGTH_M: f64 = 0.4;

/// Geometry of a cell, as triangles.
#[derive(Debug, Clone, Default)]
pub struct ReportScene {
    /// Title of the page; if empty, the name of the cell in the recording.
    pub title: String,
    /// Robots, in the order of the recording.
    pub robots: Vec<ReportRobot>,
    /// Objects at their initial poses.
    pub objects: Vec<ReportObject>,
    /// Shields of virtual fixtures, and points through which tools enter.
    pub shields: Vec<ReportShield>,
}

/// Geometry of a robot.
#[derive(Debug, Clone)]
pub struct ReportRobot {
    /// Its name in the cell.
    pub name: String,
    /// Pose of the root link.
    pub base_in_world: Pose,
    /// Maps the joint positions of samples to link poses.
    pub chain: Chain,
    /// Meshes per link of the chain, in the link's frame.
    pub link_meshes: Vec<Vec<ReportMesh>>,
    /// Meshes of the tool, in the flange's frame.
    pub tool: Vec<ReportMesh>,
    /// Tool centre point in the flange's frame.
    pub tcp_in_flange: Pose,
    /// The link that carries the tool.
    pub flange: LinkId,
    /// The guarded volumes, whose distances the page shows.
    pub volumes: Vec<Volume>,
    /// The objects that it grips, with the volumes that are guarded while it holds them, each with one of its links.
    pub gripped: Vec<(ObjectId, Volume)>,
    /// The named tools: name, link, and tool centre point in the link. Empty for a robot with one tool.
    pub tools: Vec<(String, LinkId, Pose)>,
}

/// A triangle mesh of one colour.
#[derive(Debug, Clone)]
pub struct ReportMesh {
    /// Vertices, m.
    pub vertices: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Pose of the mesh in the link, or in the flange.
    pub in_link: Pose,
    /// Red, green, blue.
    pub color: [u8; 3],
}

/// An object.
#[derive(Debug, Clone)]
pub struct ReportObject {
    /// Its name in the cell.
    pub name: String,
    /// Its solid.
    pub shape: Shape,
    /// Pose of the solid.
    pub in_world: Pose,
}

/// The shield of a virtual fixture, or a ball at its point of entry.
#[derive(Debug, Clone)]
pub struct ReportShield {
    /// Name of the fixture.
    pub name: String,
    /// Vertices, m.
    pub vertices: Vec<Vec3>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// Pose of the shield.
    pub in_world: Pose,
    /// Whether it is on at the start.
    pub active: bool,
}

impl ReportScene {
    /// An empty scene.
    pub fn new() -> Self {
        Self::default()
    }

    /// The geometry of a cell.
    pub fn of_cell(cell: &Cell) -> Self {
        let mut scene = cell.robots.iter().fold(Self::new(), |scene, r| {
            let payload: Vec<Collider> = r.payload.colliders().cloned().collect();
            let model = if r.payload.tools.is_empty() { r.without_payload() } else { r.with_all_tools() };
            scene
                .robot(&r.name, &model, r.base_in_world, r.flange, r.tcp_in_flange, &payload)
                .guarded_by(r.guarded_volumes())
                .with_tools(r.payload.tools.iter().map(|t| (t.name.clone(), t.link, t.tcp_in_link)).collect())
        });
        for (r, robot) in scene.robots.iter_mut().enumerate() {
            let volume = |(object, link)| (object, cell.gripped_volume(RobotId(r), object, link));
            robot.gripped = cell.grips(RobotId(r)).into_iter().map(volume).collect();
        }
        scene.title = cell.title();
        scene.shields = cell.guidance.fixtures.iter().filter_map(|fixture| shield(cell, fixture)).collect();
        scene.add_entries(cell);
        cell.objects.iter().fold(scene, Self::object)
    }

    /// Adds a robot, coloured by its index.
    ///
    /// Its visual meshes are drawn. A link without visual meshes shows its collision geometry.
    #[must_use]
    pub fn robot(
        mut self,
        name: impl Into<String>,
        robot: &Robot,
        base_in_world: Pose,
        flange: LinkId,
        tcp_in_flange: Pose,
        tool: &[Collider],
    ) -> Self {
        let color = rgb(palette::of_robot(self.robots.len()));
        let link_meshes = (0..robot.chain.links().len()).map(|link| meshes(shown(robot, link), color)).collect();
        self.robots.push(ReportRobot {
            name: name.into(),
            base_in_world,
            chain: robot.chain.clone(),
            link_meshes,
            tool: meshes(tool, rgb(palette::TOOL)),
            tcp_in_flange,
            flange,
            volumes: Vec::new(),
            gripped: Vec::new(),
            tools: Vec::new(),
        });
        self
    }

    /// Adds a ball at each point of entry, and the line of the shaft to its tool.
    fn add_entries(&mut self, cell: &Cell) {
        for guide in &cell.guidance.guides {
            let (Some(center), Some((_, tcp_in_link))) = (guide.guide.remote_center(), guide.tool.solid(cell)) else {
                continue;
            };
            let radius = center.radius_m().max(ENTRY_RADIUS_M);
            let (vertices, triangles) = tessellate(&Shape::Sphere(Sphere { radius }), 0.1 * radius);
            let (name, in_world) = (guide.name.clone(), Pose::from_translation(center.at()));
            self.shields.push(ReportShield { name, vertices, triangles, in_world, active: guide.active });
            let half_length = 0.5 * SHAFT_LENGTH_M;
            let shaft = Shape::Cylinder(Cylinder { half_length, radius: SHAFT_RADIUS_M });
            let (vertices, triangles) = tessellate(&shaft, 0.5 * SHAFT_RADIUS_M);
            let axis = center.axis_in_tool();
            let in_tool = Pose::new(Rotation::from_z(axis), axis * -half_length);
            let line = ReportMesh { vertices, triangles, in_link: tcp_in_link * in_tool, color: rgb(palette::SHIELD) };
            self.robots[guide.tool.robot.0].link_meshes[guide.tool.link(cell).0].push(line);
        }
    }

    /// The named tools of the robot added last.
    #[must_use]
    fn with_tools(mut self, tools: Vec<(String, LinkId, Pose)>) -> Self {
        if let Some(robot) = self.robots.last_mut() {
            robot.tools = tools;
        }
        self
    }

    /// The guarded volumes of the robot added last.
    #[must_use]
    pub fn guarded_by(mut self, volumes: Vec<Volume>) -> Self {
        if let Some(robot) = self.robots.last_mut() {
            robot.volumes = volumes;
        }
        self
    }

    /// Adds an object.
    #[must_use]
    pub fn object(mut self, object: &Object) -> Self {
        let Object { name, shape, in_world } = object.clone();
        self.objects.push(ReportObject { name, shape, in_world });
        self
    }
}

fn shown(robot: &Robot, link: usize) -> &[Collider] {
    let of = |list: &'_ [Vec<Collider>]| list.get(link).is_some_and(|colliders| !colliders.is_empty());
    if of(&robot.visuals) {
        &robot.visuals[link]
    } else if of(&robot.colliders) {
        &robot.colliders[link]
    } else {
        &[]
    }
}

/// A shield, coarse enough for a page; `None` if it cannot be made, which a run reports where it needs it.
fn shield(cell: &Cell, fixture: &CellFixture) -> Option<ReportShield> {
    let mesh = &fixture.shield(cell).ok()?.mesh;
    let coarse_m = mesh.aabb().extent().max_element() / SHIELD_LEVELS;
    let target = merge_targets(mesh.vertices(), coarse_m);
    let merged = mesh.triangles().iter().map(|corners| corners.map(|corner| target[corner as usize]));
    Some(ReportShield {
        name: fixture.name.clone(),
        vertices: mesh.vertices().to_vec(),
        triangles: merged.collect(),
        in_world: cell.objects[fixture.protects.0].in_world,
        active: fixture.active,
    })
}

fn meshes(colliders: &[Collider], color: [u8; 3]) -> Vec<ReportMesh> {
    colliders
        .iter()
        .filter(|collider| !matches!(collider.shape, Shape::HalfSpace(_)))
        .map(|collider| {
            let (vertices, triangles) = tessellate(&collider.shape, CHORD_ERROR_M);
            ReportMesh { vertices, triangles, in_link: collider.in_link, color }
        })
        .collect()
}

/// `#rrggbb` as bytes.
fn rgb(hex: &str) -> [u8; 3] {
    let value = u32::from_str_radix(hex.trim_start_matches('#'), 16).unwrap_or(0x80_80_80);
    let [_, r, g, b] = value.to_be_bytes();
    [r, g, b]
}
