//! Rows of an inspection: joints and meshes.

use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_robot::{Collider, Robot};
use serde::{Serialize, Serializer};

use crate::edges;

/// Row of a joint.
#[derive(Debug, Clone, Serialize)]
pub struct JointRow {
    /// Name of the joint.
    pub name: String,
    /// `fixed`, `revolute`, `continuous` or `prismatic`.
    #[serde(rename = "type", serialize_with = "serialize_kind")]
    pub kind: JointKind,
    /// Name of the parent link.
    pub parent: String,
    /// Name of the child link.
    pub child: String,
    /// Lower limit, rad or m.
    pub lower: Option<f64>,
    /// Upper limit, rad or m.
    pub upper: Option<f64>,
    /// Largest speed, rad/s or m/s.
    pub velocity: Option<f64>,
    /// Name of the source joint of a mimic joint.
    pub mimic: Option<String>,
}

impl JointRow {
    /// The kind as in a URDF: `fixed`, `revolute`, `continuous` or `prismatic`.
    pub fn kind_name(&self) -> &'static str {
        kind_name(self.kind)
    }
}

/// Row of a triangle mesh.
#[derive(Debug, Clone, Serialize)]
pub struct MeshRow {
    /// Name of the link; for a mesh file, of the object.
    pub link: String,
    /// Name of the object.
    pub name: String,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of distinct vertices.
    pub vertices: usize,
    /// True if, after closing hairline seams, every edge is shared by two faces of opposite direction.
    pub closed: bool,
    /// Number of vertices on hairline seams that are merged within `weld_tolerance_m`.
    ///
    /// Distances refer to the original faces.
    pub welded_vertices: usize,
    /// Tolerance of the merge, m; 0 if no vertices were merged.
    pub weld_tolerance_m: f64,
    /// Number of faces without area.
    pub degenerate: usize,
    /// Number of duplicate faces.
    pub duplicate: usize,
    /// Number of edges with one face: the boundaries of holes.
    pub open_edges: usize,
    /// Number of edges with more than two faces.
    pub non_manifold_edges: usize,
    /// True if the faces of a closed mesh are oriented inwards.
    pub inside_out: bool,
    /// Edge lengths of the axis-aligned box, in the mesh's frame, m.
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
