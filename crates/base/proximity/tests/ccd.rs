//! Times of impact compared with dense sampling and refinement, and with closed forms.

use std::sync::Arc;

use crate::common::{CONVEX, RandomGeometry, SplitMix};
use elbowroom_proximity::ccd::{
    CcdOptions, ConstantTwist, MovingShape, RigidMotion, time_of_impact, time_to_collision,
};
use elbowroom_proximity::motion_culling::{FaceCulling, RelativeTwist};
use elbowroom_proximity::{
    Capsule, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, separation, tessellate::tessellate,
};
use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

/// Number of motions; 100,000 with `ELBOWROOM_LONG=1`.
fn motions(usual: usize) -> usize {
    elbowroom_testkit::extent::amount(usual, usual * 50)
}

fn mesh_of(shape: &Shape) -> Shape {
    let (vertices, triangles) = tessellate(shape, 0.002);
    Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
}

fn cuboid(x: f64, y: f64, z: f64) -> Shape {
    Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) })
}

/// A shape that sampling a motion would miss.
fn thin(rng: &mut SplitMix) -> Shape {
    let t = rng.between(1e-4, 1e-3);
    match rng.below(6) {
        0 => cuboid(0.4, 0.4, t),
        1 => cuboid(0.6, t, t),
        2 => Shape::Capsule(Capsule { half_length: 0.5, radius: t }),
        3 => Shape::Cylinder(Cylinder { half_length: 0.5, radius: t }),
        4 => mesh_of(&cuboid(0.4, 0.4, t)),
        _ => Shape::Cylinder(Cylinder { half_length: t, radius: 0.4 }),
    }
}

fn mover(rng: &mut SplitMix, kind: usize) -> Shape {
    let mut size = || rng.between(0.01, 0.1);
    match kind {
        0 => Shape::Sphere(Sphere { radius: size() }),
        1 => Shape::Capsule(Capsule { half_length: size(), radius: size() * 0.3 }),
        2 => cuboid(size(), size(), size()),
        3 => Shape::Cylinder(Cylinder { half_length: size(), radius: size() }),
        4 => {
            let points: Vec<Vec3> = (0..12).map(|_| rng.vec(0.1)).collect();
            Shape::Hull(Arc::new(elbowroom_proximity::ConvexHull::from_points(&points).unwrap()))
        }
        _ => {
            let (half_length, radius) = (size(), size());
            mesh_of(&Shape::Cylinder(Cylinder { half_length, radius }))
        }
    }
}

/// A random motion: half are towards the origin, three quarters have rotation, some about distant axes or with many
/// turns.
fn motion(rng: &mut SplitMix) -> ConstantTwist {
    let from = Pose::new(Rotation::from_rotation_vector(rng.vec(3.0)), rng.vec(1.5));
    let aim = if rng.below(2) == 0 { rng.vec(0.3) } else { rng.vec(1.2) };
    let travel = (aim - from.translation) * rng.between(1.0, 3.0);
    match rng.below(4) {
        0 => ConstantTwist::linear(from, travel),
        1 => {
            let mut straight = ConstantTwist::linear(from, travel);
            straight.rotation = rng.vec(20.0);
            straight
        }
        2 => ConstantTwist::straight(
            from,
            Pose::new(Rotation::from_rotation_vector(rng.vec(3.0)), from.translation + travel),
        ),
        _ => ConstantTwist::screw(from, rng.vec(0.8), rng.vec(6.0), rng.between(-1.0, 1.0)),
    }
}

/// A motion with nothing known but its speed bounds.
struct Opaque(ConstantTwist);

impl RigidMotion for Opaque {
    fn pose(&self, t: f64) -> Pose {
        self.0.pose(t)
    }
    fn speed(&self, radius: f64, from: f64, to: f64) -> f64 {
        self.0.speed(radius, from, to)
    }
    fn speed_along(&self, direction: Vec3, radius: f64, from: f64, to: f64) -> f64 {
        self.0.speed_along(direction, radius, from, to)
    }
}

/// Smallest distance up to `end`, by samples and golden-section search between them.
fn least_distance(distance: &dyn Fn(f64) -> f64, end: f64, samples: usize) -> f64 {
    let at = |k: usize| end * k as f64 / samples as f64;
    let d: Vec<f64> = (0..=samples).map(|k| distance(at(k))).collect();
    let mut least = d.iter().copied().fold(f64::INFINITY, f64::min);
    for k in 0..=samples {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(samples));
        // Local minima that could be contacts.
        if d[k] <= d[before] && d[k] <= d[after] && d[k] < 0.1 {
            least = least.min(golden(distance, at(before), at(after)));
        }
    }
    least
}

fn golden(f: &dyn Fn(f64) -> f64, mut lo: f64, mut hi: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_895;
    let (mut x, mut y) = (hi - RATIO * (hi - lo), lo + RATIO * (hi - lo));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..40 {
        if fx < fy {
            (hi, y, fy) = (y, x, fx);
            x = hi - RATIO * (hi - lo);
            fx = f(x);
        } else {
            (lo, x, fx) = (x, y, fy);
            y = lo + RATIO * (hi - lo);
            fy = f(y);
        }
        if fx.min(fy) <= 0.0 {
            break;
        }
    }
    fx.min(fy)
}

/// Checks one answer; returns true if it was a contact after the start.
fn check(
    a: &Shape,
    pa: &dyn RigidMotion,
    b: &Shape,
    pb: &dyn RigidMotion,
    options: &CcdOptions,
    samples: usize,
) -> bool {
    let what = |s: String| format!("{s}\n{a:?}\n{b:?}\n{:?}\n{:?}", pa.constant_twist(), pb.constant_twist());
    let distance = |t: f64| separation(a, &pa.pose(t), b, &pb.pose(t)).distance;
    let Some(hit) = time_of_impact(a, pa, b, pb, options) else {
        let least = least_distance(&distance, 1.0, samples);
        assert!(least > 0.0, "{}", what(format!("missed: {least}")));
        return false;
    };
    assert!(hit.certain && hit.steps < options.max_steps, "{}", what(format!("{hit:?}")));
    assert!((0.0..=1.0).contains(&hit.time) && hit.separation <= options.tolerance, "{}", what(format!("{hit:?}")));
    assert_eq!(hit.separation, distance(hit.time), "{}", what(format!("{hit:?}")));
    if hit.time == 0.0 {
        return false;
    }
    let normal = hit.normal.unwrap();
    assert!((hit.on_a - hit.on_b - normal * hit.separation).length() < 1e-9, "{}", what(format!("{hit:?}")));
    let least = least_distance(&distance, hit.time, samples);
    assert!(least > 0.0, "{}", what(format!("too late: {hit:?}")));
    true
}

#[test]
fn thin_plates_and_wires_are_not_tunnelled_through() {
    let mut rng = SplitMix(1);
    let n = motions(2_000);
    let options = CcdOptions::default();
    let mut hits = 0;
    for k in 0..n {
        let (a, b) = (mover(&mut rng, k % 6), thin(&mut rng));
        let path = motion(&mut rng);
        let b_in_world = Pose::new(Rotation::from_rotation_vector(rng.vec(3.0)), rng.vec(0.2));
        hits += usize::from(check(&a, &path, &b, &b_in_world, &options, 60));
    }
    assert!(hits > n / 5 && hits < n * 4 / 5, "{hits} of {n} hit: too few");
}

#[test]
fn no_tunnelling_when_both_move() {
    let mut rng = SplitMix(2);
    let n = motions(400);
    let options = CcdOptions { tolerance: 1e-5, ..CcdOptions::default() };
    let mut hits = 0;
    for k in 0..n {
        let (a, b) = (mover(&mut rng, k % 6), thin(&mut rng));
        let (pa, mut pb) = (motion(&mut rng), motion(&mut rng));
        pb.velocity = pb.velocity * 0.3;
        hits += usize::from(check(&a, &pa, &b, &pb, &options, 150));
        // The order of the two shapes makes no difference.
        let (forward, swapped) =
            (time_of_impact(&a, &pa, &b, &pb, &options), time_of_impact(&b, &pb, &a, &pa, &options));
        assert_eq!(forward.is_some(), swapped.is_some());
    }
    assert!(hits > n / 20, "{hits} of {n} hit: too few");
}

#[test]
fn motions_with_speed_bounds_only_find_the_same() {
    let mut rng = SplitMix(3);
    let options = CcdOptions::default();
    for k in 0..motions(200) {
        let (a, b) = (mover(&mut rng, k % 6), thin(&mut rng));
        let path = motion(&mut rng);
        let (known, unknown) = (&path, Opaque(path));
        check(&a, &unknown, &b, &Pose::IDENTITY, &CcdOptions { max_steps: 1_000_000, ..options }, 60);
        let sharp = time_of_impact(&a, known, &b, &Pose::IDENTITY, &options);
        let coarse = time_of_impact(&a, &unknown, &b, &Pose::IDENTITY, &options);
        if let (Some(sharp), Some(coarse)) = (sharp, coarse) {
            // Both results are within the tolerance of one contact; a pass within the tolerance may be reported or not.
            assert!(sharp.time == 0.0 || coarse.time > 0.0);
        }
    }
}

#[test]
fn times_match_the_closed_forms() {
    let options = CcdOptions { tolerance: 1e-9, ..CcdOptions::default() };
    // A rod turns about its end onto a floor 0.3 m below: sin θ = (0.3 - 0.01) / 1.
    let rod = Shape::Capsule(Capsule { half_length: 0.5, radius: 0.01 });
    let lying = Pose::new(Rotation::from_axis_angle(Vec3::Y, std::f64::consts::FRAC_PI_2), Vec3::new(0.5, 0.0, 0.3));
    let fall = ConstantTwist::screw(lying, Vec3::Z * 0.3, Vec3::Y * 1.0, 0.0);
    let hit = time_of_impact(&rod, &fall, &Shape::HalfSpace(HalfSpace), &Pose::IDENTITY, &options).unwrap();
    assert!((hit.time - 0.29_f64.asin()).abs() < 1e-8, "{hit:?}");
    assert!((hit.normal.unwrap() - Vec3::Z).length() < 1e-9);
    // Two balls cross: |(-1 + 3t, 0.1)| = 0.15.
    let ball = |radius| Shape::Sphere(Sphere { radius });
    let fly = ConstantTwist::linear(Pose::from_translation(Vec3::new(-1.0, 0.1, 0.0)), Vec3::X * 3.0);
    let hit = time_of_impact(&ball(0.1), &fly, &ball(0.05), &Pose::IDENTITY, &options).unwrap();
    assert!((hit.time - (1.0 - (0.15_f64.powi(2) - 0.01).sqrt()) / 3.0).abs() < 1e-8, "{hit:?}");
    // A square turns beside a wall: its corner reaches h√2·cos(45° - θ) = 0.13.
    let square = cuboid(0.1, 0.1, 0.1);
    let turn = ConstantTwist::screw(Pose::IDENTITY, Vec3::ZERO, Vec3::Z * 50.0, 0.0);
    let wall = Pose::from_translation(Vec3::X * (0.13 + 0.05));
    let hit = time_of_impact(&square, &turn, &cuboid(0.05, 1.0, 1.0), &wall, &options).unwrap();
    let angle = std::f64::consts::FRAC_PI_4 - (0.13 / 0.02_f64.sqrt()).acos();
    assert!((hit.time - angle / 50.0).abs() < 1e-8, "{hit:?}");
}

#[test]
fn motions_along_the_gap_cost_no_steps() {
    let options = CcdOptions::default();
    let steps_and_hit = |a: &Shape, pa: &dyn RigidMotion, b: &Shape, pb: &dyn RigidMotion| {
        // A motion that needs more steps gives a contact that is not certain.
        time_of_impact(a, pa, b, pb, &CcdOptions { max_steps: 12, ..options })
    };
    let plate = cuboid(5.0, 5.0, 0.001);
    let over = |z: f64| Pose::from_translation(Vec3::new(-4.0, 0.0, z));
    // The brick slides 1 mm above a plate, 8 m long; then the same as a mesh.
    let brick = cuboid(0.1, 0.1, 0.1);
    let slide = ConstantTwist::linear(over(0.102), Vec3::X * 8.0);
    for (a, b) in [(brick.clone(), plate.clone()), (mesh_of(&brick), mesh_of(&plate))] {
        assert_eq!(steps_and_hit(&a, &slide, &b, &Pose::IDENTITY), None);
    }
    // It rotates fast about the direction of the gap; a ball rotates fast about any axis.
    let spin = ConstantTwist::screw(over(0.102), over(0.0).translation, Vec3::Z * 300.0, 0.0);
    assert_eq!(steps_and_hit(&brick, &spin, &plate, &Pose::IDENTITY), None);
    let ball = Shape::Sphere(Sphere { radius: 0.1 });
    let spin = ConstantTwist::screw(over(0.102), over(0.102).translation, Vec3::new(200.0, 100.0, 50.0), 0.0);
    assert_eq!(steps_and_hit(&ball, &spin, &plate, &Pose::IDENTITY), None);
    // Both shapes are on the same turntable.
    let turn = |start| ConstantTwist::screw(start, Vec3::new(1.0, 2.0, 0.0), Vec3::Z * 30.0, 0.5);
    let (p, q) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 0.201));
    assert_eq!(steps_and_hit(&brick, &turn(p), &mesh_of(&brick), &turn(q)), None);
    // One shape recedes.
    let leave = ConstantTwist::linear(q, Vec3::X);
    assert_eq!(steps_and_hit(&mesh_of(&brick), &leave, &mesh_of(&brick), &p), None);
}

#[test]
fn contact_at_the_start_is_reported_at_time_zero() {
    let brick = cuboid(0.1, 0.1, 0.1);
    let options = CcdOptions::default();
    let leave = |x: f64| ConstantTwist::linear(Pose::from_translation(Vec3::X * x), Vec3::X);
    for x in [0.0, 0.1, 0.2, 0.2 + 0.9e-4] {
        let hit = time_of_impact(&brick, &leave(x), &brick, &Pose::IDENTITY, &options).unwrap();
        assert!(hit.at_start() && hit.certain && hit.time == 0.0 && hit.steps == 1, "{x}: {hit:?}");
        assert_eq!(hit.normal.is_some(), x > 0.2, "{x}: {hit:?}");
    }
    // Initial proximity is allowed if the shapes are within the tolerance, but not if they touch.
    let options = CcdOptions { allow_initial_proximity: true, ..options };
    assert!(time_of_impact(&brick, &leave(0.1), &brick, &Pose::IDENTITY, &options).is_some());
    assert!(time_of_impact(&brick, &leave(0.2 + 0.9e-4), &brick, &Pose::IDENTITY, &options).is_none());
    let approach = ConstantTwist::linear(Pose::from_translation(Vec3::X * (0.2 + 0.9e-4)), Vec3::X * -1.0);
    let hit = time_of_impact(&brick, &approach, &brick, &Pose::IDENTITY, &options).unwrap();
    assert!(!hit.at_start() && hit.separation <= 0.45e-4 && hit.time < 0.9e-4, "{hit:?}");
    // Both shapes are at rest.
    let near = Pose::from_translation(Vec3::X * 0.25);
    let at_rest = ConstantTwist::linear(near, Vec3::ZERO);
    assert!(time_of_impact(&brick, &at_rest, &brick, &Pose::IDENTITY, &options).is_none());
    assert!(time_of_impact(&brick, &near, &mesh_of(&brick), &at_rest, &options).unwrap().at_start());
}

/// A motion whose speed bound is not a number.
struct UnknownSpeed;
impl RigidMotion for UnknownSpeed {
    fn pose(&self, t: f64) -> Pose {
        Pose::from_translation(Vec3::X * t)
    }
    fn speed(&self, _: f64, _: f64, _: f64) -> f64 {
        f64::NAN
    }
}

#[test]
fn nan_is_a_contact_that_is_not_certain() {
    let (brick, ball) = (cuboid(0.1, 0.1, 0.1), Shape::Sphere(Sphere { radius: 0.1 }));
    let far = Pose::from_translation(Vec3::X * 9.0);
    let good = ConstantTwist::screw(Pose::IDENTITY, Vec3::Y, Vec3::Z, 0.1);
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let v = Vec3::new(0.0, bad, 0.0);
        let broken = [
            ConstantTwist { velocity: v, ..good },
            ConstantTwist { rotation: v, ..good },
            ConstantTwist { pivot: v, ..good },
            ConstantTwist { start: Pose::from_translation(v), ..good },
            ConstantTwist::linear(Pose::IDENTITY, v),
            ConstantTwist::straight(Pose::IDENTITY, Pose::from_translation(v)),
            ConstantTwist::screw(Pose::IDENTITY, Vec3::ZERO, v, 1.0),
            ConstantTwist::screw(Pose::IDENTITY, Vec3::ZERO, Vec3::X, bad),
            ConstantTwist::screw(Pose::IDENTITY, Vec3::ZERO, Vec3::ZERO, f64::NAN),
        ];
        for path in broken {
            for shape in [&brick, &ball, &mesh_of(&brick)] {
                for (a, b) in [(shape, &ball), (&ball, shape)] {
                    let hit = time_of_impact(a, &path, b, &far, &CcdOptions::default());
                    // A huge number may be proven free; NaN and infinity never are.
                    let known = path.is_finite() && bad == 1e300;
                    assert!(known || hit.is_some_and(|h| !h.certain), "{path:?}: {hit:?}");
                }
            }
        }
    }
    for tolerance in [f64::NAN, -1.0, 0.0] {
        let options = CcdOptions { tolerance, ..CcdOptions::default() };
        let fly = ConstantTwist::linear(Pose::IDENTITY, Vec3::X * 20.0);
        let hit = time_of_impact(&ball, &fly, &brick, &far, &options).unwrap();
        assert!(hit.certain && (hit.time - 8.8 / 20.0).abs() < 1e-12, "{hit:?}");
    }
    assert!(!time_of_impact(&ball, &UnknownSpeed, &ball, &far, &CcdOptions::default()).unwrap().certain);
}

#[test]
fn exhausted_steps_are_a_contact_that_is_not_certain() {
    // Between two plates, a plane cannot separate the ball from both.
    let slot = TriMesh::new(
        vec![
            Vec3::new(-1.0, 0.01, -1.0),
            Vec3::new(1.0, 0.01, -1.0),
            Vec3::new(0.0, 0.01, 2.0),
            Vec3::new(-1.0, -0.01, -1.0),
            Vec3::new(1.0, -0.01, -1.0),
            Vec3::new(0.0, -0.01, 2.0),
        ],
        vec![[0, 1, 2], [3, 4, 5]],
    );
    let slot = Shape::Mesh(Arc::new(slot.unwrap()));
    let ball = Shape::Sphere(Sphere { radius: 0.009 });
    let through = ConstantTwist::linear(Pose::from_translation(Vec3::X * -0.9), Vec3::X * 1.8);
    let few = CcdOptions { max_steps: 10, ..CcdOptions::default() };
    let hit = time_of_impact(&ball, &through, &slot, &Pose::IDENTITY, &few).unwrap();
    assert!(!hit.certain && hit.steps == 10 && hit.separation > 1e-4, "{hit:?}");
    let enough = CcdOptions::default();
    assert_eq!(time_of_impact(&ball, &through, &slot, &Pose::IDENTITY, &enough), None);
}

#[test]
fn the_earliest_time_is_not_after_the_contact() {
    let mut rng = SplitMix(5);
    let mut tight = 0;
    for k in 0..300 {
        let (a, b) = (mover(&mut rng, k % 6), thin(&mut rng));
        let (start, moving) = (Pose::from_translation(rng.vec(1.0)), rng.vec(1.0));
        let turning = if k % 2 == 0 { Vec3::ZERO } else { rng.vec(3.0) };
        let motion = FrameMotion { velocity: moving, angular_velocity: turning, ..FrameMotion::REST };
        let near = separation(&a, &start, &b, &Pose::IDENTITY);
        let moving_a = MovingShape { shape: &a, in_world: &start, motion: &motion };
        let resting_b = MovingShape { shape: &b, in_world: &Pose::IDENTITY, motion: &FrameMotion::REST };
        let when = time_to_collision(&near, moving_a, resting_b, 4.0);
        let path = ConstantTwist::from_motion(start, &motion, 4.0);
        let hit =
            time_of_impact(&a, &path, &b, &Pose::IDENTITY, &CcdOptions { tolerance: 1e-9, ..CcdOptions::default() });
        let actual = hit.map_or(f64::INFINITY, |h| h.time * 4.0);
        assert!(when.earliest_s <= actual + 1e-8, "{when:?} {actual}");
        assert!(when.estimate_s >= 0.0 && (0.0..=4.0).contains(&when.earliest_s));
        tight += usize::from(hit.is_some() && when.earliest_s > 0.8 * actual);
    }
    assert!(tight > 5, "{tight}");
    let near = separation(&cuboid(1.0, 1.0, 1.0), &Pose::IDENTITY, &cuboid(1.0, 1.0, 1.0), &Pose::IDENTITY);
    let brick = MovingShape { shape: &cuboid(1.0, 1.0, 1.0), in_world: &Pose::IDENTITY, motion: &FrameMotion::REST };
    let when = time_to_collision(&near, brick, brick, 1.0);
    assert_eq!((when.estimate_s, when.earliest_s), (0.0, 0.0));
}

/// The kept faces alone give the same contact. If the first contact were on a culled face, the whole mesh would
/// already be in contact at the time of impact of the kept faces.
#[test]
fn the_first_contact_is_on_a_face_that_was_kept() {
    let mut rng = SplitMix(7);
    let options = CcdOptions { tolerance: 1e-7, max_steps: 100_000, ..CcdOptions::default() };
    let (mut hits, mut kept, mut all) = (0, 0, 0);
    for k in 0..motions(300) {
        let a = match k % 3 {
            0 => mesh_of(&mover(&mut rng, 2)),
            1 => elbow(&mut rng),
            _ => mesh_of(&Shape::Hull(Arc::new(rng.hull()))),
        };
        let Shape::Mesh(mesh) = &a else { unreachable!() };
        let b = mover(&mut rng, k % 5);
        let pa = motion(&mut rng);
        let pb = if k % 2 == 0 { ConstantTwist::linear(Pose::IDENTITY, Vec3::ZERO) } else { motion(&mut rng) };
        let near_start = separation(&a, &pa.pose(0.0), &b, &pb.pose(0.0)).distance < 1e-3;
        if near_start {
            continue;
        }
        let twist = RelativeTwist::between(&pa, &pb, 0.0, 1.0);
        let faces = FaceCulling::of(mesh).kept_faces(&twist);
        kept += faces.count();
        all += mesh.triangles().len();
        let whole = time_of_impact(&a, &pa, &b, &pb, &options);
        let triangles: Vec<_> = faces.iter().map(|t| mesh.triangles()[t]).collect();
        let Ok(part) = TriMesh::new(mesh.vertices().to_vec(), triangles) else {
            assert!(whole.is_none());
            continue;
        };
        let part = time_of_impact(&Shape::Mesh(Arc::new(part)), &pa, &b, &pb, &options);
        assert_eq!(whole.is_some(), part.is_some(), "{k} {pa:?} {pb:?}");
        if let (Some(whole), Some(part)) = (whole, part) {
            let clear = separation(&a, &pa.pose(part.time), &b, &pb.pose(part.time)).distance;
            assert!(clear > 0.0, "{k}: {whole:?} {part:?}");
            hits += 1;
        }
    }
    assert!(hits > 50 && kept < all * 9 / 10, "{hits} hits, {kept} of {all} kept");
}

/// A bent tube: a closed mesh that is not convex.
fn elbow(rng: &mut SplitMix) -> Shape {
    let s = rng.between(0.05, 0.2);
    let outline = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)];
    let level = |z: f64| outline.map(|(x, y)| Vec3::new(x, y, z) * s);
    let vertices = [level(0.0), level(1.0)].concat();
    let mut triangles = vec![];
    for k in 0..6_u32 {
        let next = (k + 1) % 6;
        triangles.extend([[k, next, next + 6], [k, next + 6, k + 6]]);
    }
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        triangles.extend([[a, c, b], [a + 6, b + 6, c + 6]]);
    }
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    assert!(mesh.report().closed && !mesh.report().inside_out);
    Shape::Mesh(Arc::new(mesh))
}

#[test]
fn every_pair_of_shapes_has_an_answer() {
    let mut rng = SplitMix(11);
    for first in CONVEX.iter().chain(&["mesh", "plane"]) {
        for second in CONVEX.iter().chain(&["mesh", "plane"]) {
            for _ in 0..4 {
                let (a, b) = (rng.shape(first), rng.shape(second));
                let (pa, pb) = (motion(&mut rng), rng.pose(1.5));
                let options = CcdOptions { max_steps: 2000, ..CcdOptions::default() };
                let hit = time_of_impact(&a, &pa, &b, &pb, &options);
                let apart = |t: f64| separation(&a, &pa.pose(t), &b, &pb).distance > 0.0;
                let until = hit.map_or(1.0, |h| h.time);
                for k in 0..20 {
                    let t = until * f64::from(k) / 20.0;
                    assert!(t >= until && hit.is_some() || apart(t), "{first} {second} {t} {hit:?}");
                }
            }
        }
    }
}
