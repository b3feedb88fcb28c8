//! Two meshes compared with a simple implementation: all pairs of triangles.

use elbowroom_proximity::advanced::{
    MeshFeatures, colliding_triangles, for_each_contact, mesh_separation, mesh_separation_with, triangles_within,
};
use elbowroom_proximity::{DistanceSettings, Separation, Shape, TriMesh, WarmStart, Workspace, collides, separation};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::extent::amount;
use elbowroom_testkit::hash::Fnv;
use elbowroom_testkit::random::Random;
use fearless_simd::Level as SimdLevel;

/// Random meshes and rotations, the same on every machine: by integer arithmetic, without library functions.
pub trait RandomMeshes {
    fn vector(&mut self) -> Vec3;

    fn rotation(&mut self) -> Rotation;

    /// A closed lump: the faces of a cube, subdivided and displaced.
    fn lump(&mut self, cuts: usize) -> TriMesh;

    /// Triangles of all sizes at any place, including slivers and points.
    fn soup(&mut self, count: usize) -> TriMesh;
}

impl RandomMeshes for Random {
    fn vector(&mut self) -> Vec3 {
        Vec3::from(self.within(1.0))
    }

    fn rotation(&mut self) -> Rotation {
        loop {
            let q: [f64; 4] = self.within(1.0);
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.1
                && let Some(r) = Rotation::from_quaternion_xyzw(q.map(|x| x / length))
            {
                return r;
            }
        }
    }

    fn lump(&mut self, cuts: usize) -> TriMesh {
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        let stretch = Vec3::new(0.3 + self.unit(), 0.3 + self.unit(), 0.3 + self.unit());
        let bump = 0.3 * self.unit();
        let shape = |p: Vec3| {
            let n = p / p.length();
            let wave = (5.0 * n.x * n.y + 3.0 * n.z).rem_euclid(1.0);
            (n * (1.0 + bump * (wave * (1.0 - wave)))).scale(stretch) * 0.3
        };
        let step = |i: usize| 2.0 * i as f64 / cuts as f64 - 1.0;
        for face in 0..6 {
            let first = vertices.len() as u32;
            for i in 0..=cuts {
                for j in 0..=cuts {
                    let (u, v) = (step(i), step(j));
                    let p = match face {
                        0 => Vec3::new(1.0, u, v),
                        1 => Vec3::new(-1.0, v, u),
                        2 => Vec3::new(v, 1.0, u),
                        3 => Vec3::new(u, -1.0, v),
                        4 => Vec3::new(u, v, 1.0),
                        _ => Vec3::new(v, u, -1.0),
                    };
                    vertices.push(shape(p));
                }
            }
            let at = |i: usize, j: usize| first + (i * (cuts + 1) + j) as u32;
            for i in 0..cuts {
                for j in 0..cuts {
                    triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                    triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        TriMesh::new(vertices, triangles).unwrap()
    }

    fn soup(&mut self, count: usize) -> TriMesh {
        let mut vertices = Vec::new();
        for _ in 0..count {
            let p = self.vector() * 0.5;
            let size = 0.3 * self.unit() * self.unit();
            let (u, v) = (self.vector() * size, self.vector() * size);
            match (self.unit() * 8.0) as usize {
                0 => vertices.extend([p, p, p]),
                1 => vertices.extend([p, p + u, p + u]),
                2 => vertices.extend([p, p + u, p + u * 0.3]),
                3 => vertices.extend([p, p + u, p + u * 0.5 + v * 1e-9]),
                // Edges are along the axes, as in modelled parts.
                4 => vertices.extend([p, p + Vec3::X * size, p + Vec3::Y * size]),
                _ => vertices.extend([p, p + u, p + v]),
            }
        }
        TriMesh::new(vertices, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
    }
}

/// Distance of two segments by the inner optimum and every end.
fn segments(p: [Vec3; 2], q: [Vec3; 2]) -> f64 {
    let to_segment = |x: Vec3, [a, b]: [Vec3; 2]| {
        let length = (b - a).length_squared();
        let s = if length > 0.0 { ((x - a).dot(b - a) / length).clamp(0.0, 1.0) } else { 0.0 };
        (x - (a + (b - a) * s)).length()
    };
    let mut best = to_segment(p[0], q).min(to_segment(p[1], q)).min(to_segment(q[0], p)).min(to_segment(q[1], p));
    let (u, v, w) = (p[1] - p[0], q[1] - q[0], p[0] - q[0]);
    let (a, b, c, d, e) = (u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w));
    let det = a * c - b * b;
    if det > 0.0 {
        let (s, t) = ((b * e - c * d) / det, (a * e - b * d) / det);
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            best = best.min((w + u * s - v * t).length());
        }
    }
    best
}

/// Distance of a point from a triangle's plane if its projection is inside, else infinite.
fn over(x: Vec3, t: [Vec3; 3]) -> f64 {
    let n = (t[1] - t[0]).cross(t[2] - t[0]);
    if n.length() < 1e-12 * (t[1] - t[0]).length_squared().max((t[2] - t[0]).length_squared()) || n.length() == 0.0 {
        return f64::INFINITY;
    }
    let inside = (0..3).all(|k| n.dot((t[(k + 1) % 3] - t[k]).cross(x - t[k])) >= 0.0);
    if inside { (n.dot(x - t[0]) / n.length()).abs() } else { f64::INFINITY }
}

fn pierces(p: [Vec3; 2], t: [Vec3; 3]) -> bool {
    let n = (t[1] - t[0]).cross(t[2] - t[0]);
    let (h, k) = (n.dot(p[0] - t[0]), n.dot(p[1] - t[0]));
    if !(h * k < 0.0) || n.length() < 1e-12 * (t[1] - t[0]).length_squared() {
        return false;
    }
    let x = p[0] + (p[1] - p[0]) * (h / (h - k));
    (0..3).all(|k| n.dot((t[(k + 1) % 3] - t[k]).cross(x - t[k])) >= 0.0)
}

fn triangles(s: [Vec3; 3], t: [Vec3; 3]) -> f64 {
    let edge = |x: [Vec3; 3], k: usize| [x[k], x[(k + 1) % 3]];
    let mut best = f64::INFINITY;
    for k in 0..3 {
        if pierces(edge(s, k), t) || pierces(edge(t, k), s) {
            return 0.0;
        }
        best = best.min(over(s[k], t)).min(over(t[k], s));
        for l in 0..3 {
            best = best.min(segments(edge(s, k), edge(t, l)));
        }
    }
    best
}

fn corners(m: &TriMesh, in_world: &Pose) -> Vec<[Vec3; 3]> {
    let at = |t: &[u32; 3]| t.map(|i| in_world.transform_point(m.vertices()[i as usize]));
    m.triangles().iter().map(at).collect()
}

/// Smallest distance, and every pair that touches.
fn all_pairs(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose) -> (f64, Vec<(u32, u32)>) {
    let (of_a, of_b) = (corners(a, a_in_world), corners(b, b_in_world));
    let (mut least, mut touching) = (f64::INFINITY, Vec::new());
    for (i, s) in of_a.iter().enumerate() {
        for (j, t) in of_b.iter().enumerate() {
            let d = triangles(*s, *t);
            least = least.min(d);
            if d <= 1e-12 {
                touching.push((i as u32, j as u32));
            }
        }
    }
    (least, touching)
}

/// Settings with a limit and a warm start.
fn with_settings(
    a: &TriMesh,
    here: &Pose,
    b: &TriMesh,
    there: &Pose,
    limit: f64,
    warm_start: &mut WarmStart,
    s: &mut Workspace,
) -> Option<Separation> {
    let settings = DistanceSettings { limit, warm_start: Some(warm_start), ..DistanceSettings::default() };
    mesh_separation_with(a, here, b, there, settings, s)
}

/// Compares every query on a pair of surfaces.
fn compare(a: &TriMesh, here: &Pose, b: &TriMesh, there: &Pose, n: &mut Random, s: &mut Workspace) {
    let (least, mut expected) = all_pairs(a, here, b, there);
    let far = here.translation.length() + there.translation.length() + 1.0;
    let close = 1e-10 * far;
    let mut warm_start = WarmStart::default();
    let found = with_settings(a, here, b, there, f64::INFINITY, &mut warm_start, s).unwrap();
    if s.closest_features() == Some(MeshFeatures::Containment) {
        assert!(a.report().closed || b.report().closed, "inside of nothing");
        return;
    }
    assert!((found.distance - least).abs() <= close, "{} is not {least}", found.distance);
    assert!(found.lower_bound <= found.distance && found.lower_bound <= least + close);
    assert!(((found.on_a - found.on_b).length() - found.distance).abs() <= close);
    if least > close {
        assert!(colliding_triangles(a, here, b, there, s).is_none());
        assert!(triangles_within(a, here, b, there, least * (1.0 - 1e-9) - close, s).is_none());
    } else {
        assert!(colliding_triangles(a, here, b, there, s).is_some());
    }
    let wide = least * (1.0 + 1e-9) + close;
    assert!(triangles_within(a, here, b, there, wide, s).is_some(), "nothing within {wide}, though {least} apart");
    let cold = || WarmStart::default();
    assert!(with_settings(a, here, b, there, least * (1.0 + 1e-9) + close, &mut cold(), s).is_some());
    let limit = least * (1.0 - 1e-9) - close;
    assert!(least < close || with_settings(a, here, b, there, limit, &mut cold(), s).is_none());
    let warm = with_settings(a, here, b, there, f64::INFINITY, &mut warm_start, s).unwrap();
    assert_eq!(warm.distance.to_bits(), found.distance.to_bits(), "a warm start changes the answer");
    let mut wrong_start = cold();
    let turned = with_settings(b, there, a, here, f64::INFINITY, &mut wrong_start, s).unwrap().distance;
    let misled = with_settings(a, here, b, there, f64::INFINITY, &mut wrong_start, s).unwrap();
    assert_eq!(misled.distance.to_bits(), found.distance.to_bits(), "a wrong warm start changes the answer");
    assert!((turned - found.distance).abs() <= close, "not symmetric");
    // A common motion does not change distances.
    let motion = Pose { rotation: n.rotation(), translation: n.vector() };
    let moved = mesh_separation(a, &(motion * *here), b, &(motion * *there), s).distance;
    assert!((moved - found.distance).abs() <= 2.0 * close, "a common motion changes {} to {moved}", found.distance);
    let mut all = Vec::new();
    for_each_contact(a, here, b, there, s, |pair| {
        if let MeshFeatures::Triangles(i, j) = pair {
            all.push((i, j));
        }
    });
    all.sort_unstable();
    assert!(all.windows(2).all(|w| w[0] != w[1]), "a contact is reported twice");
    expected.sort_unstable();
    // Pairs closer than the f64 error may be reported as well.
    let (of_a, of_b) = (corners(a, here), corners(b, there));
    assert!(expected.iter().all(|p| all.binary_search(p).is_ok()), "a contact is missing");
    assert!(all.iter().all(|&(i, j)| triangles(of_a[i as usize], of_b[j as usize]) <= close), "no contact");
}

#[test]
fn s3_2_lumps_against_all_pairs() {
    let (mut n, mut s) = (Random(1), Workspace::new());
    for round in 0..amount(60, 3_000) {
        let (a, b) = (n.lump(2 + round % 4), n.lump(1 + round % 5));
        let apart = 0.2 + n.unit();
        let here = Pose { rotation: n.rotation(), translation: n.vector() };
        let there = Pose { rotation: n.rotation(), translation: here.translation + n.vector() * apart };
        compare(&a, &here, &b, &there, &mut n, &mut s);
    }
}

#[test]
fn s3_2_soups_of_degenerate_triangles_against_all_pairs() {
    let (mut n, mut s) = (Random(2), Workspace::new());
    for round in 0..amount(150, 10_000) {
        let (a, b) = (n.soup(1 + round % 70), n.soup(1 + (round * 7) % 50));
        let spread = if round % 3 == 0 { 0.5 } else { 3.0 };
        let rotation = if round % 4 == 0 { Rotation::IDENTITY } else { n.rotation() };
        let there = Pose { rotation, translation: n.vector() * spread };
        compare(&a, &Pose::IDENTITY, &b, &there, &mut n, &mut s);
    }
}

#[test]
fn meshes_of_very_different_size_and_far_away() {
    let (mut n, mut s) = (Random(3), Workspace::new());
    for round in 0..amount(60, 2_000) {
        let scale = [1e-3, 1e3, 1e-6][round % 3];
        let big = n.lump(3);
        let small = n.lump(3);
        let small =
            TriMesh::new(small.vertices().iter().map(|v| *v * scale).collect(), small.triangles().to_vec()).unwrap();
        let off = if round % 2 == 0 { Vec3::splat(1e6) } else { Vec3::ZERO };
        let here = Pose { rotation: n.rotation(), translation: off };
        let there = Pose { rotation: n.rotation(), translation: off + n.vector() * (1.0 + scale) };
        compare(&big, &here, &small, &there, &mut n, &mut s);
    }
}

#[test]
fn plates_that_face_each_other_exactly() {
    let grid = |cuts: usize| {
        let at = |i: usize, j: usize| (i * (cuts + 1) + j) as u32;
        let point = |k: usize| Vec3::new((k / (cuts + 1)) as f64, (k % (cuts + 1)) as f64, 0.0) / cuts as f64;
        let faces = (0..cuts * cuts).flat_map(|k| {
            let (i, j) = (k / cuts, k % cuts);
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        });
        TriMesh::new((0..(cuts + 1) * (cuts + 1)).map(point).collect(), faces.collect()).unwrap()
    };
    let (mut n, mut s) = (Random(4), Workspace::new());
    let plate = grid(6);
    for height in [0.0, 1e-15, 1e-9, 1e-3, 0.25, 4.0] {
        for shift in [Vec3::ZERO, Vec3::X * 0.5, Vec3::new(1.0, 1.0, 0.0), Vec3::X * 3.0] {
            let there = Pose::from_translation(shift + Vec3::Z * height);
            compare(&plate, &Pose::IDENTITY, &plate, &there, &mut n, &mut s);
        }
    }
}

#[test]
fn one_inside_the_other_collides() {
    let (mut n, mut s) = (Random(5), Workspace::new());
    let outer = n.lump(4);
    let shrunk = outer.vertices().iter().map(|v| *v * 0.3).collect();
    let inner = TriMesh::new(shrunk, outer.triangles().to_vec()).unwrap();
    let here = Pose::IDENTITY;
    assert_eq!(colliding_triangles(&outer, &here, &inner, &here, &mut s), Some(MeshFeatures::Containment));
    assert_eq!(colliding_triangles(&inner, &here, &outer, &here, &mut s), Some(MeshFeatures::Containment));
    assert_eq!(mesh_separation(&outer, &here, &inner, &here, &mut s).distance, 0.0);
    assert_eq!(triangles_within(&outer, &here, &inner, &here, 1e-3, &mut s), Some(MeshFeatures::Containment));
}

#[test]
fn nan_is_contact() {
    let (mut n, mut s) = (Random(6), Workspace::new());
    let m = n.lump(2);
    for bad in [f64::NAN, f64::INFINITY, 1e200, 1e155] {
        let there = Pose::from_translation(Vec3::new(bad, 0.0, 0.0));
        for (x, y) in [(&Pose::IDENTITY, &there), (&there, &Pose::IDENTITY)] {
            assert_eq!(colliding_triangles(&m, x, &m, y, &mut s), Some(MeshFeatures::Unknown), "{bad}");
            assert_eq!(triangles_within(&m, x, &m, y, 0.1, &mut s), Some(MeshFeatures::Unknown));
            assert_eq!(mesh_separation(&m, x, &m, y, &mut s).distance, 0.0);
        }
    }
    // The meshes are so far apart that f64 proves that nothing is near.
    let there = Pose::from_translation(Vec3::X * 1e17);
    assert_eq!(colliding_triangles(&m, &Pose::IDENTITY, &m, &there, &mut s), None);
    let shape = Shape::Mesh(m.into());
    let there = Pose::from_translation(Vec3::X * f64::NAN);
    assert!(collides(&shape, &there, &shape, &Pose::IDENTITY));
    assert_eq!(separation(&shape, &there, &shape, &Pose::IDENTITY).distance, 0.0);
}

/// Every instruction set of this processor.
fn simd_levels() -> Vec<(&'static str, SimdLevel)> {
    let best = SimdLevel::new();
    let mut levels = vec![("best", best)];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_sse2().map(|t| ("sse2", SimdLevel::Sse2(t))));
        levels.extend(best.as_sse4_2().map(|t| ("sse4.2", SimdLevel::Sse4_2(t))));
        levels.extend(best.as_avx2().map(|t| ("avx2", SimdLevel::Avx2(t))));
        levels.extend(best.as_avx512().map(|t| ("avx512", SimdLevel::Avx512(t))));
    }
    levels
}

/// Hashes of a fixed workload: all answers, including the last bits; and the course of the search, which is the
/// pairs found and the number of nodes visited.
fn golden(simd_level: SimdLevel) -> (u64, u64) {
    let (mut n, mut s) = (Random(7), Workspace::with_simd_level(simd_level));
    let (mut answers, mut course) = (Fnv::default(), Fnv::default());
    for round in 0..120 {
        let (a, b) = if round % 3 == 0 { (n.soup(60), n.soup(40)) } else { (n.lump(6), n.lump(5)) };
        let here = Pose { rotation: n.rotation(), translation: n.vector() };
        let there = Pose { rotation: n.rotation(), translation: here.translation + n.vector() * 0.8 };
        let found = mesh_separation(&a, &here, &b, &there, &mut s);
        answers.add(found.distance.to_bits());
        // On contact, any common point is a valid answer.
        let points = if found.distance > 0.0 { &mut answers } else { &mut course };
        for x in [found.lower_bound, found.on_a.x, found.on_b.y, found.on_b.z] {
            points.add(x.to_bits());
        }
        let pair = colliding_triangles(&a, &here, &b, &there, &mut s);
        let near = triangles_within(&a, &here, &b, &there, 0.1, &mut s);
        for pair in [pair, near] {
            answers.add(u64::from(pair.is_some()));
            if let Some(MeshFeatures::Triangles(i, j)) = pair {
                course.add(u64::from(i) << 32 | u64::from(j));
            }
        }
        let v = s.stats();
        for x in [v.nodes, v.boxes, v.leaves, v.triangles] {
            course.add(u64::from(x));
        }
    }
    (answers.0, course.0)
}

/// Hash of the answers on any machine. A change here is a change of answers: state why.
const GOLDEN: u64 = 0xd7f2_aa22_0e93_64ca;

#[test]
fn every_instruction_set_gives_the_same_answers() {
    let (_, course) = golden(SimdLevel::new());
    for (name, simd_level) in simd_levels() {
        let (answers, same_course) = golden(simd_level);
        assert_eq!(answers, GOLDEN, "{name}: {answers:#018x}");
        assert_eq!(same_course, course, "{name}: the search takes another course");
    }
}
