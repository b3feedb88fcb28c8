//! Level of detail: lower bounds of the distance from the boxes of the trees down to some depth.

use elbowroom_spatial::{Pose, Vec3};

use super::containment::contained_point;
use super::cutoff::Cutoff;
use super::mesh_pair::MeshPair;
use super::node_kernel::{DISTANCE, expand_sides};
use super::node_pair::{NodePair, Sides};
use super::relative_placement::{RelativePlacement, spheres_farther_than};
use super::workspace::Workspace;
use crate::bvh::{ARITY, BoxDistance, Bvh16, NodeBound};
use crate::{Shape, TriMesh};

/// A lower bound of a distance by boxes, and the nearest boxes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BvhBound {
    /// Proven lower bound of the distance, metres; 0 if boxes touch, or if one mesh is inside the other.
    pub lower_bound: f64,
    /// A point of the first surface (to f32 rounding) in its nearest box, in the world.
    pub on_a: Vec3,
    /// A point of the second surface (to f32 rounding) in its nearest box, in the world. The distance of the two points
    /// is at least the distance of the surfaces.
    pub on_b: Vec3,
    /// Mean normal of the triangles in the box of the first mesh, by their orientation, in the world; zero if they
    /// cancel.
    pub normal_a: Vec3,
    /// Mean normal of the triangles in the box of the second mesh, by their orientation, in the world; zero if they
    /// cancel.
    pub normal_b: Vec3,
}

/// A lower bound of the distance of two meshes by their boxes down to a depth; `None` if they are guaranteed to be
/// farther apart than `limit` metres, which may end the query at a smaller depth.
///
/// Depth 0 is the box around the whole mesh; [`TriMesh::bvh_depth`] and more are boxes of up to eight triangles. The
/// boxes are aligned with the axes of each mesh's own frame, and have a slab along the mean normal of their
/// triangles. Of several boxes at nearly the same distance, rounding in f32, and so the instruction set, decides
/// which one is returned.
///
/// ```
/// use elbowroom_proximity::advanced::{bvh_lower_bound, mesh_separation};
/// use elbowroom_proximity::{TriMesh, Workspace};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there, mut workspace) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5), Workspace::new());
/// let bound = bvh_lower_bound(&mesh, &here, &mesh, &there, 0, 1.0, &mut workspace).expect("it is nearer");
/// let exact = mesh_separation(&mesh, &here, &mesh, &there, &mut workspace);
/// assert!(bound.lower_bound <= exact.distance && exact.distance <= bound.on_a.distance(bound.on_b) + 1e-6);
/// assert!(bvh_lower_bound(&mesh, &here, &mesh, &there, 0, 0.4, &mut workspace).is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn bvh_lower_bound(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    depth: u8,
    limit: f64,
    workspace: &mut Workspace,
) -> Option<BvhBound> {
    workspace.begin_query();
    if spheres_farther_than(&a.bvh, a_in_world, &b.bvh, b_in_world, limit.max(0.0)) {
        return None;
    }
    let placement = RelativePlacement::new(&a.bvh, a_in_world, &b.bvh, b_in_world);
    if !placement.is_usable() {
        return Some(BvhBound::touching(a_in_world.translation, b_in_world.translation));
    }
    let unit = a.bvh.frame.unit;
    let meshes = MeshPair { a, b, placement: &placement, simd_level: workspace.simd_level() };
    let found = nearest_node_pair(&meshes, depth, limit.max(0.0) / unit + placement.f64_error, workspace);
    if workspace.stack.overflowed() {
        return Some(BvhBound::touching(a_in_world.translation, b_in_world.translation));
    }
    let touching = found.is_some_and(|pair| pair.key <= 0.0);
    if !touching && let Some(p) = contained_point(a, a_in_world, b, b_in_world) {
        return Some(BvhBound::touching(p, p));
    }
    let found = found?;
    let (on_a, normal_a) = landmark(&a.bvh, found.a, found.height_a);
    let (on_b, normal_b) = landmark(&b.bvh, found.b, found.height_b);
    let gap = f64::from(found.key.max(0.0)).sqrt() * (1.0 - 1e-5) - 2.0 * placement.f32_error - placement.f64_error;
    Some(BvhBound {
        lower_bound: gap.max(0.0) * unit,
        on_a: a_in_world.transform_point(on_a),
        on_b: b_in_world.transform_point(on_b),
        normal_a: a_in_world.transform_vector(normal_a),
        normal_b: b_in_world.transform_vector(normal_b),
    })
}

impl BvhBound {
    fn touching(on_a: Vec3, on_b: Vec3) -> Self {
        Self { lower_bound: 0.0, on_a, on_b, normal_a: Vec3::ZERO, normal_b: Vec3::ZERO }
    }
}

/// The pair of boxes at `depth` with the smallest lower bound, no farther apart than `radius`, units of A.
fn nearest_node_pair(meshes: &MeshPair, depth: u8, radius: f64, workspace: &mut Workspace) -> Option<NodePair> {
    let Workspace { stack, stats, .. } = workspace;
    let placement = meshes.placement;
    let mut cutoff = Cutoff::new(radius, placement);
    cutoff.align(placement.map_to_a(Vec3::ZERO), placement);
    let root = NodePair::root(&meshes.a.bvh, &meshes.b.bvh);
    let (lowest_a, lowest_b) = (root.height_a.saturating_sub(depth), root.height_b.saturating_sub(depth));
    let mut best: Option<NodePair> = None;
    stack.clear();
    // The roots themselves are tested before one is expanded.
    stats.boxes += expand_sides::<DISTANCE>(meshes, &root, Sides { a: false, b: false }, &cutoff, stack);
    while let Some(pair) = stack.pop() {
        if pair.key > cutoff.squared {
            continue;
        }
        let (above_a, above_b) = (pair.height_a - lowest_a, pair.height_b - lowest_b);
        if above_a == 0 && above_b == 0 {
            if best.is_none_or(|b| pair.key < b.key) {
                best = Some(pair);
                cutoff.squared = cutoff.squared.min(pair.key.max(0.0));
            }
            if pair.key <= 0.0 {
                break;
            }
            continue;
        }
        stats.nodes += 1;
        let expanded = Sides { a: above_a >= above_b, b: above_b >= above_a };
        stats.boxes += expand_sides::<DISTANCE>(meshes, &pair, expanded, &cutoff, stack);
    }
    best
}

/// Landmark (m) and mean normal of a node, in the mesh frame.
fn landmark(tree: &Bvh16, number: u32, height: u8) -> (Vec3, Vec3) {
    let (parent, lane) = tree.parent(height as usize, number as usize);
    let at = |p: &[[f32; ARITY]; 3]| [p[0][lane], p[1][lane], p[2][lane]];
    let normal = Vec3::from(at(&parent.normal).map(f64::from));
    (tree.frame.in_metres(at(&parent.landmark)), normal.try_normalize().unwrap_or(Vec3::ZERO))
}

/// Like [`bvh_lower_bound`], for a mesh and a bounded simple shape, by the box around the shape in its own frame.
/// `None` if the shape is a half-space or a mesh, or if a number is not finite.
pub fn bvh_lower_bound_to_shape(
    mesh: &TriMesh,
    mesh_in_world: &Pose,
    shape: &Shape,
    shape_in_world: &Pose,
    depth: u8,
) -> Option<BvhBound> {
    if matches!(shape, Shape::HalfSpace(_) | Shape::Mesh(_)) || !shape.is_usable(shape_in_world) {
        return None;
    }
    let bounds = shape.aabb(&Pose::IDENTITY);
    let query = BoxDistance::new(&mesh.bvh, &bounds, &mesh_in_world.inverse_mul(shape_in_world));
    let nearest = nearest_node(&mesh.bvh, &query, depth);
    let (on_mesh, normal) = landmark(&mesh.bvh, nearest.number, nearest.height);
    let (on_mesh, normal) = (mesh_in_world.transform_point(on_mesh), mesh_in_world.transform_vector(normal));
    let on_shape = crate::project_point(shape, shape_in_world, on_mesh);
    let gap = f64::from(nearest.bound.max(0.0)) * (1.0 - 1e-6) * mesh.bvh.frame.unit;
    let point_of_shape = || mesh_in_world.inverse_transform_point(shape_in_world.transform_point(point_of(shape)));
    let touching = nearest.bound.is_nan() || mesh.contains(point_of_shape());
    Some(BvhBound {
        lower_bound: if touching { 0.0 } else { gap },
        on_a: on_mesh,
        on_b: on_shape.on_surface,
        normal_a: normal,
        normal_b: on_shape.outward,
    })
}

/// A point of the solid, in its own frame.
fn point_of(shape: &Shape) -> Vec3 {
    if let Shape::Hull(hull) = shape { hull.vertices()[0] } else { Vec3::ZERO }
}

/// A node and its lower bound, in units of the tree.
#[derive(Clone, Copy)]
struct BoundedNode {
    bound: f32,
    number: u32,
    height: u8,
}

/// The box at `depth` with the smallest bound.
fn nearest_node(tree: &Bvh16, query: &BoxDistance, depth: u8) -> BoundedNode {
    let root = tree.height() as u8;
    let lowest = root.saturating_sub(depth);
    let above = query.lower_bounds(&tree.levels[root as usize][0])[0];
    let mut best = BoundedNode { bound: f32::INFINITY, number: 0, height: root };
    // Each step down leaves at most 15 siblings on the stack, and trees have a height of 8.
    let mut stack = [BoundedNode { bound: 0.0, number: 0, height: 0 }; 16 * 10];
    stack[0] = BoundedNode { bound: above, number: 0, height: root };
    let mut len = 1;
    while len > 0 {
        len -= 1;
        let node = stack[len];
        if node.bound >= best.bound {
            continue;
        }
        if node.height == lowest {
            best = node;
            continue;
        }
        let (height, number) = (node.height as usize, node.number as usize);
        let bounds = query.lower_bounds(tree.node(height, number));
        let mut rest = tree.children(height, number);
        let mut nearest = len;
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            // A child is no nearer than the box that contains it.
            let bound = bounds[lane as usize].max(node.bound);
            stack[len] = BoundedNode { bound, number: node.number * ARITY as u32 + lane, height: node.height - 1 };
            nearest = if bound < stack[nearest].bound { len } else { nearest };
            len += 1;
        }
        stack.swap(nearest, len - 1);
    }
    best
}
