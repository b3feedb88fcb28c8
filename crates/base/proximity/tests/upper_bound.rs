//! Upper bounds of distances: never below the distance, and near it for a mesh beside a solid.

use crate::common::{RandomGeometry, SplitMix};
use elbowroom_proximity::{Cuboid, Shape, WarmStart, Workspace, separation};
use elbowroom_spatial::{Pose, Vec3};

#[test]
fn no_upper_bound_is_below_the_distance() {
    let (mut r, mut workspace) = (SplitMix(7), Workspace::new());
    for kind in ["sphere", "capsule", "cylinder", "box", "hull", "mesh"] {
        for _ in 0..150 {
            let (mesh, solid, here, there) = (r.shape("mesh"), r.shape(kind), r.pose(0.6), r.pose(0.6));
            let distance = separation(&mesh, &here, &solid, &there).distance;
            for (a, at_a, b, at_b) in [(&mesh, &here, &solid, &there), (&solid, &there, &mesh, &here)] {
                let bound = workspace.distance_upper_bound(a, at_a, b, at_b, &mut WarmStart::default()).unwrap();
                assert!(bound >= distance, "{kind}: {bound} {distance}");
                // One triangle of each is no farther than the two are large.
                assert!(bound <= distance + 10.0, "{kind}: {bound} {distance}");
            }
        }
    }
}

#[test]
fn pairs_without_a_cheap_bound_have_none() {
    let mut workspace = Workspace::new();
    let solid = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) });
    let mesh = SplitMix(8).shape("mesh");
    let nowhere = Pose::from_translation(Vec3::X * f64::NAN);
    let mut bound = |a: &Shape, b: &Shape, at: &Pose| {
        workspace.distance_upper_bound(a, &Pose::IDENTITY, b, at, &mut WarmStart::default())
    };
    assert_eq!(bound(&solid, &solid, &Pose::IDENTITY), None);
    assert_eq!(bound(&mesh, &solid, &nowhere), None);
    assert!(bound(&mesh, &solid, &Pose::IDENTITY).is_some());
}

#[test]
fn a_mesh_at_any_distance_has_one() {
    let (mut r, mut workspace) = (SplitMix(9), Workspace::new());
    let (mesh, solid) = (r.shape("mesh"), Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) }));
    for exponent in [3, 10, 18, 20, 30] {
        let far = Pose::from_translation(Vec3::X * 10f64.powi(exponent));
        let bound = workspace.distance_upper_bound(&mesh, &Pose::IDENTITY, &solid, &far, &mut WarmStart::default());
        let settings = elbowroom_proximity::DistanceSettings { limit: bound.unwrap(), ..Default::default() };
        assert!(workspace.separation(&mesh, &Pose::IDENTITY, &solid, &far, settings).is_some(), "10^{exponent} m");
    }
}
