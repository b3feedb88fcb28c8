//! An arm that holds the work-piece in one of its grasps: where it can carry it.

use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{ChainState, JointLimits};
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{Attachment, Checker, CheckerOptions, Scene, SceneError, SceneState, Selection};
use elbowroom_spatial::linalg::symmetric_eigen;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::Visibility;

use crate::{CooperationSettings, Grasp, HoldLimit, Member};

/// Starting points of a search for another branch of the inverse kinematics.
const RESTARTS: usize = 3;

/// What a configuration must keep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Margins {
    /// Share of the joint speeds that may be needed at the desired speed.
    pub speed_share: f64,
    /// Least singular value.
    pub singular_value: f64,
    /// Least distance to the limit of a joint, rad or m.
    pub joint: f64,
    /// Least distance to everything but the other members, m.
    pub gap_m: f64,
    /// Whether the hand must be able to move back to its pre-grasp.
    pub retreat: bool,
    /// Share of the work-piece that it may hide from a camera; nothing ends for more, but another arm is preferred.
    pub hidden_share: f64,
}

impl Margins {
    /// The margins of a foreseen motion.
    pub fn foreseen(settings: &CooperationSettings) -> Self {
        Self {
            speed_share: settings.speed_share,
            singular_value: settings.least_singular_value,
            joint: settings.joint_margin,
            gap_m: settings.gap_m,
            retreat: true,
            hidden_share: settings.hidden_share,
        }
    }

    /// The margins of a motion that is about to be executed. It may need more than the speed of a joint: the work-piece then
    /// slows down. An arm that would have to be this much faster jumps to another branch.
    pub fn executed(settings: &CooperationSettings, retreat: bool) -> Self {
        Self {
            speed_share: 20.0,
            singular_value: 0.0,
            joint: 0.0,
            gap_m: 0.5 * settings.gap_m,
            retreat,
            hidden_share: settings.hidden_share,
        }
    }
}

/// An arm with the work-piece in one of its grasps.
///
/// The other members of the virtual robot are not here: they move out of the way.
#[derive(Debug)]
pub(crate) struct Holding<'s> {
    /// Index of the arm among the members.
    pub member: usize,
    /// Index in the grasps of the arm.
    pub number: usize,
    pub grasp: Grasp,
    arm: Member,
    solver: IkSolver,
    scene: &'s Scene,
    checker: Checker<'s>,
    state: SceneState,
    chain_state: ChainState,
    columns: Vec<[f64; 6]>,
    /// Workspace of [`can_retreat`](Self::can_retreat).
    retreated: Vec<f64>,
    /// Joint values at the start of the last [`follow`](Self::follow).
    from: Vec<f64>,
    /// Largest share of a joint speed that the last [`follow`](Self::follow) needs.
    pub effort: f64,
    /// Robots that are not members.
    bystanders: Vec<RobotId>,
    /// The work-piece before the camera, if there is one.
    pub visibility: Option<Visibility>,
}

impl<'s> Holding<'s> {
    /// The arm `member` with the work-piece in `grasp`; everything else as in `state`.
    pub fn new(
        scene: &'s Scene,
        state: &SceneState,
        work_piece: ObjectId,
        (member, arm): (usize, &Member),
        number: usize,
        members: &[RobotId],
    ) -> Result<Self, SceneError> {
        let chain = &scene.robots()[arm.robot.0].robot.chain;
        let options = IkOptions { restarts: RESTARTS, ..IkOptions::default() };
        let (mut state, grasp) = (state.clone(), arm.grasps[number]);
        if state.attachment(work_piece).is_some() {
            state.detach(scene, work_piece)?;
        }
        state.attach_at(scene, work_piece, attachment(arm, &grasp.tool_in_part))?;
        Ok(Self {
            member,
            number,
            grasp,
            arm: arm.clone(),
            solver: IkSolver::new(chain, arm.tip, arm.tool_in_tip, options),
            scene,
            checker: Checker::new(scene, CheckerOptions::default()),
            state,
            chain_state: ChainState::new(chain),
            columns: vec![[0.0; 6]; chain.dof()],
            retreated: vec![0.0; chain.dof()],
            from: vec![0.0; chain.dof()],
            effort: 0.0,
            bystanders: (0..scene.robots().len()).map(RobotId).filter(|r| !members.contains(r)).collect(),
            visibility: None,
        })
    }

    /// Holds the work-piece with the tool at another pose in its frame.
    pub fn regrasp(&mut self, work_piece: ObjectId, tool_in_part: &Pose) -> Result<(), SceneError> {
        self.grasp.tool_in_part = *tool_in_part;
        self.state.detach(self.scene, work_piece)?;
        self.state.attach_at(self.scene, work_piece, attachment(&self.arm, tool_in_part))
    }

    /// Holds the work-piece as its grasp says.
    pub fn regrasp_exactly(&mut self, work_piece: ObjectId) -> Result<(), SceneError> {
        let tool_in_part = self.arm.grasps[self.number].tool_in_part;
        self.regrasp(work_piece, &tool_in_part)
    }

    /// Whether the hand at its pre-grasp keeps a distance (m) from the work-piece.
    pub fn is_apart_at_pre_grasp(&mut self, work_piece: ObjectId, gap_m: f64) -> Result<bool, SceneError> {
        let mut state = self.state.clone();
        let pre_grasp = self.grasp.at(self.grasp.length_m());
        state.detach(self.scene, work_piece)?;
        state.attach_at(self.scene, work_piece, attachment(&self.arm, &pre_grasp))?;
        // It stays there, and the hand may not touch it.
        state.detach(self.scene, work_piece)?;
        let Self { checker, arm, .. } = self;
        Ok(arm.hand.iter().all(|&link| {
            let link = Selection::Link { robot: arm.robot, link };
            checker.between(link, Selection::Object(work_piece)).within(&state, gap_m).is_none()
        }))
    }

    /// Moves everything but the members.
    pub fn surroundings(
        &mut self,
        change: &mut dyn FnMut(&Scene, &mut SceneState) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        change(self.scene, &mut self.state)
    }

    /// Moves `q` to the joint values near it at which the tool is at a pose in the frame of the work-piece; false if there
    /// are none.
    pub fn solve(&mut self, part_in_world: &Pose, tool_in_part: &Pose, q: &mut [f64]) -> bool {
        let base = self.scene.robots()[self.arm.robot.0].base_in_world;
        self.solver.refine(&(base.inverse_mul(part_in_world) * *tool_in_part), q)
    }

    /// Moves `q` to the joint values at which the arm holds the work-piece there, `dt_s` seconds later.
    ///
    /// # Errors
    /// [`HoldLimit`] if it cannot, on the branch of `q`; `q` is then of no use.
    pub fn follow(
        &mut self,
        part_in_world: &Pose,
        dt_s: f64,
        q: &mut [f64],
        margins: &Margins,
    ) -> Result<(), HoldLimit> {
        self.from.copy_from_slice(q);
        let tool_in_part = self.grasp.tool_in_part;
        if !self.solve(part_in_world, &tool_in_part, q) {
            let is_at_limit = |(q, l): (&f64, &JointLimits)| (q - l.lower).min(l.upper - q) < 1e-6;
            let joint = q.iter().zip(&self.arm.limits).position(is_at_limit);
            return Err(joint.map_or(HoldLimit::Reach, HoldLimit::JointRange));
        }
        self.effort = 0.0;
        for (joint, ((to, from), limits)) in q.iter().zip(&self.from).zip(&self.arm.limits).enumerate() {
            let effort = (to - from).abs() / (limits.velocity * dt_s);
            if effort > margins.speed_share {
                return Err(HoldLimit::JointSpeed(joint));
            }
            self.effort = self.effort.max(effort);
            // A joint may leave its limit.
            let is_near = |gap: f64, gap_before: f64| gap < margins.joint && gap < gap_before;
            if is_near(to - limits.lower, from - limits.lower) || is_near(limits.upper - to, limits.upper - from) {
                return Err(HoldLimit::JointRange(joint));
            }
        }
        if margins.retreat && !self.can_retreat(part_in_world, q) {
            return Err(HoldLimit::Retreat);
        }
        match self.is_free(q, margins) {
            Err(HoldLimit::Contact(a, b)) if !self.leaves(q, margins.gap_m) => Err(HoldLimit::Contact(a, b)),
            Ok(()) | Err(HoldLimit::Contact(..)) => Ok(()),
            Err(other) => Err(other),
        }
    }

    /// Whether the last step leaves what is near: a part may be lifted from a table.
    fn leaves(&mut self, q: &[f64], gap_m: f64) -> bool {
        let from = std::mem::take(&mut self.from);
        let (before_m, after_m) = (self.clearance_m(&from, gap_m), self.clearance_m(q, gap_m));
        self.from = from;
        let own = Selection::Robot(self.arm.robot);
        after_m > 0.0 && after_m >= before_m && self.checker.between(own, own).collides(&self.state).is_none()
    }

    /// Distance of the arm with the work-piece from everything but the members, up to a gap, m; infinite beyond.
    fn clearance_m(&mut self, q: &[f64], gap_m: f64) -> f64 {
        if self.state.set_q(self.scene, self.arm.robot, q).is_err() {
            return 0.0;
        }
        let Self { checker, state, bystanders, arm, .. } = self;
        let robot = arm.robot;
        let is_own = |id: GeometryId| match id {
            GeometryId::Link { robot: of, .. } => of == robot,
            GeometryId::Object(object) => state.attachment(object).is_some_and(|a| a.robot == robot),
        };
        let others = bystanders.iter().map(|r| Selection::Robot(*r)).chain([Selection::Objects]);
        let mut least = f64::INFINITY;
        for other in others {
            checker.between(Selection::Robot(robot), other).distances_within(state, gap_m, |pair| {
                // The work-piece in its hand is near by design.
                if !(is_own(pair.a) && is_own(pair.b)) {
                    least = least.min(pair.metres);
                }
            });
        }
        least
    }

    /// Whether the hand can move back to its pre-grasp from `q`, where it holds the work-piece.
    pub fn can_retreat(&mut self, part_in_world: &Pose, q: &[f64]) -> bool {
        let mut retreated = std::mem::take(&mut self.retreated);
        retreated.copy_from_slice(q);
        let can_retreat = self.retreat(part_in_world, &mut retreated);
        self.retreated = retreated;
        can_retreat
    }

    /// Moves `q`, where the arm holds the work-piece, to where its hand has moved back to its pre-grasp; false if it cannot.
    pub fn retreat(&mut self, part_in_world: &Pose, q: &mut [f64]) -> bool {
        let grasp = self.grasp;
        [0.3, 0.6, 1.0].iter().all(|share| self.solve(part_in_world, &grasp.at(share * grasp.length_m()), q))
    }

    /// Whether the arm with the work-piece keeps the margins at a configuration.
    ///
    /// # Errors
    /// [`HoldLimit`] if it does not.
    pub fn is_free(&mut self, q: &[f64], margins: &Margins) -> Result<(), HoldLimit> {
        if margins.singular_value > 0.0 && self.least_singular_value(q) < margins.singular_value {
            return Err(HoldLimit::Singularity);
        }
        // The number of joint values is that of the robot, and they are finite.
        if self.state.set_q(self.scene, self.arm.robot, q).is_err() {
            return Err(HoldLimit::Reach);
        }
        let Self { checker, state, bystanders, arm, .. } = self;
        let own = Selection::Robot(arm.robot);
        let mut near = checker.between(own, own).collides(state);
        if let Some(pair) = near {
            return Err(HoldLimit::Contact(pair.a, pair.b));
        }
        near = checker.between(own, Selection::Objects).within(state, margins.gap_m);
        for other in bystanders.iter() {
            near = near.or_else(|| checker.between(own, Selection::Robot(*other)).within(state, margins.gap_m));
        }
        let Some(pair) = near else { return Ok(()) };
        // Perhaps only the work-piece in the hand.
        if self.clearance_m(q, margins.gap_m).is_infinite() { Ok(()) } else { Err(HoldLimit::Contact(pair.a, pair.b)) }
    }

    /// Whether the arm at `q` hides more than a share of the work-piece from the camera.
    pub fn hides(&mut self, part_in_world: &Pose, q: &[f64], share: f64) -> bool {
        let Self { scene, state, arm, visibility: Some(visibility), .. } = self else { return false };
        // An unknown place hides it.
        state.set_q(scene, arm.robot, q).is_err()
            || visibility.hides_more_than(share, part_in_world, parts(scene, state, arm.robot))
    }

    /// The nearest free configuration that holds the work-piece there, on any branch, and can let it go; if possible, one
    /// that does not hide it.
    pub fn search(&mut self, part_in_world: &Pose, seed: &[f64], margins: &Margins) -> Option<Vec<f64>> {
        let base = self.scene.robots()[self.arm.robot.0].base_in_world;
        let tool_in_root = base.inverse_mul(part_in_world) * self.grasp.tool_in_part;
        let mut nearest = None;
        for q in self.solver.solve_all(&tool_in_root, seed) {
            if !self.can_retreat(part_in_world, &q) || self.is_free(&q, margins).is_err() {
                continue;
            }
            if !self.hides(part_in_world, &q, margins.hidden_share) {
                return Some(q);
            }
            nearest = nearest.or(Some(q));
        }
        nearest
    }

    /// Whether the arm at `q` keeps a distance (m) from another member, whose hand may hold the same work-piece.
    pub fn clears(&mut self, q: &[f64], other: RobotId, other_q: &[f64], gap_m: f64) -> bool {
        let (scene, robot) = (self.scene, self.arm.robot);
        let Self { state, checker, .. } = self;
        if state.set_q(scene, robot, q).is_err() || state.set_q(scene, other, other_q).is_err() {
            return false;
        }
        let links = &scene.robots()[robot.0].robot;
        // Links without the work-piece, which the other hand touches.
        links.links_with_colliders().all(|link| {
            let link = Selection::Link { robot, link };
            checker.between(link, Selection::Robot(other)).within(state, gap_m).is_none()
        })
    }

    /// Least singular value of the Jacobian of the tool centre point; metres are divided by the distance of the tool from
    /// the base. Infinite for an arm with fewer than six joints, which never has full rank.
    pub fn least_singular_value(&mut self, q: &[f64]) -> f64 {
        if q.len() < 6 {
            return f64::INFINITY;
        }
        let chain = &self.scene.robots()[self.arm.robot.0].robot.chain;
        self.chain_state.q.copy_from_slice(q);
        chain.forward(&mut self.chain_state);
        let tool_in_root = self.chain_state.link_in_root(self.arm.tip) * self.arm.tool_in_tip;
        chain.jacobian(&self.chain_state, self.arm.tip, self.arm.tool_in_tip.translation, &mut self.columns);
        let length_m = tool_in_root.translation.distance(Vec3::ZERO).max(0.1);
        let mut square = [[0.0; 6]; 6];
        for column in &self.columns {
            let scaled: [f64; 6] = std::array::from_fn(|i| if i < 3 { column[i] / length_m } else { column[i] });
            for (row, a) in square.iter_mut().zip(scaled) {
                row.iter_mut().zip(scaled).for_each(|(entry, b)| *entry += a * b);
            }
        }
        let (values, _) = symmetric_eigen(square);
        values.into_iter().fold(f64::INFINITY, f64::min).max(0.0).sqrt()
    }
}

/// The solids of a robot, and where they are.
pub(crate) fn parts<'a>(
    scene: &'a Scene,
    state: &'a SceneState,
    robot: RobotId,
) -> impl Iterator<Item = (&'a Shape, Pose)> {
    let links = scene.robots()[robot.0].robot.links_with_colliders();
    links.map(move |link| GeometryId::Link { robot, link }).flat_map(move |id| {
        let in_world = state.pose(scene, id).unwrap_or(Pose::IDENTITY);
        scene.shapes(id).map(move |(shape, in_link)| (shape, in_world * in_link))
    })
}

/// How an arm holds the work-piece with its tool at a pose in the frame of the work-piece.
pub(crate) fn attachment(arm: &Member, tool_in_part: &Pose) -> Attachment {
    Attachment {
        robot: arm.robot,
        link: arm.tip,
        in_link: arm.tool_in_tip * tool_in_part.inverse(),
        touch_links: arm.hand.clone(),
        visiting_links: Vec::new(),
    }
}
