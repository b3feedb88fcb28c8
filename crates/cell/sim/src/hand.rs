//! The hand of a robot, and how it grips parts.

use std::fmt;

use elbowroom_cell::{Cell, CellRobot, Units};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::{Shape, Sphere, collides, separation};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;
use elbowroom_spatial::Pose;

/// Largest distance from the hand at which a part can be gripped, m.
pub(crate) const MAX_GRIP_DISTANCE_M: f64 = 0.05;

/// The hand of a robot: the flange link, the links fixed to it, and the fingers that it carries.
pub(crate) struct Hand<'a> {
    robot: &'a CellRobot,
    links: Vec<LinkId>,
}

impl<'a> Hand<'a> {
    pub(crate) fn of(robot: &'a CellRobot) -> Self {
        Self { robot, links: robot.hand_links() }
    }

    /// Distance (m) from a part to the nearest solid of the hand, or to the TCP if that is nearer.
    pub(crate) fn distance_m(&self, state: &ChainState, part: &Shape, part_in_world: &Pose) -> f64 {
        let tcp = self.link_in_world(state, self.robot.flange) * self.robot.tcp_in_flange;
        let point = Shape::Sphere(Sphere { radius: 0.0 });
        let to_tcp = separation(&point, &tcp, part, part_in_world).distance;
        let solids = self.links.iter().flat_map(|link| {
            let link_in_world = self.link_in_world(state, *link);
            self.robot.robot.colliders[link.0].iter().map(move |c| (&c.shape, link_in_world * c.in_link))
        });
        let to_solid = |(shape, in_world)| separation(shape, &in_world, part, part_in_world).distance;
        solids.map(to_solid).fold(to_tcp, f64::min)
    }

    /// Attachment of a part at its present pose. The hand, and the links that touch the part now, may touch it.
    pub(crate) fn attachment(&self, id: RobotId, state: &ChainState, part: &Shape, part_in_world: &Pose) -> Attachment {
        let robot = &self.robot.robot;
        let touches = |link: LinkId| {
            let in_world = self.link_in_world(state, link);
            robot.colliders[link.0].iter().any(|c| collides(&c.shape, &(in_world * c.in_link), part, part_in_world))
        };
        let touch_links = robot.links_with_colliders().filter(|l| self.links.contains(l) || touches(*l)).collect();
        let flange_in_world = self.link_in_world(state, self.robot.flange);
        let in_link = flange_in_world.inverse_mul(part_in_world);
        Attachment { robot: id, link: self.robot.flange, in_link, touch_links, visiting_links: Vec::new() }
    }

    fn link_in_world(&self, state: &ChainState, link: LinkId) -> Pose {
        self.robot.base_in_world * state.link_in_root(link)
    }
}

/// A part that is too far from the hand to be gripped.
#[derive(Debug)]
pub(crate) struct OutOfGrip {
    part: String,
    distance_m: f64,
    /// Units of the message.
    units: Units,
}

impl fmt::Display for OutOfGrip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let show = |metres: f64| self.units.show_length((metres * 1e4).round() / 1e4);
        let [distance, limit] = [self.distance_m, MAX_GRIP_DISTANCE_M].map(show);
        write!(
            f,
            "grips \"{}\", which is {distance} from the flange, the tool and the TCP: at most {limit} is within grip",
            self.part
        )
    }
}

/// Attachment of a part at `part_in_world` that a robot grips with its present tool.
///
/// # Errors
/// [`OutOfGrip`] if the part is too far from the hand.
pub(crate) fn grip(
    cell: &Cell,
    id: RobotId,
    robot: &CellRobot,
    object: ObjectId,
    part_in_world: &Pose,
    state: &ChainState,
) -> Result<Attachment, OutOfGrip> {
    let (hand, part) = (Hand::of(robot), &cell.objects[object.0]);
    let distance_m = hand.distance_m(state, &part.shape, part_in_world);
    if distance_m > MAX_GRIP_DISTANCE_M {
        return Err(OutOfGrip { part: part.name.clone(), distance_m, units: cell.units });
    }
    Ok(hand.attachment(id, state, &part.shape, part_in_world))
}
