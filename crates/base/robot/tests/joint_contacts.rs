//! Links that always touch at the joint between them, and links that only seem to.

use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, Cuboid, Shape, Sphere, collides};
use elbowroom_robot::{Collider, JointContact, JointContactKind, RSequence, Robot, joint_contacts};
use elbowroom_spatial::{Pose, Rotation, Vec3};

fn sphere(radius: f64, at: Vec3) -> Collider {
    Collider { name: String::new(), shape: Shape::Sphere(Sphere { radius }), in_link: Pose::from_translation(at) }
}

fn cuboid(size: Vec3, at: Vec3) -> Collider {
    let shape = Shape::Cuboid(Cuboid { half_extents: size * 0.5 });
    Collider { name: String::new(), shape, in_link: Pose::from_translation(at) }
}

/// A bar along x from the origin of its link.
fn bar(length: f64, radius: f64) -> Collider {
    let shape = Shape::Capsule(Capsule { half_length: 0.5 * length, radius });
    let turned = Rotation::from_rpy(0.0, std::f64::consts::FRAC_PI_2, 0.0);
    Collider { name: String::new(), shape, in_link: Pose::new(turned, Vec3::X * (0.5 * length)) }
}

/// Links on a line, each turning about z at the end of the one before; `lengths` are the distances between the joints.
fn arm(links: Vec<Vec<Collider>>, lengths: &[f64], half_range: f64) -> Robot {
    let joint = |i: usize| Joint {
        name: format!("joint_{}", i + 1),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(Vec3::X * lengths[i]),
        axis: if i.is_multiple_of(2) { Vec3::Z } else { Vec3::X },
        limits: Limits::range(-half_range, half_range),
        mimic: None,
    };
    let names = (0..links.len()).map(|i| format!("link_{i}")).collect();
    let chain = Chain::new("arm", names, (0..links.len() - 1).map(joint).collect()).unwrap();
    let mut robot = Robot::new(chain);
    robot.colliders = links;
    robot
}

fn found(robot: &Robot) -> Vec<JointContact> {
    joint_contacts(robot, &vec![0.0; robot.chain.dof()])
}

/// A forearm with a wrist of two joints at its end; the hand's hub reaches into the forearm.
fn wrist(hand: Vec<Collider>) -> Robot {
    let forearm = vec![cuboid(Vec3::new(0.4, 0.1, 0.1), Vec3::X * 0.25)];
    arm(vec![forearm, vec![sphere(0.04, Vec3::ZERO)], hand], &[0.45, 0.02], 1.5)
}

#[test]
fn a_hub_inside_the_forearm_is_found_with_its_joint() {
    let robot = wrist(vec![sphere(0.05, Vec3::ZERO)]);
    let all = found(&robot);
    assert_eq!(all.len(), 1, "{all:?}");
    let contact = all[0];
    assert_eq!((contact.a, contact.b), (LinkId(0), LinkId(2)));
    assert!(contact.farthest_m.1 < 0.1 && contact.samples >= 1000, "{contact:?}");
    // The result is always the same, whatever the start within the sampled range.
    assert_eq!(joint_contacts(&robot, &[0.3, -0.2]), all);
    assert!(joint_contacts(&robot, &[0.0]).is_empty() && joint_contacts(&robot, &[f64::NAN, 0.0]).is_empty());
}

#[test]
fn a_hand_that_also_hits_the_forearm_elsewhere_stays_a_pair() {
    // The hand's hub is always in the forearm; in some configurations a bar is folded back onto the forearm.
    let forearm = vec![cuboid(Vec3::new(0.4, 0.1, 0.1), Vec3::X * 0.25)];
    let hand = vec![sphere(0.05, Vec3::ZERO), bar(0.4, 0.02)];
    let folding = arm(vec![forearm, vec![sphere(0.04, Vec3::ZERO)], hand], &[0.45, 0.02], 3.1);
    assert!(found(&folding).is_empty(), "{:?}", found(&folding));
}

#[test]
fn links_that_touch_often_but_not_always_stay_a_pair() {
    // The hand's pin touches the forearm at rest, and separates when the wrist turns. The range determines in how many
    // configurations.
    let mut shares = Vec::new();
    for half_range in [1.5, 2.0, 3.0] {
        let forearm = vec![cuboid(Vec3::new(0.4, 0.1, 0.1), Vec3::X * 0.25)];
        let hand = vec![sphere(0.02, Vec3::new(-0.05, 0.03, 0.0))];
        let robot = arm(vec![forearm, vec![sphere(0.04, Vec3::ZERO)], hand], &[0.45, 0.03], half_range);
        assert!(found(&robot).is_empty(), "{half_range}: {:?}", found(&robot));
        shares.push(share_in_contact(&robot, LinkId(0), LinkId(2)));
    }
    assert!(shares.iter().all(|s| *s > 0.5 && *s < 1.0), "{shares:?}");
}

/// The fraction of 1000 configurations in which the first colliders of two links touch.
fn share_in_contact(robot: &Robot, a: LinkId, b: LinkId) -> f64 {
    let (mut state, sequence) = (ChainState::new(&robot.chain), RSequence::new(robot.chain.dof()));
    let mut touches = |n: u64| {
        sequence.set_state(&robot.chain, &mut state, n, 0);
        let [(x, p), (y, q)] = [a, b].map(|link| {
            let collider = &robot.colliders[link.0][0];
            (&collider.shape, state.link_in_root(link) * collider.in_link)
        });
        collides(x, &p, y, &q)
    };
    (0..1000).filter(|n| touches(*n)).count() as f64 / 1000.0
}

#[test]
fn links_that_always_touch_far_from_their_joints_stay_a_pair() {
    // The forearm's far end always slides on a plate around the base.
    let plate = vec![cuboid(Vec3::new(3.0, 3.0, 0.1), -Vec3::Z * 0.1)];
    let far = vec![sphere(0.06, Vec3::X * 0.9)];
    let mut robot = arm(vec![plate, vec![sphere(0.02, Vec3::ZERO)], far], &[0.0, 0.1], 3.0);
    // Both joints are about z, so the far end stays on the plate.
    let joints = robot.chain.joints().iter().cloned().map(|j| Joint { axis: Vec3::Z, ..j }).collect();
    robot.chain = Chain::new("arm", robot.chain.links().to_vec(), joints).unwrap();
    assert!(found(&robot).is_empty(), "{:?}", found(&robot));
}

#[test]
fn links_with_three_joints_between_stay_a_pair() {
    let ball = |radius| vec![sphere(radius, Vec3::ZERO)];
    let robot = arm(vec![ball(0.1), ball(0.02), ball(0.02), ball(0.1)], &[0.01, 0.01, 0.01], 3.0);
    let pairs: Vec<_> = found(&robot).iter().map(|c| (c.a.0, c.b.0)).collect();
    assert!(!pairs.contains(&(0, 3)) && pairs.contains(&(0, 2)), "{pairs:?}");
}

#[test]
fn a_piston_that_one_joint_value_moves_is_found_and_one_that_leaves_its_cylinder_is_not() {
    // The arm lifts; the cylinder beside it and the piston in it follow.
    let pistons = |stroke: f64| {
        let joint = |name: &str, kind, parent, child, axis, at, mimic| Joint {
            name: name.to_owned(),
            kind,
            parent: LinkId(parent),
            child: LinkId(child),
            origin: Pose::from_translation(at),
            axis,
            limits: Limits::range(-1.0, 1.0),
            mimic,
        };
        let follow = |multiplier| Some(Mimic { joint: JointId(0), multiplier, offset: 0.0 });
        let (revolute, slide) = (JointKind::Revolute, JointKind::Prismatic);
        let joints = vec![
            joint("lift", revolute, 0, 1, Vec3::Y, Vec3::X * 0.5, None),
            joint("tilt", revolute, 0, 2, Vec3::Y, Vec3::ZERO, follow(-0.2)),
            joint("push", slide, 2, 3, Vec3::X, Vec3::X * 0.2, follow(stroke)),
        ];
        let names = ["base", "arm", "cylinder", "piston"].map(String::from).to_vec();
        let mut robot = Robot::new(Chain::new("press", names, joints).unwrap());
        robot.colliders[0] = vec![cuboid(Vec3::new(0.3, 0.2, 0.2), Vec3::ZERO)];
        robot.colliders[1] = vec![cuboid(Vec3::new(0.3, 0.1, 0.1), Vec3::X * 1.5)];
        robot.colliders[2] = vec![bar(0.3, 0.04)];
        robot.colliders[3] = vec![bar(0.3, 0.02)];
        robot.colliders[3][0].in_link.translation -= Vec3::X * 0.3;
        robot
    };
    let pairs = |robot: &Robot| found(robot).iter().map(|c| (c.a.0, c.b.0)).collect::<Vec<_>>();
    // The piston's end stays in the base, where the cylinder is mounted.
    assert_eq!(pairs(&pistons(0.1)), [(0, 3)]);
    // The piston is drawn out of the base.
    assert!(pairs(&pistons(0.5)).is_empty());
}

fn kinds(robot: &Robot) -> Vec<(usize, usize, JointContactKind)> {
    found(robot).iter().map(|c| (c.a.0, c.b.0, c.kind)).collect()
}

/// A shoulder, an arm on it and a lever on the arm that turns about the arm's own joint; the lever's far end passes `post_x_m`.
fn lever(lever_at: Vec3, post_x_m: f64) -> Robot {
    let joint = |name: &str, parent, child, at| Joint {
        name: name.to_owned(),
        kind: JointKind::Revolute,
        parent: LinkId(parent),
        child: LinkId(child),
        origin: Pose::from_translation(at),
        axis: Vec3::Y,
        limits: Limits::range(-1.5, 1.5),
        mimic: None,
    };
    let joints = vec![joint("lift", 0, 1, Vec3::ZERO), joint("drive", 1, 2, lever_at)];
    let names = ["shoulder", "arm", "lever"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("lift", names, joints).unwrap());
    let post = cuboid(Vec3::new(0.1, 0.1, 0.2), Vec3::new(post_x_m, 0.0, -0.5));
    robot.colliders[0] = vec![cuboid(Vec3::splat(0.1), Vec3::ZERO), post];
    robot.colliders[1] = vec![cuboid(Vec3::new(0.1, 0.05, 0.5), Vec3::Z * 0.3)];
    robot.colliders[2] = vec![bar(0.6, 0.02)];
    robot
}

#[test]
fn a_lever_on_the_axis_of_the_joint_below_counts_as_joined_even_where_it_also_hits_farther_out() {
    // The lever beside the arm always touches the shoulder at the common axis; in some configurations its end also hits
    // the post.
    let near = lever(Vec3::ZERO, 0.0);
    assert_eq!(kinds(&near), [(0, 2, JointContactKind::Linkage)]);
    let contact = found(&near)[0];
    assert!(contact.nearest_m.1 < 0.1 && contact.farthest_m.1 > 0.4, "{contact:?}");
    // It hits nothing else, so the contact is only at the joint.
    assert_eq!(kinds(&lever(Vec3::ZERO, 5.0)), [(0, 2, JointContactKind::AtJoint)]);
    // On its own axis it remains a pair.
    assert!(kinds(&lever(Vec3::new(0.03, 0.0, 0.0), 0.0)).is_empty(), "{:?}", kinds(&lever(Vec3::X * 0.03, 0.0)));
}

/// A crank, and a rod on the base that the same value moves. The rod's eye passes the crank's pin at a distance that
/// the ratio of the mimic joint makes smaller or larger.
fn crank(eye_m: f64, ratio: f64) -> Robot {
    let joint = |name: &str, parent, child, at, mimic| Joint {
        name: name.to_owned(),
        kind: JointKind::Revolute,
        parent: LinkId(parent),
        child: LinkId(child),
        origin: Pose::from_translation(at),
        axis: Vec3::Y,
        limits: Limits::range(-1.0, 1.0),
        mimic,
    };
    let follow = Some(Mimic { joint: JointId(0), multiplier: ratio, offset: 0.0 });
    let joints = vec![joint("turn", 0, 1, Vec3::ZERO, None), joint("swing", 0, 2, Vec3::new(1.0, 0.0, 0.0), follow)];
    let names = ["base", "crank", "rod"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("crank", names, joints).unwrap());
    robot.colliders[0] = vec![sphere(0.05, Vec3::new(0.5, 0.0, -2.0))];
    // The pin is 0.2 m from the crank's joint, and the eye 0.8 m from the rod's.
    robot.colliders[1] = vec![sphere(0.03, Vec3::X * 0.2), cuboid(Vec3::new(0.15, 0.02, 0.02), Vec3::X * 0.08)];
    robot.colliders[2] = vec![sphere(eye_m, Vec3::X * 0.2 - Vec3::X), bar(0.7, 0.01)];
    robot.colliders[2][1].in_link.translation -= Vec3::X * 0.7;
    robot
}

#[test]
fn an_eye_on_its_pin_is_found_though_it_leaves_it_at_the_ends_of_the_stroke() {
    // Turning the crank by 1 rad lifts the pin by 0.17 m; the rod by a quarter of it, the eye by 0.2 m.
    let robot = crank(0.04, -0.25);
    assert_eq!(kinds(&robot), [(1, 2, JointContactKind::Pivot)]);
    let contact = found(&robot)[0];
    assert!(contact.contacts >= 500 && contact.contacts < contact.samples, "{contact:?}");
    // The links need not touch at the start.
    assert!(joint_contacts(&robot, &[1.0]).contains(&contact));
    // The links touch in less than half of the stroke: not a pivot. Driven by its own value, the rod is not a pivot
    // either.
    assert!(kinds(&crank(0.04, 0.25)).is_empty(), "{:?}", kinds(&crank(0.04, 0.25)));
    let joints = robot.chain.joints().iter().cloned().map(|j| Joint { mimic: None, ..j }).collect();
    let free = Robot { chain: Chain::new("crank", robot.chain.links().to_vec(), joints).unwrap(), ..robot };
    assert!(kinds(&free).is_empty(), "{:?}", kinds(&free));
}
