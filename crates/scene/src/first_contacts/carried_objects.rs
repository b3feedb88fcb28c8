//! Objects that a robot carries: they move with a link, and meet objects too.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::{Shape, penetration};
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_spatial::{Pose, Vec3};

use super::{FirstContacts, PlacedGeometry, TrackedPair};
use crate::Attachment;

/// A contact that is permitted while a part is lifted off or set down counts from this penetration depth on, m.
const SET_DOWN_DEPTH: f64 = 1e-3;

/// How a robot carries an object.
#[derive(Debug, Clone)]
pub(super) struct HeldObject {
    attachment: Attachment,
    /// Radius around the link's origin that holds the object, m.
    radius: f64,
    /// True while it is set down: it may touch objects.
    set_down: bool,
}

impl HeldObject {
    pub(super) fn in_world(&self, robots: &[(&Robot, Pose)], states: &[&ChainState]) -> Pose {
        let Attachment { robot, link, in_link, .. } = &self.attachment;
        robots[robot.0].1 * states[robot.0].link_in_root(*link) * *in_link
    }
}

/// The link that moves a geometry, and a radius (m) around the link's origin that holds the geometry.
pub(super) struct Carrier {
    pub robot: RobotId,
    pub link: LinkId,
    pub radius: f64,
}

impl Carrier {
    pub(super) fn of(id: GeometryId, robots: &[(&Robot, Pose)], held: &[Option<HeldObject>]) -> Option<Self> {
        match id {
            GeometryId::Link { robot, link } => Some(Self { robot, link, radius: robots[robot.0].0.link_radius(link) }),
            GeometryId::Object(o) => held[o.0].as_ref().map(|h| {
                let Attachment { robot, link, .. } = h.attachment;
                Self { robot, link, radius: h.radius }
            }),
        }
    }
}

impl FirstContacts<'_> {
    /// Attaches an object to a link from the last [`check`](Self::check) on. It is checked against all links but those that
    /// may touch it, and against all objects. What it touches now does not begin to touch: such a contact counts once it has
    /// separated, or is 1 mm deeper than now. The object no longer moves by itself.
    pub fn attach(&mut self, object: ObjectId, attachment: Attachment, states: &[&ChainState]) {
        let shape = &self.objects[object.0].shape;
        let radius = shape.aabb(&attachment.in_link).max_distance(Vec3::ZERO);
        self.held[object.0] = Some(HeldObject { attachment, radius, set_down: false });
        self.place_held(states);
        self.renew_pairs(object, states);
    }

    /// Detaches an object: it stays where it was at the last [`check`](Self::check).
    pub fn detach(&mut self, object: ObjectId, states: &[&ChainState]) {
        self.held[object.0] = None;
        self.renew_pairs(object, states);
    }

    /// How an object is attached; `None` where it is not.
    pub fn attachment(&self, object: ObjectId) -> Option<&Attachment> {
        self.held[object.0].as_ref().map(|h| &h.attachment)
    }

    /// Whether an attached object is being set down: it may touch objects, up to a depth of 1 mm.
    pub fn set_down(&mut self, object: ObjectId, set_down: bool) {
        if let Some(held) = &mut self.held[object.0] {
            held.set_down = set_down;
        }
    }

    /// Pose of an object at the last [`check`](Self::check), in the world.
    pub fn object_in_world(&self, object: ObjectId) -> Pose {
        self.placed[object.0].0
    }

    pub(super) fn place_held(&mut self, states: &[&ChainState]) {
        for (o, held) in self.held.iter().enumerate() {
            let Some(held) = held else { continue };
            let pose = held.in_world(&self.robots, states);
            self.placed[o] = (pose, self.object_boxes[o].transformed(&pose));
        }
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
        let Self { robots, objects, boxes, placed, held, .. } = self;
        let now = PlacedGeometry { robots, objects, boxes, placed, states };
        let pairs = partners.into_iter().map(|other| {
            // Links are named first, as in all other pairs.
            let (a, b) = if matches!(other, GeometryId::Link { .. }) { (other, id) } else { (id, other) };
            let mut pair = TrackedPair::new(robots, held, a, b);
            let moves = |o: ObjectId| GeometryId::Object(o) == other && held[o.0].is_none();
            pair.moving_object = moving.iter().copied().find(|(o, _)| moves(*o));
            let gap = now.gap(a, b);
            pair.resting = gap.is_none();
            pair.allowed_depth = pair.resting.then(|| now.depth(a, b) + SET_DOWN_DEPTH);
            pair.measured(states, gap);
            pair
        });
        let pairs: Vec<_> = pairs.collect();
        self.pairs.extend(pairs);
    }

    fn may_meet(&self, object: ObjectId, robot: RobotId, link: LinkId) -> bool {
        match self.held[object.0].as_ref().map(|h| &h.attachment) {
            Some(a) => a.robot != robot || (a.link != link && !a.touch_links.contains(&link)),
            None => self.robots[robot.0].0.chain.is_movable(link),
        }
    }
}

impl TrackedPair {
    /// True where a resting pair is deeper in contact than is permitted.
    pub(super) fn is_too_deep(&self, now: &PlacedGeometry<'_, '_>) -> bool {
        self.allowed_depth.is_some_and(|allowed| !(now.depth(self.a, self.b) <= allowed))
    }

    /// True where the contact is that of a part with what it is set down on; the pair rests from then on.
    pub(super) fn is_set_down(&mut self, held: &[Option<HeldObject>], now: &PlacedGeometry<'_, '_>) -> bool {
        let (GeometryId::Object(a), GeometryId::Object(b)) = (self.a, self.b) else { return false };
        let is_set_down = [a, b].iter().any(|o| held[o.0].as_ref().is_some_and(|h| h.set_down));
        if is_set_down && now.depth(self.a, self.b) <= SET_DOWN_DEPTH {
            (self.resting, self.allowed_depth) = (true, Some(SET_DOWN_DEPTH));
        }
        self.resting
    }
}

impl PlacedGeometry<'_, '_> {
    /// The largest penetration depth of two geometries in contact, m; of meshes, that of their hulls.
    fn depth(&self, a: GeometryId, b: GeometryId) -> f64 {
        let solids = |id| (0..self.shape_count(id)).map(move |i| (id, i));
        let pairs = solids(a).flat_map(|a| solids(b).map(move |b| (a, b)));
        let depth = |((a, i), (b, k))| {
            let ((a, pose_a, _), (b, pose_b, _)): ((&Shape, Pose, _), (&Shape, Pose, _)) =
                (self.shape(a, i), self.shape(b, k));
            penetration(a, &pose_a, b, &pose_b).map_or(0.0, |p| p.depth)
        };
        pairs.map(depth).fold(0.0, f64::max)
    }
}
