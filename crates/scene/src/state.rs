//! The mutable part: where everything is now.

use std::sync::atomic::{AtomicU64, Ordering};

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_spatial::Pose;

use crate::attach::Attachment;
use crate::world_box::WorldBox;
use crate::{Member, Scene, SceneError};

/// Where robots and objects of a [`Scene`] are now, and what is attached to what.
///
/// All memory is taken by [`SceneState::new`]. States are independent of each other and of the threads that look at them.
#[derive(Debug, Clone)]
pub struct SceneState {
    pub(crate) chains: Vec<ChainState>,
    /// Per model.
    pub(crate) in_world: Vec<Pose>,
    /// Per model, then per robot with what it carries.
    pub(crate) boxes: Vec<WorldBox>,
    /// Per object.
    pub(crate) attached: Vec<Option<Attachment>>,
    /// Per object: not where it was when the scene was built.
    pub(crate) displaced: Vec<bool>,
    /// Per robot: some joint is beyond its limits.
    pub(crate) beyond_limits: Vec<bool>,
    /// What was proven when the scene was built holds for every pair.
    pub(crate) all_proofs_hold: bool,
    /// Names what is attached to what: states of equal number have equal pairs. 0: nothing is attached.
    pub(crate) arrangement: u64,
}

/// Numbers of arrangements; only whether two are equal matters.
static NEXT: AtomicU64 = AtomicU64::new(1);

impl SceneState {
    /// All joints at zero (which may lie beyond a limit), objects where the scene has them, nothing attached.
    pub fn new(scene: &Scene) -> Self {
        let mut state = Self {
            chains: scene.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            in_world: vec![Pose::IDENTITY; scene.models.len()],
            boxes: vec![WorldBox::NOTHING; scene.models.len() + scene.robots.len()],
            attached: vec![None; scene.objects.len()],
            displaced: vec![false; scene.objects.len()],
            beyond_limits: vec![false; scene.robots.len()],
            all_proofs_hold: true,
            arrangement: 0,
        };
        for (i, o) in scene.objects.iter().enumerate() {
            state.put(scene, scene.first_object + i, o.in_world);
        }
        for robot in 0..scene.robots.len() {
            state.moved(scene, robot);
        }
        state
    }

    /// Moves a robot to joint values (rad or m, in the order of
    /// [`Chain::active_joints`](elbowroom_kinematics::Chain::active_joints)), with all that it carries. Values beyond
    /// the limits are taken as they are. Does not allocate.
    ///
    /// # Errors
    /// No such robot, a wrong number of values, or one that is NaN or infinite, by its joint's name. Nothing has moved then.
    pub fn set_q(&mut self, scene: &Scene, robot: usize, q: &[f64]) -> Result<(), SceneError> {
        self.check_q(scene, robot, q)?;
        self.chains[robot].q.copy_from_slice(q);
        scene.robots[robot].robot.chain.forward(&mut self.chains[robot]);
        self.moved(scene, robot);
        Ok(())
    }

    /// What [`SceneState::set_q`] refuses.
    #[allow(clippy::unused_self)]
    pub(crate) fn check_q(&self, scene: &Scene, robot: usize, q: &[f64]) -> Result<(), SceneError> {
        let count = scene.robots.len();
        let r = scene.robots.get(robot).ok_or(SceneError::NoSuchRobot { index: robot, count })?;
        let chain = &r.robot.chain;
        let joint_name = |i: usize| chain.joints()[chain.active_joints()[i].0].name.clone();
        if q.len() != chain.dof() {
            let joints = (0..chain.dof()).map(joint_name).collect::<Vec<_>>().join(", ");
            let robot = r.name.clone();
            return Err(SceneError::JointCount { robot, expected: chain.dof(), joints, given: q.len() });
        }
        if let Some(i) = q.iter().position(|v| !v.is_finite()) {
            return Err(SceneError::JointNotFinite { robot: r.name.clone(), joint: joint_name(i), value: q[i] });
        }
        Ok(())
    }

    /// Joint values of a robot, rad or m; empty where there is no such robot.
    pub fn q(&self, robot: usize) -> &[f64] {
        self.chains.get(robot).map_or(&[], |c| &c.q)
    }

    /// Puts an object somewhere else.
    ///
    /// # Errors
    /// No such object, a pose that is not finite, or the object is attached.
    pub fn place(&mut self, scene: &Scene, object: usize, in_world: Pose) -> Result<(), SceneError> {
        let name = self.check_place(scene, object)?;
        if !in_world.is_finite() {
            return Err(SceneError::PoseNotFinite(format!("`{name}`")));
        }
        self.displaced[object] = in_world != scene.objects[object].in_world;
        self.count_proofs();
        self.put(scene, scene.first_object + object, in_world);
        Ok(())
    }

    /// The name of an object that can be placed.
    pub(crate) fn check_place<'s>(&self, scene: &'s Scene, object: usize) -> Result<&'s str, SceneError> {
        let count = scene.objects.len();
        let o = scene.objects.get(object).ok_or(SceneError::NoSuchObject { index: object, count })?;
        match &self.attached[object] {
            Some(a) => {
                let link = scene.link_name(a.robot, a.link);
                Err(SceneError::PlacedWhileAttached { object: o.name.clone(), link })
            }
            None => Ok(&o.name),
        }
    }

    /// Becomes equal to a state of the same scene; allocates only where attachments differ.
    pub(crate) fn copy_from(&mut self, scene: &Scene, other: &Self) {
        for (robot, (own, chain)) in self.chains.iter_mut().zip(&other.chains).enumerate() {
            own.q.copy_from_slice(&chain.q);
            scene.robots[robot].robot.chain.forward(own);
        }
        self.in_world.clone_from(&other.in_world);
        self.boxes.clone_from(&other.boxes);
        if self.arrangement != other.arrangement {
            self.attached.clone_from(&other.attached);
        }
        self.displaced.clone_from(&other.displaced);
        self.beyond_limits.clone_from(&other.beyond_limits);
        self.all_proofs_hold = other.all_proofs_hold;
        self.arrangement = other.arrangement;
    }

    /// Where a member's frame is, in the world; `None` where the scene has no such member.
    pub fn pose(&self, scene: &Scene, member: Member) -> Option<Pose> {
        match member {
            Member::Link { robot, link } => {
                let r = scene.robots.get(robot)?;
                (link.0 < r.robot.chain.links().len()).then(|| self.link_in_world(scene, robot, link))
            }
            Member::Object(o) => self.in_world.get(scene.first_object + o).copied(),
        }
    }

    pub(crate) fn link_in_world(&self, scene: &Scene, robot: usize, link: LinkId) -> Pose {
        scene.robots[robot].base_in_world * self.chains[robot].link_in_root(link)
    }

    pub(crate) fn put(&mut self, scene: &Scene, model: usize, in_world: Pose) {
        self.in_world[model] = in_world;
        let m = &scene.models[model];
        self.boxes[model] = match &m.obb {
            Some(obb) => WorldBox::of_obb(obb, &in_world),
            None => m
                .exact
                .iter()
                .fold(WorldBox::NOTHING, |b, s| b.joined(&WorldBox::of_aabb(&s.shape.aabb(&(in_world * s.in_member))))),
        };
    }

    /// Everything that follows from a robot's joint values.
    pub(crate) fn moved(&mut self, scene: &Scene, robot: usize) {
        let r = &scene.robots[robot];
        let chain = &r.robot.chain;
        for link in 0..chain.links().len() {
            if let Some(model) = scene.link_model[robot][link] {
                let in_world = self.link_in_world(scene, robot, LinkId(link));
                self.put(scene, model, in_world);
            }
        }
        let beyond = !scene.within_limits(robot, &self.chains[robot].q);
        if std::mem::replace(&mut self.beyond_limits[robot], beyond) != beyond {
            self.count_proofs();
        }
        if self.arrangement != 0 {
            self.carry(scene, robot);
        }
        self.enclose(scene, robot);
    }

    /// The box around a robot and what it carries.
    pub(crate) fn enclose(&mut self, scene: &Scene, robot: usize) {
        let links = scene.link_model[robot].iter().flatten().copied();
        let mut all = links.fold(WorldBox::NOTHING, |b, m| b.joined(&self.boxes[m]));
        if self.arrangement != 0 {
            for (o, a) in self.attached.iter().enumerate() {
                if a.as_ref().is_some_and(|a| a.robot == robot) {
                    all = all.joined(&self.boxes[scene.first_object + o]);
                }
            }
        }
        self.boxes[scene.models.len() + robot] = all;
    }

    /// True where what was proven when the scene was built holds for a pair: joints within limits, objects in place.
    pub(crate) fn proofs_hold(&self, member: Member) -> bool {
        match member {
            Member::Link { robot, .. } => !self.beyond_limits[robot],
            Member::Object(o) => !self.displaced[o] && self.attached[o].is_none(),
        }
    }

    fn count_proofs(&mut self) {
        let free = |o: (&bool, &Option<Attachment>)| !o.0 && o.1.is_none();
        self.all_proofs_hold =
            !self.beyond_limits.contains(&true) && self.displaced.iter().zip(&self.attached).all(free);
    }

    pub(crate) fn rearranged(&mut self) {
        self.count_proofs();
        self.arrangement =
            if self.attached.iter().any(Option::is_some) { NEXT.fetch_add(1, Ordering::Relaxed) } else { 0 };
    }
}
