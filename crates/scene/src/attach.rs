//! Grasping, letting go, changing tools: objects that are part of a link for a while.

use elbowroom_kinematics::LinkId;
use elbowroom_spatial::Pose;

use crate::pairs::{is_moved, joints_between};
use crate::{Member, PairState, Reason, Scene, SceneError, SceneState};

/// How an object is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Attachment {
    /// Index of the robot.
    pub robot: usize,
    /// The link that holds it.
    pub link: LinkId,
    /// Where the object's frame is in the link's.
    pub in_link: Pose,
    /// Links of the robot that may touch it, such as fingers.
    pub may_touch: Vec<LinkId>,
}

impl SceneState {
    /// Makes an object part of a link, where it is now: it moves with the link from then on, and is tested against the
    /// other links, except `may_touch`, and against the other objects. Its padding and hand edits of its pairs stay.
    ///
    /// ```
    /// use elbowroom_kinematics::LinkId;
    /// use elbowroom_scene::{Member, SceneState, example};
    /// use elbowroom_spatial::Vec3;
    /// let scene = example::two_arms();
    /// let part = scene.objects().iter().position(|o| o.name == "part").unwrap();
    /// let mut state = SceneState::new(&scene);
    /// let before = state.pose(&scene, Member::Object(part)).unwrap();
    /// state.attach(&scene, part, 0, LinkId(3), &[])?;
    /// state.set_q(&scene, 0, &[1.0, 0.0, 0.0])?;
    /// let after = state.pose(&scene, Member::Object(part)).unwrap();
    /// assert!(after.translation.distance(before.translation) > 0.1);
    /// state.detach(&scene, part)?; // stays there
    /// state.set_q(&scene, 0, &[0.0, 0.0, 0.0])?;
    /// assert_eq!(state.pose(&scene, Member::Object(part)), Some(after));
    /// # Ok::<(), elbowroom_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// No such object, robot or link, or the object is attached already.
    pub fn attach(
        &mut self,
        scene: &Scene,
        object: usize,
        robot: usize,
        link: LinkId,
        may_touch: &[LinkId],
    ) -> Result<(), SceneError> {
        self.check_attach(scene, object, robot, link, may_touch)?;
        let in_link = self.link_in_world(scene, robot, link).inverse_mul(&self.in_world[scene.first_object + object]);
        self.attach_at(scene, object, robot, link, in_link, may_touch)
    }

    /// Like [`SceneState::attach`], putting the object's frame to `in_link` of the link: a tool in its changer.
    ///
    /// # Errors
    /// As there, or a pose that is not finite.
    pub fn attach_at(
        &mut self,
        scene: &Scene,
        object: usize,
        robot: usize,
        link: LinkId,
        in_link: Pose,
        may_touch: &[LinkId],
    ) -> Result<(), SceneError> {
        self.check_attach(scene, object, robot, link, may_touch)?;
        if !in_link.is_finite() {
            return Err(SceneError::PoseNotFinite(format!("`{}`", scene.objects[object].name)));
        }
        self.attached[object] = Some(Attachment { robot, link, in_link, may_touch: may_touch.to_vec() });
        self.rearranged();
        self.carry(scene, robot);
        self.enclose(scene, robot);
        Ok(())
    }

    /// Lets go of an object: it stays where it is now.
    ///
    /// # Errors
    /// No such object, or it is not attached.
    pub fn detach(&mut self, scene: &Scene, object: usize) -> Result<(), SceneError> {
        let count = scene.objects.len();
        let o = scene.objects.get(object).ok_or(SceneError::NoSuchObject { index: object, count })?;
        let held = self.attached[object].take().ok_or_else(|| SceneError::NotAttached(o.name.clone()))?;
        self.displaced[object] = self.in_world[scene.first_object + object] != o.in_world;
        self.rearranged();
        self.enclose(scene, held.robot);
        Ok(())
    }

    /// How an object is held; `None` where it is not.
    pub fn attachment(&self, object: usize) -> Option<&Attachment> {
        self.attached.get(object)?.as_ref()
    }

    /// Whether a pair counts now, and why: the [pair matrix](Scene::pairs), and what attachments make of it. `None`
    /// where there is no such pair, as for two objects of which none is attached.
    pub fn pair(&self, scene: &Scene, a: Member, b: Member) -> Option<(PairState, Reason)> {
        if a == b || !scene.solid(a) || !scene.solid(b) {
            return None;
        }
        let entry = scene.pairs.get(a, b);
        let (held_a, held_b) = (self.held(a), self.held(b));
        if held_a.is_none() && held_b.is_none() {
            return entry.map(|e| (e.state, e.reason.clone()));
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
            if let Member::Link { robot, link } = other
                && robot == held.robot
                && held.may_touch.contains(&link)
            {
                return skipped(Reason::MayTouch(scene.link_name(robot, link)));
            }
        }
        if !self.moves(scene, a, b) {
            return skipped(Reason::NoJointBetween);
        }
        Some((PairState::Tested, Reason::Default))
    }

    /// True where a joint moves one against the other.
    fn moves(&self, scene: &Scene, a: Member, b: Member) -> bool {
        let chain = |r: usize| &scene.robots[r].robot.chain;
        match (self.carrier(a), self.carrier(b)) {
            (Some((ra, la)), Some((rb, lb))) if ra == rb => {
                joints_between(chain(ra), la, lb).iter().any(|j| chain(ra).joints()[j.0].kind.moves())
            }
            (a, b) => [a, b].into_iter().flatten().any(|(r, l)| is_moved(chain(r), l)),
        }
    }

    pub(crate) fn held(&self, member: Member) -> Option<&Attachment> {
        match member {
            Member::Object(o) => self.attachment(o),
            Member::Link { .. } => None,
        }
    }

    /// Robot and link that the member moves with.
    pub(crate) fn carrier(&self, member: Member) -> Option<(usize, LinkId)> {
        match member {
            Member::Link { robot, link } => Some((robot, link)),
            Member::Object(o) => self.attachment(o).map(|a| (a.robot, a.link)),
        }
    }

    /// Moves what a robot carries to where its links are.
    pub(crate) fn carry(&mut self, scene: &Scene, robot: usize) {
        for object in 0..self.attached.len() {
            let Some(a) = self.attached[object].as_ref().filter(|a| a.robot == robot) else { continue };
            let in_world = self.link_in_world(scene, robot, a.link) * a.in_link;
            self.put(scene, scene.first_object + object, in_world);
        }
    }

    fn check_attach(
        &self,
        scene: &Scene,
        object: usize,
        robot: usize,
        link: LinkId,
        may_touch: &[LinkId],
    ) -> Result<(), SceneError> {
        let (objects, robots) = (scene.objects.len(), scene.robots.len());
        let o = scene.objects.get(object).ok_or(SceneError::NoSuchObject { index: object, count: objects })?;
        let r = scene.robots.get(robot).ok_or(SceneError::NoSuchRobot { index: robot, count: robots })?;
        let count = r.robot.chain.links().len();
        if let Some(bad) = may_touch.iter().chain([&link]).find(|l| l.0 >= count) {
            return Err(SceneError::NoSuchLink { robot: r.name.clone(), index: bad.0, count });
        }
        if let Some(a) = &self.attached[object] {
            let link = scene.link_name(a.robot, a.link);
            return Err(SceneError::AlreadyAttached { object: o.name.clone(), link });
        }
        Ok(())
    }
}
