//! The mutable part of a scene: the current configuration and attachments.

use std::sync::atomic::{AtomicU64, Ordering};

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_spatial::{Aabb, Pose};

use crate::attachment::Attachment;
use crate::world_box::WorldBox;
use crate::{Scene, SceneError};

/// The poses of the robots and objects of a [`Scene`], and the attachments of objects.
///
/// [`SceneState::new`] allocates all memory. States are independent of each other and of the checkers that read them.
#[derive(Debug)]
pub struct SceneState {
    pub(crate) chains: Vec<ChainState>,
    /// Per model: its pose in the world.
    pub(crate) in_world: Vec<Pose>,
    /// Boxes in the world: one per model, then one per robot with the objects attached to it.
    pub(crate) boxes: Vec<WorldBox>,
    /// Per object: its attachment.
    pub(crate) attached: Vec<Option<Attachment>>,
    /// Per object: true if its pose differs from its pose in the scene.
    pub(crate) displaced: Vec<bool>,
    /// Per robot: true if a joint is beyond its limits.
    pub(crate) beyond_limits: Vec<bool>,
    /// True if the out-of-reach proofs of the scene hold for every pair.
    pub(crate) all_proofs_hold: bool,
    /// Number of the set of attachments: states with equal numbers have equal pairs. 0: no object is attached.
    pub(crate) arrangement: u64,
}

impl Clone for SceneState {
    fn clone(&self) -> Self {
        Self {
            chains: self.chains.clone(),
            in_world: self.in_world.clone(),
            boxes: self.boxes.clone(),
            attached: self.attached.clone(),
            displaced: self.displaced.clone(),
            beyond_limits: self.beyond_limits.clone(),
            all_proofs_hold: self.all_proofs_hold,
            arrangement: self.arrangement,
        }
    }

    /// Reuses the memory of `self`.
    fn clone_from(&mut self, source: &Self) {
        let Self { chains, in_world, boxes, attached, displaced, beyond_limits, all_proofs_hold, arrangement } = source;
        self.chains.clone_from(chains);
        self.in_world.clone_from(in_world);
        self.boxes.clone_from(boxes);
        // Equal numbers mean equal attachments: nothing is allocated then.
        if self.arrangement != *arrangement || self.attached.len() != attached.len() {
            self.attached.clone_from(attached);
        }
        self.displaced.clone_from(displaced);
        self.beyond_limits.clone_from(beyond_limits);
        (self.all_proofs_hold, self.arrangement) = (*all_proofs_hold, *arrangement);
    }
}

/// Source of arrangement numbers; only their equality has a meaning.
static NEXT_ARRANGEMENT: AtomicU64 = AtomicU64::new(1);

impl SceneState {
    /// Creates the initial state: joints at zero (which may be beyond a limit), objects as in the scene, none attached.
    pub fn new(scene: &Scene) -> Self {
        let mut state = Self {
            chains: scene.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            in_world: vec![Pose::IDENTITY; scene.models.len()],
            boxes: vec![WorldBox::EMPTY; scene.models.len() + scene.robots.len()],
            attached: vec![None; scene.objects.len()],
            displaced: vec![false; scene.objects.len()],
            beyond_limits: vec![false; scene.robots.len()],
            all_proofs_hold: true,
            arrangement: 0,
        };
        for (i, o) in scene.objects.iter().enumerate() {
            state.set_model_pose(scene, scene.object_model(ObjectId(i)), o.in_world);
        }
        for robot in 0..scene.robots.len() {
            state.robot_moved(scene, RobotId(robot));
        }
        state
    }

    /// Moves a robot to joint values, together with the objects attached to it. Does not allocate.
    ///
    /// `q` is in rad or m, in the order of [`Chain::active_joints`](elbowroom_kinematics::Chain::active_joints). Values
    /// beyond the limits are accepted.
    ///
    /// # Errors
    /// [`SceneError`] if the robot does not exist, the number of values is wrong, or a value is NaN or infinite. On an
    /// error nothing moves.
    pub fn set_q(&mut self, scene: &Scene, robot: RobotId, q: &[f64]) -> Result<(), SceneError> {
        self.check_q(scene, robot, q)?;
        self.chains[robot.0].q.copy_from_slice(q);
        scene.robots[robot.0].robot.chain.forward(&mut self.chains[robot.0]);
        self.robot_moved(scene, robot);
        Ok(())
    }

    /// Checks whether [`set_q`](Self::set_q) accepts joint values.
    ///
    /// # Errors
    /// The errors of [`set_q`](Self::set_q).
    #[allow(clippy::unused_self)]
    pub fn check_q(&self, scene: &Scene, robot: RobotId, q: &[f64]) -> Result<(), SceneError> {
        let count = scene.robots.len();
        let r = scene.robots.get(robot.0).ok_or(SceneError::NoSuchRobot { index: robot.0, count })?;
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

    /// Joint values of a robot, rad or m; empty if the robot does not exist.
    pub fn q(&self, robot: RobotId) -> &[f64] {
        self.chains.get(robot.0).map_or(&[], |c| &c.q)
    }

    /// Sets the pose of an object.
    ///
    /// # Errors
    /// [`SceneError`] if the object does not exist or is attached, or the pose is not finite.
    pub fn place(&mut self, scene: &Scene, object: ObjectId, in_world: Pose) -> Result<(), SceneError> {
        let name = self.check_place(scene, object)?;
        if !in_world.is_finite() {
            return Err(SceneError::PoseNotFinite(format!("`{name}`")));
        }
        self.displaced[object.0] = in_world != scene.objects[object.0].in_world;
        self.update_proofs();
        self.set_model_pose(scene, scene.object_model(object), in_world);
        Ok(())
    }

    /// Checks that an object can be placed, and returns its name.
    pub(crate) fn check_place<'s>(&self, scene: &'s Scene, object: ObjectId) -> Result<&'s str, SceneError> {
        let count = scene.objects.len();
        let o = scene.objects.get(object.0).ok_or(SceneError::NoSuchObject { index: object.0, count })?;
        match &self.attached[object.0] {
            Some(a) => {
                let link = scene.link_name(a.robot, a.link);
                Err(SceneError::PlacedWhileAttached { object: o.name.clone(), link })
            }
            None => Ok(&o.name),
        }
    }

    /// Copies another state of the same scene. Allocates only if the attachments differ.
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

    /// Pose of a link or object in the world; `None` if the scene has no such link or object.
    pub fn pose(&self, scene: &Scene, id: GeometryId) -> Option<Pose> {
        match id {
            GeometryId::Link { robot, link } => {
                let r = scene.robots.get(robot.0)?;
                (link.0 < r.robot.chain.links().len()).then(|| self.link_in_world(scene, robot, link))
            }
            GeometryId::Object(o) => self.in_world.get(scene.object_model(o)).copied(),
        }
    }

    pub(crate) fn link_in_world(&self, scene: &Scene, robot: RobotId, link: LinkId) -> Pose {
        scene.robots[robot.0].base_in_world * self.chains[robot.0].link_in_root(link)
    }

    /// The attachment of an object; `None` if it is not attached.
    pub fn attachment(&self, object: ObjectId) -> Option<&Attachment> {
        self.attached.get(object.0)?.as_ref()
    }

    /// The attachment of a geometry, if it is an attached object.
    pub(crate) fn attachment_of(&self, id: GeometryId) -> Option<&Attachment> {
        match id {
            GeometryId::Object(o) => self.attachment(o),
            GeometryId::Link { .. } => None,
        }
    }

    /// The box of [`Level::L1`](crate::Level::L1) around a robot with the objects attached to it, in the world.
    ///
    /// `None` if there is no such robot, or if it has no shape or an unbounded one.
    pub fn robot_box(&self, scene: &Scene, robot: RobotId) -> Option<Aabb> {
        self.boxes.get(scene.models.len() + robot.0)?.aabb()
    }

    /// The robot and link with which the geometry moves.
    pub(crate) fn carrier(&self, id: GeometryId) -> Option<(RobotId, LinkId)> {
        match id {
            GeometryId::Link { robot, link } => Some((robot, link)),
            GeometryId::Object(o) => self.attachment(o).map(|a| (a.robot, a.link)),
        }
    }

    pub(crate) fn set_model_pose(&mut self, scene: &Scene, model: usize, in_world: Pose) {
        self.in_world[model] = in_world;
        let m = &scene.models[model];
        self.boxes[model] = match &m.obb {
            Some(obb) => WorldBox::of_obb(obb, &in_world),
            None => m
                .exact
                .iter()
                .fold(WorldBox::EMPTY, |b, s| b.union(&WorldBox::of_aabb(&s.shape.aabb(&(in_world * s.in_geometry))))),
        };
    }

    /// Updates all data that depend on a robot's joint values.
    pub(crate) fn robot_moved(&mut self, scene: &Scene, robot: RobotId) {
        let chain = &scene.robots[robot.0].robot.chain;
        for link in 0..chain.links().len() {
            if let Some(model) = scene.link_model[robot.0][link] {
                let in_world = self.link_in_world(scene, robot, LinkId(link));
                self.set_model_pose(scene, model, in_world);
            }
        }
        let beyond = !scene.within_limits(robot, &self.chains[robot.0].q);
        if std::mem::replace(&mut self.beyond_limits[robot.0], beyond) != beyond {
            self.update_proofs();
        }
        if self.arrangement != 0 {
            self.move_attached(scene, robot);
        }
        self.update_robot_box(scene, robot);
    }

    /// Moves the objects attached to a robot to the poses of its links.
    pub(crate) fn move_attached(&mut self, scene: &Scene, robot: RobotId) {
        for object in 0..self.attached.len() {
            let Some(a) = self.attached[object].as_ref().filter(|a| a.robot == robot) else { continue };
            let in_world = self.link_in_world(scene, robot, a.link) * a.in_link;
            self.set_model_pose(scene, scene.object_model(ObjectId(object)), in_world);
        }
    }

    /// Updates the box around a robot and the objects attached to it.
    pub(crate) fn update_robot_box(&mut self, scene: &Scene, robot: RobotId) {
        let links = scene.link_model[robot.0].iter().flatten().copied();
        let mut all = links.fold(WorldBox::EMPTY, |b, m| b.union(&self.boxes[m]));
        if self.arrangement != 0 {
            for (o, a) in self.attached.iter().enumerate() {
                if a.as_ref().is_some_and(|a| a.robot == robot) {
                    all = all.union(&self.boxes[scene.object_model(ObjectId(o))]);
                }
            }
        }
        self.boxes[scene.models.len() + robot.0] = all;
    }

    /// True if the out-of-reach proofs of the scene hold for the geometry.
    ///
    /// They hold for a robot with its joints within the limits, and for an unattached object at its pose of the scene.
    pub(crate) fn proofs_hold(&self, id: GeometryId) -> bool {
        match id {
            GeometryId::Link { robot, .. } => !self.beyond_limits[robot.0],
            GeometryId::Object(o) => !self.displaced[o.0] && self.attached[o.0].is_none(),
        }
    }

    fn update_proofs(&mut self) {
        let in_place = |o: (&bool, &Option<Attachment>)| !o.0 && o.1.is_none();
        self.all_proofs_hold =
            !self.beyond_limits.contains(&true) && self.displaced.iter().zip(&self.attached).all(in_place);
    }

    /// Updates all data that depend on the attachments, except poses and boxes.
    pub(crate) fn attachments_changed(&mut self) {
        self.update_proofs();
        let any = self.attached.iter().any(Option::is_some);
        self.arrangement = if any { NEXT_ARRANGEMENT.fetch_add(1, Ordering::Relaxed) } else { 0 };
    }
}
