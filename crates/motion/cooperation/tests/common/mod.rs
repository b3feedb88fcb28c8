//! Two arms that face each other with a bar between them, and random motions of the bar.
#![allow(dead_code, reason = "every program uses a part of it")]

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use elbowroom_cooperation::{CooperationSettings, CooperationStep, Grasp, HandedOver, Hold, Member, VirtualRobot};
use elbowroom_formats::{LoadOptions, robot};
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{ChainState, JointLimits, LinkId};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::{Collider, GeometryId, ObjectId, Robot};
use elbowroom_scene::{Attachment, Checker, CheckerOptions, Object, Scene, SceneState, Selection};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;
use elbowroom_vision::{Camera, Intrinsics, Visibility};

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

/// Largest speed of a random motion, m/s: that of the settings.
const MOTION_M_S: f64 = 0.25;
/// Distance of the flange of the RX60B from its base at most, m: the size 1.
const RX60B_REACH_M: f64 = 1.0;

/// An arm with a hand; its tool centre point is at the tip.
pub struct ArmModel {
    pub file: PathBuf,
    pub robot: Robot,
    pub tip: LinkId,
    /// Its reach beside that of the RX60B; all lengths of its cell are so many times as large.
    pub size: f64,
}

impl ArmModel {
    pub fn rx60b() -> Self {
        Self::load(&elbowroom_testkit::folder::model("rx60b"), Some(1.0)).unwrap()
    }

    /// An arm whose flange is called `tool0`, with at least six joints; its size is measured if it is not given.
    pub fn load(file: &Path, size: Option<f64>) -> Option<Self> {
        let mut robot = robot::load(file, &LoadOptions::default()).ok()?.robot;
        let tip = robot.chain.link("tool0")?;
        if robot.chain.dof() < 6 || robot.chain.path(tip).len() < 6 {
            return None;
        }
        let size = size.unwrap_or_else(|| reach_m(&robot, tip) / RX60B_REACH_M);
        let half = Vec3::new(HAND_WIDE_M, HAND_WIDE_M, 0.5 * HAND_M) * size;
        robot.colliders[tip.0].push(Collider {
            name: "hand".into(),
            shape: Shape::Cuboid(Cuboid { half_extents: half }),
            in_link: Pose::from_translation(Vec3::Z * half.z),
        });
        Some(Self { file: file.to_owned(), robot, tip, size })
    }

    fn tool_in_tip(&self) -> Pose {
        Pose::from_translation(Vec3::Z * (HAND_M * self.size))
    }

    /// Joint values with the tool raised above the base.
    fn raised(&self) -> Option<Vec<f64>> {
        let at = Vec3::new(0.3, 0.0, 0.7) * self.size;
        self.holding(&Pose::new(Rotation::from_z(Vec3::X), at))
    }

    /// Joint values at which the tool is at a pose in the frame of the base.
    fn holding(&self, tool_in_root: &Pose) -> Option<Vec<f64>> {
        let mut solver = IkSolver::new(&self.robot.chain, self.tip, self.tool_in_tip(), IkOptions::default());
        let seed: Vec<f64> = [0.0, 0.5, 1.5, 0.0, 0.3, 0.0, 0.0].into_iter().take(self.robot.chain.dof()).collect();
        solver.solve(tool_in_root, &seed).map(|solution| solution.q).ok()
    }
}

/// Largest distance of the flange from the base in random configurations, m.
fn reach_m(robot: &Robot, tip: LinkId) -> f64 {
    let (mut random, mut state) = (SplitMix(3), ChainState::new(&robot.chain));
    let limits = JointLimits::of_chain(&robot.chain, 0.3, 0.3, 2.0);
    let far = (0..2000).map(|_| {
        for (q, l) in state.q.iter_mut().zip(&limits) {
            *q = random.between(l.lower.max(-PI), l.upper.min(PI));
        }
        robot.chain.forward(&mut state);
        state.link_in_root(tip).translation.length()
    });
    far.fold(0.0, f64::max)
}

/// Grasps at both ends of a bar of half this width and length (m), and at its four sides.
fn grasps(size: f64, [thin_m, bar_m]: [f64; 2]) -> Vec<Grasp> {
    let grasp = |outward: Vec3, distance_m: f64| {
        let rotation = Rotation::from_z(-outward);
        Grasp { tool_in_part: Pose::new(rotation, outward * distance_m), approach: outward * (-0.06 * size) }
    };
    let ends = [Vec3::Z, -Vec3::Z].map(|z| grasp(z, bar_m * size));
    let sides = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y].map(|side| grasp(side, thin_m * size));
    ends.into_iter().chain(sides).collect()
}

/// A cell of two arms, or three, in a circle around the bar.
pub struct Pair {
    pub scene: Scene,
    pub members: Vec<Member>,
    /// Joint values of the arms at the start.
    pub start: Vec<Vec<f64>>,
    /// Size of the bar and of the motions: that of the smallest arm.
    pub size: f64,
    /// A camera that looks at the bar.
    pub visibility: Option<Visibility>,
}

impl Pair {
    /// `count` arms at a distance (m) from the middle.
    pub fn new(count: usize, distance_m: f64) -> Self {
        Self::among(count, distance_m, None)
    }

    /// Like [`Self::new`], with a block: its middle, and half of its size.
    pub fn among(count: usize, distance_m: f64, block: Option<(Vec3, Vec3)>) -> Self {
        let arm = ArmModel::rx60b();
        Self::of(&vec![&arm; count], distance_m, block).unwrap()
    }

    /// These arms; the distance (m) is for an arm of size 1. `None` if they cannot start like this.
    pub fn of(arms: &[&ArmModel], distance_m: f64, block: Option<(Vec3, Vec3)>) -> Option<Self> {
        Self::with_part(arms, distance_m, block, [THIN_M, BAR_M])
    }

    /// Two RX60B with a square plate in place of the bar, which they grasp at its faces and edges.
    pub fn with_plate() -> Self {
        let arm = ArmModel::rx60b();
        Self::with_part(&[&arm, &arm], 0.6, None, [0.06, 0.01]).unwrap()
    }

    /// Like [`Self::of`], with a bar of half this width and length (m), for an arm of size 1.
    fn with_part(arms: &[&ArmModel], distance_m: f64, block: Option<(Vec3, Vec3)>, part_m: [f64; 2]) -> Option<Self> {
        let size = arms.iter().map(|arm| arm.size).fold(f64::INFINITY, f64::min);
        let mut builder = Scene::builder();
        let mut members = Vec::new();
        for (index, arm) in arms.iter().enumerate() {
            let angle = std::f64::consts::TAU * index as f64 / arms.len() as f64;
            let turn = Rotation::from_axis_angle(Vec3::Z, angle);
            let base = Pose::new(turn, turn * Vec3::X * (-distance_m * arm.size));
            let id = builder.robot(["one", "two", "three"][index], arm.robot.clone(), base);
            members.push(Member {
                robot: id,
                tip: arm.tip,
                tool_in_tip: arm.tool_in_tip(),
                limits: JointLimits::of_chain(&arm.robot.chain, 0.3, 0.3, 2.0),
                hand: vec![arm.tip],
                grasps: grasps(size, part_m),
            });
        }
        // The first arm holds the bar at its lower end; the bar points away from it.
        let at = Vec3::new((0.62 - distance_m) * arms[0].size, 0.0, 0.45 * arms[0].size);
        let start = Pose::new(Rotation::from_z(Vec3::X), at);
        let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(part_m[0], part_m[0], part_m[1]) * size });
        builder.object(Object { name: "bar".into(), shape, in_world: start });
        if let Some((at, half_extents)) = block {
            let shape = Shape::Cuboid(Cuboid { half_extents });
            builder.object(Object { name: "table".into(), shape, in_world: Pose::from_translation(at) });
        }
        let scene = builder.build().ok()?;
        let base_in_world = scene.robots()[0].base_in_world;
        let held = arms[0].holding(&(base_in_world.inverse_mul(&start) * members[0].grasps[1].tool_in_part))?;
        let mut all = vec![held];
        for arm in &arms[1..] {
            all.push(arm.raised()?);
        }
        Some(Self { scene, members, start: all, size, visibility: None })
    }

    /// The same cell with a camera there, which looks at a point.
    pub fn seen_from(mut self, eye: Vec3, target: Vec3) -> Self {
        let camera = Camera::look_at(Intrinsics::pinhole(640, 480, 1.2), eye, target, Vec3::Y).unwrap();
        self.visibility = Some(Visibility::new(camera, &self.scene.objects()[0].shape));
        self
    }

    /// The same cell, in which only the first arm can grasp the bar.
    pub fn with_one_hand(mut self) -> Self {
        for member in &mut self.members[1..] {
            member.grasps.iter_mut().for_each(|grasp| grasp.tool_in_part.translation = Vec3::Z * 10.0);
        }
        self
    }

    /// Whether nothing touches at the start.
    pub fn can_start(&self) -> bool {
        let robots = self.members.iter().map(|m| Selection::Robot(m.robot));
        let mut checker = Checker::new(&self.scene, CheckerOptions::default());
        let mut state = self.state();
        let at = &self.members[0];
        let held = Attachment {
            robot: at.robot,
            link: at.tip,
            in_link: at.tool_in_tip * at.grasps[1].tool_in_part.inverse(),
            touch_links: at.hand.clone(),
            visiting_links: Vec::new(),
        };
        state.attach_at(&self.scene, ObjectId(0), held).unwrap();
        robots.into_iter().all(|robot| checker.between(robot, Selection::All).collides(&state).is_none())
    }

    pub fn state(&self) -> SceneState {
        let mut state = SceneState::new(&self.scene);
        for (member, q) in self.members.iter().zip(&self.start) {
            state.set_q(&self.scene, member.robot, q).unwrap();
        }
        state
    }

    pub fn robot(&self, settings: CooperationSettings) -> VirtualRobot<'_> {
        let members = self.members.clone();
        let mut robot = VirtualRobot::new(&self.scene, self.state(), ObjectId(0), members, (0, 1), settings).unwrap();
        if let Some(visibility) = &self.visibility {
            robot.keep_in_view(visibility);
        }
        robot
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
                .solve_all(&(in_root * g.tool_in_part), &vec![0.0; m.limits.len()])
                .iter()
                .any(|q| solver.refine(&(in_root * pre), &mut q.clone()))
        })
    }
}

/// Whether one of the arms could hold the bar at every pose of a motion.
pub fn one_arm_covers(pair: &Pair, motion: &[Pose]) -> bool {
    let mut reach = Reach::new(pair);
    (0..pair.members.len()).any(|m| motion.iter().step_by(5).all(|pose| reach.holds(pair, m, pose)))
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
        let at = at * pair.size;
        let turn = Rotation::from_rotation_vector(Vec3::from(random.within::<3>(1.0)));
        let (from, to) = (*poses.last().unwrap(), Pose::new(turn * start.rotation, at));
        let length = from.translation.distance(to.translation) / (0.15 * pair.size).min(MOTION_M_S);
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
    /// Time for which the arms hid more than 30 % of what the camera sees of the bar, s, and for which it saw nothing.
    pub hidden_s: f64,
    pub out_of_view_s: f64,
}

impl Outcome {
    /// Notes the share of the bar that is hidden in a step.
    fn see(&mut self, share: Option<f64>) {
        match share {
            Some(share) if share > HIDDEN_SHARE => self.hidden_s += DT_S,
            None => self.out_of_view_s += DT_S,
            Some(_) => {}
        }
    }
}

/// Share from which on the bar counts as hidden.
pub const HIDDEN_SHARE: f64 = 0.3;

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
        outcome.see(robot.hidden_share());
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
