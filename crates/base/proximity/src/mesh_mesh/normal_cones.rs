//! Cones around the normals of the parts of a surface, for every node, leaf and triangle of its tree.

use std::sync::Arc;

use elbowroom_spatial::Vec3;

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

    /// False if no direction of this cone is opposite to one of the other, whose axes `rows` rotates into this frame.
    #[inline(always)]
    pub fn may_face(&self, other: &Self, rows: &[[f32; 3]; 3]) -> bool {
        if self.half_angle + other.half_angle >= std::f32::consts::PI {
            return true;
        }
        let [x, y, z] = other.axis;
        let along = |k: usize| self.axis[k] * (rows[k][0] * x + rows[k][1] * y + rows[k][2] * z);
        -(along(0) + along(1) + along(2)) >= self.cos * other.cos - self.sin * other.sin
    }

    /// False if the unit vector is outside the cone.
    #[inline(always)]
    pub fn may_contain(&self, direction: Vec3) -> bool {
        let axis = Vec3::from(self.axis.map(f64::from));
        axis.dot(direction) >= f64::from(self.cos) - 1e-6
    }
}

/// A mesh with cones around its normals: what [`for_each_local_minimum`](super::for_each_local_minimum) needs (Johnson
/// and Cohen, *Spatialized normal cone hierarchies*, 2001).
///
/// The cone of a part contains every outward direction in which a point of the part can be the nearest of its
/// neighbourhood: the normals of its triangles and of all triangles that share a corner with them. Parts that are open,
/// inside out or without a usable normal have a cone of all directions, so they are slower and not left out.
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
    /// A cone per slot of the tree.
    slots: Vec<NormalCone>,
    /// Cones by height, then by number; height 0 has the leaves.
    levels: Vec<Vec<NormalCone>>,
}

impl NormalConeHierarchy {
    /// Computes the cones.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        let vertex_faces = VertexFaces::new(&mesh);
        let triangles = cones_of_triangles(&mesh, &vertex_faces);
        let slots: Vec<NormalCone> = mesh.bvh.order.iter().map(|&t| triangles[t as usize]).collect();
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

    /// True if every part of the surface is closed and all its triangles face outwards.
    pub fn is_solid(&self) -> bool {
        (0..self.mesh.triangles().len()).all(|t| is_solid(&self.mesh, t))
    }

    #[inline(always)]
    pub(super) fn of_node(&self, height: u8, number: u32) -> &NormalCone {
        &self.levels[usize::from(height)][number as usize]
    }

    #[inline(always)]
    pub(super) fn of_slot(&self, slot: u32) -> &NormalCone {
        &self.slots[slot as usize]
    }
}

fn merged(cones: &[NormalCone], arity: usize) -> Vec<NormalCone> {
    cones.chunks(arity).map(|c| NormalCone::around(c.iter().map(NormalCone::axis_and_half_angle))).collect()
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

/// True if a triangle belongs to the closed surface of a solid and faces outwards.
fn is_solid(mesh: &TriMesh, t: usize) -> bool {
    mesh.in_closed_component[t] && mesh.in_oriented_component[t] && !mesh.report().inside_out
}

fn cones_of_triangles(mesh: &TriMesh, vertex_faces: &VertexFaces) -> Vec<NormalCone> {
    let normals = normals(mesh);
    let cone = |t: usize| {
        let neighbours = vertex_faces.neighbours(mesh, t);
        if !neighbours.clone().all(|t| is_solid(mesh, t)) {
            return NormalCone::EVERY_DIRECTION;
        }
        NormalCone::around(neighbours.filter_map(|t| normals[t]).map(|n| (n, ANGLE_MARGIN)))
    };
    (0..mesh.triangles().len()).map(cone).collect()
}
