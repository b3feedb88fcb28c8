//! Rays against surfaces: compared with all triangles one by one, and with the signed distance along the ray.

use std::sync::Arc;

use crate::common::{CONVEX, RandomGeometry, SplitMix, cases, lump};
use elbowroom_proximity::{
    Cuboid, Shape, TriMesh, intersects_segment, project_point, ray_cast, tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Vec3};

/// Distance at which a ray meets a triangle by the signs of three volumes (Plücker); `Err` if it passes its border so
/// closely that rounding decides.
fn oracle_hit([a, b, c]: [Vec3; 3], from: Vec3, along: Vec3) -> Result<Option<f64>, ()> {
    let (a, b, c) = (a - from, b - from, c - from);
    let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|n| n.dot(along));
    let sum: f64 = volumes.iter().sum();
    let scale = a.length().max(b.length()).max(c.length()).powi(2);
    if volumes.iter().any(|v| v.abs() < 1e-9 * scale) {
        // A triangle without area, or far from the ray, is not in doubt.
        let near = [(a, b), (b, c), (c, a)].iter().any(|(p, q)| line_distance(*p, *q, along) < 1e-6);
        return if near { Err(()) } else { Ok(None) };
    }
    if volumes.iter().any(|v| v.signum() != volumes[0].signum()) {
        return Ok(None);
    }
    let distance = (a * volumes[0] + b * volumes[1] + c * volumes[2]).dot(along) / sum;
    Ok((distance >= 0.0).then_some(distance))
}

/// Distance between the segment from `p` to `q` and the line through 0 along `along`, by sampling.
fn line_distance(p: Vec3, q: Vec3, along: Vec3) -> f64 {
    let off = |x: Vec3| (x - along * x.dot(along)).length();
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let (u, v) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if off(p.lerp(q, u)) < off(p.lerp(q, v)) { high = v } else { low = u }
    }
    off(p.lerp(q, low))
}

/// Distance of the first triangle; `Err` if rounding decides.
fn oracle(mesh: &TriMesh, from: Vec3, along: Vec3) -> Result<Option<f64>, ()> {
    let mut first: Option<f64> = None;
    for t in mesh.triangles() {
        let corners = t.map(|v| mesh.vertices()[v as usize]);
        if let Some(at) = oracle_hit(corners, from, along)?.filter(|at| first.is_none_or(|f| *at < f)) {
            first = Some(at);
        }
    }
    Ok(first)
}

#[test]
fn rays_meet_the_triangle_that_a_search_of_all_triangles_finds() {
    let mut rng = SplitMix(71);
    let meshes = [
        lump(0.3, 0.01, Vec3::new(1.0, 0.6, 1.4), 0.25),
        lump(0.05, 0.0005, Vec3::new(1.0, 1.0, 1.0), 0.1),
        lump(50.0, 2.0, Vec3::new(1.0, 0.1, 1.0), 0.3),
    ];
    let (mut hits, mut misses) = (0, 0);
    for mesh in meshes {
        let size = mesh.aabb().extent().max_element();
        let shape = Shape::Mesh(Arc::new(mesh.clone()));
        for k in 0..cases(1_200) / 2 {
            let pose = if k % 3 == 0 { Pose::IDENTITY } else { rng.pose(size) };
            let (from, to) = (rng.vec(1.5 * size), rng.vec(0.5 * size));
            let direction = match k % 5 {
                // Along an axis: two components are 0.
                0 => [Vec3::X, -Vec3::Y, Vec3::Z][k % 3],
                _ => to - from,
            };
            let Some(along) = direction.try_normalize() else { continue };
            let found = ray_cast(&shape, &pose, pose.transform_point(from), pose.transform_vector(direction));
            let Ok(expected) = oracle(&mesh, from, along) else { continue };
            match (found, expected) {
                (None, None) => misses += 1,
                (Some(hit), Some(at)) => {
                    hits += 1;
                    assert!((hit.distance_m - at).abs() < 1e-9 * size, "{hit:?}, all triangles say {at}");
                    let on_ray = pose.transform_point(from + along * at);
                    assert!((hit.point - on_ray).length() < 1e-9 * size, "{hit:?} {on_ray:?}");
                    let off = project_point(&shape, &pose, hit.point).signed_distance.abs();
                    assert!(off < 1e-13 * (1.0 + size + pose.translation.length()), "{off} off the surface: {hit:?}");
                    assert!((hit.outward.length() - 1.0).abs() < 1e-12 && hit.triangle.is_some());
                    // From outside the normal looks back, from inside it looks ahead.
                    let is_inside = mesh.contains(from);
                    let cosine = hit.outward.dot(pose.transform_vector(along));
                    assert!(if is_inside { cosine > -1e-9 } else { cosine < 1e-9 }, "{cosine} {is_inside}");
                }
                _ => panic!("{found:?}, all triangles say {expected:?}: from {from:?} along {along:?}"),
            }
        }
    }
    assert!(hits > 500 && misses > 100, "{hits} hits, {misses} misses");
}

#[test]
fn rays_meet_convex_shapes_where_the_signed_distance_changes_its_sign() {
    let mut rng = SplitMix(72);
    let mut hits = 0;
    for kind in CONVEX.into_iter().chain(["plane"]) {
        for _ in 0..cases(600) {
            let (shape, pose, from, aim) = (rng.shape(kind), rng.pose(0.5), rng.vec(2.0), rng.vec(0.7));
            let Some(along) = (aim - from).try_normalize() else { continue };
            let signed = |t: f64| project_point(&shape, &pose, from + along * t).signed_distance;
            let found = ray_cast(&shape, &pose, from, (aim - from) * 3.0);
            let end = found.map_or(6.0, |hit| hit.distance_m);
            // Before the hit, or along the whole ray, the sign is that of the origin.
            let side = signed(0.0).signum();
            for k in 0..400 {
                let t = end * f64::from(k) / 400.0;
                assert!(side * signed(t) > -1e-9, "{kind}: {t} of {found:?}, {} there", signed(t));
            }
            let Some(hit) = found else { continue };
            hits += 1;
            assert!(project_point(&shape, &pose, hit.point).signed_distance.abs() < 1e-12, "{kind}: {hit:?}");
            assert!((hit.point - (from + along * hit.distance_m)).length() < 1e-12);
            assert!((hit.outward.length() - 1.0).abs() < 1e-12);
            // A little farther along the normal the distance is that much larger.
            let above = project_point(&shape, &pose, hit.point + hit.outward * 1e-4).signed_distance;
            assert!((above - 1e-4).abs() < 1e-9, "{kind}: {above} {hit:?}");
        }
    }
    assert!(hits > 600, "{hits}");
}

#[test]
fn no_ray_slips_between_two_triangles() {
    // From inside a closed surface every ray leaves it, through edges and corners too.
    let mut rng = SplitMix(73);
    let mesh = lump(0.3, 0.01, Vec3::new(1.0, 0.7, 1.2), 0.1);
    let shape = Shape::Mesh(Arc::new(mesh.clone()));
    for _ in 0..cases(4_000) {
        let t = mesh.triangles()[rng.below(mesh.triangles().len())].map(|v| mesh.vertices()[v as usize]);
        let part = [0.0, 0.5, rng.between(0.0, 1.0)][rng.below(3)];
        let on_edge = t[0].lerp(t[1], part);
        let hit = ray_cast(&shape, &Pose::IDENTITY, Vec3::ZERO, on_edge).expect("the surface is closed");
        assert!(hit.distance_m <= on_edge.length() + 1e-9, "{hit:?} lies behind {on_edge:?}");
    }
}

#[test]
fn degenerate_rays_and_meshes_have_an_answer() {
    let (vertices, triangles) = tessellate(&Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) }), 0.01);
    let mut needles = triangles.clone();
    needles.extend([[0, 0, 1], [2, 2, 2], [0, 1, 0]]);
    let mut turned = triangles.clone();
    for t in &mut turned {
        t.swap(0, 1);
    }
    let shape = |t: Vec<[u32; 3]>| Shape::Mesh(Arc::new(TriMesh::new(vertices.clone(), t).unwrap()));
    for mesh in [shape(triangles.clone()), shape(needles), shape(turned)] {
        let hit = ray_cast(&mesh, &Pose::IDENTITY, Vec3::new(0.03, 0.02, 5.0), -Vec3::Z).unwrap();
        assert!((hit.distance_m - 4.9).abs() < 1e-12 && hit.outward == Vec3::Z, "{hit:?}");
        // Along a face, through an edge and a corner.
        for (from, along) in [
            (Vec3::new(-1.0, 0.0, 0.1), Vec3::X),
            (Vec3::new(1.0, 1.0, 0.0), -Vec3::new(1.0, 1.0, 0.0)),
            (Vec3::splat(1.0), -Vec3::splat(1.0)),
        ] {
            let hit = ray_cast(&mesh, &Pose::IDENTITY, from, along);
            assert!(hit.is_some_and(|h| h.point.abs().max_element() < 0.1 + 1e-9), "{from:?}: {hit:?}");
        }
        for bad in [Vec3::ZERO, Vec3::new(f64::NAN, 0.0, 1.0), Vec3::splat(f64::INFINITY)] {
            assert_eq!(ray_cast(&mesh, &Pose::IDENTITY, Vec3::ZERO, bad), None);
            let far = ray_cast(&mesh, &Pose::IDENTITY, bad, Vec3::Z);
            assert!(far.is_none() || bad == Vec3::ZERO);
        }
        assert_eq!(ray_cast(&mesh, &Pose::from_translation(Vec3::splat(f64::NAN)), Vec3::ZERO, Vec3::Z), None);
        assert_eq!(ray_cast(&mesh, &Pose::IDENTITY, Vec3::splat(1e300), Vec3::X), None);
    }
}

#[test]
fn lines_of_sight_meet_a_mesh_as_a_search_of_all_triangles_says() {
    let mut rng = SplitMix(74);
    let meshes = [
        lump(0.3, 0.01, Vec3::new(1.0, 0.6, 1.4), 0.25),
        lump(0.05, 0.0005, Vec3::new(1.0, 1.0, 1.0), 0.1),
        lump(50.0, 2.0, Vec3::new(1.0, 0.1, 1.0), 0.3),
    ];
    let mut found = [0; 2];
    let mut within = 0;
    for mesh in meshes {
        let size = mesh.aabb().extent().max_element();
        let shape = Shape::Mesh(Arc::new(mesh.clone()));
        for k in 0..cases(1_200) / 2 {
            let pose = if k % 3 == 0 { Pose::IDENTITY } else { rng.pose(size) };
            let wide = [1.5, 0.5, 0.05][k % 3] * size;
            let from = rng.vec(wide);
            let to = if k % 5 == 0 { from + Vec3::Y * rng.between(-size, size) } else { from + rng.vec(size) };
            let Some(along) = (to - from).try_normalize() else { continue };
            let Ok(first) = oracle(&mesh, from, along) else { continue };
            if first.is_some_and(|at| (at - from.distance(to)).abs() < 1e-9 * size) {
                continue;
            }
            let (crosses, is_inside) = (first.is_some_and(|at| at <= from.distance(to)), mesh.contains(from));
            let meets = intersects_segment(&shape, &pose, pose.transform_point(from), pose.transform_point(to));
            assert_eq!(meets, crosses || is_inside, "{from:?} to {to:?}, first triangle at {first:?}");
            found[usize::from(meets)] += 1;
            within += usize::from(is_inside && !crosses);
        }
    }
    assert!(found[0] > 100 && found[1] > 300 && within > 20, "{found:?}, {within} inside without a crossing");
}

#[test]
fn lines_of_sight_meet_a_convex_solid_if_the_least_signed_distance_along_them_is_not_positive() {
    let mut rng = SplitMix(75);
    let mut found = [0; 2];
    for kind in CONVEX.into_iter().chain(["plane"]) {
        for k in 0..cases(600) {
            let (shape, pose, from) = (rng.shape(kind), rng.pose(0.5), rng.vec(1.0));
            // Every eighth has no length.
            let to = if k % 8 == 0 { from } else { from + rng.vec(1.0) };
            // The signed distance from a convex solid is convex along a line.
            let signed = |t: f64| project_point(&shape, &pose, from.lerp(to, t)).signed_distance;
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..120 {
                let (u, v) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if signed(u) < signed(v) { high = v } else { low = u }
            }
            let least = signed(low).min(signed(0.0)).min(signed(1.0));
            if least.abs() < 1e-7 {
                continue;
            }
            let meets = intersects_segment(&shape, &pose, from, to);
            assert_eq!(meets, least < 0.0, "{kind}: {from:?} to {to:?}, least distance {least}");
            found[usize::from(meets)] += 1;
        }
    }
    assert!(found.iter().all(|count| *count > 300), "{found:?}");
}

#[test]
fn an_unknown_line_of_sight_is_not_free() {
    let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) });
    let (nan, far) = (Vec3::new(f64::NAN, 0.0, 0.0), Vec3::splat(2.0));
    let lost = Pose::from_translation(nan);
    assert!(intersects_segment(&shape, &Pose::IDENTITY, nan, far));
    assert!(intersects_segment(&shape, &Pose::IDENTITY, far, Vec3::splat(f64::INFINITY)));
    assert!(intersects_segment(&shape, &lost, far, far + Vec3::X));
    assert!(!intersects_segment(&shape, &Pose::IDENTITY, far, far));
}
