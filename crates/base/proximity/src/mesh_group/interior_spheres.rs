//! Spheres inside a closed mesh.

use elbowroom_spatial::Vec3;

use crate::TriMesh;

/// Approximate number of grid points that are tried.
const POINTS: f64 = 1500.0;
/// Number of steps away from the nearest point of the surface.
const STEPS: usize = 12;
/// Bound of a distance's rounding error, as a fraction of the size.
const ROUNDING: f64 = 1e-9;

/// A point inside the solid, and a radius (m) within which the surface has no point.
type Sphere = (Vec3, f64);

/// Up to `count` spheres in the interior. Each is chosen among the points of a grid as the sphere that contains the
/// most points outside all earlier spheres, and is then moved while it grows.
pub(super) fn interior_spheres(mesh: &TriMesh, count: usize) -> Vec<Sphere> {
    if !mesh.has_interior() {
        return Vec::new();
    }
    let mut left: Vec<Sphere> = grid(mesh).into_iter().filter_map(|p| Some((p, clearance(mesh, p)?))).collect();
    let mut chosen = Vec::new();
    while chosen.len() < count {
        let gain = |s: &Sphere| left.iter().filter(|(p, _)| p.distance(s.0) < s.1).count();
        let Some((_, best)) = left
            .iter()
            .map(|s| (gain(s), *s))
            .max_by(|a, b| (a.0, a.1.1).partial_cmp(&(b.0, b.1.1)).unwrap_or(std::cmp::Ordering::Equal))
        else {
            break;
        };
        let grown = grown(mesh, best);
        left.retain(|(p, _)| p.distance(grown.0) >= grown.1 && *p != best.0);
        chosen.push(grown);
    }
    chosen
}

/// A grid of points in the mesh's box.
fn grid(mesh: &TriMesh) -> Vec<Vec3> {
    let (bounds, extent) = (mesh.aabb(), mesh.aabb().extent());
    let spacing = (extent.x * extent.y * extent.z / POINTS).cbrt();
    if !(spacing > 0.0) {
        return Vec::new();
    }
    let along = |k: f64| (k / spacing).clamp(1.0, POINTS) as usize;
    let counts = [along(extent.x), along(extent.y), along(extent.z)];
    let at = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let mut points = Vec::new();
    for x in 0..counts[0] {
        for y in 0..counts[1] {
            for z in 0..counts[2] {
                let share = Vec3::new(at(x, counts[0]), at(y, counts[1]), at(z, counts[2]));
                let p = Vec3::new(share.x * extent.x, share.y * extent.y, share.z * extent.z);
                points.push(bounds.min + p);
            }
        }
    }
    points
}

/// Lower bound of the distance (m) from an inside point to the surface; `None` for a point outside.
fn clearance(mesh: &TriMesh, p: Vec3) -> Option<f64> {
    let nearest = mesh.nearest_point_within(p, f64::INFINITY)?;
    let metres = p.distance(nearest) - ROUNDING * (mesh.aabb().max_distance(Vec3::ZERO) + p.length());
    (metres > 0.0 && mesh.contains(p)).then_some(metres)
}

/// The sphere moved away from the surface as long as its radius grows.
fn grown(mesh: &TriMesh, mut best: Sphere) -> Sphere {
    let mut step = 0.5 * best.1;
    for _ in 0..STEPS {
        let Some(nearest) = mesh.nearest_point_within(best.0, f64::INFINITY) else { break };
        let Some(away) = (best.0 - nearest).try_normalize() else { break };
        let there = best.0 + away * step;
        match clearance(mesh, there) {
            Some(radius) if radius > best.1 => best = (there, radius),
            _ => step *= 0.5,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tessellate::tessellate;
    use crate::{Capsule, Cuboid, Shape};

    /// The spheres contain no point of any triangle, in steps of a twentieth of its sides; all centres are inside.
    #[test]
    fn spheres_are_inside() {
        let shapes = [
            Shape::Capsule(Capsule { half_length: 0.2, radius: 0.05 }),
            Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.02, 0.1) }),
        ];
        for shape in shapes {
            let (vertices, triangles) = tessellate(&shape, 1e-3);
            let mesh = TriMesh::new(vertices, triangles).unwrap();
            let spheres = interior_spheres(&mesh, 16);
            assert_eq!(spheres.len(), 16);
            let on_surface: Vec<Vec3> = (0..mesh.triangles().len())
                .flat_map(|t| {
                    let [a, b, c] = mesh.corners(t);
                    (0..=20).flat_map(move |i| {
                        let from = a + (b - a) * (f64::from(i) / 20.0);
                        (0..=20 - i).map(move |j| from + (c - a) * (f64::from(j) / 20.0))
                    })
                })
                .collect();
            for (centre, radius) in &spheres {
                assert!(mesh.contains(*centre) && *radius > 0.0);
                assert!(on_surface.iter().all(|p| p.distance(*centre) >= *radius));
            }
            // The largest sphere is nearly as large as possible.
            let largest = spheres.iter().fold(0.0, |r: f64, s| r.max(s.1));
            let expected = if matches!(shape, Shape::Capsule(_)) { 0.05 } else { 0.02 };
            assert!((largest - expected).abs() < 3e-3, "{largest}");
        }
        let open = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
        assert!(interior_spheres(&open, 16).is_empty());
    }
}
