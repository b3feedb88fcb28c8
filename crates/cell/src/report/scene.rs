//! What the 3-D scene shows besides the recording.

use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_proximity::{Shape, tessellate::tessellate};
use elbowroom_scene::{Body, Object, Robot};
use elbowroom_spatial::{Pose, Vec3};

use super::palette;
use crate::Cell;

/// No point of a curved surface is farther than this (m) from the triangles that are drawn.
const CHORD_ERROR_M: f64 = 1e-3;

/// The bodies of a cell, as triangles.
#[derive(Debug, Clone, Default)]
pub struct ReportScene {
    /// In the order of the recording.
    pub robots: Vec<ReportRobot>,
    /// Solid things, where they stand at the start.
    pub objects: Vec<ReportObject>,
}

/// A robot as the report draws it.
#[derive(Debug, Clone)]
pub struct ReportRobot {
    /// Its name in the cell.
    pub name: String,
    /// Where its root link stands.
    pub base_in_world: Pose,
    /// Turns the samples' joint positions into link poses.
    pub chain: Chain,
    /// Per link of the chain, in the link's frame.
    pub link_meshes: Vec<Vec<ReportMesh>>,
    /// In the flange's frame.
    pub tool: Vec<ReportMesh>,
    /// Where the tool centre point sits on the flange.
    pub tcp_in_flange: Pose,
    /// The link that carries the tool.
    pub flange: LinkId,
}

/// Triangles of one colour.
#[derive(Debug, Clone)]
pub struct ReportMesh {
    /// Corners, m.
    pub vertices: Vec<Vec3>,
    /// Three corners each, outward by the right-hand rule.
    pub triangles: Vec<[u32; 3]>,
    /// Where the corners' frame stands in the link, or in the flange.
    pub in_link: Pose,
    /// Red, green, blue.
    pub color: [u8; 3],
}

/// A solid thing.
#[derive(Debug, Clone)]
pub struct ReportObject {
    /// Its name in the cell.
    pub name: String,
    /// Corners, m.
    pub vertices: Vec<Vec3>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
    /// Where the corners' frame stands.
    pub in_world: Pose,
}

impl ReportScene {
    /// A scene with nothing in it.
    pub fn new() -> Self {
        Self::default()
    }

    /// Everything that stands in a cell.
    pub fn of_cell(cell: &Cell) -> Self {
        let scene = cell.robots.iter().fold(Self::new(), |scene, r| {
            let carried: Vec<Body> = r.carried().cloned().collect();
            scene.robot(&r.name, &r.bare(), r.base_in_world, r.flange, r.tcp_in_flange, &carried)
        });
        cell.objects.iter().fold(scene, Self::object)
    }

    /// Adds a robot, coloured by its place in the scene. Its visuals are drawn; links without any show their bodies.
    #[must_use]
    pub fn robot(
        mut self,
        name: impl Into<String>,
        robot: &Robot,
        base_in_world: Pose,
        flange: LinkId,
        tcp_in_flange: Pose,
        tool: &[Body],
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
        });
        self
    }

    /// Adds a solid thing.
    #[must_use]
    pub fn object(mut self, object: &Object) -> Self {
        let (vertices, triangles) = tessellate(&object.shape, CHORD_ERROR_M);
        self.objects.push(ReportObject { name: object.name.clone(), vertices, triangles, in_world: object.in_world });
        self
    }
}

fn shown(robot: &Robot, link: usize) -> &[Body] {
    let of = |list: &'_ [Vec<Body>]| list.get(link).is_some_and(|bodies| !bodies.is_empty());
    if of(&robot.visuals) {
        &robot.visuals[link]
    } else if of(&robot.bodies) {
        &robot.bodies[link]
    } else {
        &[]
    }
}

fn meshes(bodies: &[Body], color: [u8; 3]) -> Vec<ReportMesh> {
    bodies
        .iter()
        .filter(|body| !matches!(body.shape, Shape::HalfSpace(_)))
        .map(|body| {
            let (vertices, triangles) = tessellate(&body.shape, CHORD_ERROR_M);
            ReportMesh { vertices, triangles, in_link: body.in_link, color }
        })
        .collect()
}

/// `#rrggbb` as bytes.
fn rgb(hex: &str) -> [u8; 3] {
    let value = u32::from_str_radix(hex.trim_start_matches('#'), 16).unwrap_or(0x80_80_80);
    let [_, r, g, b] = value.to_be_bytes();
    [r, g, b]
}
