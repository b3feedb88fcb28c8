//! The pair rules, and the checker against asking every pair at every step.

use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Capsule, Shape, Sphere, collides};
use elbowroom_scene::pairs::{FirstContacts, Member, links_can_meet, pairs};
use elbowroom_scene::{Body, Object, Robot};
use elbowroom_spatial::{Pose, Vec3};

/// Five links in a row, joints about y and z in turn; link 2 has no solid.
fn snake() -> Robot {
    let joint = |i: usize| Joint {
        name: format!("j{i}"),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(Vec3::Z * 0.3),
        axis: if i.is_multiple_of(2) { Vec3::Y } else { Vec3::X },
        limits: Limits::range(-2.5, 2.5),
        mimic: None,
    };
    let links = (0..5).map(|i| format!("l{i}")).collect();
    let mut robot = Robot::new(Chain::new("snake", links, (0..4).map(joint).collect()).unwrap());
    for i in [0, 1, 3, 4] {
        let shape = Shape::Capsule(Capsule { half_length: 0.1, radius: 0.04 });
        robot.bodies[i].push(Body { name: String::new(), shape, in_link: Pose::from_translation(Vec3::Z * 0.15) });
    }
    robot
}

#[test]
fn neighbours_are_no_pair_not_even_across_a_link_without_solids() {
    let mut robot = snake();
    let meet = |r: &Robot, a, b| links_can_meet(r, LinkId(a), LinkId(b));
    assert!(!meet(&robot, 0, 1) && !meet(&robot, 1, 3) && !meet(&robot, 3, 4));
    assert!(meet(&robot, 0, 3) && meet(&robot, 0, 4) && meet(&robot, 1, 4));
    robot.disabled_pairs.push((LinkId(4), LinkId(0), "never".into()));
    assert!(!meet(&robot, 0, 4));
    // Two snakes and two objects: 2 · 2 within, 4 · 4 − 1 between (both feet stand still), 2 · 3 · 2 with objects.
    assert_eq!(pairs(&[&robot, &robot], 2).len(), 4 + 15 + 12);
}

#[test]
fn the_checker_finds_every_first_contact_at_the_step_where_it_begins() {
    let robot = snake();
    let base = [Pose::IDENTITY, Pose::from_translation(Vec3::X * 0.9)];
    let objects = [Object {
        name: "ball".into(),
        shape: Shape::Sphere(Sphere { radius: 0.15 }),
        in_world: Pose::from_translation(Vec3::new(0.4, 0.5, 0.7)),
    }];
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / (1_u64 << 23) as f64 - 1.0
    };
    let mut contacts = 0;
    for _ in 0..150 {
        let mut checker = FirstContacts::new(vec![(&robot, base[0]), (&robot, base[1])], &objects);
        let mut states = [ChainState::new(&robot.chain), ChainState::new(&robot.chain)];
        let goals: Vec<Vec<f64>> = (0..2).map(|_| (0..4).map(|_| random() * 2.4).collect()).collect();
        let mut known: Vec<(Member, Member)> = Vec::new();
        for step in 0..200 {
            for (state, goal) in states.iter_mut().zip(&goals) {
                state.q.iter_mut().zip(goal).for_each(|(q, g)| *q = g * f64::from(step) / 200.0);
                robot.chain.forward(state);
            }
            let mut found = Vec::new();
            checker.check(&[&states[0], &states[1]], |a, b| found.push((a, b)));
            let solid = |m: Member| match m {
                Member::Object(o) => (objects[o].shape.clone(), objects[o].in_world),
                Member::Link { robot: r, link } => {
                    let body = &robot.bodies[link.0][0];
                    (body.shape.clone(), base[r] * states[r].link_in_root(link) * body.in_link)
                }
            };
            let touching: Vec<_> = pairs(&[&robot, &robot], 1)
                .into_iter()
                .filter(|p| !known.contains(p))
                .filter(|(a, b)| {
                    let ((sa, pa), (sb, pb)) = (solid(*a), solid(*b));
                    collides(&sa, &pa, &sb, &pb)
                })
                .collect();
            assert_eq!(found, touching, "step {step}");
            contacts += found.len();
            known.extend(found);
        }
    }
    assert!(contacts > 20, "{contacts}");
}
