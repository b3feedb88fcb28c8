//! Level of detail: how far apart two meshes certainly are by their boxes down to some depth, and where.

use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::limit::Limit;
use super::node::{NEAR, open_as};
use super::placement::{Pairing, apart};
use super::probe::{Box as BoxProbe, Probe};
use super::scratch::{Entry, Scratch, Visits};
use super::swallowed::swallowed;
use super::tree::{FAN, Tree};
use crate::{Shape, TriMesh};

/// What boxes tell of two meshes, or of a mesh and something simple.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coarse {
    /// Proven: the distance is not below this, metres. 0 where boxes touch, and where one mesh lies inside the other.
    pub lower_bound: f64,
    /// A point of the first surface (to f32 rounding) in the box that is nearest, in the world: its landmark.
    pub on_a: Vec3,
    /// The same of the second. Their distance is no smaller than that of the surfaces.
    pub on_b: Vec3,
    /// Mean normal of the triangles in the box of the first, as they are drawn, in the world; zero where they cancel.
    pub normal_a: Vec3,
    /// The same of the second.
    pub normal_b: Vec3,
}

/// How many levels of boxes a mesh has below the one around all of it. Every level divides a box into up to sixteen;
/// those of the last hold up to eight triangles each.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, TriMesh, mesh, tessellate::tessellate};
/// let (corners, faces) = tessellate(&Shape::Sphere(Sphere { radius: 1.0 }), 0.001);
/// let ball = TriMesh::new(corners, faces)?;
/// let (triangles, depth) = (ball.triangles().len(), mesh::depth(&ball).into());
/// assert!(triangles <= 8 * 16_usize.pow(depth) && triangles > 8 * 16_usize.pow(depth - 1));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn depth(mesh: &TriMesh) -> u8 {
    mesh.tree.height() as u8
}

/// How far apart the boxes of two meshes are, down to a depth (0: the box around all of a mesh; [`depth`] and beyond:
/// boxes of up to eight triangles); `None` where they are certainly farther apart than `limit` metres, which ends the
/// search as soon as a level says so.
///
/// The boxes lie along the axes of each mesh's own frame, with a slab along the mean normal of what they hold. Which of
/// several boxes at nearly the same distance is told depends on rounding in f32, and so on the instruction set.
///
/// ```
/// use elbowroom_proximity::{TriMesh, mesh::{Scratch, bound_at, distance}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there, mut scratch) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5), Scratch::new());
/// let coarse = bound_at(&mesh, &here, &mesh, &there, 0, 1.0, &mut scratch).expect("it is nearer");
/// let exact = distance(&mesh, &here, &mesh, &there, &mut scratch);
/// assert!(coarse.lower_bound <= exact.distance && exact.distance <= coarse.on_a.distance(coarse.on_b) + 1e-6);
/// assert!(bound_at(&mesh, &here, &mesh, &there, 0, 0.4, &mut scratch).is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn bound_at(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    depth: u8,
    limit: f64,
    scratch: &mut Scratch,
) -> Option<Coarse> {
    scratch.visits = Visits::default();
    if apart(&a.tree, a_in_world, &b.tree, b_in_world, limit.max(0.0)) {
        return None;
    }
    let pairing = Pairing::new(&a.tree, a_in_world, &b.tree, b_in_world);
    if !pairing.is_usable() {
        return Some(Coarse::unknown(a_in_world.translation, b_in_world.translation));
    }
    let unit = a.tree.frame.unit;
    let found = descend(&a.tree, &b.tree, &pairing, depth, limit.max(0.0) / unit + pairing.slack, scratch);
    if scratch.stack.overflown() {
        return Some(Coarse::unknown(a_in_world.translation, b_in_world.translation));
    }
    let touching = found.is_some_and(|e| e.key <= 0.0);
    if !touching && let Some(p) = swallowed(a, a_in_world, b, b_in_world) {
        return Some(Coarse::unknown(p, p));
    }
    let found = found?;
    let (on_a, normal_a) = lane(&a.tree, found.a, found.height_a);
    let (on_b, normal_b) = lane(&b.tree, found.b, found.height_b);
    let gap = f64::from(found.key.max(0.0)).sqrt() * (1.0 - 1e-5) - 2.0 * pairing.doubt - pairing.slack;
    Some(Coarse {
        lower_bound: gap.max(0.0) * unit,
        on_a: a_in_world.transform_point(on_a),
        on_b: b_in_world.transform_point(on_b),
        normal_a: a_in_world.transform_vector(normal_a),
        normal_b: b_in_world.transform_vector(normal_b),
    })
}

impl Coarse {
    fn unknown(on_a: Vec3, on_b: Vec3) -> Self {
        Self { lower_bound: 0.0, on_a, on_b, normal_a: Vec3::ZERO, normal_b: Vec3::ZERO }
    }
}

/// The pair of boxes that looks nearest; no farther than `radius`, units of A.
fn descend(a: &Tree, b: &Tree, pairing: &Pairing, depth: u8, radius: f64, scratch: &mut Scratch) -> Option<Entry> {
    let level = scratch.level();
    let Scratch { stack, visits, .. } = scratch;
    let mut limit = Limit::new(radius, pairing);
    limit.look_along(pairing.in_a(Vec3::ZERO), pairing);
    let root = Entry::root(a, b);
    let (floor_a, floor_b) = (root.height_a.saturating_sub(depth), root.height_b.saturating_sub(depth));
    let mut best: Option<Entry> = None;
    stack.clear();
    // The roots themselves are compared before any is opened.
    visits.boxes += open_as::<NEAR>(level, (a, b), &root, (false, false), pairing, &limit, stack);
    while let Some(pair) = stack.pop() {
        if pair.key > limit.squared {
            continue;
        }
        let (above_a, above_b) = (pair.height_a - floor_a, pair.height_b - floor_b);
        if above_a == 0 && above_b == 0 {
            if best.is_none_or(|b| pair.key < b.key) {
                best = Some(pair);
                limit.squared = limit.squared.min(pair.key.max(0.0));
            }
            if pair.key <= 0.0 {
                break;
            }
            continue;
        }
        visits.nodes += 1;
        let opens = (above_a >= above_b, above_b >= above_a);
        visits.boxes += open_as::<NEAR>(level, (a, b), &pair, opens, pairing, &limit, stack);
    }
    best
}

/// Landmark and mean normal of a node, mesh frame, metres.
fn lane(tree: &Tree, number: u32, height: u8) -> (Vec3, Vec3) {
    let (number, height) = (number as usize, height as usize);
    let (parent, lane) = (&tree.levels[height][number / FAN], number % FAN);
    let at = |p: &[[f32; FAN]; 3]| [p[0][lane], p[1][lane], p[2][lane]];
    let normal = Vec3::from(at(&parent.normal).map(f64::from));
    (tree.frame.in_metres(at(&parent.mark)), normal.try_normalize().unwrap_or(Vec3::ZERO))
}

/// [`bound_at`] of a mesh and a bounded simple shape, by the box around the shape in its own frame. `None` for a
/// half-space, a mesh as the second, and what is not a number.
pub fn bound_of(
    mesh: &TriMesh,
    mesh_in_world: &Pose,
    shape: &Shape,
    shape_in_world: &Pose,
    depth: u8,
) -> Option<Coarse> {
    if matches!(shape, Shape::HalfSpace(_) | Shape::Mesh(_)) || !crate::separation::usable(shape, shape_in_world) {
        return None;
    }
    let bounds: Aabb = shape.aabb(&Pose::IDENTITY);
    let probe = BoxProbe::new(&mesh.tree, &bounds, &mesh_in_world.inverse_mul(shape_in_world));
    let (bound, number, height) = nearest_box(&mesh.tree, &probe, depth);
    let (mark, normal) = lane(&mesh.tree, number, height);
    let (mark, normal) = (mesh_in_world.transform_point(mark), mesh_in_world.transform_vector(normal));
    let other = crate::project_point(shape, shape_in_world, mark);
    let gap = f64::from(bound.max(0.0)) * (1.0 - 1e-6) * mesh.tree.frame.unit;
    let inside = || mesh.contains(mesh_in_world.inverse_transform_point(shape_in_world.transform_point(inner(shape))));
    let lower_bound = if bound.is_nan() || inside() { 0.0 } else { gap };
    Some(Coarse { lower_bound, on_a: mark, on_b: other.on_surface, normal_a: normal, normal_b: other.outward })
}

/// A point of the solid, in its own frame.
fn inner(shape: &Shape) -> Vec3 {
    if let Shape::Hull(hull) = shape { hull.vertices()[0] } else { Vec3::ZERO }
}

/// The box at a depth whose bound is smallest: bound (units of the tree), number and height.
fn nearest_box(tree: &Tree, probe: &BoxProbe, depth: u8) -> (f32, u32, u8) {
    let root = tree.height() as u8;
    let floor = root.saturating_sub(depth);
    let above = probe.bounds(&tree.levels[root as usize][0])[0];
    let mut best = (f32::INFINITY, 0, root);
    // Each step down leaves at most 15 siblings behind; trees are 8 high.
    let mut stack = [(0.0_f32, 0_u32, 0_u8); 16 * 10];
    stack[0] = (above, 0, root);
    let mut len = 1;
    while len > 0 {
        len -= 1;
        let (bound, number, height) = stack[len];
        if bound >= best.0 {
            continue;
        }
        if height == floor {
            best = (bound, number, height);
            continue;
        }
        let bounds = probe.bounds(&tree.levels[height as usize - 1][number as usize]);
        let mut rest = tree.children(height as usize, number as usize);
        let mut nearest = len;
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            // A child is no nearer than the box that holds it.
            let bound = bounds[lane as usize].max(bound);
            stack[len] = (bound, number * FAN as u32 + lane, height - 1);
            nearest = if bound < stack[nearest].0 { len } else { nearest };
            len += 1;
        }
        stack.swap(nearest, len - 1);
    }
    best
}
