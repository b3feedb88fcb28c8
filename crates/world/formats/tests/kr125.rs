//! The KR125 of `examples/models` and its published table.

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits, dh::ClassicalRow};
use elbowroom_robot::Robot;
use elbowroom_spatial::Vec3;

fn kr125() -> Robot {
    let urdf = elbowroom_testkit::folder::model("kr125");
    load(&urdf, &LoadOptions::default()).unwrap().robot
}

#[test]
fn its_motion_agrees_with_the_published_table() {
    let row = |joint: &str, a: f64, alpha: f64, d: f64, theta: f64| ClassicalRow {
        joint: joint.into(),
        kind: JointKind::Revolute,
        a,
        alpha: alpha.to_radians(),
        d,
        theta: theta.to_radians(),
        limits: Limits::UNLIMITED,
    };
    let table = [
        row("joint_1", 0.41, -90.0, 0.865, 0.0),
        row("joint_2", 1.0, 0.0, 0.0, 0.0),
        row("joint_3", 0.045, 90.0, 0.0, -90.0),
        row("joint_4", 0.0, -90.0, -1.0, 0.0),
        row("joint_5", 0.0, 90.0, 0.0, 0.0),
        row("joint_6", 0.0, 180.0, -0.21, 180.0),
    ];
    let published = Chain::from_dh("kr125", &table).unwrap();
    let ours = kr125().chain;
    let (mut a, mut b) = (ChainState::new(&published), ChainState::new(&ours));
    for n in 0..200 {
        let q: Vec<f64> = (0..6).map(|i| f64::from(n * 37 + i * 101) * 0.013 % 2.0 - 1.0).collect();
        a.q.copy_from_slice(&q);
        a.q[0] = -q[0]; // axis 1 has the opposite sign
        b.q.copy_from_slice(&q);
        published.forward(&mut a);
        ours.forward(&mut b);
        let (x, y) = (a.link_in_root(published.tip()), b.link_in_root(ours.link("tool0").unwrap()));
        assert!(x.translation.distance(y.translation) < 1e-9, "{q:?}: {x:?} {y:?}");
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            assert!(x.transform_vector(axis).distance(y.transform_vector(axis)) < 1e-9, "{q:?}");
        }
    }
    let degrees = |limits: &Limits| {
        let of = |x: f64| (x.to_degrees() * 1e6).round() / 1e6;
        (of(limits.lower), of(limits.upper), of(limits.velocity.unwrap()))
    };
    let limits: Vec<_> = ours.joints().iter().filter(|j| j.kind.moves()).map(|j| degrees(&j.limits)).collect();
    let published = [
        (-185.0, 185.0, 100.0),
        (-130.0, 3.0, 100.0),
        (-120.0, 148.0, 100.0),
        (-350.0, 350.0, 154.0),
        (-120.0, 120.0, 167.0),
        (-350.0, 350.0, 251.0),
    ];
    assert_eq!(limits, published);
}
