//! Degenerate meshes: every query has an answer or an error with a reason, and unknown never counts as free.

use std::sync::Arc;

use crate::common::{CONVEX, RandomGeometry, SplitMix};
use elbowroom_proximity::advanced::{colliding_triangles, mesh_separation, triangles_within};
use elbowroom_proximity::ccd::{CcdOptions, ConstantTwist, time_of_impact};
use elbowroom_proximity::motion_culling::{FaceCulling, RelativeTwist};
use elbowroom_proximity::repair::{orient, split_components, weld};
use elbowroom_proximity::{
    Cuboid, DistanceSettings, MeshError, Shape, TriMesh, WarmStart, Workspace, collides, fit, penetration,
    project_point, separation, separation_within, tessellate::tessellate, within,
};
use elbowroom_spatial::{Pose, Vec3};

/// Vertices and triangles.
type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

fn brick(half: f64, at: Vec3) -> Triangles {
    let (vertices, triangles) = tessellate(&Shape::Cuboid(Cuboid { half_extents: Vec3::splat(half) }), 0.01);
    (vertices.into_iter().map(|v| v + at).collect(), triangles)
}

/// Degenerate meshes that `TriMesh::new` accepts.
fn degenerate_meshes() -> Vec<(&'static str, Triangles)> {
    let line = |k: f64| Vec3::new(0.1 * k, 0.2 * k, -0.1 * k);
    let brick_at = |at| brick(0.1, at);
    let mut doubled = brick_at(Vec3::ZERO);
    doubled.1 = [doubled.1.clone(), doubled.1].concat();
    let mut open = brick_at(Vec3::ZERO);
    open.1.truncate(7);
    let mut inside_out = brick_at(Vec3::ZERO);
    inside_out.1.iter_mut().for_each(|t| t.swap(0, 1));
    let mut mixed = brick_at(Vec3::ZERO);
    mixed.1[3].swap(0, 1);
    let mut needles = brick_at(Vec3::ZERO);
    needles.1.extend([[0, 0, 1], [2, 2, 2], [0, 1, 0]]);
    vec![
        ("one triangle", (vec![Vec3::ZERO, Vec3::X * 0.2, Vec3::Y * 0.2], vec![[0, 1, 2]])),
        ("one point", (vec![Vec3::splat(0.1)], vec![[0, 0, 0]])),
        ("one line", (vec![line(0.0), line(1.0), line(2.0)], vec![[0, 1, 2], [0, 2, 1]])),
        ("points only", (vec![Vec3::ZERO, Vec3::X * 0.1, Vec3::Y * 0.1], vec![[0, 0, 0], [1, 1, 1], [2, 2, 2]])),
        ("tiny", brick(1e-12, Vec3::ZERO)),
        ("duplicate", doubled),
        ("open", open),
        ("inside out", inside_out),
        ("mixed", mixed),
        ("needles", needles),
        ("far", brick_at(Vec3::splat(1e6))),
        ("huge", brick(1e6, Vec3::ZERO)),
    ]
}

fn shape(triangles: &Triangles) -> Shape {
    Shape::Mesh(Arc::new(TriMesh::new(triangles.0.clone(), triangles.1.clone()).unwrap()))
}

fn mesh_of(shape: &Shape) -> &TriMesh {
    let Shape::Mesh(mesh) = shape else { unreachable!() };
    mesh
}

/// Runs every query and checks that the answers agree.
fn check(what: &str, a: &Shape, pa: &Pose, b: &Shape, pb: &Pose, workspace: &mut Workspace) {
    let s = separation(a, pa, b, pb);
    assert!(s.distance.is_finite() && s.lower_bound >= 0.0 && s.lower_bound <= s.distance, "{what}: {s:?}");
    assert!(s.on_a.is_finite() && s.on_b.is_finite(), "{what}: {s:?}");
    let touching = collides(a, pa, b, pb);
    assert!(touching || s.distance > 0.0, "{what}: distance 0 counts as free");
    assert!(!touching || s.lower_bound <= 0.0, "{what}: {s:?} and yet a contact");
    let slack = 1e-9 * (1.0 + pa.translation.length() + pb.translation.length() + size(a));
    assert!(within(a, pa, b, pb, s.distance + slack), "{what}: {s:?}");
    assert!(separation_within(a, pa, b, pb, s.distance + slack).is_some(), "{what}");
    let mut warm_start = WarmStart::default();
    for _ in 0..2 {
        let settings = DistanceSettings { warm_start: Some(&mut warm_start), ..DistanceSettings::default() };
        let again = workspace.separation(a, pa, b, pb, settings).unwrap();
        assert!((again.distance - s.distance).abs() <= slack, "{what}: {again:?} {s:?}");
    }
    assert_eq!(workspace.collides(a, pa, b, pb), touching, "{what}");
    assert!(workspace.within(a, pa, b, pb, s.distance + slack), "{what}");
    if let Some(out) = penetration(a, pa, b, pb) {
        assert!(out.depth >= 0.0 && out.direction.is_finite(), "{what}: {out:?}");
    }
    let hit = time_of_impact(a, &ConstantTwist::linear(*pa, Vec3::X * 0.1), b, pb, &CcdOptions::default());
    assert!(s.distance > 1e-4 || hit.is_some_and(|h| h.at_start()), "{what}: {s:?} {hit:?}");
}

fn size(s: &Shape) -> f64 {
    let b = s.aabb(&Pose::IDENTITY);
    if b.extent().is_finite() { b.extent().length() + b.center().length() } else { 0.0 }
}

#[test]
fn every_query_on_degenerate_meshes_has_an_answer() {
    let mut rng = SplitMix(3);
    let mut workspace = Workspace::new();
    let meshes = degenerate_meshes();
    for (name, triangles) in &meshes {
        let a = shape(triangles);
        for kind in CONVEX.iter().chain(&["plane", "mesh"]) {
            for _ in 0..6 {
                let b = rng.shape(kind);
                let (pa, pb) = (rng.pose(1.0), rng.pose(1.0));
                check(&format!("{name}, {kind}"), &a, &pa, &b, &pb, &mut workspace);
                check(&format!("{kind}, {name}"), &b, &pb, &a, &pa, &mut workspace);
            }
        }
        for (other, triangles) in &meshes {
            let b = shape(triangles);
            for _ in 0..3 {
                let (pa, pb) = (rng.pose(0.3), rng.pose(0.3));
                check(&format!("{name}, {other}"), &a, &pa, &b, &pb, &mut workspace);
            }
        }
    }
}

#[test]
fn degenerate_meshes_are_reported_repaired_fitted_and_projected_on() {
    for (name, (vertices, triangles)) in degenerate_meshes() {
        let whole = shape(&(vertices.clone(), triangles.clone()));
        let mesh = mesh_of(&whole);
        let report = mesh.report();
        let solid = ["duplicate", "inside out", "needles", "far", "huge"].contains(&name);
        assert!(!solid || report.volume > 0.0, "{name}: {report:?}");
        assert_eq!(report.duplicate > 0, ["duplicate", "one line", "needles"].contains(&name), "{name}: {report:?}");
        assert!(report.volume.is_finite() && mesh.aabb().min.is_finite(), "{name}");
        assert!(mesh.hull().is_none_or(|h| h.volume() >= 0.0), "{name}");
        let p = project_point(&whole, &Pose::IDENTITY, Vec3::new(0.3, 0.4, 0.5));
        assert!(p.signed_distance.is_finite(), "{name}: {p:?}");
        assert!(!mesh.contains(Vec3::splat(3e7)), "{name}");
        let welded = weld(&vertices, &triangles, 1e-9).unwrap();
        let oriented = orient(&welded.vertices, &welded.triangles).unwrap();
        assert_eq!(oriented.triangles.len(), welded.triangles.len());
        assert!(!split_components(&vertices, &triangles).unwrap().is_empty(), "{name}");
        if ["duplicate", "inside out", "mixed", "needles", "far", "huge"].contains(&name) {
            let solid = TriMesh::new(welded.vertices, oriented.triangles).unwrap();
            assert!(solid.report().closed && !solid.report().inside_out && solid.report().degenerate == 0, "{name}");
        }
        // Faces are culled only if the mesh is guaranteed to be a solid.
        let kept = FaceCulling::of(mesh).kept_faces(&RelativeTwist::constant(Vec3::Z, Vec3::ZERO)).count();
        let sure = ["inside out", "needles", "far", "huge", "tiny"].contains(&name);
        assert_eq!(kept < triangles.len(), sure, "{name}: {kept} of {}", triangles.len());
        let all = FaceCulling::of(mesh).kept_faces(&RelativeTwist::constant(Vec3::splat(f64::NAN), Vec3::ZERO)).count();
        assert_eq!(all, triangles.len(), "{name}");
        assert!(fit::tightest(&vertices).is_none_or(|f| f.shape.volume().is_finite()), "{name}");
    }
}

#[test]
fn a_mesh_far_from_its_origin_has_the_same_distance() {
    let (near_origin, far) = (shape(&brick(0.1, Vec3::ZERO)), shape(&brick(0.1, Vec3::splat(1e6))));
    let back = Pose::from_translation(Vec3::splat(-1e6) + Vec3::X * 0.5);
    let s = separation(&near_origin, &Pose::IDENTITY, &far, &back);
    assert!((s.distance - 0.3).abs() < 1e-8 && s.lower_bound > 0.29, "{s:?}");
    let both = Pose::from_translation(Vec3::splat(1e6));
    let s = separation(&near_origin, &both, &far, &Pose::IDENTITY);
    assert_eq!(s.distance, 0.0);
    let near = Pose::from_translation(Vec3::splat(1e6) + Vec3::Y * 0.21);
    assert!(!collides(&near_origin, &near, &far, &Pose::IDENTITY));
}

#[test]
fn a_mesh_too_small_to_square_its_size_is_never_free_where_it_touches() {
    let (dust, solid) = (shape(&brick(1e-160, Vec3::ZERO)), shape(&brick(0.1, Vec3::ZERO)));
    let box_around = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) });
    let away = Pose::from_translation(Vec3::X * 0.5);
    for other in [&solid, &box_around] {
        assert!(collides(&dust, &Pose::IDENTITY, other, &Pose::IDENTITY));
        assert!(collides(other, &Pose::IDENTITY, &dust, &Pose::IDENTITY));
        assert!(within(&dust, &away, other, &Pose::IDENTITY, 0.41));
        assert!(separation(&dust, &away, other, &Pose::IDENTITY).lower_bound <= 0.4);
    }
}

#[test]
fn invalid_meshes_are_refused_with_a_reason() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    assert_eq!(TriMesh::new(corners.clone(), vec![]).unwrap_err(), MeshError::Empty);
    assert_eq!(TriMesh::new(vec![], vec![]).unwrap_err(), MeshError::Empty);
    let out = TriMesh::new(corners.clone(), vec![[0, 1, 2], [0, 3, 1]]).unwrap_err();
    assert_eq!(out, MeshError::IndexOutOfRange { triangle: 1, index: 3, vertices: 3 });
    for bad in [f64::NAN, f64::INFINITY, -1e101] {
        let mut broken = corners.clone();
        broken[2].y = bad;
        assert_eq!(TriMesh::new(broken, vec![[0, 1, 2]]).unwrap_err(), MeshError::NotFinite { vertex: 2 });
    }
}

#[test]
fn a_pose_of_nan_is_a_contact_for_every_mesh() {
    let mut workspace = Workspace::new();
    for (name, triangles) in degenerate_meshes() {
        let (a, b) = (shape(&triangles), shape(&brick(0.1, Vec3::ZERO)));
        for bad in [f64::NAN, f64::INFINITY] {
            let pose = Pose::from_translation(Vec3::new(0.0, bad, 9.0));
            for (pa, pb) in [(pose, Pose::IDENTITY), (Pose::IDENTITY, pose)] {
                assert!(collides(&a, &pa, &b, &pb) && separation(&a, &pa, &b, &pb).distance == 0.0, "{name}");
                assert!(within(&a, &pa, &b, &pb, 0.0), "{name}");
                assert!(workspace.collides(&a, &pa, &b, &pb) && workspace.within(&a, &pa, &b, &pb, 0.0), "{name}");
                let (m, n) = (mesh_of(&a), mesh_of(&b));
                assert!(colliding_triangles(m, &pa, n, &pb, &mut workspace).is_some(), "{name}");
                assert!(triangles_within(m, &pa, n, &pb, 0.1, &mut workspace).is_some(), "{name}");
                assert_eq!(mesh_separation(m, &pa, n, &pb, &mut workspace).distance, 0.0, "{name}");
            }
        }
    }
}
