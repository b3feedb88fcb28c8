//! Cones around the normals of the parts of a surface, for every node, leaf and triangle of its tree.

use std::sync::Arc;

use elbowroom_spatial::Vec3;

use super::nearest_directions::NearestDirections;
use super::relative_placement::{AffineF32, RelativePlacement};
use super::vertex_faces::VertexFaces;
use crate::TriMesh;
use crate::bvh::{ARITY, LEAF_SIZE};

/// Added to every half-angle, radians: several times the error of an angle computed from f32 cosines.
const ANGLE_MARGIN: f64 = 2e-3;
/// Squared ratio of height to longest edge below which a triangle has no usable normal.
const FLAT: f64 = 1e-14;

/// A set of directions around an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalCone {
    axis: [f32; 3],
    /// Half of the opening angle, radians; π contains every direction.
    half_angle: f32,
    cos: f32,
    sin: f32,
}

impl NormalCone {
    const EVERY_DIRECTION: Self = Self { axis: [0.0, 0.0, 1.0], half_angle: std::f32::consts::PI, cos: -1.0, sin: 0.0 };

    /// A cone that contains cones given by their axes and half-angles; every direction if it would not be convex.
    fn around(cones: impl Iterator<Item = (Vec3, f64)> + Clone) -> Self {
        let sum = cones.clone().fold(Vec3::ZERO, |sum, (axis, _)| sum + axis);
        let Some(axis) = sum.try_normalize() else { return Self::EVERY_DIRECTION };
        let half_angle =
            cones.fold(0.0, |widest: f64, (n, half)| widest.max(axis.dot(n).clamp(-1.0, 1.0).acos() + half));
        if !(half_angle < std::f64::consts::FRAC_PI_2) {
            return Self::EVERY_DIRECTION;
        }
        Self {
            axis: axis.to_array().map(|x| x as f32),
            half_angle: half_angle as f32,
            cos: half_angle.cos() as f32,
            sin: half_angle.sin() as f32,
        }
    }

    fn axis_and_half_angle(&self) -> (Vec3, f64) {
        (Vec3::from(self.axis.map(f64::from)), f64::from(self.half_angle))
    }

    /// False if no direction of this cone is opposite to one of a cone with this axis, given in the same frame.
    #[inline(always)]
    fn may_face(&self, other: &Self, other_axis: [f32; 3]) -> bool {
        self.half_angle + other.half_angle >= std::f32::consts::PI
            || -dot(self.axis, other_axis) >= self.cos * other.cos - self.sin * other.sin
    }

    /// False if the unit vector is outside the cone.
    #[inline(always)]
    pub fn may_contain(&self, direction: Vec3) -> bool {
        let axis = Vec3::from(self.axis.map(f64::from));
        axis.dot(direction) >= f64::from(self.cos) - 1e-6
    }
}

/// A part of a surface: a ball around it, in the unit frame of its mesh, and the cone of its normals.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfacePatch {
    center: [f32; 3],
    radius: f32,
    pub cone: NormalCone,
}

impl SurfacePatch {
    /// A patch around others: the ball around the middle of their box.
    fn around(patches: &[Self]) -> Self {
        let bounds = |side: f32| -> [f32; 3] {
            std::array::from_fn(|k| {
                let ends = patches.iter().map(|p| side.mul_add(p.radius, p.center[k]) * side);
                ends.fold(f32::NEG_INFINITY, f32::max) * side
            })
        };
        let (low, high) = (bounds(-1.0), bounds(1.0));
        let center: [f32; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        let reach = |p: &Self| {
            let offset: [f32; 3] = std::array::from_fn(|k| p.center[k] - center[k]);
            dot(offset, offset).sqrt() + p.radius
        };
        let radius = patches.iter().map(reach).fold(0.0, f32::max) * 1.000_01;
        Self { center, radius, cone: NormalCone::around(patches.iter().map(|p| p.cone.axis_and_half_angle())) }
    }

    /// A patch of one triangle with the corners in the unit frame.
    fn of_triangle([a, b, c]: [Vec3; 3], cone: NormalCone) -> Self {
        let center = (a + b + c) / 3.0;
        let radius = a.distance(center).max(b.distance(center)).max(c.distance(center));
        Self { center: center.to_array().map(|x| x as f32), radius: radius as f32 * 1.000_01 + 1e-6, cone }
    }

    /// False if no point of this patch and of one of the other mesh can be nearest to each other in their neighbourhoods
    /// and no farther apart than the limit.
    ///
    /// The direction between them would lie in both cones, so it is at most the smaller half-angle θ away from an axis. The
    /// way from centre to centre would be that of the points up to both radii: along the axis between 0 and the limit,
    /// across it up to the limit times sin θ.
    #[inline(always)]
    pub fn may_face(&self, other: &Self, pair: &FacingTest) -> bool {
        let other_axis = rotated(&pair.rows, other.cone.axis);
        if !self.cone.may_face(&other.cone, other_axis) {
            return false;
        }
        let center = rotated(&pair.scaled_rows, other.center);
        let way: [f32; 3] = std::array::from_fn(|k| center[k] + pair.shift[k] - self.center[k]);
        let reach = self.radius + other.radius * pair.scale + pair.error;
        let (axis, sin, cos) = if self.cone.half_angle <= other.cone.half_angle {
            (self.cone.axis, self.cone.sin, self.cone.cos)
        } else {
            (other_axis.map(|x| -x), other.cone.sin, other.cone.cos)
        };
        if cos < 0.0 {
            return true;
        }
        let along = dot(way, axis);
        let across = (dot(way, way) - along * along).max(0.0).sqrt();
        along >= -reach && along <= pair.limit + reach && across <= reach + pair.limit * sin
    }
}

/// What the test of two patches needs of the placement of the meshes, in units of A.
pub(super) struct FacingTest {
    rows: [[f32; 3]; 3],
    scaled_rows: [[f32; 3]; 3],
    shift: [f32; 3],
    scale: f32,
    /// Added to every radius: errors of f32.
    error: f32,
    /// Largest distance of two points.
    limit: f32,
}

impl FacingTest {
    pub fn new(placement: &RelativePlacement, limit: f64) -> Self {
        let AffineF32 { r, m, t, scale, .. } = placement.b_in_a;
        let error = 4.0 * placement.f32_error as f32;
        Self { rows: r, scaled_rows: m, shift: t, scale: scale * 1.000_01, error, limit: limit as f32 * 1.000_01 }
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn rotated(rows: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    [dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)]
}

/// A mesh with cones around its normals: what [`for_each_local_minimum`](super::for_each_local_minimum) needs (Johnson
/// and Cohen, *Spatialized normal cone hierarchies*, 2001).
///
/// The cone of a part contains every outward direction in which a point of the part can be the nearest of its
/// neighbourhood: the normals of its triangles, and what lies beyond them at convex edges and corners. Parts that are open,
/// not outward, joined across a seam or beside a triangle without a usable normal have a cone of all directions, so
/// they are slower and not left out.
///
/// ```
/// use std::sync::Arc;
/// use elbowroom_proximity::{TriMesh, advanced::NormalConeHierarchy};
/// use elbowroom_spatial::Vec3;
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let cones = NormalConeHierarchy::new(Arc::new(mesh));
/// assert_eq!(cones.mesh().triangles().len(), 4);
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct NormalConeHierarchy {
    mesh: Arc<TriMesh>,
    pub(super) vertex_faces: VertexFaces,
    /// A patch per slot of the tree.
    slots: Vec<SurfacePatch>,
    /// Patches by height, then by number; height 0 has the leaves.
    levels: Vec<Vec<SurfacePatch>>,
}

impl NormalConeHierarchy {
    /// Computes the cones.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        let vertex_faces = VertexFaces::new(&mesh);
        let outward = outward_triangles(&mesh, &vertex_faces);
        let triangles = cones_of_triangles(&mesh, &vertex_faces, &outward);
        let patch = |&t: &u32| {
            let corners = mesh.corners(t as usize).map(|p| mesh.bvh.frame.to_units(p));
            SurfacePatch::of_triangle(corners, triangles[t as usize])
        };
        let slots: Vec<SurfacePatch> = mesh.bvh.order.iter().map(patch).collect();
        let mut levels = vec![merged(&slots, LEAF_SIZE)];
        for height in 0..mesh.bvh.height() {
            levels.push(merged(&levels[height], ARITY));
        }
        Self { mesh, vertex_faces, slots, levels }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Arc<TriMesh> {
        &self.mesh
    }

    /// True if every part of the surface is closed and its triangles face the same side.
    pub fn is_oriented(&self) -> bool {
        let mesh = &self.mesh;
        (0..mesh.triangles().len()).all(|t| mesh.in_closed_component[t] && mesh.in_oriented_component[t])
    }

    #[inline(always)]
    pub(super) fn of_node(&self, height: u8, number: u32) -> &SurfacePatch {
        &self.levels[usize::from(height)][number as usize]
    }

    #[inline(always)]
    pub(super) fn of_slot(&self, slot: u32) -> &SurfacePatch {
        &self.slots[slot as usize]
    }
}

fn merged(patches: &[SurfacePatch], arity: usize) -> Vec<SurfacePatch> {
    patches.chunks(arity).map(SurfacePatch::around).collect()
}

/// The outward normal of every triangle; `None` if it has none.
fn normals(mesh: &TriMesh) -> Vec<Option<Vec3>> {
    let normal = |t: usize| {
        let [a, b, c] = mesh.closed_corners(t);
        let n = (b - a).cross(c - a);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        if n.length_squared() > longest * longest * FLAT { n.try_normalize() } else { None }
    };
    (0..mesh.triangles().len()).map(normal).collect()
}

/// Whether each triangle belongs to a closed part of the surface that encloses a volume and faces out of it. The wall of a
/// cavity does not, although it faces out of the solid.
fn outward_triangles(mesh: &TriMesh, vertex_faces: &VertexFaces) -> Vec<bool> {
    let parts = vertex_faces.parts(mesh);
    let origin = mesh.aabb().center();
    let mut volumes = vec![0.0; mesh.vertices().len()];
    for (t, &part) in parts.iter().enumerate() {
        let [a, b, c] = mesh.closed_corners(t).map(|p| p - origin);
        volumes[part as usize] += a.dot(b.cross(c));
    }
    let is_oriented = |t: usize| mesh.in_closed_component[t] && mesh.in_oriented_component[t];
    parts.iter().enumerate().map(|(t, &part)| is_oriented(t) && volumes[part as usize] > 0.0).collect()
}

fn cones_of_triangles(mesh: &TriMesh, vertex_faces: &VertexFaces, outward: &[bool]) -> Vec<NormalCone> {
    let normals = normals(mesh);
    let directions = NearestDirections::new(mesh, vertex_faces, &normals);
    let cone = |t: usize| {
        let mut neighbours = vertex_faces.neighbours(mesh, t);
        let is_clear = |t: usize| outward[t] && normals[t].is_some() && !vertex_faces.is_welded(mesh, t);
        if !neighbours.all(is_clear) {
            return NormalCone::EVERY_DIRECTION;
        }
        NormalCone::around(directions.of_triangle(t).map(|d| (d, ANGLE_MARGIN)))
    };
    (0..mesh.triangles().len()).map(cone).collect()
}
