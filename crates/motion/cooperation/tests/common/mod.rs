//! Two arms that face each other with a bar between them, and random motions of the bar.
#![allow(dead_code, reason = "every program uses a part of it")]

use elbowroom_cooperation::{CooperationSettings, CooperationStep, Grasp, HandedOver, Hold, Member, VirtualRobot};
use elbowroom_formats::{LoadOptions, robot};
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{JointLimits, LinkId};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::{Collider, GeometryId, ObjectId, Robot};
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

/// Duration of a step, s.
pub const DT_S: f64 = 0.004;
/// Length of the hand, m.
pub const HAND_M: f64 = 0.06;
/// Half of the width of the hand, m.
pub const HAND_WIDE_M: f64 = 0.015;
/// Half of the length of the bar, m.
pub const BAR_M: f64 = 0.15;
/// Half of its thickness, m.
pub const THIN_M: f64 = 0.02;

/// An arm with a hand; its tool centre point is at the tip.
fn arm() -> (Robot, LinkId) {
    let file = elbowroom_testkit::folder::model("rx60b");
    let mut robot = robot::load(&file, &LoadOptions::default()).unwrap().robot;
    let flange = robot.chain.link("tool0").unwrap();
    robot.colliders[flange.0].push(Collider {
        name: "hand".into(),
        shape: Shape::Cuboid(Cuboid { half_extents: Vec3::new(HAND_WIDE_M, HAND_WIDE_M, 0.5 * HAND_M) }),
        in_link: Pose::from_translation(Vec3::Z * (0.5 * HAND_M)),
    });
    (robot, flange)
}

/// Grasps at both ends of the bar and at its four sides.
fn grasps() -> Vec<Grasp> {
    let grasp = |outward: Vec3, distance_m: f64| {
        let rotation = Rotation::from_z(-outward);
        Grasp { tool_in_part: Pose::new(rotation, outward * distance_m), approach: outward * -0.06 }
    };
    let ends = [Vec3::Z, -Vec3::Z].map(|z| grasp(z, BAR_M));
    let sides = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y].map(|side| grasp(side, THIN_M));
    ends.into_iter().chain(sides).collect()
}

/// A cell of two arms, or three, in a circle around the bar.
pub struct Pair {
    pub scene: Scene,
    pub members: Vec<Member>,
    /// Joint values of the arms at the start.
    pub start: Vec<Vec<f64>>,
}

impl Pair {
    /// `count` arms at a distance (m) from the middle.
    pub fn new(count: usize, distance_m: f64) -> Self {
        Self::among(count, distance_m, None)
    }

    /// Like [`Self::new`], with a block: its middle, and half of its size.
    pub fn among(count: usize, distance_m: f64, block: Option<(Vec3, Vec3)>) -> Self {
        let (robot, tip) = arm();
        let mut builder = Scene::builder();
        let limits = JointLimits::of_chain(&robot.chain, 0.3, 0.3, 2.0);
        let mut members = Vec::new();
        for index in 0..count {
            let angle = std::f64::consts::TAU * index as f64 / count as f64;
            let turn = Rotation::from_axis_angle(Vec3::Z, angle);
            let base = Pose::new(turn, turn * Vec3::X * -distance_m);
            let id = builder.robot(["one", "two", "three"][index], robot.clone(), base);
            members.push(Member {
                robot: id,
                tip,
                tool_in_tip: Pose::from_translation(Vec3::Z * HAND_M),
                limits: limits.clone(),
                hand: vec![tip],
                grasps: grasps(),
            });
        }
        // The first arm holds the bar at its lower end; the bar points away from it.
        let start = Pose::new(Rotation::from_z(Vec3::X), Vec3::new(0.62 - distance_m, 0.0, 0.45));
        let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(THIN_M, THIN_M, BAR_M) });
        builder.object(Object { name: "bar".into(), shape, in_world: start });
        if let Some((at, half_extents)) = block {
            let shape = Shape::Cuboid(Cuboid { half_extents });
            builder.object(Object { name: "table".into(), shape, in_world: Pose::from_translation(at) });
        }
        let scene = builder.build().unwrap();
        let chain = &robot.chain;
        let mut solver = IkSolver::new(chain, tip, members[0].tool_in_tip, IkOptions::default());
        let tool = scene.robots()[0].base_in_world.inverse_mul(&start) * members[0].grasps[1].tool_in_part;
        let held = solver.solve(&tool, &[0.0, 0.5, 1.5, 0.0, 0.3, 0.0]).unwrap().q;
        let mut all = vec![vec![0.0, 0.0, 1.57, 0.0, 0.5, 0.0]; count];
        all[0] = held;
        Self { scene, members, start: all }
    }

    /// Like [`Self::new`], but only the first arm can grasp the bar.
    pub fn alone(count: usize, distance_m: f64) -> Self {
        let mut pair = Self::new(count, distance_m);
        for member in &mut pair.members[1..] {
            member.grasps.iter_mut().for_each(|grasp| grasp.tool_in_part.translation = Vec3::Z * 10.0);
        }
        pair
    }

    pub fn state(&self) -> SceneState {
        let mut state = SceneState::new(&self.scene);
        for (member, q) in self.members.iter().zip(&self.start) {
            state.set_q(&self.scene, member.robot, q).unwrap();
        }
        state
    }

    pub fn robot(&self, settings: CooperationSettings) -> VirtualRobot<'_> {
        VirtualRobot::new(&self.scene, self.state(), ObjectId(0), self.members.clone(), (0, 1), settings).unwrap()
    }
}

/// Which arms can hold the bar at a pose, in any grasp and on any branch, and can let it go.
pub struct Reach {
    solvers: Vec<IkSolver>,
}

impl Reach {
    pub fn new(pair: &Pair) -> Self {
        let solver = |m: &Member| {
            let chain = &pair.scene.robots()[m.robot.0].robot.chain;
            IkSolver::new(chain, m.tip, m.tool_in_tip, IkOptions::default())
        };
        Self { solvers: pair.members.iter().map(solver).collect() }
    }

    pub fn holds(&mut self, pair: &Pair, member: usize, part: &Pose) -> bool {
        let m = &pair.members[member];
        let in_root = pair.scene.robots()[m.robot.0].base_in_world.inverse_mul(part);
        let solver = &mut self.solvers[member];
        m.grasps.iter().any(|g| {
            let pre = Pose::new(g.tool_in_part.rotation, g.tool_in_part.translation - g.approach);
            solver
                .solve_all(&(in_root * g.tool_in_part), &[0.0; 6])
                .iter()
                .any(|q| solver.refine(&(in_root * pre), &mut q.clone()))
        })
    }
}

/// A straight motion of the bar: poses every 20 ms.
pub fn straight(start: Pose, end: Pose, speed_m_s: f64) -> Vec<Pose> {
    let pieces = (start.translation.distance(end.translation) / speed_m_s / 0.02).ceil();
    (0..=pieces as usize).map(|k| start.interpolate(&end, k as f64 / pieces)).collect()
}

/// A random motion of the bar: poses every 20 ms, each of which some arm can hold.
pub fn motion(random: &mut SplitMix, pair: &Pair, start: Pose, reach_m: f64, corners: usize) -> Vec<Pose> {
    let mut poses = vec![start];
    let mut reach = Reach::new(pair);
    let mut left = corners;
    for _ in 0..200 * corners {
        if left == 0 {
            break;
        }
        let at = Vec3::new(random.between(-reach_m, reach_m), random.between(-0.3, 0.3), random.between(0.2, 0.6));
        let turn = Rotation::from_rotation_vector(Vec3::from(random.within::<3>(1.0)));
        let (from, to) = (*poses.last().unwrap(), Pose::new(turn * start.rotation, at));
        let length = from.translation.distance(to.translation) / 0.15;
        let turned = (from.rotation.inverse() * to.rotation).angle() / 0.6;
        let pieces = (length.max(turned) / 0.02).ceil().max(1.0);
        let way: Vec<Pose> = (1..=pieces as usize).map(|k| from.interpolate(&to, k as f64 / pieces)).collect();
        let is_held = |p: &Pose| (0..pair.members.len()).any(|m| reach.holds(pair, m, p));
        if way.iter().step_by(5).chain(way.last()).all(is_held) {
            poses.extend(way);
            left -= 1;
        }
    }
    poses
}

/// What a motion came to.
#[derive(Debug, Default)]
pub struct Outcome {
    pub share: f64,
    pub stopped_s: f64,
    pub hand_overs: Vec<(f64, HandedOver)>,
    pub deviation_m: f64,
    pub contacts: usize,
    pub last_hold: Option<Hold>,
    /// Wall-clock times of the steps, µs.
    pub step_us: Vec<f64>,
    /// Largest share of the speed of a joint.
    pub largest_speed_share: f64,
    /// Largest speed of the work-piece, m/s.
    pub largest_speed_m_s: f64,
    /// Largest change of the rate from one step to the next.
    pub largest_rate_change: f64,
}

/// Steps per desired pose.
pub const PER_ROW: usize = 5;

/// The pose of a motion that arrives in this step, if any.
pub fn desire_in_step(robot: &mut VirtualRobot<'_>, motion: &[Pose], step: usize) {
    if let Some(pose) = motion.get(step / PER_ROW).filter(|_| step.is_multiple_of(PER_ROW)) {
        robot.desire(step as f64 * DT_S, pose).unwrap();
    }
}

/// Carries out a motion. Every step is checked by a checker of its own.
pub fn carry(pair: &Pair, settings: CooperationSettings, motion: &[Pose]) -> Outcome {
    carry_seen(pair, settings, motion, &mut |_, _| {})
}

/// Like [`carry`]; `see` gets the time (s) and the state after each step.
pub fn carry_seen(
    pair: &Pair,
    settings: CooperationSettings,
    motion: &[Pose],
    see: &mut dyn FnMut(f64, &VirtualRobot<'_>),
) -> Outcome {
    let mut robot = pair.robot(settings);
    let mut checker = Checker::new(&pair.scene, CheckerOptions::default());
    let (mut state, mut outcome, mut still_s, mut rate) = (pair.state(), Outcome::default(), 0.0, 0.0);
    let most = motion.len() * PER_ROW * 4 + 5000;
    for k in 0..most {
        let t_s = k as f64 * DT_S;
        desire_in_step(&mut robot, motion, k);
        let before = robot.part_in_world().translation;
        let begin = std::time::Instant::now();
        let step: CooperationStep = robot.step(DT_S, &vec![1.0; pair.members.len()]);
        outcome.step_us.push(begin.elapsed().as_secs_f64() * 1e6);
        outcome.largest_rate_change = outcome.largest_rate_change.max((step.rate - rate).abs());
        rate = step.rate;
        outcome.largest_speed_m_s =
            outcome.largest_speed_m_s.max(robot.part_in_world().translation.distance(before) / DT_S);
        for (member, m) in pair.members.iter().enumerate() {
            let share = robot.qd(member).iter().zip(&m.limits).map(|(qd, l)| qd.abs() / l.velocity);
            outcome.largest_speed_share = share.fold(outcome.largest_speed_share, f64::max);
        }
        let (wanted, left_s) = robot.on_path();
        let part = robot.part_in_world();
        outcome.deviation_m = outcome.deviation_m.max(wanted.translation.distance(part.translation));
        outcome.hand_overs.extend(step.handed_over.map(|h| (t_s, h)));
        if left_s > 1e-6 && step.rate == 0.0 {
            outcome.stopped_s += DT_S;
            still_s += DT_S;
            outcome.last_hold = step.hold.or(outcome.last_hold);
        } else {
            still_s = 0.0;
        }
        if state.attachment(ObjectId(0)) != robot.attachment() {
            if state.attachment(ObjectId(0)).is_some() {
                state.detach(&pair.scene, ObjectId(0)).unwrap();
            }
            state.attach_at(&pair.scene, ObjectId(0), robot.attachment().unwrap().clone()).unwrap();
        }
        for (member, m) in pair.members.iter().enumerate() {
            state.set_q(&pair.scene, m.robot, robot.q(member)).unwrap();
        }
        outcome.contacts += usize::from(checker.collides(&state).is_some());
        see(t_s + DT_S, &robot);
        let is_over = k > motion.len() * PER_ROW && left_s < 1e-6;
        if is_over || still_s > 15.0 {
            break;
        }
    }
    let (_, left_s) = robot.on_path();
    outcome.share = robot.path_s() / (robot.path_s() + left_s).max(1e-9);
    outcome
}

pub fn part_pose(pair: &Pair) -> Pose {
    pair.state().pose(&pair.scene, GeometryId::Object(ObjectId(0))).unwrap()
}
