//! Distances checked by certificates that do not use the code under test.
//!
//! Witness points inside the solids prove an upper bound, a support plane between the solids a lower bound.

use crate::common::{CONVEX, RandomGeometry, SplitMix, cases};
use elbowroom_proximity::{Cuboid, Shape, Sphere, collides, project_point, separation, separation_within, within};
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// Distance of the two support planes perpendicular to `d`, which points from b to a.
fn plane_gap(a: &Shape, pa: &Pose, b: &Shape, pb: &Pose, d: Vec3) -> f64 {
    let low = pa.transform_point(a.support(pa.inverse_transform_vector(-d))).dot(d);
    if matches!(b, Shape::HalfSpace(_)) {
        return low - pb.translation.dot(d);
    }
    low - pb.transform_point(b.support(pb.inverse_transform_vector(d))).dot(d)
}

/// The best of the support planes near `d`: perpendicular to the witness points, along normals of faces,
/// perpendicular to axes, and improved by hill climbing until they prove `wanted` or do not improve any more. Every
/// direction gives a valid bound.
fn best_plane_gap(d: Vec3, frames: [Rotation; 2], wanted: f64, gap: impl Fn(Vec3) -> f64) -> f64 {
    let axes = frames.map(|r| [r.x_axis(), r.y_axis(), r.z_axis()]);
    let across = axes.as_flattened().iter().map(|&e| d - e * d.dot(e));
    let products = axes[0].iter().flat_map(|x| axes[1].map(|y| x.cross(y)));
    let special = axes.as_flattened().iter().copied().chain(across).chain(products);
    let near = special.filter_map(Vec3::try_normalize).filter(|e| e.dot(d).abs() > 0.99);
    let all = near.map(|e| if e.dot(d) < 0.0 { -e } else { e }).chain([d]);
    let mut best = (f64::NEG_INFINITY, d);
    for e in all {
        let value = gap(e);
        best = if value > best.0 { (value, e) } else { best };
    }
    hill_climb(best.1, best.0, wanted, gap)
}

fn hill_climb(mut d: Vec3, mut best: f64, wanted: f64, gap: impl Fn(Vec3) -> f64) -> f64 {
    let (mut step, mut phase) = (1e-4, 0.0);
    while best < wanted && step > 1e-17 {
        let (x, y) = (d.any_perpendicular(), d.cross(d.any_perpendicular()));
        let mut improved = false;
        for k in 0..8 {
            let (sin, cos) = (phase + f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
            let tilted = (d + (x * cos + y * sin) * step).try_normalize().unwrap();
            let value = gap(tilted);
            if value > best {
                (best, d, improved) = (value, tilted, true);
            }
        }
        step *= if improved { 1.5 } else { 0.8 };
        phase += 1.0;
    }
    best
}

/// Radius of the core about the frame's origin, metres.
fn reach(shape: &Shape) -> f64 {
    match shape {
        Shape::Capsule(c) => c.half_length,
        Shape::Cylinder(c) => c.half_length.hypot(c.radius),
        Shape::Cuboid(c) => c.half_extents.length(),
        Shape::Hull(h) => h.vertices().iter().fold(0.0, |r: f64, v| r.max(v.length())),
        _ => 0.0,
    }
}

fn certify(a: &Shape, pa: &Pose, b: &Shape, pb: &Pose, tolerance: f64) -> bool {
    let s = separation(a, pa, b, pb);
    let what = || format!("{a:?} at {pa:?}\n{b:?} at {pb:?}\n{s:?}");
    assert!(s.distance >= 0.0 && s.lower_bound >= 0.0 && s.lower_bound <= s.distance, "{}", what());
    assert!(s.on_a.is_finite() && s.on_b.is_finite(), "{}", what());
    assert_eq!(collides(a, pa, b, pb), s.distance <= 0.0, "{}", what());
    if s.distance < 1e-9 {
        return false;
    }
    // Continuous witness points of nearly parallel faces and edges may be slightly farther apart.
    let flat = [a, b].iter().all(|s| !matches!(s, Shape::Sphere(_) | Shape::HalfSpace(_)));
    let excess = if flat { 2e-8 * (reach(a) + reach(b)) } else { 0.0 };
    let d = (s.on_a - s.on_b) / s.distance;
    assert!(
        (d.length() - 1.0).abs() < 1e-6 + excess / s.distance,
        "the distance of the witness points is not the distance: {}",
        what()
    );
    assert!((s.on_a.distance(s.on_b) - s.distance).abs() <= tolerance + excess, "{}", what());
    assert!(project_point(a, pa, s.on_a).signed_distance <= tolerance, "on_a is not in a: {}", what());
    assert!(project_point(b, pb, s.on_b).signed_distance <= tolerance, "on_b is not in b: {}", what());
    let d = d.try_normalize().unwrap();
    let d = if matches!(b, Shape::HalfSpace(_)) { pb.rotation.z_axis() } else { d };
    let tolerance = tolerance + 4e-15 / s.distance;
    let proven = best_plane_gap(d, [pa.rotation, pb.rotation], s.distance - tolerance, |d| plane_gap(a, pa, b, pb, d));
    // Hill climbing gets stuck on the ridges of cylinders' support functions, by up to 5e-9 for thin discs. The `lower_bound` is
    // checked with the full tolerance below.
    let curved = matches!(a, Shape::Cylinder(_)) || matches!(b, Shape::Cylinder(_));
    assert!(
        s.distance - proven <= if curved { tolerance.max(1e-8) } else { tolerance },
        "not the least: {proven} proven, {}",
        what()
    );
    assert!(s.distance - s.lower_bound <= tolerance + 1e-13, "loose bound: {}", what());
    true
}

fn pair(first: &str, second: &str, tolerance: f64) {
    let mut rng = SplitMix(first.len() as u64 * 31 + second.len() as u64);
    let n = cases(10_000);
    let mut apart = 0;
    for _ in 0..n {
        let (a, b) = (rng.shape(first), rng.shape(second));
        let (pa, pb) = (rng.pose(1.5), rng.pose(1.5));
        apart += usize::from(certify(&a, &pa, &b, &pb, tolerance));
    }
    assert!(apart > n / 10, "only {apart} of {n} apart: too few");
}

#[test]
fn sphere_against_all_is_exact() {
    for other in ["sphere", "capsule", "cylinder", "box", "plane", "hull"] {
        pair("sphere", other, 1e-14);
    }
}

#[test]
fn capsule_against_primitives_is_exact() {
    for other in ["capsule", "cylinder", "box", "plane"] {
        pair("capsule", other, 2e-14);
    }
    pair("capsule", "hull", 1e-12);
}

#[test]
fn half_space_against_all_is_exact() {
    for other in ["cylinder", "box", "hull"] {
        pair(other, "plane", 1e-14);
    }
}

#[test]
fn polytopes_are_exact_to_rounding() {
    pair("box", "box", 1e-12);
    pair("box", "hull", 1e-12);
    pair("hull", "hull", 1e-12);
}

#[test]
fn cylinders_are_within_the_stated_bound() {
    pair("cylinder", "box", 1e-11);
    pair("cylinder", "hull", 1e-11);
    pair("cylinder", "cylinder", 1e-11);
}

/// The four tests of the tool's OBB against the elementary regions, each compared with points sampled in the box.
#[test]
fn s1_10_obb_against_plane_sphere_cylinder_and_obb() {
    let mut rng = SplitMix(110);
    for case in 0..cases(2_000) / 4 {
        for other in ["plane", "sphere", "cylinder", "box"] {
            let (gun, region) = (rng.shape("box"), rng.shape(other));
            let (pg, pr) = (rng.pose(1.5), rng.pose(1.5));
            let apart = certify(&gun, &pg, &region, &pr, 1e-11);
            let Shape::Cuboid(c) = &gun else { unreachable!() };
            for _ in 0..30 {
                // Corners, edges, faces and the inside: each coordinate at an end or in between.
                let mut coordinate = |h: f64| match rng.below(3) {
                    0 => -h,
                    1 => h,
                    _ => rng.between(-h, h),
                };
                let h = c.half_extents;
                let p = pg.transform_point(Vec3::new(coordinate(h.x), coordinate(h.y), coordinate(h.z)));
                let to_region = project_point(&region, &pr, p).signed_distance.max(0.0);
                let distance = separation(&gun, &pg, &region, &pr).distance;
                assert!(to_region >= distance - 1e-12, "case {case} {other}: a point of the box is nearer");
                assert!(!apart || to_region > 0.0);
            }
        }
    }
}

#[test]
fn swapped_and_moved_pairs_answer_the_same() {
    let mut rng = SplitMix(7);
    for first in ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"] {
        for second in ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"] {
            for _ in 0..100 {
                let (a, b, pa, pb) = (rng.shape(first), rng.shape(second), rng.pose(1.5), rng.pose(1.5));
                let ab = separation(&a, &pa, &b, &pb);
                let ba = separation(&b, &pb, &a, &pa);
                assert!((ab.distance - ba.distance).abs() < 1e-11, "{first} {second}: {ab:?} {ba:?}");
                let motion = Pose::new(Rotation::from_rotation_vector(rng.vec(3.0)), rng.vec(5.0));
                let moved = separation(&a, &(motion * pa), &b, &(motion * pb));
                assert!((ab.distance - moved.distance).abs() < 1e-11, "{first} {second}: {ab:?} {moved:?}");
            }
        }
    }
}

#[test]
fn a_limit_changes_only_answers_beyond_it() {
    let mut rng = SplitMix(9);
    for first in ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"] {
        for second in ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"] {
            for _ in 0..100 {
                let (a, b, pa, pb) = (rng.shape(first), rng.shape(second), rng.pose(1.5), rng.pose(1.5));
                let (limit, all) = (rng.between(0.0, 1.0), separation(&a, &pa, &b, &pb));
                let limited = separation_within(&a, &pa, &b, &pb, limit);
                match limited {
                    None => assert!(all.distance > limit - 1e-12, "{first} {second} {limit}: {all:?}"),
                    Some(s) => assert!((s.distance - all.distance).abs() < 1e-11, "{first} {second}: {s:?} {all:?}"),
                }
                assert_eq!(within(&a, &pa, &b, &pb, limit), limited.is_some());
                assert!(limited.is_some() || all.lower_bound > limit - 1e-11);
                assert!(limited.is_none() || all.distance <= limit + 1e-11);
            }
        }
    }
}

#[test]
fn growing_a_shape_never_increases_the_distance() {
    use elbowroom_proximity::{Capsule, Cylinder};
    let mut rng = SplitMix(11);
    for _ in 0..cases(3_000) {
        let grow = 1.0 + rng.unit();
        let (r, h) = (rng.size(), rng.size());
        let pairs = [
            (Shape::Sphere(Sphere { radius: r }), Shape::Sphere(Sphere { radius: r * grow })),
            (
                Shape::Capsule(Capsule { half_length: h, radius: r }),
                Shape::Capsule(Capsule { half_length: h * grow, radius: r }),
            ),
            (
                Shape::Cylinder(Cylinder { half_length: h, radius: r }),
                Shape::Cylinder(Cylinder { half_length: h, radius: r * grow }),
            ),
            (
                Shape::Cuboid(Cuboid { half_extents: Vec3::new(r, h, 0.1) }),
                Shape::Cuboid(Cuboid { half_extents: Vec3::new(r * grow, h, 0.1) }),
            ),
        ];
        let (pa, pb) = (rng.pose(1.5), rng.pose(1.5));
        for kind in CONVEX {
            let other = rng.shape(kind);
            for (small, large) in &pairs {
                let (s, l) = (separation(small, &pa, &other, &pb), separation(large, &pa, &other, &pb));
                assert!(l.distance <= s.distance + 1e-11, "{small:?} {large:?} {other:?}: {s:?} {l:?}");
            }
        }
    }
}

#[test]
fn degenerate_sizes_and_poses_have_an_answer() {
    let sizes = [0.0, 1e-9, 1.0, 1e6];
    let places = [0.0, 1e-9, 2.0, 3.0, 2e6];
    let turns = [Rotation::IDENTITY, Rotation::from_rpy(0.0, 1e-9, 0.0), Rotation::from_rpy(1.0, 2.0, 3.0)];
    let all = |r: f64| {
        use elbowroom_proximity::{Capsule, Cylinder};
        [
            Shape::Sphere(Sphere { radius: r }),
            Shape::Capsule(Capsule { half_length: r, radius: 0.5 * r }),
            Shape::Cylinder(Cylinder { half_length: r, radius: r }),
            Shape::Cuboid(Cuboid { half_extents: Vec3::splat(r) }),
        ]
    };
    for (ra, rb, at) in sizes.iter().flat_map(|a| sizes.iter().flat_map(move |b| places.map(|p| (*a, *b, p)))) {
        for (a, b, turn) in all(ra)
            .iter()
            .flat_map(|a| all(rb).map(|b| (a.clone(), b)))
            .flat_map(|(a, b)| turns.map(|t| (a.clone(), b.clone(), t)))
        {
            let pa = Pose::new(turn, Vec3::new(0.0, 0.0, at));
            let s = separation(&a, &pa, &b, &Pose::IDENTITY);
            let scale = 1.0 + ra + rb + at;
            certify(&a, &pa, &b, &Pose::IDENTITY, 1e-12 * scale);
            // Each shape contains the sphere of half its size about its centre, and is inside the sphere of twice its size.
            assert!(s.distance <= (at - 0.5 * (ra + rb)).max(0.0) + 1e-14 * scale, "{a:?} {b:?} {at}: {s:?}");
            assert!(s.distance >= (at - 2.0 * (ra + rb)).max(0.0) - 1e-14 * scale, "{a:?} {b:?} {at}: {s:?}");
        }
    }
}

#[test]
fn touching_counts_as_contact() {
    use elbowroom_proximity::Cylinder;
    let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
    let can = Shape::Cylinder(Cylinder { half_length: 0.5, radius: 0.5 });
    for direction in [Vec3::X, -Vec3::Y, Vec3::Z] {
        for other in [&cube, &can] {
            let s = separation(&cube, &Pose::from_translation(direction), other, &Pose::IDENTITY);
            assert!(s.distance <= 1e-14 && s.lower_bound == 0.0, "{direction:?} {other:?} {s:?}");
            assert!(collides(other, &Pose::from_translation(direction), &cube, &Pose::IDENTITY));
        }
    }
}

#[test]
fn nan_is_never_free() {
    let mut rng = SplitMix(13);
    let kinds = ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for k in 0..3 {
            let mut t = [9.0; 3];
            t[k] = bad;
            for first in kinds {
                for second in kinds {
                    let (a, b) = (rng.shape(first), rng.shape(second));
                    for (pa, pb) in [
                        (Pose::from_translation(t.into()), Pose::from_translation(Vec3::splat(-9.0))),
                        (
                            Pose::from_translation(Vec3::splat(9.0)),
                            Pose::new(Rotation::from_rpy(bad, 0.0, 0.0), -Vec3::Z),
                        ),
                    ] {
                        let s = separation(&a, &pa, &b, &pb);
                        assert_eq!((s.distance, s.lower_bound), (0.0, 0.0), "{first} {second} {bad}");
                        assert!(collides(&a, &pa, &b, &pb));
                    }
                }
            }
        }
        let far = Pose::from_translation(Vec3::splat(9.0));
        for broken in
            [Shape::Sphere(Sphere { radius: bad }), Shape::Cuboid(Cuboid { half_extents: Vec3::new(1.0, bad, 1.0) })]
        {
            assert_eq!(separation(&broken, &far, &rng.shape("box"), &Pose::IDENTITY).distance, 0.0);
            assert!(broken.validate().is_err());
        }
    }
}

#[test]
fn random_bit_patterns_neither_panic_nor_hang() {
    let mut rng = SplitMix(17);
    let kinds = ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"];
    for _ in 0..20_000 {
        let (a, b) = (rng.shape(kinds[rng.0 as usize % 7]), rng.shape(kinds[(rng.0 >> 8) as usize % 7]));
        let mut any = || f64::from_bits(rng.bits());
        let (pa, pb) = (
            Pose::from_translation(Vec3::new(any(), any(), any())),
            Pose::new(Rotation::from_rpy(any(), any(), any()), Vec3::new(any(), 0.0, any())),
        );
        let s = separation(&a, &pa, &b, &pb);
        assert!(
            s.distance >= 0.0 && s.lower_bound >= 0.0 && s.lower_bound <= s.distance,
            "{a:?} {pa:?} {b:?} {pb:?} {s:?}"
        );
    }
}
