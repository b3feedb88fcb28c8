//! Contact of a mesh and a sphere, capsule, cylinder or half-space: the point of the mesh that is deepest in the
//! other shape.

use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::contact_point::ContactPoint;
use super::surface::outward_normal;
use crate::bvh::BoxDistance;
use crate::separation::nearest_to_cylinder;
use crate::triangle::{nearest_on_triangle, segment_triangle};
use crate::{Shape, TriMesh, project_point};

/// The deepest point so far.
struct Deepest {
    /// Heights that differ by less count as equal, metres.
    resolution: f64,
    /// Distance from the centre or the axis, or height, in units of the resolution; a smaller value is deeper.
    height: f64,
    at: Vec3,
    triangle: usize,
}

impl Deepest {
    /// Offers a point. Of equal points the one with the smaller triangle index is kept, so that the result does not
    /// depend on the order of the tree.
    fn offer(&mut self, height: f64, at: Vec3, triangle: usize) {
        let height = (height / self.resolution).round();
        if height < self.height || (height == self.height && triangle < self.triangle) {
            (self.height, self.at, self.triangle) = (height, at, triangle);
        }
    }
}

/// The other shape, in the mesh's frame.
struct PlacedShape<'a> {
    shape: &'a Shape,
    in_mesh: &'a Pose,
    center: Vec3,
    axis: Vec3,
}

impl<'a> PlacedShape<'a> {
    fn new(shape: &'a Shape, in_mesh: &'a Pose) -> Self {
        Self { shape, in_mesh, center: in_mesh.translation, axis: in_mesh.rotation.z_axis() }
    }

    /// The deepest point of a triangle, and its distance from the centre or the axis, or its height.
    #[inline]
    fn deepest_of(&self, t: [Vec3; 3]) -> (f64, Vec3) {
        let Self { shape, in_mesh, center, axis } = *self;
        match shape {
            Shape::Capsule(c) => {
                let near = segment_triangle(center - axis * c.half_length, center + axis * c.half_length, t);
                (near.squared.sqrt(), near.on_b)
            }
            Shape::Cylinder(c) => {
                // The depth has one maximum over a triangle; these candidates contain it in most cases.
                let near = segment_triangle(center - axis * c.half_length, center + axis * c.half_length, t);
                let common = nearest_to_cylinder(c, in_mesh, t);
                let height = |p: Vec3| (project_point(shape, in_mesh, p).signed_distance, p);
                let candidates = [common, near.on_b, t[0], t[1], t[2]].map(height);
                candidates.into_iter().min_by(|x, y| x.0.total_cmp(&y.0)).unwrap_or((f64::INFINITY, t[0]))
            }
            Shape::HalfSpace(_) => {
                let height = |p: &Vec3| (*p - center).dot(axis);
                let lowest = t.into_iter().min_by(|p, q| height(p).total_cmp(&height(q))).unwrap_or(t[0]);
                (height(&lowest), lowest)
            }
            _ => {
                let at = nearest_on_triangle(center, t);
                (at.distance(center), at)
            }
        }
    }
}

/// The contact of the surfaces; `None` if the other shape is wholly inside the mesh.
pub(super) fn mesh_smooth(
    mesh: &TriMesh,
    in_world: &Pose,
    other: &Shape,
    other_in_mesh: &Pose,
) -> Option<ContactPoint> {
    let resolution = (1e-10 * mesh.aabb().extent().max_element()).max(f64::MIN_POSITIVE);
    let mut best = Deepest { resolution, height: f64::INFINITY, at: Vec3::ZERO, triangle: usize::MAX };
    let (radius, placed) = (radius(other), PlacedShape::new(other, other_in_mesh));
    let mut visit = |triangle: usize| {
        let (height, at) = placed.deepest_of(mesh.corners(triangle));
        best.offer(height, at, triangle);
    };
    if matches!(other, Shape::HalfSpace(_)) {
        (0..mesh.triangles().len()).for_each(&mut visit);
    } else {
        let bounds = other.aabb(&Pose::IDENTITY);
        // The box of the core; a cylinder is its own core.
        let shrink = Vec3::splat(radius);
        let core = Aabb { min: bounds.min + shrink, max: bounds.max - shrink };
        let size = mesh.aabb().extent().max_element() + bounds.extent().max_element() + placed.center.length();
        let limit = BoxDistance::limit(&mesh.bvh, radius + 1e-12 * size);
        mesh.bvh.traverse(&BoxDistance::new(&mesh.bvh, &core, other_in_mesh), limit, &mut |triangle| {
            visit(triangle);
            limit
        });
        let depth = best.height * resolution - radius;
        if !(depth <= 1e-12 * size + resolution) {
            return None;
        }
    }
    let other_in_world = *in_world * *other_in_mesh;
    let on_a = in_world.transform_point(best.at);
    let beside = project_point(other, &other_in_world, on_a);
    let away = in_world.inverse_transform_vector(-beside.outward);
    Some(ContactPoint {
        on_a,
        on_b: beside.on_surface,
        normal_a: in_world.transform_vector(outward_normal(mesh, best.triangle, best.at, away)),
        normal_b: beside.outward,
        triangle_a: Some(best.triangle as u32),
        triangle_b: None,
        touching: true,
    })
}

fn radius(shape: &Shape) -> f64 {
    match shape {
        Shape::Sphere(s) => s.radius,
        Shape::Capsule(c) => c.radius,
        _ => 0.0,
    }
}
