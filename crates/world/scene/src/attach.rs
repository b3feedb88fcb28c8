//! Attaching objects to links and detaching them: grasping, releasing, tool changes.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_spatial::Pose;

use crate::attachment::Attachment;
use crate::{PairEntry, PairState, Reason, Scene, SceneError, SceneState};

impl SceneState {
    /// Attaches an object to a link, at its present pose.
    ///
    /// From then on the object moves with the link. It is checked against the other links, except `touch_links`, and
    /// against the other objects. Its padding and the manual edits of its pairs remain.
    ///
    /// ```
    /// use elbowroom_kinematics::LinkId;
    /// use elbowroom_robot::{GeometryId, ObjectId, RobotId};
    /// use elbowroom_scene::{SceneState, example};
    /// use elbowroom_spatial::Vec3;
    /// let scene = example::two_arms();
    /// let (robot, part) = (RobotId(0), ObjectId(0));
    /// let mut state = SceneState::new(&scene);
    /// let before = state.pose(&scene, GeometryId::Object(part)).unwrap();
    /// state.attach(&scene, part, robot, LinkId(3), &[])?;
    /// state.set_q(&scene, robot, &[1.0, 0.0, 0.0])?;
    /// let after = state.pose(&scene, GeometryId::Object(part)).unwrap();
    /// assert!(after.translation.distance(before.translation) > 0.1);
    /// state.detach(&scene, part)?; // keeps its pose
    /// state.set_q(&scene, robot, &[0.0, 0.0, 0.0])?;
    /// assert_eq!(state.pose(&scene, GeometryId::Object(part)), Some(after));
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] if the object, robot or link does not exist, or the object is attached already.
    pub fn attach(
        &mut self,
        scene: &Scene,
        object: ObjectId,
        robot: RobotId,
        link: LinkId,
        touch_links: &[LinkId],
    ) -> Result<(), SceneError> {
        let in_link = Pose::IDENTITY;
        let touch_links = touch_links.to_vec();
        let mut attachment = Attachment { robot, link, in_link, touch_links, visiting_links: Vec::new() };
        self.check_attach(scene, object, &attachment)?;
        let object_in_world = self.in_world[scene.object_model(object)];
        attachment.in_link = self.link_in_world(scene, robot, link).inverse_mul(&object_in_world);
        self.attach_at(scene, object, attachment)
    }

    /// Like [`SceneState::attach`], but moves the object's frame to a given pose in the link: a tool in its changer.
    ///
    /// # Errors
    /// The errors of [`SceneState::attach`], or a pose that is not finite.
    pub fn attach_at(&mut self, scene: &Scene, object: ObjectId, attachment: Attachment) -> Result<(), SceneError> {
        self.check_attach(scene, object, &attachment)?;
        if !attachment.in_link.is_finite() {
            return Err(SceneError::PoseNotFinite(format!("`{}`", scene.objects[object.0].name)));
        }
        let robot = attachment.robot;
        self.attached[object.0] = Some(attachment);
        self.attachments_changed();
        self.move_attached(scene, robot);
        self.update_robot_box(scene, robot);
        Ok(())
    }

    /// Detaches an object: it keeps its present pose.
    ///
    /// # Errors
    /// [`SceneError`] if the object does not exist or is not attached.
    pub fn detach(&mut self, scene: &Scene, object: ObjectId) -> Result<(), SceneError> {
        let count = scene.objects.len();
        let o = scene.objects.get(object.0).ok_or(SceneError::NoSuchObject { index: object.0, count })?;
        let held = self.attached[object.0].take().ok_or_else(|| SceneError::NotAttached(o.name.clone()))?;
        self.displaced[object.0] = self.in_world[scene.object_model(object)] != o.in_world;
        self.attachments_changed();
        self.update_robot_box(scene, held.robot);
        Ok(())
    }

    /// Whether a pair is tested now, and why.
    ///
    /// This is the [allowed collision matrix](Scene::allowed_collision_matrix) as attachments change it. `None` if the
    /// pair does not exist, for example two unattached objects without an edit.
    pub fn pair(&self, scene: &Scene, a: GeometryId, b: GeometryId) -> Option<(PairState, Reason)> {
        if a == b || !scene.has_shape(a) || !scene.has_shape(b) {
            return None;
        }
        let entry = scene.matrix.get(a, b);
        let (held_a, held_b) = (self.attachment_of(a), self.attachment_of(b));
        if held_a.is_none() && held_b.is_none() {
            let objects = matches!((a, b), (GeometryId::Object(_), GeometryId::Object(_)));
            let is_pair = |e: &&PairEntry| !objects || matches!(e.reason, Reason::ByHand(_));
            return entry.filter(is_pair).map(|e| (e.state, e.reason.clone()));
        }
        if let Some(e) = entry.filter(|e| matches!(e.reason, Reason::ByHand(_))) {
            return Some((e.state, e.reason.clone()));
        }
        let skipped = |reason| Some((PairState::Skipped, reason));
        for (held, other) in [(held_a, b), (held_b, a)] {
            let Some(held) = held else { continue };
            if let Some((robot, link)) = self.carrier(other).filter(|c| *c == (held.robot, held.link)) {
                return skipped(Reason::Attached(scene.link_name(robot, link)));
            }
            if let GeometryId::Link { robot, link } = other
                && held.may_touch(robot, link)
            {
                return skipped(Reason::MayTouch(scene.link_name(robot, link)));
            }
        }
        if !self.joint_between(scene, a, b) {
            return skipped(Reason::NoJointBetween);
        }
        Some((PairState::Tested, Reason::Default))
    }

    /// True if a joint moves one geometry against the other.
    fn joint_between(&self, scene: &Scene, a: GeometryId, b: GeometryId) -> bool {
        let chain = |r: RobotId| &scene.robots[r.0].robot.chain;
        match (self.carrier(a), self.carrier(b)) {
            (Some((ra, la)), Some((rb, lb))) if ra == rb => {
                chain(ra).joints_between(la, lb).iter().any(|j| chain(ra).joints()[j.0].kind.moves())
            }
            (a, b) => [a, b].into_iter().flatten().any(|(r, l)| chain(r).is_movable(l)),
        }
    }

    fn check_attach(&self, scene: &Scene, object: ObjectId, attachment: &Attachment) -> Result<(), SceneError> {
        let (objects, robots) = (scene.objects.len(), scene.robots.len());
        let o = scene.objects.get(object.0).ok_or(SceneError::NoSuchObject { index: object.0, count: objects })?;
        let own = attachment.touch_links.iter().chain([&attachment.link]).map(|link| (attachment.robot, *link));
        for (robot, link) in own.chain(attachment.visiting_links.iter().copied()) {
            let r = scene.robots.get(robot.0).ok_or(SceneError::NoSuchRobot { index: robot.0, count: robots })?;
            let count = r.robot.chain.links().len();
            if link.0 >= count {
                return Err(SceneError::NoSuchLink { robot: r.name.clone(), index: link.0, count });
            }
        }
        if let Some(a) = &self.attached[object.0] {
            let link = scene.link_name(a.robot, a.link);
            return Err(SceneError::AlreadyAttached { object: o.name.clone(), link });
        }
        Ok(())
    }
}
