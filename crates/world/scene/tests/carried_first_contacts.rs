//! Comparison of the first contacts of a carried object with tests of every pair at many instants.

use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
use elbowroom_proximity::{Capsule, Cuboid, Shape, Sphere, collides};
use elbowroom_robot::{Collider, GeometryId, ObjectId, Robot, RobotId};
use elbowroom_scene::{Attachment, FirstContacts, Object};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::linear_congruential;

const PART: ObjectId = ObjectId(0);
const HAND: LinkId = LinkId(3);

/// Four links in a row, with joints alternating about y and x.
fn arm() -> Robot {
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
    let links = (0..4).map(|i| format!("l{i}")).collect();
    let mut robot = Robot::new(Chain::new("arm", links, (0..3).map(joint).collect()).unwrap());
    for colliders in &mut robot.colliders {
        let shape = Shape::Capsule(Capsule { half_length: 0.08, radius: 0.04 });
        let in_link = Pose::from_translation(Vec3::Z * 0.15);
        colliders.push(Collider { name: String::new(), shape, in_link });
    }
    robot
}

fn objects() -> Vec<Object> {
    let object = |name: &str, shape, at| Object { name: name.into(), shape, in_world: Pose::from_translation(at) };
    let part = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.15, 0.12, 0.2) });
    let ball = Shape::Sphere(Sphere { radius: 0.12 });
    vec![
        object("part", part, Vec3::new(0.0, 0.0, 1.29)),
        object("ball", ball, Vec3::new(0.6, 0.1, 0.8)),
        object("post", Shape::Capsule(Capsule { half_length: 0.5, radius: 0.03 }), Vec3::new(-0.5, -0.4, 0.7)),
    ]
}

struct Setup {
    robot: Robot,
    bases: [Pose; 2],
    objects: Vec<Object>,
}

impl Setup {
    /// True if the part, at `in_hand` in the hand of the first robot, touches the other geometry.
    fn touches(&self, other: GeometryId, states: &[ChainState], in_hand: Pose) -> bool {
        let part = self.bases[0] * states[0].link_in_root(HAND) * in_hand;
        let (shape, pose) = match other {
            GeometryId::Object(o) => (&self.objects[o.0].shape, self.objects[o.0].in_world),
            GeometryId::Link { robot, link } => {
                let collider = &self.robot.colliders[link.0][0];
                (&collider.shape, self.bases[robot.0] * states[robot.0].link_in_root(link) * collider.in_link)
            }
        };
        collides(&self.objects[PART.0].shape, &part, shape, &pose)
    }

    fn partners(&self) -> Vec<GeometryId> {
        let link = |robot: usize, link: usize| GeometryId::Link { robot: RobotId(robot), link: LinkId(link) };
        let own = (0..HAND.0).map(|l| link(0, l));
        let other = (0..self.robot.colliders.len()).map(|l| link(1, l));
        own.chain(other).chain((1..self.objects.len()).map(|o| GeometryId::Object(ObjectId(o)))).collect()
    }

    fn states(&self, goals: &[Vec<f64>], share: f64) -> Vec<ChainState> {
        let state = |goal: &Vec<f64>| {
            let mut state = ChainState::new(&self.robot.chain);
            state.q.iter_mut().zip(goal).for_each(|(q, g)| *q = g * share);
            self.robot.chain.forward(&mut state);
            state
        };
        goals.iter().map(state).collect()
    }
}

#[test]
fn a_carried_object_meets_links_robots_and_objects() {
    let bases = [Pose::IDENTITY, Pose::from_translation(Vec3::new(0.9, 0.2, 0.0))];
    let setup = Setup { robot: arm(), bases, objects: objects() };
    let mut seed = 11_u64;
    let mut random = || (linear_congruential(&mut seed) >> 40) as f64 / (1_u64 << 23) as f64 - 1.0;
    let mut contacts = [0, 0, 0];
    for run in 0..200 {
        let mut checker = FirstContacts::new(setup.bases.map(|b| (&setup.robot, b)).to_vec(), &setup.objects);
        let goals: Vec<Vec<f64>> = (0..2).map(|_| (0..3).map(|_| random() * 2.5).collect()).collect();
        let (steps, fine) = if run % 2 == 0 { (150, 4) } else { (10, 60) };
        let start = setup.states(&goals, 0.0);
        checker.check(&[&start[0], &start[1]], &[], |_| {});
        let in_link = start[0].link_in_root(HAND).inverse_mul(&setup.objects[PART.0].in_world);
        let attachment =
            Attachment { robot: RobotId(0), link: HAND, in_link, touch_links: vec![HAND], visiting_links: vec![] };
        checker.attach(PART, attachment, &[&start[0], &start[1]]);
        let mut known = Vec::new();
        for step in 0..steps {
            let at = |fraction: f64| setup.states(&goals, (f64::from(step) + fraction) / f64::from(steps));
            let now = at(1.0);
            let mut found = Vec::new();
            checker.check(&[&now[0], &now[1]], &[], |c| {
                let part = GeometryId::Object(PART);
                if c.a == part || c.b == part {
                    found.push((if c.a == part { c.b } else { c.a }, c.fraction));
                }
            });
            for other in setup.partners().into_iter().filter(|o| !known.contains(o)) {
                let touches = |fraction: f64| setup.touches(other, &at(fraction), in_link);
                let first = (1..=fine).map(|k| f64::from(k) / f64::from(fine)).find(|f| touches(*f));
                let reported = found.iter().find(|f| f.0 == other).map(|f| f.1);
                match (first, reported) {
                    (Some(first), Some(reported)) => {
                        // A contact that lasts a thousandth of the step may be missed.
                        let late = reported - first;
                        assert!(late < 1e-3 && late > -1.0 / f64::from(fine) - 1e-9, "{other:?}: {reported} {first}");
                    }
                    (None, Some(reported)) => assert!(touches(reported), "{other:?} in step {step} of run {run}"),
                    (Some(first), None) => panic!("{other:?} missed in step {step} of run {run} at {first}"),
                    (None, None) => {}
                }
            }
            for (other, _) in found {
                let kind = match other {
                    GeometryId::Link { robot, .. } => robot.0,
                    GeometryId::Object(_) => 2,
                };
                contacts[kind] += 1;
                known.push(other);
            }
        }
        // After detaching, the part stays in place.
        let end = setup.states(&goals, 1.0);
        let place = checker.object_in_world(PART);
        assert!(place.translation.distance((end[0].link_in_root(HAND) * in_link).translation) < 1e-12);
        checker.detach(PART, &[&end[0], &end[1]]);
        checker.check(&[&start[0], &start[1]], &[], |_| {});
        assert!(checker.object_in_world(PART) == place && checker.attachment(PART).is_none());
    }
    assert!(contacts.iter().all(|c| *c > 5), "{contacts:?}");
}
