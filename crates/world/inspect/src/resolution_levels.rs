//! Resolution levels of each link: boxes, capsule, hull, and coarse, middle and fine triangles.

use elbowroom_formats::MeshData;
use elbowroom_proximity::{Shape, TriMesh, fit, tessellate::tessellate};
use elbowroom_robot::Collider;
use elbowroom_spatial::{Aabb, Pose, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use crate::{deviation, simplify};

/// Resolution levels of one link, in its frame. For a mesh file: of one object.
///
/// Boxes, capsule and hull enclose the link. The middle and coarse triangles lie on both sides of the exact surface,
/// within `deviation_m`. A query whose security margin equals the deviation covers the exact surface.
#[derive(Debug, Clone, Serialize)]
pub struct LinkLevels {
    /// Name of the link or object.
    pub link: String,
    /// Axis-aligned box in the link's frame, the basis of L1.
    #[serde(rename = "box")]
    pub aabb: BoxRow,
    /// Level L2: an oriented box.
    pub obb: Option<ObbRow>,
    /// Level `capsule`.
    pub capsule: Option<CapsuleRow>,
    /// Level `hull`; null if the link is flat.
    pub hull: Option<HullRow>,
    /// Level L3: all triangles; null if the link has no mesh.
    pub fine: Option<TrianglesRow>,
    /// A mesh with about a quarter of the triangles.
    pub middle: Option<TrianglesRow>,
    /// A mesh with about a sixteenth of the triangles.
    pub coarse: Option<TrianglesRow>,
    /// Hull, middle and coarse meshes.
    #[serde(skip)]
    pub meshes: Vec<MeshData>,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Serialize)]
pub struct BoxRow {
    /// Corner with the smallest coordinates, m.
    pub min_m: [f64; 3],
    /// Corner with the largest coordinates, m.
    pub max_m: [f64; 3],
}

/// An oriented box.
#[derive(Debug, Clone, Serialize)]
pub struct ObbRow {
    /// Centre, m.
    pub center_m: [f64; 3],
    /// Rotation as in URDF, rad.
    pub rpy: [f64; 3],
    /// Edge lengths, m.
    pub size_m: [f64; 3],
}

/// A capsule.
#[derive(Debug, Clone, Serialize)]
pub struct CapsuleRow {
    /// First end of the axis, m.
    pub from_m: [f64; 3],
    /// Second end of the axis, m.
    pub to_m: [f64; 3],
    /// Radius, m.
    pub radius_m: f64,
}

/// A convex hull.
#[derive(Debug, Clone, Serialize)]
pub struct HullRow {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of faces.
    pub triangles: usize,
    /// Volume, m³.
    pub volume_m3: f64,
}

/// A triangle mesh.
#[derive(Debug, Clone, Serialize)]
pub struct TrianglesRow {
    /// Number of triangles.
    pub triangles: usize,
    /// Proven upper bound on the distance of any point of the exact surface from this mesh, m. Null if unknown.
    pub deviation_m: Option<f64>,
}

/// Largest number of triangles of a mesh that is simplified. Simplifying larger meshes would take minutes.
const MAX_TRIANGLES: usize = 500_000;
/// Smallest number of triangles after simplification.
const MIN_TRIANGLES: usize = 12;
/// Largest chord error (m) of tessellated primitives in a fit.
const CHORD_M: f64 = 1e-4;

/// The levels of all links with solids, computed in parallel.
pub(super) fn of_links(links: &[(String, Vec<Collider>)]) -> Vec<LinkLevels> {
    links.par_iter().with_max_len(1).filter_map(|(name, colliders)| of_link(name, colliders)).collect()
}

fn of_link(link: &str, colliders: &[Collider]) -> Option<LinkLevels> {
    let solid = |b: &&Collider| !matches!(b.shape, Shape::HalfSpace(_));
    let aabb = colliders.iter().filter(solid).fold(Aabb::EMPTY, |all, b| all.union(&b.shape.aabb(&b.in_link)));
    if aabb.is_empty() {
        return None;
    }
    let points: Vec<Vec3> = colliders.iter().filter(solid).flat_map(points).collect();
    let rounded =
        colliders.iter().any(|b| matches!(b.shape, Shape::Sphere(_) | Shape::Capsule(_) | Shape::Cylinder(_)));
    let slack = if rounded { CHORD_M } else { 0.0 };
    let outermost = fit::ExtremePoints::of(&points);
    let hull = outermost.as_ref().and_then(fit::ExtremePoints::hull);
    let mut meshes: Vec<MeshData> = hull
        .iter()
        .map(|h| MeshData { name: "hull".into(), vertices: h.vertices().to_vec(), triangles: h.triangles().to_vec() })
        .collect();
    let TriangleLevels { fine, middle, coarse } = triangles(colliders, &mut meshes);
    Some(LinkLevels {
        link: link.to_owned(),
        aabb: BoxRow { min_m: aabb.min.to_array(), max_m: aabb.max.to_array() },
        obb: outermost.as_ref().and_then(fit::ExtremePoints::cuboid).and_then(|f| obb(&f, slack)),
        capsule: outermost.as_ref().and_then(fit::ExtremePoints::capsule).and_then(|f| capsule(&f, slack)),
        hull: hull.map(|h| HullRow {
            vertices: h.vertices().len(),
            triangles: h.triangles().len(),
            volume_m3: h.volume(),
        }),
        fine,
        middle,
        coarse,
        meshes,
    })
}

fn points(collider: &Collider) -> Vec<Vec3> {
    let corners = match &collider.shape {
        Shape::Mesh(m) => m.vertices().to_vec(),
        other => tessellate(other, CHORD_M).0,
    };
    corners.into_iter().map(|p| collider.in_link.transform_point(p)).collect()
}

fn obb(fit: &fit::Fit, slack: f64) -> Option<ObbRow> {
    let Shape::Cuboid(c) = &fit.shape else { return None };
    let size = (c.half_extents + Vec3::splat(slack)) * 2.0;
    let (center, rpy) = (fit.in_frame.translation.to_array(), fit.in_frame.rotation.to_rpy());
    Some(ObbRow { center_m: center, rpy, size_m: size.to_array() })
}

fn capsule(fit: &fit::Fit, slack: f64) -> Option<CapsuleRow> {
    let Shape::Capsule(c) = &fit.shape else { return None };
    let end = |z: f64| fit.in_frame.transform_point(Vec3::Z * z).to_array();
    Some(CapsuleRow { from_m: end(-c.half_length), to_m: end(c.half_length), radius_m: c.radius + slack })
}

/// The triangle meshes of a link.
#[derive(Default)]
struct TriangleLevels {
    fine: Option<TrianglesRow>,
    middle: Option<TrianglesRow>,
    coarse: Option<TrianglesRow>,
}

/// Computes the triangle levels of a link, and adds the middle and coarse meshes to `meshes`.
fn triangles(colliders: &[Collider], meshes: &mut Vec<MeshData>) -> TriangleLevels {
    let solids: Vec<(&TriMesh, &Pose)> = colliders
        .iter()
        .filter_map(|b| if let Shape::Mesh(m) = &b.shape { Some((&**m, &b.in_link)) } else { None })
        .collect();
    let count: usize = solids.iter().map(|(m, _)| m.triangles().len()).sum();
    if solids.is_empty() {
        return TriangleLevels::default();
    }
    let fine = Some(TrianglesRow { triangles: count, deviation_m: Some(0.0) });
    if count > MAX_TRIANGLES {
        return TriangleLevels { fine, ..TriangleLevels::default() };
    }
    let mut models = [SimplifiedModel::named("middle"), SimplifiedModel::named("coarse")];
    for (mesh, in_link) in solids {
        let n = mesh.triangles().len();
        let (middle, coarse) =
            simplify::middle_and_coarse(mesh, (n / 4).max(MIN_TRIANGLES), (n / 16).max(MIN_TRIANGLES));
        for (model, simple) in models.iter_mut().zip([middle, coarse]) {
            model.add(&simple, deviation::bound(mesh, &simple), in_link);
        }
    }
    let [middle, coarse] = models.map(|m| {
        let row = m.row();
        meshes.push(m.mesh);
        row
    });
    TriangleLevels { fine, middle: Some(middle), coarse: Some(coarse) }
}

/// The simplified solids of a link, merged.
struct SimplifiedModel {
    mesh: MeshData,
    deviation_m: f64,
}

impl SimplifiedModel {
    fn named(name: &str) -> Self {
        Self { mesh: MeshData { name: name.into(), ..MeshData::default() }, deviation_m: 0.0 }
    }

    fn add(&mut self, simple: &simplify::Simplified, deviation_m: f64, in_link: &Pose) {
        let offset = self.mesh.vertices.len() as u32;
        self.mesh.vertices.extend(simple.vertices.iter().map(|p| in_link.transform_point(*p)));
        self.mesh.triangles.extend(simple.triangles.iter().map(|t| t.map(|i| i + offset)));
        self.deviation_m = self.deviation_m.max(deviation_m);
    }

    fn row(&self) -> TrianglesRow {
        let deviation_m = Some(self.deviation_m).filter(|d| d.is_finite());
        TrianglesRow { triangles: self.mesh.triangles.len(), deviation_m }
    }
}
