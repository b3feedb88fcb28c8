//! Comparison of first contacts with tests of every pair at every step.

use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::ccd::{ConstantTwist, RigidMotion};
use elbowroom_proximity::{Capsule, Cuboid, Shape, Sphere, collides};
use elbowroom_robot::{Collider, GeometryId, ObjectId, Robot, RobotId, collision_pairs, rest_pose_contacts};

use elbowroom_scene::{FirstContacts, MovedObject, Object};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::linear_congruential;

/// Five links in a row, with joints alternating about y and z; link 2 has no collider.
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
        robot.colliders[i].push(Collider {
            name: String::new(),
            shape,
            in_link: Pose::from_translation(Vec3::Z * 0.15),
        });
    }
    robot
}

/// Two fingers that slide along x on a palm without colliders, boxes of 20 mm, 40 mm apart at 0.
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
        robot.colliders[i].push(Collider { name: String::new(), shape, in_link: Pose::IDENTITY });
    }
    robot
}

/// The calls at which the fingers begin to touch, while both fingers move through `q` together.
fn touches(q: &[f64]) -> Vec<usize> {
    let robot = gripper();
    let mut checker = FirstContacts::new(vec![(&robot, Pose::IDENTITY)], &[]);
    let mut state = ChainState::new(&robot.chain);
    let mut found = Vec::new();
    for (call, q) in q.iter().enumerate() {
        state.q.fill(*q);
        robot.chain.forward(&mut state);
        checker.check(&[&state], &[], |_| found.push(call));
    }
    found
}

#[test]
fn fingers_on_an_empty_palm_collide_and_a_rest_pose_contact_counts_once_they_have_separated() {
    assert_eq!(touches(&[0.0, -0.005, -0.01, -0.02, -0.03]), [2]);
    // Closed at the start: the contact counts only after the fingers have been open.
    assert_eq!(touches(&[-0.01, -0.012, -0.02, -0.012]), [0; 0]);
    assert_eq!(touches(&[-0.02, -0.01, 0.0, 0.01, -0.02, -0.03]), [4]);
    let robot = gripper();
    let at = |q: f64| rest_pose_contacts(&robot, &[q; 2]);
    assert!(at(0.0).is_empty());
    let closed = at(-0.01);
    assert_eq!((closed[0].a, closed[0].b, closed.len()), (LinkId(1), LinkId(2), 1));
    assert!(closed[0].contacts > 10 && !closed[0].always(), "{closed:?}");
}

/// Two snakes beside each other, and a ball that passes.
struct Setup {
    robot: Robot,
    base: [Pose; 2],
    objects: [Object; 1],
}

impl Setup {
    fn new() -> Self {
        let ball = Shape::Sphere(Sphere { radius: 0.1 });
        let in_world = Pose::from_translation(Vec3::new(0.4, -0.9, 0.7));
        let base = [Pose::IDENTITY, Pose::from_translation(Vec3::X * 0.9)];
        Self { robot: snake(), base, objects: [Object { name: "ball".into(), shape: ball, in_world }] }
    }

    fn pairs(&self) -> Vec<(GeometryId, GeometryId)> {
        let mut list = collision_pairs(&[&self.robot, &self.robot], 1);
        let base = |robot| GeometryId::Link { robot: RobotId(robot), link: LinkId(0) };
        list.extend((0..2).map(|robot| (base(robot), GeometryId::Object(ObjectId(0)))));
        list
    }

    fn touch(&self, (a, b): (GeometryId, GeometryId), states: &[ChainState], ball: Pose) -> bool {
        let shape = |id: GeometryId| match id {
            GeometryId::Object(o) => (self.objects[o.0].shape.clone(), ball),
            GeometryId::Link { robot, link } => {
                let collider = &self.robot.colliders[link.0][0];
                (collider.shape.clone(), self.base[robot.0] * states[robot.0].link_in_root(link) * collider.in_link)
            }
        };
        let ((sa, pa), (sb, pb)) = (shape(a), shape(b));
        collides(&sa, &pa, &sb, &pb)
    }
}

#[test]
fn every_first_contact_is_found_with_its_time() {
    let setup = Setup::new();
    let mut seed = 7_u64;
    let mut random = || (linear_congruential(&mut seed) >> 40) as f64 / (1_u64 << 23) as f64 - 1.0;
    let (mut contacts, mut with_ball, mut passed) = (0, 0, 0);
    for run in 0..120 {
        let robots = setup.base.map(|base| (&setup.robot, base)).to_vec();
        let mut checker = FirstContacts::new(robots, &setup.objects).moving(&[ObjectId(0)]);
        assert_eq!(checker.len(), setup.pairs().len());
        // Every other run has steps so coarse that a contact may begin and end within one step.
        let (steps, fine) = if run % 2 == 0 { (200, 4) } else { (12, 50) };
        let goals: Vec<Vec<f64>> = (0..2).map(|_| (0..4).map(|_| random() * 2.4).collect()).collect();
        let travel = Vec3::new(random(), 2.5, random() * 0.5);
        let at = |share: f64| {
            let states = goals.iter().map(|goal| {
                let mut state = ChainState::new(&setup.robot.chain);
                state.q.iter_mut().zip(goal).for_each(|(q, g)| *q = g * share);
                setup.robot.chain.forward(&mut state);
                state
            });
            let start = setup.objects[0].in_world;
            (states.collect::<Vec<_>>(), Pose::new(start.rotation, start.translation + travel * share))
        };
        let mut known: Vec<(GeometryId, GeometryId)> = Vec::new();
        for step in 0..steps {
            let time = |fraction: f64| (f64::from(step) - 1.0 + fraction).max(0.0) / f64::from(steps);
            let (states, ball) = at(time(1.0));
            let path = ConstantTwist::linear(at(time(0.0)).1, ball.translation - at(time(0.0)).1.translation);
            let moved = [MovedObject { object: ObjectId(0), path: &path as &dyn RigidMotion, jumps: false }];
            let mut found = Vec::new();
            checker.check(&[&states[0], &states[1]], &moved, |c| found.push(((c.a, c.b), c.fraction)));
            for pair in setup.pairs().into_iter().filter(|p| !known.contains(p)) {
                let first = (1..=fine).map(|k| f64::from(k) / f64::from(fine)).find(|f| {
                    let (states, ball) = at(time(*f));
                    setup.touch(pair, &states, ball)
                });
                let reported = found.iter().find(|f| f.0 == pair).map(|f| f.1);
                match (first, reported) {
                    (Some(first), Some(reported)) => {
                        let late = reported - first;
                        assert!(late < 1e-9 && late > -1.0 / f64::from(fine) - 1e-9, "{pair:?}: {reported} {first}");
                    }
                    (None, Some(reported)) => {
                        // A contact so short that it lies between two samples.
                        let (states, ball) = at(time(reported));
                        assert!(setup.touch(pair, &states, ball), "{pair:?} in step {step}");
                    }
                    (Some(first), None) => panic!("{pair:?} missed in step {step} at {first}"),
                    (None, None) => {}
                }
            }
            let now = at(time(1.0));
            for (pair, _) in found {
                contacts += 1;
                with_ball += usize::from(pair.1 == GeometryId::Object(ObjectId(0)));
                passed += usize::from(!setup.touch(pair, &now.0, now.1));
                known.push(pair);
            }
        }
    }
    assert!(contacts > 40 && with_ball > 20 && passed > 3, "{contacts} {with_ball} {passed}");
}
