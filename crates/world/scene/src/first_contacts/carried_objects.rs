//! Attaching objects to links and detaching them during a simulation.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_spatial::{Pose, Vec3};

use super::held_object::HeldObject;
use super::{FirstContacts, PlacedGeometry, TrackedPair};
use crate::Attachment;

impl FirstContacts<'_> {
    /// Attaches an object to a link, effective from the last [`check`](Self::check).
    ///
    /// The object is checked against all objects and all links except those that may touch it. It no longer moves by
    /// itself. A pair that touches already counts as a new contact only after it has separated, or if it is 1 mm deeper
    /// than now.
    pub fn attach(&mut self, object: ObjectId, attachment: Attachment, states: &[&ChainState]) {
        let shape = &self.objects[object.0].shape;
        let radius = shape.aabb(&attachment.in_link).max_distance(Vec3::ZERO);
        self.held[object.0] = Some(HeldObject { attachment, radius, set_down: false });
        self.place_held(states);
        self.renew_pairs(object, states);
    }

    /// Detaches an object. It stays at its pose of the last [`check`](Self::check).
    pub fn detach(&mut self, object: ObjectId, states: &[&ChainState]) {
        self.held[object.0] = None;
        self.renew_pairs(object, states);
    }

    /// The attachment of an object; `None` if it is not attached.
    pub fn attachment(&self, object: ObjectId) -> Option<&Attachment> {
        self.held[object.0].as_ref().map(|h| &h.attachment)
    }

    /// Sets whether an attached object is being set down: it may then touch objects, up to a depth of 1 mm.
    pub fn set_down(&mut self, object: ObjectId, set_down: bool) {
        if let Some(held) = &mut self.held[object.0] {
            held.set_down = set_down;
        }
    }

    /// Pose of an object at the last [`check`](Self::check), in the world.
    pub fn object_in_world(&self, object: ObjectId) -> Pose {
        self.placed[object.0].0
    }

    fn renew_pairs(&mut self, object: ObjectId, states: &[&ChainState]) {
        let id = GeometryId::Object(object);
        let moving: Vec<_> = self.pairs.iter().filter_map(|p| p.moving_object).collect();
        self.pairs.retain(|p| p.a != id && p.b != id);
        let links = (0..self.robots.len()).flat_map(|r| {
            let robot = RobotId(r);
            self.robots[r].0.links_with_colliders().map(move |link| (robot, link))
        });
        let links = links.filter(|(r, l)| self.may_meet(object, *r, *l));
        let mut partners: Vec<_> = links.map(|(robot, link)| GeometryId::Link { robot, link }).collect();
        let is_held = |o: usize| self.held[o].is_some();
        let others = (0..self.objects.len()).filter(|o| *o != object.0 && (is_held(*o) || is_held(object.0)));
        partners.extend(others.map(|o| GeometryId::Object(ObjectId(o))));
        partners.retain(|other| self.rules.skipped(id, *other).is_none());
        let Self { robots, objects, boxes, placed, held, .. } = self;
        let now = PlacedGeometry { robots, objects, boxes, placed, states };
        let pairs = partners.into_iter().map(|other| {
            // Links come first, as in all other pairs.
            let (a, b) = if matches!(other, GeometryId::Link { .. }) { (other, id) } else { (id, other) };
            let mut pair = TrackedPair::new(robots, held, a, b);
            let moves = |o: ObjectId| GeometryId::Object(o) == other && held[o.0].is_none();
            pair.moving_object = moving.iter().copied().find(|(o, _)| moves(*o));
            pair.rest_where_in_contact(&now);
            pair
        });
        let pairs: Vec<_> = pairs.collect();
        self.pairs.extend(pairs);
    }

    fn may_meet(&self, object: ObjectId, robot: RobotId, link: LinkId) -> bool {
        match self.held[object.0].as_ref().map(|h| &h.attachment) {
            Some(a) => (a.robot, a.link) != (robot, link) && !a.may_touch(robot, link),
            None => self.robots[robot.0].0.chain.is_movable(link),
        }
    }
}
