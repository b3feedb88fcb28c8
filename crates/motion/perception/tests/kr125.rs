//! The KR125 of `examples/models`: its published table, and its solids within the planar arm of the joint-space map.

use elbowroom_cspace::{JointConvention, PlanarArm};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits, LinkId, dh::ClassicalRow};
use elbowroom_perception::MappedArm;
use elbowroom_proximity::{Shape, tessellate::tessellate};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};
use proptest::prelude::*;

/// Largest chord error of tessellated solids, metres.
const CHORD_M: f64 = 5e-4;

fn kr125() -> Robot {
    let urdf = elbowroom_testkit::folder::model("kr125");
    load(&urdf, &LoadOptions::default()).unwrap().robot
}

/// Corners of all solids of a link, in its frame.
fn corners(robot: &Robot, link: usize) -> Vec<Vec3> {
    let of = |collider: &elbowroom_robot::Collider| -> Vec<Vec3> {
        let (corners, _) = tessellate(&collider.shape, CHORD_M);
        corners.into_iter().map(|p| collider.in_link.transform_point(p)).collect()
    };
    robot.colliders[link].iter().flat_map(of).collect()
}

fn to_segment(p: Vec3, a: Vec3, b: Vec3) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).dot(b - a)).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
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

/// Capsules and spheres are convex: a convex solid is inside if its corners are. Joint values do not matter: links 2
/// and 3 are fixed to their capsule, link 4 rotates about the forearm's axis, 5 and 6 about the wrist's centre.
#[test]
fn links_lie_within_the_planar_arm_whatever_the_wrist_does() {
    let (robot, arm) = (kr125(), PlanarArm::KR125);
    let link = |name: &str| corners(&robot, robot.chain.link(name).unwrap().0);
    let origin = Vec3::ZERO;
    let upper = link("link_2").into_iter().map(|p| to_segment(p, origin, Vec3::X)).fold(0.0, f64::max);
    assert!(upper + CHORD_M <= arm.upper_radius_m, "upper arm: {upper}");
    let wrist = Vec3::new(1.0, 0.0, 0.045);
    let fore = link("link_3").into_iter().map(|p| to_segment(p, origin, wrist)).fold(0.0, f64::max);
    assert!(fore + CHORD_M <= arm.fore_radius_m, "forearm: {fore}");
    // A corner of link 4 at any angle about axis 4, which runs 45 mm above the elbow to the wrist's centre.
    let turned = |p: Vec3| {
        let (x, r) = (0.55 + p.x, p.y.hypot(p.z));
        let at = |n: u32| {
            let (sin, cos) = (f64::from(n) * std::f64::consts::TAU / 720.0).sin_cos();
            to_segment(Vec3::new(x, r * sin, 0.045 + r * cos), origin, wrist)
        };
        // Upper bound of the change within half a step.
        (0..720).map(at).fold(0.0, f64::max) + r * std::f64::consts::TAU / 1440.0
    };
    let second = link("link_4").into_iter().map(turned).fold(0.0, f64::max);
    assert!(second + CHORD_M <= arm.fore_radius_m, "second half of the forearm: {second}");
    for name in ["link_5", "link_6"] {
        let far = link(name).into_iter().map(Vec3::length).fold(0.0, f64::max);
        assert!(far + CHORD_M <= arm.wrist_radius_m, "{name}: {far}");
    }
}

#[test]
fn rotating_geometry_outside_the_upper_arm_is_enclosed_by_solids_of_revolution_about_axis_1() {
    let (robot, arm) = (kr125(), PlanarArm::KR125);
    let shoulder = Vec3::new(arm.offset_m, 0.0, arm.height_m - 0.35);
    for collider in &robot.colliders[robot.chain.link("link_1").unwrap().0] {
        let (corners, _) = tessellate(&collider.shape, CHORD_M);
        let far = |p: &Vec3| collider.in_link.transform_point(*p).distance(shoulder) + CHORD_M;
        let is_within = corners.iter().all(|p| far(p) <= arm.upper_radius_m);
        let axis = collider.in_link.transform_vector(Vec3::Z);
        let on_axis = collider.in_link.translation.x.hypot(collider.in_link.translation.y) < 1e-12;
        let is_round = matches!(collider.shape, Shape::Cylinder(_)) && on_axis && (axis - Vec3::Z).length() < 1e-12;
        assert!(is_within || is_round, "{collider:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// All links together, with signs and offsets.
    #[test]
    fn surfaces_lie_within_capsules_and_sphere_at_any_joint_values(share in prop::array::uniform6(0.0..1.0_f64)) {
        let robot = kr125();
        let joint = |(id, t): (&elbowroom_kinematics::JointId, f64)| {
            let limits = robot.chain.joints()[id.0].limits;
            limits.lower + (limits.upper - limits.lower) * t
        };
        let q: Vec<f64> = robot.chain.active_joints().iter().zip(share).map(joint).collect();
        let mut state = ChainState::new(&robot.chain);
        state.q.copy_from_slice(&q);
        robot.chain.forward(&mut state);
        let arm = PlanarArm::KR125;
        let [shoulder, elbow, wrist] = arm.joints_in_base(JointConvention::KR125.to_planar([q[0], q[1], q[2]]));
        for name in ["link_2", "link_3", "link_4", "link_5", "link_6"] {
            let link = robot.chain.link(name).unwrap().0;
            let in_base = state.link_in_root(LinkId(link));
            for p in corners(&robot, link) {
                let p = in_base.transform_point(p);
                let beyond = (to_segment(p, shoulder, elbow) - arm.upper_radius_m)
                    .min(to_segment(p, elbow, wrist) - arm.fore_radius_m)
                    .min(p.distance(wrist) - arm.wrist_radius_m);
                prop_assert!(beyond <= -CHORD_M, "{name}: {beyond} m outside at {q:?}");
            }
        }
    }
}

#[test]
fn its_grid_has_the_published_ranges() {
    let arm = MappedArm::kr125(kr125(), Pose::IDENTITY);
    let grid = arm.grid(2.0_f64.to_radians()).unwrap();
    assert_eq!(grid.shape(), [185, 67, 134]);
    let q = [0.4, -1.0, 0.6, 0.1, 0.2, 0.3];
    let planar = arm.to_planar(&q);
    assert!(grid.cell(planar).is_some());
    let back = arm.to_joints(&q, planar);
    assert!(q.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-12));
    let bad = MappedArm { joints: [0, 1, 9], ..arm };
    let message = bad.grid(0.03).unwrap_err().to_string();
    assert!(message.contains("joint index 9") && message.contains("has 6"), "{message}");
}
