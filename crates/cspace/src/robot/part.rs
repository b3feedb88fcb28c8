//! The robot in pieces, each with the joints that move it.

use std::sync::Arc;

use elbowroom_kinematics::{ChainState, JointId, JointKind, LinkId};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_scene::Robot;
use elbowroom_spatial::{Pose, Vec3};

use super::joints::{Drive, Hanging, Mover, RobotMapError};
use super::pieces::{self, Piece, Soup};
use super::swept;
use crate::Obstacle;

/// Size of a piece as a share of how far it is from the farthest axis: what turning adds to its motion is as small a
/// share of the whole.
const SHARE: f64 = 0.15;

/// Points of a piece that may be found deep inside something.
const POINTS: usize = 6;

/// A piece of the robot.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub shape: Shape,
    /// The link that it moves with.
    pub link: LinkId,
    pub in_link: Pose,
    /// A ball around it, in the link's frame.
    pub center: Vec3,
    pub radius: f64,
    /// Number of axes, counted from the first, that can move it: in all others it stays where it is.
    pub depth: usize,
    pub movers: Vec<Mover>,
    /// Some points of it, in the link's frame, far apart.
    pub points: Vec<Vec3>,
    /// Per mover: farther from its axis no point of the piece ever is, metres.
    pub levers: Vec<f64>,
}

impl Part {
    /// A piece that hangs on some joints, placed in the frame of the last one's child; `None` where it reaches too far.
    fn of(drive: &Drive, piece: Piece, movers: &[Mover]) -> Option<Self> {
        let reach = piece.center.length() + piece.radius;
        if !(reach <= Obstacle::FARTHEST_M) {
            return None;
        }
        let link = movers.last()?.child;
        let levers = levers(drive, link, reach, movers)?;
        let depth = 1 + movers.iter().map(|m| m.axis).max()?;
        let points = piece.points(POINTS);
        let Piece { shape, in_solid: in_link, center, radius } = piece;
        Some(Self { shape, link, in_link, center, radius, depth, movers: movers.to_vec(), points, levers })
    }
}

/// A closed mesh, whole: it can hold something inside that does not touch its surface.
#[derive(Debug, Clone)]
pub(super) struct Hollow {
    pub mesh: Arc<TriMesh>,
    pub part: Part,
}

/// All pieces of the links that the map moves.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts {
    pub pieces: Vec<Part>,
    pub hollows: Vec<Hollow>,
    /// What joints carry that may be anywhere, and none of the map's before them: solids in the world.
    pub still: Vec<(Shape, Pose)>,
}

/// What moves as one: everything that hangs on the same joints of the map.
#[derive(Debug, Default)]
struct Rigid {
    movers: Vec<Mover>,
    /// Flat-sided solids together, in the frame of the last joint's child.
    soup: Soup,
    round: Vec<(Shape, Pose)>,
}

impl Parts {
    pub fn of(robot: &Robot, drive: &Drive) -> Result<Self, RobotMapError> {
        let mut all = Self::default();
        let mut rigid: Vec<Rigid> = Vec::new();
        let state = drive.state();
        for (link, hanging) in drive.links.iter().enumerate() {
            let Some(last) = hanging.movers.last() else {
                all.add_still(robot, drive, link)?;
                continue;
            };
            let on = |m: &Rigid| m.movers.last().is_some_and(|m| m.child == last.child);
            let at = rigid.iter().position(on).unwrap_or_else(|| {
                rigid.push(Rigid { movers: hanging.movers.clone(), ..Rigid::default() });
                rigid.len() - 1
            });
            for body in &robot.bodies[link] {
                let refuse = || RobotMapError::Place(format!("link `{}`", drive.chain.links()[link]));
                if !body.in_link.is_finite() || body.shape.validate().is_err() {
                    return Err(refuse());
                }
                let (shape, in_carrier) = match hanging.loose.as_slice() {
                    [] => (body.shape.clone(), body.in_link),
                    loose => swept::enclose(&body.shape, body.in_link, loose).ok_or_else(refuse)?,
                };
                let carrier = if hanging.loose.is_empty() { LinkId(link) } else { hanging.carrier };
                let in_last = between(&state, last.child, carrier) * in_carrier;
                all.take(drive, &mut rigid[at], &pieces::solid(&shape), in_last).ok_or_else(refuse)?;
            }
        }
        for rigid in rigid {
            let link = rigid.movers.last().map_or(String::new(), |m| drive.chain.links()[m.child.0].clone());
            all.cut(drive, rigid).ok_or_else(|| RobotMapError::Place(format!("what hangs on link `{link}`")))?;
        }
        Ok(all)
    }

    /// A link that the map does not move and other joints do: wherever they have it.
    fn add_still(&mut self, robot: &Robot, drive: &Drive, link: usize) -> Result<(), RobotMapError> {
        let Hanging { loose, carrier, .. } = &drive.links[link];
        if loose.is_empty() {
            return Ok(());
        }
        let carrier_in_world = drive.link_in_world(&drive.state(), *carrier);
        for body in &robot.bodies[link] {
            let refuse = || RobotMapError::Place(format!("link `{}`", drive.chain.links()[link]));
            let (shape, in_carrier) = swept::enclose(&body.shape, body.in_link, loose).ok_or_else(refuse)?;
            self.still.push((shape, carrier_in_world * in_carrier));
        }
        Ok(())
    }

    fn take(&mut self, drive: &Drive, rigid: &mut Rigid, shape: &Shape, in_last: Pose) -> Option<()> {
        let Shape::Mesh(mesh) = shape else {
            rigid.round.push((shape.clone(), in_last));
            return Some(());
        };
        rigid.soup.add(mesh, &in_last);
        if mesh.has_inside() {
            let part = Part::of(drive, Piece::of(shape.clone()).placed(&in_last), &rigid.movers)?;
            self.hollows.push(Hollow { mesh: Arc::clone(mesh), part });
        }
        Some(())
    }

    fn cut(&mut self, drive: &Drive, rigid: Rigid) -> Option<()> {
        let Rigid { movers, soup, round } = rigid;
        let link = movers.last()?.child;
        let far = levers(drive, link, 0.0, &movers)?.into_iter().fold(0.0, f64::max);
        let size = |reach: f64| SHARE * (far + reach);
        let small = size(soup.reach());
        let mut found = soup.cut(small)?;
        for (shape, in_link) in round {
            let reach = Piece::of(shape.clone()).radius + in_link.translation.length();
            found.extend(pieces::cut_round(&shape, size(reach)).into_iter().map(|p| p.placed(&in_link)));
        }
        for piece in found {
            self.pieces.push(Part::of(drive, piece, &movers)?);
        }
        Some(())
    }
}

/// Where a link is in another, joints as they are.
fn between(state: &ChainState, frame: LinkId, link: LinkId) -> Pose {
    state.link_in_root(frame).inverse_mul(&state.link_in_root(link))
}

/// How far points within `reach` of a link's origin can be from the axes of the joints above, metres.
fn levers(drive: &Drive, link: LinkId, reach: f64, movers: &[Mover]) -> Option<Vec<f64>> {
    let mut out = vec![0.0; movers.len()];
    let mut far = reach;
    for id in drive.chain.path(link).into_iter().rev() {
        let joint = &drive.chain.joints()[id.0];
        if let Some(at) = movers.iter().position(|m| m.child == joint.child) {
            out[at] = far;
        }
        if joint.kind == JointKind::Prismatic {
            far += slide(drive, id);
        }
        far += joint.origin.translation.length();
    }
    far.is_finite().then_some(out)
}

/// The longest that a slide can be, metres.
fn slide(drive: &Drive, id: JointId) -> f64 {
    let mimic = drive.chain.mimic_source(id);
    let source = mimic.map_or(id, |m| m.joint);
    let limits = drive.chain.joints()[source.0].limits;
    let ends = match drive.chain.q_index(source) {
        Some(value) if !drive.joints.contains(&value) => [drive.held[value]; 2],
        _ => [limits.lower, limits.upper],
    };
    let (multiplier, offset) = mimic.map_or((1.0, 0.0), |m| (m.multiplier, m.offset));
    ends.map(|value| (multiplier * value + offset).abs()).into_iter().fold(0.0, f64::max)
}
