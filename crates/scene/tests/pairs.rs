//! The pair rules, and the checker against asking every pair at every step.

use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::impact::{Path, Steady};
use elbowroom_proximity::{Capsule, Cuboid, Shape, Sphere, collides};
use elbowroom_scene::pairs::{FirstContacts, Member, links_can_meet, pairs, resting_contacts};
use elbowroom_scene::{Body, Object, ObjectStep, Robot};
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
fn neighbours_are_no_pair_and_two_moving_joints_make_one() {
    let mut robot = snake();
    let meet = |r: &Robot, a, b| links_can_meet(r, LinkId(a), LinkId(b));
    assert!(!meet(&robot, 0, 1) && !meet(&robot, 3, 4));
    assert!(meet(&robot, 1, 3), "two joints with a link without solids between them");
    assert!(meet(&robot, 0, 3) && meet(&robot, 0, 4) && meet(&robot, 1, 4));
    robot.disabled_pairs.push((LinkId(4), LinkId(0), "never".into()));
    assert!(!meet(&robot, 0, 4));
    // Two snakes and two objects: 2 · 3 within, 4 · 4 − 1 between (both feet stand still), 2 · 3 · 2 with objects.
    assert_eq!(pairs(&[&robot, &robot], 2).len(), 6 + 15 + 12);
    // Across a fixed joint and a link without solids there is one moving joint: neighbours.
    let mut joints = robot.chain.joints().to_vec();
    joints[1].kind = JointKind::Fixed;
    robot.chain = Chain::new("stiff", robot.chain.links().to_vec(), joints).unwrap();
    assert!(!meet(&robot, 1, 3) && meet(&robot, 0, 3));
}

/// Two fingers that slide along x on a palm without solids, boxes of 20 mm, 40 mm apart at 0.
fn gripper() -> Robot {
    let finger = |i: usize| Joint {
        name: format!("f{i}"),
        kind: JointKind::Prismatic,
        parent: LinkId(0),
        child: LinkId(i),
        origin: Pose::from_translation(Vec3::X * if i == 1 { 0.02 } else { -0.02 }),
        axis: if i == 1 { Vec3::X } else { -Vec3::X },
        limits: Limits::range(-0.05, 0.05),
        mimic: None,
    };
    let links = ["palm", "one", "two"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("gripper", links, vec![finger(1), finger(2)]).unwrap());
    for i in [1, 2] {
        let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.01) });
        robot.bodies[i].push(Body { name: String::new(), shape, in_link: Pose::IDENTITY });
    }
    robot
}

/// The looks at which the fingers begin to touch, while both go through `q` together.
fn touches(q: &[f64]) -> Vec<usize> {
    let robot = gripper();
    let mut checker = FirstContacts::new(vec![(&robot, Pose::IDENTITY)], &[]);
    let mut state = ChainState::new(&robot.chain);
    let mut found = Vec::new();
    for (look, q) in q.iter().enumerate() {
        state.q.fill(*q);
        robot.chain.forward(&mut state);
        checker.check(&[&state], &[], |_| found.push(look));
    }
    found
}

#[test]
fn fingers_on_an_empty_palm_collide_and_a_contact_at_rest_counts_once_they_were_apart() {
    assert_eq!(touches(&[0.0, -0.005, -0.01, -0.02, -0.03]), [2]);
    // Closed at the start: no event, until they have been open.
    assert_eq!(touches(&[-0.01, -0.012, -0.02, -0.012]), [0; 0]);
    assert_eq!(touches(&[-0.02, -0.01, 0.0, 0.01, -0.02, -0.03]), [4]);
    let robot = gripper();
    let at = |q: f64| resting_contacts(&robot, &[q; 2]);
    assert!(at(0.0).is_empty());
    let closed = at(-0.01);
    assert_eq!((closed[0].a, closed[0].b, closed.len()), (LinkId(1), LinkId(2), 1));
    assert!(closed[0].contacts > 10 && !closed[0].always(), "{closed:?}");
}

/// Two snakes beside each other, and a ball that passes.
struct Stage {
    robot: Robot,
    base: [Pose; 2],
    objects: [Object; 1],
}

impl Stage {
    fn new() -> Self {
        let ball = Shape::Sphere(Sphere { radius: 0.1 });
        let in_world = Pose::from_translation(Vec3::new(0.4, -0.9, 0.7));
        let base = [Pose::IDENTITY, Pose::from_translation(Vec3::X * 0.9)];
        Self { robot: snake(), base, objects: [Object { name: "ball".into(), shape: ball, in_world }] }
    }

    fn pairs(&self) -> Vec<(Member, Member)> {
        let mut list = pairs(&[&self.robot, &self.robot], 1);
        list.extend((0..2).map(|robot| (Member::Link { robot, link: LinkId(0) }, Member::Object(0))));
        list
    }

    fn touch(&self, (a, b): (Member, Member), states: &[ChainState], ball: Pose) -> bool {
        let solid = |m: Member| match m {
            Member::Object(o) => (self.objects[o].shape.clone(), ball),
            Member::Link { robot, link } => {
                let body = &self.robot.bodies[link.0][0];
                (body.shape.clone(), self.base[robot] * states[robot].link_in_root(link) * body.in_link)
            }
        };
        let ((sa, pa), (sb, pb)) = (solid(a), solid(b));
        collides(&sa, &pa, &sb, &pb)
    }
}

#[test]
fn the_checker_finds_every_first_contact_and_when_it_begins() {
    let stage = Stage::new();
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / (1_u64 << 23) as f64 - 1.0
    };
    let (mut contacts, mut with_ball, mut passed) = (0, 0, 0);
    for run in 0..120 {
        let robots = stage.base.map(|base| (&stage.robot, base)).to_vec();
        let mut checker = FirstContacts::new(robots, &stage.objects).moving(&[0]);
        assert_eq!(checker.len(), stage.pairs().len());
        // Every other run in steps so coarse that a contact may come and go within one.
        let (steps, fine) = if run % 2 == 0 { (200, 4) } else { (12, 50) };
        let goals: Vec<Vec<f64>> = (0..2).map(|_| (0..4).map(|_| random() * 2.4).collect()).collect();
        let way = Vec3::new(random(), 2.5, random() * 0.5);
        let at = |share: f64| {
            let states = goals.iter().map(|goal| {
                let mut state = ChainState::new(&stage.robot.chain);
                state.q.iter_mut().zip(goal).for_each(|(q, g)| *q = g * share);
                stage.robot.chain.forward(&mut state);
                state
            });
            let start = stage.objects[0].in_world;
            (states.collect::<Vec<_>>(), Pose::new(start.rotation, start.translation + way * share))
        };
        let mut known: Vec<(Member, Member)> = Vec::new();
        for step in 0..steps {
            let time = |fraction: f64| (f64::from(step) - 1.0 + fraction).max(0.0) / f64::from(steps);
            let (states, ball) = at(time(1.0));
            let path = Steady::linear(at(time(0.0)).1, ball.translation - at(time(0.0)).1.translation);
            let moves = [ObjectStep { object: 0, path: &path as &dyn Path, jumps: false }];
            let mut found = Vec::new();
            checker.check(&[&states[0], &states[1]], &moves, |c| found.push(((c.a, c.b), c.fraction)));
            for pair in stage.pairs().into_iter().filter(|p| !known.contains(p)) {
                let first = (1..=fine).map(|k| f64::from(k) / f64::from(fine)).find(|f| {
                    let (states, ball) = at(time(*f));
                    stage.touch(pair, &states, ball)
                });
                let told = found.iter().find(|f| f.0 == pair).map(|f| f.1);
                match (first, told) {
                    (Some(first), Some(told)) => {
                        let late = told - first;
                        assert!(late < 1e-9 && late > -1.0 / f64::from(fine) - 1e-9, "{pair:?}: {told} {first}");
                    }
                    (None, Some(told)) => {
                        // A touch so short that the samples are on both sides of it.
                        let (states, ball) = at(time(told));
                        assert!(stage.touch(pair, &states, ball), "{pair:?} in step {step}");
                    }
                    (Some(first), None) => panic!("{pair:?} missed in step {step} at {first}"),
                    (None, None) => {}
                }
            }
            let here = at(time(1.0));
            for (pair, _) in found {
                contacts += 1;
                with_ball += usize::from(pair.1 == Member::Object(0));
                passed += usize::from(!stage.touch(pair, &here.0, here.1));
                known.push(pair);
            }
        }
    }
    assert!(contacts > 40 && with_ball > 20 && passed > 3, "{contacts} {with_ball} {passed}");
}
