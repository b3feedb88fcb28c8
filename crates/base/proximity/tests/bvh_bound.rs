//! Lower bounds by the boxes of the BVH compared with the exact distance.

use std::sync::Arc;

use crate::common::{CONVEX, RandomGeometry, SplitMix};
use elbowroom_proximity::advanced::{bvh_lower_bound, bvh_lower_bound_to_shape, mesh_separation};
use elbowroom_proximity::{Shape, Sphere, TriMesh, Workspace, project_point, separation, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};

fn lump(r: &mut SplitMix, fine: f64) -> TriMesh {
    let (mut v, t) = tessellate(&Shape::Sphere(Sphere { radius: 0.3 }), fine);
    let stretch = Vec3::new(r.between(0.5, 2.0), r.between(0.5, 1.5), r.between(0.5, 1.5));
    for p in &mut v {
        *p = p.scale(stretch);
    }
    TriMesh::new(v, t).unwrap()
}

#[test]
fn boxes_are_never_farther_than_surfaces_and_get_better_with_depth() {
    let mut r = SplitMix(11);
    let mut workspace = Workspace::new();
    let (mut cleared, mut sum, mut exact_sum) = ([0; 6], [0.0; 6], 0.0);
    for _ in 0..80 {
        let (a, b) = (lump(&mut r, 0.0002), lump(&mut r, 0.002));
        let (p, q) = (r.pose(0.2), r.pose(1.0));
        let exact = mesh_separation(&a, &p, &b, &q, &mut workspace);
        exact_sum += exact.distance;
        let deepest = a.bvh_depth().max(b.bvh_depth());
        assert!(deepest >= 2);
        for level in 0..=deepest + 1 {
            let c = bvh_lower_bound(&a, &p, &b, &q, level, f64::INFINITY, &mut workspace).unwrap();
            assert!(c.lower_bound <= exact.distance, "{level} {c:?} {exact:?}");
            sum[level as usize] += c.lower_bound;
            cleared[level as usize] += usize::from(c.lower_bound > 0.0);
            if exact.distance > 0.0 {
                assert!(c.on_a.distance(c.on_b) >= exact.distance - 1e-6);
                let on = |m: &TriMesh, pose: &Pose, x: Vec3| {
                    project_point(&Shape::Mesh(Arc::new(m.clone())), pose, x).signed_distance.abs()
                };
                assert!(on(&a, &p, c.on_a) < 1e-6 && on(&b, &q, c.on_b) < 1e-6, "landmarks");
            }
            // With a limit, `None` is returned only if it is proven, and otherwise the same bound.
            let limit = r.between(0.0, 1.0);
            match bvh_lower_bound(&a, &p, &b, &q, level, limit, &mut workspace) {
                None => assert!(exact.distance > limit),
                Some(d) => assert!((d.lower_bound - c.lower_bound).abs() < 1e-4 && c.lower_bound < limit + 1e-4),
            }
            let lost = Pose::from_translation(Vec3::X * f64::NAN);
            assert_eq!(bvh_lower_bound(&a, &p, &b, &lost, level, 0.1, &mut workspace).unwrap().lower_bound, 0.0);
        }
        let last = bvh_lower_bound(&a, &p, &b, &q, 9, f64::INFINITY, &mut workspace).unwrap();
        assert!(exact.distance == 0.0 || last.lower_bound > exact.distance - 0.15, "{last:?} {exact:?}");
    }
    assert!(sum[0] < sum[1] && sum[1] < sum[2] && sum[2] > 0.8 * exact_sum, "{sum:?} {exact_sum}");
    assert!(cleared[0] < cleared[1] && cleared[1] <= cleared[2], "{cleared:?}");
}

#[test]
fn contained_shapes_have_the_bound_zero() {
    let mut r = SplitMix(12);
    let mut workspace = Workspace::new();
    let (v, t) = tessellate(&Shape::Sphere(Sphere { radius: 2.0 }), 0.001);
    let hollow = TriMesh::new(v, t).unwrap();
    for _ in 0..50 {
        let (small, p) = (lump(&mut r, 0.002), r.pose(0.5));
        for level in 0..4 {
            for (a, b, x, y) in [(&hollow, &small, Pose::IDENTITY, p), (&small, &hollow, p, Pose::IDENTITY)] {
                assert_eq!(bvh_lower_bound(a, &x, b, &y, level, 0.0, &mut workspace).unwrap().lower_bound, 0.0);
            }
            let ball = Shape::Sphere(Sphere { radius: 0.1 });
            assert_eq!(bvh_lower_bound_to_shape(&hollow, &Pose::IDENTITY, &ball, &p, level).unwrap().lower_bound, 0.0);
        }
    }
}

#[test]
fn boxes_of_a_mesh_are_never_farther_from_a_simple_shape() {
    let mut r = SplitMix(13);
    let mut sum = [0.0; 4];
    let mut exact_sum = 0.0;
    for k in 0..200 {
        let a = lump(&mut r, 0.0005);
        let (b, p, q) = (r.shape(CONVEX[k % 5]), r.pose(0.3), r.pose(2.0));
        let exact = separation(&Shape::Mesh(Arc::new(a.clone())), &p, &b, &q).distance;
        exact_sum += exact;
        for (level, sum) in sum.iter_mut().enumerate() {
            let c = bvh_lower_bound_to_shape(&a, &p, &b, &q, level as u8).unwrap();
            assert!(c.lower_bound <= exact, "{level} {b:?} {c:?} {exact}");
            *sum += c.lower_bound;
        }
    }
    assert!(sum[0] < sum[1] && sum[1] < sum[2] && sum[2] > 0.6 * exact_sum, "{sum:?} {exact_sum}");
    let nan = Pose::from_translation(Vec3::X * f64::NAN);
    assert!(
        bvh_lower_bound_to_shape(&lump(&mut r, 0.01), &Pose::IDENTITY, &Shape::Sphere(Sphere { radius: 0.1 }), &nan, 1)
            .is_none()
    );
}
