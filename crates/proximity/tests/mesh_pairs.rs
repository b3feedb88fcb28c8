//! Two meshes against the plain way: every triangle with every other.

use elbowroom_proximity::mesh::{Hint, Pair, Scratch, collide, contacts, distance, distance_at, within};
use elbowroom_proximity::{TriMesh, collides, separation};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use fearless_simd::Level;

/// A generator of numbers in [0, 1) with nothing but integer arithmetic, the same on every machine.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    fn rotation(&mut self) -> Rotation {
        loop {
            let q = [self.signed(), self.signed(), self.signed(), self.signed()];
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.1
                && let Some(r) = Rotation::from_quaternion_xyzw(q.map(|x| x / length))
            {
                return r;
            }
        }
    }

    /// A closed lump: a cube's faces cut into squares and pushed out, without a library function.
    fn lump(&mut self, cuts: usize) -> TriMesh {
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        let stretch = Vec3::new(0.3 + self.next(), 0.3 + self.next(), 0.3 + self.next());
        let bump = 0.3 * self.next();
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

    /// Triangles of all sizes, slivers and points among them, anywhere.
    fn soup(&mut self, count: usize) -> TriMesh {
        let mut vertices = Vec::new();
        for _ in 0..count {
            let p = self.vector() * 0.5;
            let size = 0.3 * self.next() * self.next();
            let (u, v) = (self.vector() * size, self.vector() * size);
            match (self.next() * 8.0) as usize {
                0 => vertices.extend([p, p, p]),
                1 => vertices.extend([p, p + u, p + u]),
                2 => vertices.extend([p, p + u, p + u * 0.3]),
                3 => vertices.extend([p, p + u, p + u * 0.5 + v * 1e-9]),
                // Along the axes, as drawn parts are.
                4 => vertices.extend([p, p + Vec3::X * size, p + Vec3::Y * size]),
                _ => vertices.extend([p, p + u, p + v]),
            }
        }
        TriMesh::new(vertices, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
    }
}

/// Nearest points of two segments by trying the inner optimum and every end.
fn segments(p: [Vec3; 2], q: [Vec3; 2]) -> f64 {
    let foot = |x: Vec3, [a, b]: [Vec3; 2]| {
        let length = (b - a).length_squared();
        let s = if length > 0.0 { ((x - a).dot(b - a) / length).clamp(0.0, 1.0) } else { 0.0 };
        (x - (a + (b - a) * s)).length()
    };
    let mut best = foot(p[0], q).min(foot(p[1], q)).min(foot(q[0], p)).min(foot(q[1], p));
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

/// Distance of a point from a triangle's plane where the foot is inside, else infinite.
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
fn plainly(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose) -> (f64, Vec<(u32, u32)>) {
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

/// Asks everything there is to ask about a pair of surfaces and compares.
fn compare(a: &TriMesh, here: &Pose, b: &TriMesh, there: &Pose, n: &mut Numbers, s: &mut Scratch) {
    let (least, mut expected) = plainly(a, here, b, there);
    let far = here.translation.length() + there.translation.length() + 1.0;
    let close = 1e-10 * far;
    let found = distance(a, here, b, there, s);
    if found.pair == Pair::Inside {
        assert!(a.report().closed || b.report().closed, "inside of nothing");
        return;
    }
    assert!((found.distance - least).abs() <= close, "{} is not {least}", found.distance);
    assert!(found.lower_bound <= found.distance && found.lower_bound <= least + close);
    assert!(((found.on_a - found.on_b).length() - found.distance).abs() <= close);
    if least > close {
        assert!(collide(a, here, b, there, s).is_none());
        assert!(within(a, here, b, there, least * (1.0 - 1e-9) - close, s).is_none());
    } else {
        assert!(collide(a, here, b, there, s).is_some());
    }
    let wide = least * (1.0 + 1e-9) + close;
    assert!(within(a, here, b, there, wide, s).is_some(), "nothing within {wide}, though {least} apart");
    assert!(distance_at(a, here, b, there, least * (1.0 + 1e-9) + close, None, s).is_some());
    assert!(least < close || distance_at(a, here, b, there, least * (1.0 - 1e-9) - close, None, s).is_none());
    let hinted = distance_at(a, here, b, there, f64::INFINITY, Some(found.hint), s).unwrap();
    assert_eq!(hinted.distance.to_bits(), found.distance.to_bits(), "a hint changes the answer");
    let astray: Hint = distance(b, there, a, here, s).hint;
    let misled = distance_at(a, here, b, there, f64::INFINITY, Some(astray), s).unwrap();
    assert_eq!(misled.distance.to_bits(), found.distance.to_bits(), "a wrong hint changes the answer");
    let turned = distance(b, there, a, here, s).distance;
    assert!((turned - found.distance).abs() <= close, "not symmetric");
    // Any common motion leaves distances alone.
    let motion = Pose { rotation: n.rotation(), translation: n.vector() };
    let moved = distance(a, &(motion * *here), b, &(motion * *there), s).distance;
    assert!((moved - found.distance).abs() <= 2.0 * close, "a common motion changes {} to {moved}", found.distance);
    let mut all = Vec::new();
    contacts(a, here, b, there, s, |pair| {
        if let Pair::Triangles(i, j) = pair {
            all.push((i, j));
        }
    });
    all.sort_unstable();
    assert!(all.windows(2).all(|w| w[0] != w[1]), "a contact is told twice");
    expected.sort_unstable();
    // What is apart by less than the slack may be told as well.
    let (of_a, of_b) = (corners(a, here), corners(b, there));
    assert!(expected.iter().all(|p| all.binary_search(p).is_ok()), "a contact is missing");
    assert!(all.iter().all(|&(i, j)| triangles(of_a[i as usize], of_b[j as usize]) <= close), "no contact");
}

fn rounds(short: usize, long: usize) -> usize {
    if std::env::var_os("ELBOWROOM_LONG").is_some() { long } else { short }
}

#[test]
fn s3_2_lumps_against_the_plain_way() {
    let (mut n, mut s) = (Numbers(1), Scratch::new());
    for round in 0..rounds(60, 3_000) {
        let (a, b) = (n.lump(2 + round % 4), n.lump(1 + round % 5));
        let apart = 0.2 + n.next();
        let here = Pose { rotation: n.rotation(), translation: n.vector() };
        let there = Pose { rotation: n.rotation(), translation: here.translation + n.vector() * apart };
        compare(&a, &here, &b, &there, &mut n, &mut s);
    }
}

#[test]
fn s3_2_soups_of_degenerate_triangles_against_the_plain_way() {
    let (mut n, mut s) = (Numbers(2), Scratch::new());
    for round in 0..rounds(150, 10_000) {
        let (a, b) = (n.soup(1 + round % 70), n.soup(1 + (round * 7) % 50));
        let spread = if round % 3 == 0 { 0.5 } else { 3.0 };
        let rotation = if round % 4 == 0 { Rotation::IDENTITY } else { n.rotation() };
        let there = Pose { rotation, translation: n.vector() * spread };
        compare(&a, &Pose::IDENTITY, &b, &there, &mut n, &mut s);
    }
}

#[test]
fn meshes_of_very_different_size_and_far_away() {
    let (mut n, mut s) = (Numbers(3), Scratch::new());
    for round in 0..rounds(60, 2_000) {
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
    let (mut n, mut s) = (Numbers(4), Scratch::new());
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
    let (mut n, mut s) = (Numbers(5), Scratch::new());
    let outer = n.lump(4);
    let shrunk = outer.vertices().iter().map(|v| *v * 0.3).collect();
    let inner = TriMesh::new(shrunk, outer.triangles().to_vec()).unwrap();
    let here = Pose::IDENTITY;
    assert_eq!(collide(&outer, &here, &inner, &here, &mut s), Some(Pair::Inside));
    assert_eq!(collide(&inner, &here, &outer, &here, &mut s), Some(Pair::Inside));
    assert_eq!(distance(&outer, &here, &inner, &here, &mut s).distance, 0.0);
    assert_eq!(within(&outer, &here, &inner, &here, 1e-3, &mut s), Some(Pair::Inside));
}

#[test]
fn what_is_not_a_number_is_contact() {
    let (mut n, mut s) = (Numbers(6), Scratch::new());
    let m = n.lump(2);
    for bad in [f64::NAN, f64::INFINITY, 1e200, 1e155] {
        let there = Pose::from_translation(Vec3::new(bad, 0.0, 0.0));
        for (x, y) in [(&Pose::IDENTITY, &there), (&there, &Pose::IDENTITY)] {
            assert_eq!(collide(&m, x, &m, y, &mut s), Some(Pair::Unknown), "{bad}");
            assert_eq!(within(&m, x, &m, y, 0.1, &mut s), Some(Pair::Unknown));
            assert_eq!(distance(&m, x, &m, y, &mut s).distance, 0.0);
        }
    }
    // So far away that nothing can be near: certain in f64.
    let there = Pose::from_translation(Vec3::X * 1e17);
    assert_eq!(collide(&m, &Pose::IDENTITY, &m, &there, &mut s), None);
    let shape = elbowroom_proximity::Shape::Mesh(m.into());
    let there = Pose::from_translation(Vec3::X * f64::NAN);
    assert!(collides(&shape, &there, &shape, &Pose::IDENTITY));
    assert_eq!(separation(&shape, &there, &shape, &Pose::IDENTITY).distance, 0.0);
}

/// Every instruction set of this processor.
fn levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = vec![("best", best)];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_sse2().map(|t| ("sse2", Level::Sse2(t))));
        levels.extend(best.as_sse4_2().map(|t| ("sse4.2", Level::Sse4_2(t))));
        levels.extend(best.as_avx2().map(|t| ("avx2", Level::Avx2(t))));
        levels.extend(best.as_avx512().map(|t| ("avx512", Level::Avx512(t))));
    }
    levels
}

fn mix(hash: &mut u64, x: u64) {
    // FNV-1a, byte by byte.
    for byte in x.to_le_bytes() {
        *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
}

/// All answers of a fixed workload, last bits included; and the way to them: which pairs were found, what was visited.
fn golden(level: Level) -> (u64, u64) {
    let (mut n, mut s) = (Numbers(7), Scratch::with_level(level));
    let (mut answers, mut way) = (0xcbf2_9ce4_8422_2325, 0xcbf2_9ce4_8422_2325);
    for round in 0..120 {
        let (a, b) = if round % 3 == 0 { (n.soup(60), n.soup(40)) } else { (n.lump(6), n.lump(5)) };
        let here = Pose { rotation: n.rotation(), translation: n.vector() };
        let there = Pose { rotation: n.rotation(), translation: here.translation + n.vector() * 0.8 };
        let found = distance(&a, &here, &b, &there, &mut s);
        mix(&mut answers, found.distance.to_bits());
        // On contact the first point found is as good as any other.
        let points = if found.distance > 0.0 { &mut answers } else { &mut way };
        for x in [found.lower_bound, found.on_a.x, found.on_b.y, found.on_b.z] {
            mix(points, x.to_bits());
        }
        let pair = collide(&a, &here, &b, &there, &mut s);
        let near = within(&a, &here, &b, &there, 0.1, &mut s);
        for pair in [pair, near] {
            mix(&mut answers, u64::from(pair.is_some()));
            if let Some(Pair::Triangles(i, j)) = pair {
                mix(&mut way, u64::from(i) << 32 | u64::from(j));
            }
        }
        let v = s.visits();
        for x in [v.nodes, v.boxes, v.leaves, v.triangles] {
            mix(&mut way, u64::from(x));
        }
    }
    (answers, way)
}

/// The answers of the engine, wherever it runs. A change here is a change of answers: say why.
const GOLDEN: u64 = 0xd7f2_aa22_0e93_64ca;

#[test]
fn every_instruction_set_gives_the_same_answers() {
    let (_, way) = golden(Level::new());
    for (name, level) in levels() {
        let (answers, same_way) = golden(level);
        assert_eq!(answers, GOLDEN, "{name}: {answers:#018x}");
        assert_eq!(same_way, way, "{name} goes another way");
    }
}
