//! Surfaces of regions and of their warning zones, and their horizontal cross-sections.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use elbowroom_proximity::repair::merge_targets;
use elbowroom_proximity::surroundings::cavity;
use elbowroom_proximity::{Shape, Sphere, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};

/// An edge, the smaller vertex index first.
type Edge = (u32, u32);

/// Vertices and triangles.
pub type SurfaceMesh = (Vec<Vec3>, Vec<[u32; 3]>);

const CHORD_ERROR_M: f64 = 1e-3;
/// Distance within which vertices are merged, m.
const SAME_VERTEX_M: f64 = 1e-9;
/// Half the side (m) of the patch drawn for a plane.
const PATCH_M: f64 = 2.0;
/// Thickness (m) of the half-space drawn behind a plane.
const PATCH_DEPTH_M: f64 = 0.05;

/// The region's surface in the shape's frame. A plane is a thin patch; of what surrounds a solid that robots must not
/// leave, it is the inner side.
pub fn solid(shape: &Shape) -> SurfaceMesh {
    match shape {
        Shape::HalfSpace(_) => slab(-PATCH_DEPTH_M, 0.0),
        Shape::Mesh(mesh) if let Some(inner) = cavity(mesh) => inner,
        _ => tessellate(shape, CHORD_ERROR_M),
    }
}

/// The surface at distance `warning_m` around the shape, in the shape's frame; `None` without a warning zone.
///
/// For a convex shape the vertices are exact: the support point of each direction, moved along that direction (the
/// Minkowski sum with a ball). The vertices of a mesh move along their normals.
pub fn warning(shape: &Shape, warning_m: f64) -> Option<SurfaceMesh> {
    if !(warning_m > 0.0 && warning_m.is_finite()) {
        return None;
    }
    Some(match shape {
        Shape::HalfSpace(_) => slab(0.0, warning_m),
        Shape::Sphere(s) => tessellate(&Shape::Sphere(Sphere { radius: s.radius + warning_m }), CHORD_ERROR_M),
        Shape::Mesh(_) => {
            let (vertices, triangles) = solid(shape);
            offset_along_normals(&vertices, &triangles, warning_m)
        }
        _ => inflated(shape, warning_m),
    })
}

fn slab(z0: f64, z1: f64) -> SurfaceMesh {
    let shape =
        Shape::Cuboid(elbowroom_proximity::Cuboid { half_extents: Vec3::new(PATCH_M, PATCH_M, 0.5 * (z1 - z0)) });
    let (mut vertices, triangles) = tessellate(&shape, CHORD_ERROR_M);
    for v in &mut vertices {
        v.z += 0.5 * (z0 + z1);
    }
    (vertices, triangles)
}

/// Directions on a sphere, each mapped to the support point of the inflated shape.
fn inflated(shape: &Shape, margin: f64) -> SurfaceMesh {
    const AROUND: usize = 96;
    const RINGS: usize = 49; // odd: one ring just above and one just below the equator, so flat sides stay flat
    let direction = |ring: usize, step: usize| {
        // Directions avoid the axes, where a face has no unique support point.
        let tilt = PI * (ring as f64 + 0.02) / (RINGS as f64 - 0.96);
        let turn = TAU * (step as f64 + 0.5) / AROUND as f64;
        Vec3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos())
    };
    let mut vertices = Vec::with_capacity(RINGS * AROUND + 2);
    for ring in 0..RINGS {
        for step in 0..AROUND {
            let d = direction(ring, step);
            vertices.push(shape.support(d) + d * margin);
        }
    }
    let mean = |from: usize| vertices[from..from + AROUND].iter().fold(Vec3::ZERO, |a, &b| a + b) / AROUND as f64;
    let (top, bottom) = (mean(0), mean((RINGS - 1) * AROUND));
    let (north, south) = (vertices.len() as u32, vertices.len() as u32 + 1);
    vertices.extend([top, bottom]);
    let at = |ring: usize, step: usize| (ring * AROUND + step % AROUND) as u32;
    let mut triangles = Vec::with_capacity(2 * RINGS * AROUND);
    for step in 0..AROUND {
        triangles.push([north, at(0, step), at(0, step + 1)]);
        triangles.push([south, at(RINGS - 1, step + 1), at(RINGS - 1, step)]);
        for ring in 0..RINGS - 1 {
            let [a, b] = [at(ring, step), at(ring, step + 1)];
            let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    (vertices, triangles)
}

fn offset_along_normals(vertices: &[Vec3], triangles: &[[u32; 3]], margin: f64) -> SurfaceMesh {
    let mut normals = vec![Vec3::ZERO; vertices.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| vertices[i as usize]);
        let area_normal = (b - a).cross(c - a);
        for &i in t {
            normals[i as usize] += area_normal;
        }
    }
    let moved = vertices.iter().zip(&normals).map(|(&v, n)| v + n.try_normalize().unwrap_or(Vec3::ZERO) * margin);
    (moved.collect(), triangles.to_vec())
}

/// Closed curves (x, y) in which a surface intersects the horizontal plane at `height_m`, both in the world.
///
/// An open surface gives open curves.
pub fn section(surface: &SurfaceMesh, in_world: &Pose, height_m: f64) -> Vec<Vec<[f64; 2]>> {
    let welded = merge_targets(&surface.0, SAME_VERTEX_M);
    let points: Vec<Vec3> = surface.0.iter().map(|&v| in_world.transform_point(v)).collect();
    let above = |i: u32| points[i as usize].z >= height_m;
    let mut next: HashMap<Edge, [Option<Edge>; 2]> = HashMap::new();
    let mut at: HashMap<Edge, [f64; 2]> = HashMap::new();
    for t in &surface.1 {
        let t = t.map(|i| welded[i as usize]);
        let crossed: Vec<Edge> = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
            .into_iter()
            .filter(|&(a, b)| above(a) != above(b))
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        let [e, f] = crossed[..] else { continue };
        for (here, there) in [(e, f), (f, e)] {
            at.entry(here).or_insert_with(|| cross(points[here.0 as usize], points[here.1 as usize], height_m));
            let slots = next.entry(here).or_default();
            if let Some(free) = slots.iter_mut().find(|s| s.is_none()) {
                *free = Some(there);
            }
        }
    }
    chains(next, &at)
}

fn cross(a: Vec3, b: Vec3, height: f64) -> [f64; 2] {
    let p = a.lerp(b, (height - a.z) / (b.z - a.z));
    [p.x, p.y]
}

fn chains(mut next: HashMap<Edge, [Option<Edge>; 2]>, at: &HashMap<Edge, [f64; 2]>) -> Vec<Vec<[f64; 2]>> {
    let mut starts: Vec<Edge> = next.keys().copied().collect();
    // Ends of open curves first, then a fixed order: the output is deterministic.
    starts.sort_unstable_by_key(|e| (next[e][1].is_some(), *e));
    let mut curves = Vec::new();
    for start in starts {
        let mut curve = Vec::new();
        let mut here = Some(start);
        while let Some(edge) = here {
            let Some(neighbours) = next.remove(&edge) else {
                if edge == start {
                    curve.push(at[&edge]);
                }
                break;
            };
            curve.push(at[&edge]);
            let unseen = neighbours.into_iter().flatten().find(|n| next.contains_key(n));
            let closes = neighbours.into_iter().flatten().any(|n| n == start) && curve.len() > 2;
            here = unseen.or(closes.then_some(start));
        }
        if curve.len() > 1 {
            curves.push(curve);
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_proximity::{Cuboid, Cylinder, project_point};

    fn shapes() -> Vec<Shape> {
        vec![
            Shape::Sphere(Sphere { radius: 0.3 }),
            Shape::Cylinder(Cylinder { half_length: 0.6, radius: 0.15 }),
            Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.2, 0.4, 0.1) }),
        ]
    }

    #[test]
    fn every_vertex_of_a_warning_zone_is_at_its_thickness() {
        for shape in shapes() {
            let (vertices, _) = warning(&shape, 0.25).unwrap();
            let poles = 2; // means of a ring: inside the cap by its sagitta
            for v in &vertices[..vertices.len() - poles] {
                let d = project_point(&shape, &Pose::IDENTITY, *v).signed_distance;
                assert!((d - 0.25).abs() < 2e-3, "{shape:?} {v:?}: {d}");
            }
        }
    }

    #[test]
    fn sections_are_closed_and_lie_on_the_surface() {
        let tilted = Pose::from_xyz_rpy([0.3, -0.2, 0.7], [0.4, -0.3, 1.0]);
        for shape in shapes() {
            let curves = section(&solid(&shape), &tilted, 0.72);
            assert_eq!(curves.len(), 1);
            assert_eq!(curves[0].first(), curves[0].last());
            for p in &curves[0] {
                let d = project_point(&shape, &tilted, Vec3::new(p[0], p[1], 0.72)).signed_distance;
                assert!(d.abs() < 2e-3, "{shape:?}: {d}");
            }
            assert!(section(&solid(&shape), &tilted, 9.0).is_empty());
        }
    }
}
