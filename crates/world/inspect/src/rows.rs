//! Rows of an inspection: joints and meshes.

use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::{Collider, Robot};
use serde::{Serialize, Serializer};

use crate::edges;

/// A joint.
#[derive(Debug, Clone, Serialize)]
pub struct JointRow {
    /// Its name.
    pub name: String,
    /// `fixed`, `revolute`, `continuous` or `prismatic`.
    #[serde(rename = "type", serialize_with = "serialize_kind")]
    pub kind: JointKind,
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
    /// The source joint of a mimic joint.
    pub mimic: Option<String>,
}

impl JointRow {
    /// The kind as in a URDF: `fixed`, `revolute`, `continuous` or `prismatic`.
    pub fn kind_name(&self) -> &'static str {
        kind_name(self.kind)
    }
}

/// A triangle mesh.
#[derive(Debug, Clone, Serialize)]
pub struct MeshRow {
    /// Its link; for a mesh file, its object.
    pub link: String,
    /// The object's name.
    pub name: String,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of distinct vertices.
    pub vertices: usize,
    /// True if every edge is shared by two faces of opposite direction, after closing hairline seams.
    pub closed: bool,
    /// Vertices on hairline seams that are merged within `weld_tolerance_m`; distances refer to the original faces.
    pub welded_vertices: usize,
    /// 0 if nothing was welded.
    pub weld_tolerance_m: f64,
    /// Faces without area.
    pub degenerate: usize,
    /// Duplicate faces.
    pub duplicate: usize,
    /// Edges with one face: the boundaries of holes.
    pub open_edges: usize,
    /// Edges with more than two faces.
    pub non_manifold_edges: usize,
    /// True if the faces of a closed mesh are oriented inwards.
    pub inside_out: bool,
    /// Edge lengths of its axis-aligned box, in its own frame.
    pub extent_m: [f64; 3],
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn serialize_kind<S: Serializer>(kind: &JointKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind_name(*kind))
}

pub(super) fn joint_row(chain: &Chain, joint: &elbowroom_kinematics::Joint) -> JointRow {
    let bound = |v: f64| (v.is_finite() && joint.kind.moves() && joint.kind != JointKind::Continuous).then_some(v);
    JointRow {
        name: joint.name.clone(),
        kind: joint.kind,
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

pub(super) fn mesh_rows(robot: &Robot) -> Vec<MeshRow> {
    let colliders = robot.chain.links().iter().zip(&robot.colliders);
    let row = |link: &String, collider: &Collider| match &collider.shape {
        Shape::Mesh(solid) => Some(mesh_row(link, &collider.name, solid)),
        _ => None,
    };
    colliders.flat_map(|(link, colliders)| colliders.iter().filter_map(|b| row(link, b)).collect::<Vec<_>>()).collect()
}

pub(super) fn mesh_row(link: &str, name: &str, solid: &TriMesh) -> MeshRow {
    let report = solid.report();
    let (open_edges, non_manifold_edges) = edges::count(solid);
    MeshRow {
        link: link.to_owned(),
        name: name.to_owned(),
        triangles: report.triangles,
        vertices: report.vertices,
        closed: report.closed,
        welded_vertices: report.welded,
        weld_tolerance_m: report.weld_tolerance,
        degenerate: report.degenerate,
        duplicate: report.duplicate,
        open_edges,
        non_manifold_edges,
        inside_out: report.inside_out,
        extent_m: solid.aabb().extent().to_array(),
    }
}
