//! Shields: closed, outside of what they protect, open along their target; compared with the formula.
#![allow(clippy::print_stdout, reason = "figures of the evidence")]

use std::sync::Arc;

use elbowroom_proximity::advanced::{MeshFeatures, for_each_contact};
use elbowroom_proximity::{Shape, TriMesh, Workspace, project_point};
use elbowroom_shared_control::{
    NavigatorSettings, ProtectedSurface, Shield, ShieldError, ShieldSettings, ShieldTarget, SurfaceNavigator,
    generate_shield,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::extent::amount;
use elbowroom_testkit::random::SplitMix;

use crate::common::{ball, block, point};

const SETTINGS: ShieldSettings =
    ShieldSettings { offset_m: 0.004, width_m: 0.012, depth_m: 0.005, flare_rad: 0.3, tolerance_m: 0.003 };

/// Distances from the solid moved outwards and from the opening, negative inside. By the formula, foot by foot; the opening
/// ends at a height above the surface.
fn formula(solid: &Shape, shield: &Shield, s: &ShieldSettings, p: Vec3, height_m: f64) -> (f64, f64) {
    let around = project_point(solid, &Pose::IDENTITY, p).signed_distance - s.offset_m;
    let opening = |(foot, axis): &(Vec3, Vec3)| {
        let z = axis.dot(p - *foot);
        let across = (p - *foot - *axis * z).length();
        let wall = s.flare_rad.cos() * (across - 0.5 * s.width_m) - s.flare_rad.sin() * (z + s.depth_m);
        wall.max(-(z + s.depth_m)).max(z - height_m)
    };
    (around, shield.passage.iter().map(opening).fold(f64::INFINITY, f64::min))
}

/// A point of the surface, by a ray from far away towards a point near the middle.
fn on_surface(mesh: &Arc<TriMesh>, random: &mut SplitMix) -> Vec3 {
    let far = point(random, 1.0) * 0.3;
    project_point(&Shape::Mesh(mesh.clone()), &Pose::IDENTITY, far).on_surface
}

fn random_target(mesh: &Arc<TriMesh>, random: &mut SplitMix) -> ShieldTarget {
    let at = on_surface(mesh, random);
    match random.below(3) {
        0 => ShieldTarget::FacesWithin { at, radius_m: 0.01 },
        1 => ShieldTarget::Drill {
            at,
            axis: -project_point(&Shape::Mesh(mesh.clone()), &Pose::IDENTITY, at * 1.001).outward,
        },
        _ => {
            let near = project_point(&Shape::Mesh(mesh.clone()), &Pose::IDENTITY, at + point(random, 0.02));
            ShieldTarget::Line(vec![at, near.on_surface])
        }
    }
}

/// Calls `check` with shields around three solids for random targets, some of them without depth and flare.
fn for_random_shields(mut check: impl FnMut(&Shape, &Shield, &ShieldSettings, &mut SplitMix)) {
    let mut random = SplitMix(12);
    let solids = [ball(0.03, 2), block(Vec3::new(0.06, 0.04, 0.03)), ball(0.02, 1)];
    for (case, solid) in solids.iter().cycle().take(9).enumerate() {
        let target = random_target(solid, &mut random);
        let settings = if case >= 5 { ShieldSettings { flare_rad: 0.0, depth_m: 0.0, ..SETTINGS } } else { SETTINGS };
        match generate_shield(solid, &target, &settings) {
            Ok(shield) => check(&Shape::Mesh(solid.clone()), &shield, &settings, &mut random),
            Err(ShieldError::LeavesSurface { .. }) => {}
            Err(error) => panic!("{target:?}: {error}"),
        }
    }
}

#[test]
fn shields_protect_everything_but_the_opening() {
    let (mut bare, mut protected, mut opened) = (0, 0, 0);
    for_random_shields(|shape, shield, settings, random| {
        let report = shield.mesh.report();
        assert!(report.closed && !report.inside_out && report.degenerate == 0, "{report:?}");
        assert!(ProtectedSurface::new(shield.mesh.clone(), Pose::IDENTITY).is_ok());
        let bounds = *shield.mesh.aabb();
        for k in 0..amount(3000, 150_000) {
            let p = if k % 2 == 0 {
                bounds.min + Vec3::from(random.within(0.5)).scale(bounds.extent()) + bounds.extent() * 0.5
            } else {
                let (foot, axis) = shield.passage[random.below(shield.passage.len())];
                foot + axis * random.between(-0.01, 0.02) + point(random, 0.01)
            };
            let (solid, opening) = formula(shape, shield, settings, p, settings.offset_m + 2.0 * settings.tolerance_m);
            if solid <= 0.0 && opening > settings.tolerance_m {
                protected += 1;
                assert!(shield.mesh.contains(p), "{p:?} is bare: {solid} {opening}");
            } else if solid > settings.tolerance_m || opening < -settings.tolerance_m {
                bare += 1;
                opened += k % 2;
                assert!(!shield.mesh.contains(p), "{p:?} is blocked: {solid} {opening}");
            }
        }
    });
    assert!(protected > 5000 && bare > 5000 && opened > 2000, "{protected} protected, {bare} bare, {opened} opened");
}

/// A tool, and points of it: between them the distances change by at most `beside_m`.
struct SampledTool {
    shape: Shape,
    points: Vec<Vec3>,
    beside_m: f64,
}

impl SampledTool {
    fn block(size: Vec3, step_m: f64) -> Self {
        let count = |length: f64| (length / step_m).ceil() as usize;
        let at = |i: usize, length: f64| (i as f64 / count(length) as f64 - 0.5) * length;
        let mut points = Vec::new();
        for i in 0..=count(size.x) {
            for j in 0..=count(size.y) {
                points.extend((0..=count(size.z)).map(|k| Vec3::new(at(i, size.x), at(j, size.y), at(k, size.z))));
            }
        }
        Self { shape: Shape::Mesh(block(size)), points, beside_m: 0.5 * 3.0_f64.sqrt() * step_m }
    }

    /// A ball by its corners: no point of a triangle is farther from all of them than its longest edge.
    fn ball(radius: f64, n: usize) -> Self {
        let mesh = ball(radius, n);
        let corner = |v: u32| mesh.vertices()[v as usize];
        let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let beside_m = edges.map(|(a, b)| corner(a).distance(corner(b))).fold(0.0, f64::max);
        Self { points: mesh.vertices().to_vec(), shape: Shape::Mesh(mesh), beside_m }
    }
}

/// A tool may be wherever no point of it is in the shield, by the formula; nothing is left open for it elsewhere.
#[test]
fn tools_meet_the_shield_where_the_formula_says() {
    let tools = [SampledTool::block(Vec3::new(0.002, 0.002, 0.02), 0.001), SampledTool::ball(0.002, 2)];
    let (mut free, mut in_opening, mut blocked) = (0, 0, 0);
    for_random_shields(|solid, shield, settings, random| {
        let shape = Shape::Mesh(shield.mesh.clone());
        let mut workspace = Workspace::new();
        for k in 0..amount(300, 125_000) {
            let tool = &tools[usize::from(k % 3 == 0)];
            let (foot, axis) = shield.passage[random.below(shield.passage.len())];
            let tilt = Rotation::from_rotation_vector(point(random, if k % 2 == 0 { 0.1 } else { 3.0 }));
            let middle = foot + axis * random.between(0.0, 0.03) + point(random, if k % 2 == 0 { 0.001 } else { 0.03 });
            let pose = Pose::new(tilt * Rotation::from_z(axis), middle);
            // Negative inside the shield; no two points differ by more than they are apart.
            let outside = |p: &Vec3| {
                // Above the opening nothing of a convex solid's shield is in the way.
                let (around, opening) = formula(solid, shield, settings, pose.transform_point(*p), f64::INFINITY);
                around.max(-opening)
            };
            let least = tool.points.iter().map(outside).fold(f64::INFINITY, f64::min);
            let meets = workspace.collides(&tool.shape, &pose, &shape, &Pose::IDENTITY);
            if least < -settings.tolerance_m {
                blocked += 1;
                assert!(meets, "{pose:?} is open: {least} m");
            } else if least > settings.tolerance_m + tool.beside_m {
                free += 1;
                let is_below_the_shield = |p: &Vec3| {
                    let p = pose.transform_point(*p);
                    project_point(solid, &Pose::IDENTITY, p).signed_distance < settings.offset_m
                };
                in_opening += usize::from(tool.points.iter().any(is_below_the_shield));
                assert!(!meets, "{pose:?} is blocked: {least} m");
            }
        }
    });
    println!("{free} poses free, {in_opening} of them in an opening, {blocked} blocked");
    assert!(
        free > 300 && in_opening > 20 && blocked > 200,
        "{free} free, {in_opening} in an opening, {blocked} blocked"
    );
}

#[test]
fn no_triangle_of_a_shield_crosses_another() {
    let target = ShieldTarget::Line(vec![Vec3::new(0.02, 0.0, 0.0458), Vec3::new(-0.02, 0.01, 0.0447)]);
    let solid = ball(0.05, 3);
    let shield = generate_shield(&solid, &target, &SETTINGS).unwrap().mesh;
    let here = &Pose::IDENTITY;
    let mut neighbours = 0;
    for_each_contact(&shield, here, &shield, here, &mut Workspace::new(), |pair| {
        let MeshFeatures::Triangles(i, j) = pair else { panic!("{pair:?}") };
        let (s, t) = (shield.triangles()[i as usize], shield.triangles()[j as usize]);
        assert!(s.iter().any(|v| t.contains(v)), "{s:?} meets {t:?}");
        neighbours += 1;
    });
    assert!(neighbours > 10 * shield.triangles().len(), "{neighbours}");
}

#[test]
fn a_tool_reaches_the_ground_of_a_drilled_opening_and_nothing_beside_it() {
    let solid = block(Vec3::new(0.1, 0.1, 0.05));
    let top = Vec3::Z * 0.025;
    let settings = ShieldSettings { flare_rad: 0.0, tolerance_m: 0.002, ..SETTINGS };
    let target = ShieldTarget::Drill { at: top, axis: -Vec3::Z };
    let shield = generate_shield(&solid, &target, &settings).unwrap();
    let surface = ProtectedSurface::new(shield.mesh, Pose::IDENTITY).unwrap();
    let drill = block(Vec3::new(0.004, 0.004, 0.02));
    let start = Pose::from_translation(Vec3::new(0.03, 0.0, 0.06));
    let mut navigator = SurfaceNavigator::new(drill, vec![surface], start, NavigatorSettings::default()).unwrap();
    // First beside the opening, pushed into the solid, then over the opening and down.
    let mut tip = |x: f64| {
        for _ in 0..2000 {
            navigator.step(&Pose::from_translation(Vec3::new(x, 0.0, 0.0)), 1e-3);
        }
        navigator.tool_in_world().translation.z - 0.01
    };
    let beside = tip(0.03);
    assert!(beside > 0.025 + settings.offset_m && beside < 0.025 + settings.offset_m + 0.003, "{beside}");
    let inside = tip(0.0);
    assert!(inside < 0.025 - settings.depth_m + 0.002 && inside > 0.025 - settings.depth_m - 0.002, "{inside}");
}

#[test]
fn targets_off_the_surface_are_refused_with_the_place() {
    let solid = ball(0.05, 3);
    let refuse = |target: ShieldTarget| generate_shield(&solid, &target, &SETTINGS).unwrap_err();
    let above = Vec3::Z * 0.0562;
    let error = refuse(ShieldTarget::Line(vec![Vec3::X * 0.05, above]));
    assert!(matches!(error, ShieldError::OffSurface { number: 2, .. }), "{error}");
    assert!(error.to_string().contains("6.200 mm off the surface; at most 3.000 mm"), "{error}");
    assert_eq!(refuse(ShieldTarget::Line(vec![Vec3::X * 0.05])), ShieldError::TooFewPoints { needed: 2 });
    // From one side of the ball to the other, through its middle.
    let through = ShieldTarget::Line(vec![Vec3::X * 0.05, Vec3::X * -0.05]);
    assert!(matches!(refuse(through), ShieldError::LeavesSurface { number: 1, .. }));
    let fine = ShieldSettings { tolerance_m: 1e-5, ..SETTINGS };
    let error =
        generate_shield(&solid, &ShieldTarget::Drill { at: Vec3::Z * 0.05, axis: -Vec3::Z }, &fine).unwrap_err();
    assert!(matches!(error, ShieldError::TooFine { .. }), "{error}");
    let bad = ShieldSettings { width_m: f64::NAN, ..SETTINGS };
    assert!(generate_shield(&solid, &ShieldTarget::Drill { at: Vec3::Z * 0.05, axis: -Vec3::Z }, &bad).is_err());
    let open = TriMesh::new(solid.vertices().to_vec(), solid.triangles()[2..].to_vec()).unwrap();
    let drill = ShieldTarget::Drill { at: Vec3::Z * 0.05, axis: -Vec3::Z };
    assert!(generate_shield(&Arc::new(open), &drill, &SETTINGS).unwrap_err().to_string().contains("is open"));
}

#[test]
fn the_other_side_of_a_thin_part_stays_protected() {
    let plate = block(Vec3::new(0.1, 0.1, 0.01));
    let corner = |x: f64, y: f64| Vec3::new(x, y, 0.005);
    let border = vec![corner(-0.02, -0.02), corner(0.02, -0.02), corner(0.02, 0.02), corner(-0.02, 0.02)];
    let settings = ShieldSettings { depth_m: 0.0, width_m: 0.006, flare_rad: 0.0, tolerance_m: 0.002, ..SETTINGS };
    for target in [ShieldTarget::Area(border), ShieldTarget::FacesWithin { at: corner(0.0, 0.0), radius_m: 0.02 }] {
        let shield = generate_shield(&plate, &target, &settings).unwrap();
        assert!(shield.passage.iter().all(|(foot, axis)| foot.z > 0.0 && axis.z > 0.9), "{target:?}");
        assert!(!shield.mesh.contains(Vec3::Z * 0.008) && shield.mesh.contains(Vec3::Z * -0.005), "{target:?}");
    }
}

#[test]
fn the_width_of_a_shallow_opening_is_that_between_its_walls() {
    let solid = block(Vec3::new(0.05, 0.03, 0.05));
    for (depth_m, flare_rad) in [(0.0, 0.0), (0.002, 0.0), (0.01, 0.3)] {
        let settings = ShieldSettings { depth_m, flare_rad, tolerance_m: 0.0015, ..SETTINGS };
        let top = |x: f64| Vec3::new(x, 0.0, 0.025);
        for target in
            [ShieldTarget::Drill { at: top(0.0), axis: -Vec3::Z }, ShieldTarget::Line(vec![top(-0.015), top(0.015)])]
        {
            let width = generate_shield(&solid, &target, &settings).unwrap().narrowest_m(&settings);
            let expected = settings.width_m + 2.0 * (depth_m + settings.tolerance_m) * flare_rad.tan();
            assert!((width - expected).abs() < 2.5 * settings.tolerance_m, "{width} instead of {expected}: {target:?}");
        }
    }
}

#[test]
fn targets_that_lead_elsewhere_or_need_too_much_are_refused() {
    let solid = block(Vec3::new(0.1, 0.1, 0.05));
    let top = Vec3::Z * 0.025;
    let refuse =
        |target: &ShieldTarget, settings: ShieldSettings| generate_shield(&solid, target, &settings).err().unwrap();
    let outwards = ShieldTarget::Drill { at: top, axis: Vec3::Z };
    let error = refuse(&outwards, SETTINGS);
    assert!(error.to_string().contains("180° off the direction into the solid"), "{error}");
    // Over the edge of the block, without a point on it.
    let over = ShieldTarget::Line(vec![Vec3::new(0.036, 0.0, 0.025), Vec3::new(0.05, 0.0, 0.011)]);
    assert!(matches!(refuse(&over, SETTINGS), ShieldError::LeavesSurface { number: 1, .. }));
    let drill = ShieldTarget::Drill { at: top, axis: -Vec3::Z };
    for offset_m in [1.0, 1e9] {
        let error = refuse(&drill, ShieldSettings { offset_m, ..SETTINGS });
        assert!(matches!(error, ShieldError::TooFine { .. }), "{error}");
    }
    let narrow = ShieldSettings { width_m: 1e-12, ..SETTINGS };
    let line = ShieldTarget::Line(vec![top, top + Vec3::X * 0.03]);
    let faces = ShieldTarget::FacesWithin { at: top, radius_m: 0.03 };
    for target in [line, faces] {
        assert_eq!(refuse(&target, narrow), ShieldError::TooManyFeet, "{target:?}");
    }
    let all = ShieldSettings { width_m: 1.0, depth_m: 1.0, ..SETTINGS };
    assert_eq!(refuse(&drill, all), ShieldError::NothingLeft);
}

#[test]
fn an_area_is_open_inside_its_border_and_closed_outside() {
    let solid = block(Vec3::new(0.1, 0.1, 0.05));
    let corner = |x: f64, y: f64| Vec3::new(x, y, 0.025);
    let border = vec![corner(-0.02, -0.02), corner(0.02, -0.02), corner(0.02, 0.02), corner(-0.02, 0.02)];
    let settings = ShieldSettings { width_m: 0.006, flare_rad: 0.0, tolerance_m: 0.002, ..SETTINGS };
    let shield = generate_shield(&solid, &ShieldTarget::Area(border), &settings).unwrap().mesh;
    for (x, y) in [(0.0, 0.0), (0.015, -0.015), (-0.02, 0.02), (0.0, 0.021)] {
        assert!(!shield.contains(corner(x, y)), "({x}, {y}) is to be open");
    }
    for (x, y) in [(0.03, 0.0), (0.0, -0.028), (0.04, 0.04)] {
        assert!(shield.contains(corner(x, y)), "({x}, {y}) is to be protected");
    }
}
