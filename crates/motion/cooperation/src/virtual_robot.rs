//! Several arms that act as one.

use elbowroom_kinematics::ChainState;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{Attachment, Checker, CheckerOptions, Scene, SceneError, SceneMotion, SceneState, Selection};
use elbowroom_spatial::Pose;

use crate::carried::Carried;
use crate::decision_memory::DecisionMemory;
use crate::desired_path::{DesiredPath, angle_between};
use crate::forecast::Forecast;
use crate::free_arm::{ArmMotion, Attraction, FreeArm};
use crate::hand_over::{HandOver, HandOverPhase};
use crate::holding::{Holding, attachment};
use crate::look_ahead::LookAhead;
use crate::{CooperationError, CooperationSettings, CooperationStep, Hold, Member, PoseRefusal};

/// Largest distance (m) of the holder's tool from its grasp at the start.
const GRASPED_M: f64 = 5e-3;
/// Largest angle (rad) of the holder's tool from its grasp at the start.
const GRASPED_RAD: f64 = 0.05;

/// An arm without the work-piece, and where it goes.
#[derive(Debug)]
pub(crate) struct Limb {
    pub free: FreeArm,
    /// Where it goes when it is in the way.
    pub home: Vec<f64>,
    /// Joint values after the step.
    pub next: Vec<f64>,
    /// Velocity of the place where it waits, rad/s or m/s.
    pub drift: Vec<f64>,
    /// The holding for which it waits; `None` if it has none.
    pub waits_for: Option<usize>,
    /// Whether it stands in the way of the work-piece.
    pub is_in_the_way: bool,
}

/// Several arms that act as one: they carry one work-piece along a desired motion.
///
/// The work-piece never leaves the path of the poses that have [arrived](Self::desire); it only slows down. One arm holds
/// it, or two while it is handed over, never none.
#[derive(Debug)]
pub struct VirtualRobot<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) checker: Checker<'s>,
    pub(crate) state: SceneState,
    /// The state with the holder where it will be.
    pub(crate) state_ahead: SceneState,
    /// How fast the arms move.
    motion: SceneMotion,
    pub(crate) work_piece: ObjectId,
    pub(crate) members: Vec<Member>,
    pub(crate) settings: CooperationSettings,
    pub(crate) arms: Vec<ArmMotion>,
    pub(crate) limbs: Vec<Limb>,
    pub(crate) holdings: Vec<Holding<'s>>,
    pub(crate) forecasts: Vec<Forecast>,
    pub(crate) carried: Carried,
    pub(crate) hand_over: Option<HandOver>,
    pub(crate) decision: DecisionMemory,
}

impl<'s> VirtualRobot<'s> {
    /// A virtual robot of these arms, at the configurations that they have in `state`. The arm `holder.0` holds the
    /// work-piece, near its grasp `holder.1`; the work-piece is where it is in `state`.
    ///
    /// # Errors
    /// [`CooperationError`].
    pub fn new(
        scene: &'s Scene,
        mut state: SceneState,
        work_piece: ObjectId,
        members: Vec<Member>,
        holder: (usize, usize),
        settings: CooperationSettings,
    ) -> Result<Self, CooperationError> {
        check(scene, work_piece, &members, &settings)?;
        let in_scene = |e: SceneError| CooperationError::Scene(e.to_string());
        let part_in_world = state.pose(scene, GeometryId::Object(work_piece));
        let part_in_world = part_in_world.ok_or(CooperationError::NoSuchGrasp)?;
        let (mut holdings, first) = holdings(scene, &state, work_piece, &members, holder).map_err(in_scene)?;
        let first = first.ok_or(CooperationError::NoSuchGrasp)?;
        check_approaches(&mut holdings, work_piece, settings.gap_m)?;
        let arms: Vec<ArmMotion> = members.iter().map(|m| arm_motion(scene, &state, m.robot)).collect();
        let tool_in_part = grasped(scene, &state, &members[holder.0], &part_in_world, &holdings[first])?;
        holdings[first].regrasp(work_piece, &tool_in_part).map_err(in_scene)?;
        if state.attachment(work_piece).is_some() {
            state.detach(scene, work_piece).map_err(in_scene)?;
        }
        state.attach_at(scene, work_piece, attachment(&members[holder.0], &tool_in_part)).map_err(in_scene)?;
        let mut checker = Checker::new(scene, CheckerOptions::default());
        for member in &members {
            let touching = checker.between(Selection::Robot(member.robot), Selection::All).collides(&state);
            if let Some(pair) = touching {
                return Err(CooperationError::Touching(pair.a, pair.b));
            }
        }
        let limbs = members.iter().zip(&arms).map(|(member, arm)| Limb::new(member, &arm.state.q)).collect();
        let forecasts = holdings.iter().map(|h| Forecast::new(members[h.member].limits.len())).collect();
        let carried = Carried {
            path: DesiredPath::new(part_in_world),
            path_s: 0.0,
            rate: 0.0,
            holder: first,
            is_paused: false,
            ahead: LookAhead::new(&arms[holder.0].state.q, 0.0),
            follower_ahead: LookAhead::new(&arms[holder.0].state.q, 0.0),
        };
        Ok(Self {
            scene,
            checker,
            state_ahead: state.clone(),
            decision: DecisionMemory::new(holdings.len()),
            state,
            motion: SceneMotion::new(scene),
            work_piece,
            members,
            settings,
            arms,
            limbs,
            holdings,
            forecasts,
            carried,
            hand_over: None,
        })
    }

    /// Takes a desired pose of the work-piece that has arrived at a time (s).
    ///
    /// The work-piece goes there in a straight line from the desired pose before, at the speed at which they arrived or more
    /// slowly.
    ///
    /// # Errors
    /// [`PoseRefusal`]; the pose is then ignored.
    pub fn desire(&mut self, t_s: f64, part_in_world: &Pose) -> Result<(), PoseRefusal> {
        self.carried.path.push(t_s, part_in_world, &self.settings)?;
        self.carried.is_paused = false;
        Ok(())
    }

    /// The work-piece stops on its path until the next desired pose, to which it then goes as fast as it may.
    pub fn pause(&mut self) {
        self.carried.path.pause();
        self.carried.is_paused = true;
    }

    /// No more poses come: the work-piece goes on to the last one.
    pub fn end(&mut self) {
        self.carried.path.pause();
    }

    /// Moves everything but the members: what they are when the next step is proven. The work-piece stays.
    ///
    /// # Errors
    /// The error of `change`.
    pub fn surroundings(
        &mut self,
        mut change: impl FnMut(&Scene, &mut SceneState) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        change(self.scene, &mut self.state)?;
        self.holdings.iter_mut().try_for_each(|holding| holding.surroundings(&mut change))
    }

    /// Joint values of an arm, rad or m.
    pub fn q(&self, member: usize) -> &[f64] {
        &self.arms[member].state.q
    }

    /// Joint velocities of an arm in the last step, rad/s or m/s.
    pub fn qd(&self, member: usize) -> &[f64] {
        &self.arms[member].state.qd
    }

    /// Index of the arm that holds the work-piece.
    pub fn holder(&self) -> usize {
        self.holdings[self.carried.holder].member
    }

    /// How the work-piece is attached.
    pub fn attachment(&self) -> Option<&Attachment> {
        self.state.attachment(self.work_piece)
    }

    /// Pose of the work-piece in the world.
    pub fn part_in_world(&self) -> Pose {
        let id = GeometryId::Object(self.work_piece);
        self.state.pose(self.scene, id).unwrap_or(Pose::IDENTITY)
    }

    /// The pose on the desired path that the work-piece has now, and how much of the path is left, s.
    pub fn on_path(&self) -> (Pose, f64) {
        (self.carried.pose(), self.carried.path.end().0 - self.carried.path_s)
    }

    /// Path time of the work-piece, s: how much of the desired motion it has carried out.
    pub fn path_s(&self) -> f64 {
        self.carried.path_s
    }

    /// The phase of the present hand-over; `None` between hand-overs.
    pub fn phase(&self) -> Option<HandOverPhase> {
        self.hand_over.as_ref().map(|h| h.phase)
    }

    /// Whether an arm keeps out of the way of something.
    pub fn is_yielding(&self, member: usize) -> bool {
        self.limbs[member].free.is_yielding() && !self.carries(member)
    }

    /// Least distance between two members, with the work-piece, m, up to a distance beyond which it is infinite; what may
    /// touch does not count.
    pub fn gap_m(&mut self, most_m: f64) -> f64 {
        let mut least = f64::INFINITY;
        for (i, a) in self.members.iter().enumerate() {
            for b in &self.members[i + 1..] {
                let mut pair = self.checker.between(Selection::Robot(a.robot), Selection::Robot(b.robot));
                pair.distances_within(&self.state, most_m, |pair| least = least.min(pair.metres));
            }
        }
        least
    }

    /// Least singular value of the Jacobian of the arm that holds the work-piece, as
    /// [`CooperationSettings::least_singular_value`] bounds it for what is foreseen; infinite with fewer than six joints.
    pub fn least_singular_value(&mut self) -> f64 {
        let holding = &mut self.holdings[self.carried.holder];
        holding.least_singular_value(&self.arms[holding.member].state.q)
    }

    /// Whether the arm moves with the work-piece.
    pub(crate) fn carries(&self, member: usize) -> bool {
        let follower = self.hand_over.as_ref().and_then(HandOver::follower);
        member == self.holder() || follower.is_some_and(|k| self.holdings[k].member == member)
    }

    /// Moves all arms for `dt_s` seconds, each at its override, 0 to 1: that of its monitor.
    ///
    /// The work-piece moves on by the smaller override of the arms that carry it. Every motion is proven free before it is
    /// executed; an arm that is not free stands.
    ///
    /// Allocates nothing, but where an arm searches for its joint values at another grasp, at most once per step, and in
    /// hand-overs.
    pub fn step(&mut self, dt_s: f64, overrides: &[f64]) -> CooperationStep {
        if !(dt_s > 0.0 && dt_s.is_finite()) || overrides.len() != self.members.len() {
            self.stand();
            return CooperationStep { hold: Some(Hold::Input), ..CooperationStep::default() };
        }
        let handed_over = self.proceed(dt_s);
        self.look_ahead(dt_s);
        self.choose_waiting();
        self.track(dt_s);
        let hold = self.advance(dt_s, overrides);
        self.carried.path.passed(self.carried.path_s);
        self.foresee(dt_s);
        self.decide(dt_s, overrides);
        let hold = hold.filter(|_| self.carried.wants_to_move() && self.carried.rate == 0.0);
        CooperationStep { rate: self.carried.rate, hold, handed_over }
    }

    /// Writes the joint velocities (rad/s or m/s) with which an arm would go on at override 1, and moves nothing.
    pub fn intent(&mut self, member: usize, dt_s: f64, velocities: &mut [f64]) {
        if !self.carries(member) {
            velocities.copy_from_slice(&self.limbs[member].free.velocity);
            return;
        }
        // What they would do if they could; a hand that leaves moves also while the work-piece stands.
        let is_possible = self.carry(1.0, 1.0, dt_s).is_ok() || self.carry(0.0, 1.0, dt_s).is_ok();
        let (next, q) = (&self.limbs[member].next, &self.arms[member].state.q);
        for ((v, to), from) in velocities.iter_mut().zip(next).zip(q) {
            *v = if is_possible { (to - from) / dt_s } else { 0.0 };
        }
    }

    /// Everything stands.
    pub(crate) fn stand(&mut self) {
        self.carried.rate = 0.0;
        for arm in &mut self.arms {
            arm.state.qd.fill(0.0);
            self.scene.robots()[arm.robot.0].robot.chain.forward_motion(&mut arm.state);
        }
    }

    /// Moves the arms that do not hold the work-piece towards where they wait.
    pub(crate) fn react(&mut self, dt_s: f64, overrides: &[f64]) {
        for arm in &self.arms {
            // As many values as the robot has joints, and finite.
            let _ = self.motion.set_qd(self.scene, &self.state, arm.robot, &arm.state.qd);
        }
        for member in 0..self.members.len() {
            if self.carries(member) {
                self.limbs[member].free.carries();
                continue;
            }
            let limb = &mut self.limbs[member];
            if limb.is_in_the_way {
                limb.free.gives_way();
            }
            let attraction = match limb.waits_for {
                Some(k) if !limb.is_in_the_way => {
                    Attraction { q: &self.forecasts[k].pre_grasp, velocity: Some(&limb.drift) }
                }
                _ => Attraction { q: &limb.home, velocity: None },
            };
            let scene = (self.scene, &self.state, &mut self.checker);
            limb.free.react(scene, (&self.arms, &self.motion, member), attraction, &self.settings, dt_s);
            let share = usable(overrides[member]);
            let q = &self.arms[member].state.q;
            for ((next, q), v) in limb.next.iter_mut().zip(q).zip(&limb.free.velocity) {
                *next = q + v * dt_s * share;
            }
        }
    }

    /// Keeps the poses of waiting arms at the pre-grasps, which move with the work-piece.
    fn track(&mut self, dt_s: f64) {
        let part_in_world = self.carried.pose();
        for member in 0..self.members.len() {
            let limb = &mut self.limbs[member];
            let Some(k) = limb.waits_for else { continue };
            let (holding, pre_grasp) = (&mut self.holdings[k], &mut self.forecasts[k].pre_grasp);
            limb.drift.copy_from_slice(pre_grasp);
            let grasp = holding.grasp;
            if !holding.solve(&part_in_world, &grasp.at(grasp.length_m()), pre_grasp) {
                pre_grasp.copy_from_slice(&limb.drift);
            }
            for (drift, now) in limb.drift.iter_mut().zip(pre_grasp.iter()) {
                *drift = (now - *drift) / dt_s;
            }
        }
    }
}

impl Limb {
    fn new(member: &Member, q: &[f64]) -> Self {
        Self {
            free: FreeArm::new(&member.limits),
            home: q.to_vec(),
            next: q.to_vec(),
            drift: vec![0.0; q.len()],
            waits_for: None,
            is_in_the_way: false,
        }
    }
}

/// An override as a share; what is not a number is 0.
pub(crate) fn usable(speed_override: f64) -> f64 {
    if speed_override > 0.0 { speed_override.min(1.0) } else { 0.0 }
}

/// Every arm with every grasp, and the index of the holder's among them.
fn holdings<'s>(
    scene: &'s Scene,
    state: &SceneState,
    work_piece: ObjectId,
    members: &[Member],
    holder: (usize, usize),
) -> Result<(Vec<Holding<'s>>, Option<usize>), SceneError> {
    let robots: Vec<RobotId> = members.iter().map(|m| m.robot).collect();
    let (mut all, mut first) = (Vec::new(), None);
    for (index, member) in members.iter().enumerate() {
        for number in 0..member.grasps.len() {
            if (index, number) == holder {
                first = Some(all.len());
            }
            all.push(Holding::new(scene, state, work_piece, (index, member), number, &robots)?);
        }
    }
    Ok((all, first))
}

/// Every hand must keep the gap from the work-piece before its approach.
fn check_approaches(holdings: &mut [Holding<'_>], work_piece: ObjectId, gap_m: f64) -> Result<(), CooperationError> {
    for holding in holdings {
        let is_apart = holding.is_apart_at_pre_grasp(work_piece, gap_m);
        if !is_apart.map_err(|e| CooperationError::Scene(e.to_string()))? {
            return Err(CooperationError::ShortApproach { member: holding.member, grasp: holding.number });
        }
    }
    Ok(())
}

fn arm_motion(scene: &Scene, state: &SceneState, robot: RobotId) -> ArmMotion {
    let at = &scene.robots()[robot.0];
    let mut motion = ChainState::new(&at.robot.chain);
    motion.q.copy_from_slice(state.q(robot));
    at.robot.chain.forward_motion(&mut motion);
    ArmMotion { robot, state: motion, base_in_world: at.base_in_world }
}

/// The pose of the holder's tool in the work-piece.
fn grasped(
    scene: &Scene,
    state: &SceneState,
    holder: &Member,
    part_in_world: &Pose,
    holding: &Holding<'_>,
) -> Result<Pose, CooperationError> {
    let tip = GeometryId::Link { robot: holder.robot, link: holder.tip };
    let tip_in_world = state.pose(scene, tip).ok_or(CooperationError::NoSuchGrasp)?;
    let tool_in_part = part_in_world.inverse_mul(&(tip_in_world * holder.tool_in_tip));
    let wanted = holding.grasp.tool_in_part;
    let distance_m = wanted.translation.distance(tool_in_part.translation);
    let angle_rad = angle_between(&wanted.rotation, &tool_in_part.rotation);
    let is_there = distance_m <= GRASPED_M && angle_rad <= GRASPED_RAD;
    if is_there { Ok(tool_in_part) } else { Err(CooperationError::NotGrasped { distance_m, angle_rad }) }
}

fn check(
    scene: &Scene,
    work_piece: ObjectId,
    members: &[Member],
    settings: &CooperationSettings,
) -> Result<(), CooperationError> {
    let twice = |(i, m): (usize, &Member)| members[..i].iter().any(|other| other.robot == m.robot);
    if members.len() < 2 || members.iter().enumerate().any(twice) {
        return Err(CooperationError::Members);
    }
    if !settings.is_usable() {
        return Err(CooperationError::Settings);
    }
    if work_piece.0 >= scene.objects().len() {
        return Err(CooperationError::Scene(format!("the scene has no object {}", work_piece.0)));
    }
    for (index, member) in members.iter().enumerate() {
        let robot = scene.robots().get(member.robot.0);
        let chain = robot.map(|r| &r.robot.chain);
        let chain =
            chain.ok_or_else(|| CooperationError::Scene(format!("the scene has no robot {}", member.robot.0)))?;
        if chain.dof() != member.limits.len() {
            return Err(CooperationError::Limits(index));
        }
    }
    Ok(())
}
