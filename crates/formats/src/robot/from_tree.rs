//! Robots out of node trees: every node is a link, and what moves is said by tracks, by a file of joints, or by options.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::Shape;
use elbowroom_scene::{Body, Robot};
use elbowroom_spatial::{Pose, Vec3};

use super::ask;
use super::motion::{Found, Motion, motion, show};
use crate::error::Warnings;
use crate::joints::{AxisFrame, JointSpec};
use crate::names::Names;
use crate::nodetree::NodeTree;
use crate::{FormatError, Warning};

/// More links than any robot has, and than a pair matrix should.
pub const MOST_LINKS: usize = 2000;

/// Two poses nearer than this (m, rad) are one.
pub(super) const SAME: f64 = 1e-9;

/// The robot of a tree. `file` is named in messages; `beside` is the file of joints that was looked for.
pub(super) fn robot(
    tree: NodeTree,
    specs: &[JointSpec],
    (file, beside): (&Path, &Path),
    warnings: &mut Warnings,
) -> Result<Robot, FormatError> {
    if tree.nodes.len() > MOST_LINKS {
        let what = format!("has {} nodes; a robot has at most {MOST_LINKS} links", tree.nodes.len());
        return Err(FormatError::new(file, None, what).hint("the robot alone, without its surroundings"));
    }
    let builder = Builder::new(tree, file);
    let moves = builder.moves(specs, warnings)?;
    if moves.iter().all(Option::is_none) && specs.is_empty() {
        warnings.extend(ask::what_moves(&builder.tree, &builder.names, file, beside));
    }
    tell_tracks(&builder, &moves, specs, file, beside, warnings);
    builder.build(&moves)
}

/// How a node moves on its parent.
#[derive(Debug, Clone)]
pub(super) struct Move {
    name: String,
    kind: JointKind,
    /// In the node's frame.
    axis: Vec3,
    /// The link's origin in the node's frame.
    at: Vec3,
    limits: Limits,
    mimic: Option<(String, f64, f64)>,
}

struct Builder<'a> {
    tree: NodeTree,
    /// Unique, one per node.
    names: Vec<String>,
    /// Of the link that carries all, where the file has none.
    own_root: String,
    frames: Vec<Pose>,
    file: &'a Path,
}

impl<'a> Builder<'a> {
    fn new(tree: NodeTree, file: &'a Path) -> Self {
        let mut taken = Names::default();
        let names = tree.nodes.iter().map(|n| taken.unique(named(&n.name))).collect();
        let own_root = taken.unique(named(&tree.name));
        let frames = tree.in_world();
        Self { tree, names, own_root, frames, file }
    }

    /// What moves each node; `None` where it is fixed.
    fn moves(&self, specs: &[JointSpec], warnings: &mut Warnings) -> Result<Vec<Option<Move>>, FormatError> {
        let size = self.tree.aabb().extent().max_element();
        let size = if size.is_finite() && size > 0.0 { size } else { 1.0 };
        let mut by_node: HashMap<usize, &JointSpec> = HashMap::new();
        for spec in specs {
            if by_node.insert(self.node(spec)?, spec).is_some() {
                return Err(spec.error(format!("`{}` is named twice", spec.node)).hint("one entry per node"));
            }
        }
        let mut moves = Vec::with_capacity(self.tree.nodes.len());
        for (i, node) in self.tree.nodes.iter().enumerate() {
            let spec = by_node.get(&i).copied();
            let found = match motion(node, size) {
                Motion::Joint(found) => Some(found),
                Motion::None => None,
                Motion::Unclear(how) => {
                    if spec.is_none_or(|s| s.axis.is_none()) {
                        let what =
                            format!("the track of `{}` is no joint's: it {how}; it is taken as fixed", self.names[i]);
                        warnings.push_with(|| {
                            Warning::new(self.file, None, what)
                                .hint("keys that turn about one axis, or the axis in a file of joints")
                        });
                    }
                    None
                }
            };
            moves.push(match spec {
                Some(spec) => self.told(i, spec, found)?,
                None => found.map(|f| self.found(i, f)),
            });
        }
        Ok(moves)
    }

    fn node(&self, spec: &JointSpec) -> Result<usize, FormatError> {
        if let Some(i) = self.names.iter().position(|n| *n == spec.node) {
            return Ok(i);
        }
        let what = format!("there is no node `{}` in {}", spec.node, self.file.display());
        let close = |n: &&String| n.eq_ignore_ascii_case(&spec.node);
        let hint = self.names.iter().find(close).map_or_else(
            || format!("one of {}", ask::listed(self.names.iter().map(String::as_str))),
            |close| format!("[joint.{}]", crate::joints::key(close)),
        );
        Err(spec.error(what).hint(hint))
    }

    fn found(&self, i: usize, found: Found) -> Move {
        let Found { kind, axis, at, lower, upper } = found;
        Move { name: self.names[i].clone(), kind, axis, at, limits: Limits::range(lower, upper), mimic: None }
    }

    /// What the user says, and for the rest the track.
    fn told(&self, i: usize, spec: &JointSpec, found: Option<Found>) -> Result<Option<Move>, FormatError> {
        let bounded = spec.min.is_some() || spec.max.is_some();
        let kind = spec.kind.or(found.map(|f| f.kind));
        let kind = kind.unwrap_or(if bounded { JointKind::Revolute } else { JointKind::Continuous });
        // Limits make a bounded joint of one whose track goes round.
        let kind =
            if kind == JointKind::Continuous && bounded && spec.kind.is_none() { JointKind::Revolute } else { kind };
        if kind == JointKind::Fixed {
            return Ok(None);
        }
        let into_node = match spec.frame {
            AxisFrame::Node => Pose::IDENTITY,
            AxisFrame::Parent => self.tree.nodes[i].in_parent.inverse(),
            AxisFrame::World => self.frames[i].inverse(),
        };
        let axis = match (spec.axis, found) {
            (Some(axis), _) => into_node.transform_vector(axis).try_normalize().unwrap_or(Vec3::Z),
            (None, Some(found)) => found.axis,
            (None, None) => {
                let what = format!("`{}` has no axis, and no track to take it from", spec.node);
                return Err(spec.error(what).hint("axis = \"z\"   (x, y, z, -x, -y, -z, or a vector: [0, 0, 1])"));
            }
        };
        let at = match (spec.at, found) {
            (Some(at), _) => into_node.transform_point(at),
            (None, Some(found)) => found.at,
            (None, None) => Vec3::ZERO,
        };
        let same_sense = found.filter(|f| (f.kind == JointKind::Prismatic) == (kind == JointKind::Prismatic));
        let end = |said: Option<f64>, track: fn(&Found) -> f64| {
            said.map(|v| spec.si(kind, v)).or(same_sense.map(|f| track(&f)))
        };
        let (lower, upper) = match (end(spec.min, |f| f.lower), end(spec.max, |f| f.upper)) {
            _ if kind == JointKind::Continuous => (f64::NEG_INFINITY, f64::INFINITY),
            (Some(lower), Some(upper)) if lower <= upper => (lower, upper),
            _ => {
                let what = format!("the joint of `{}` has no range: it needs min and max", spec.node);
                return Err(spec
                    .error(what)
                    .hint("min = -180, max = 180; or kind = \"continuous\" for endless turning"));
            }
        };
        let rate = |v: Option<f64>| v.map(|v| spec.si(kind, v));
        let limits =
            Limits { velocity: rate(spec.speed), acceleration: rate(spec.acceleration), ..Limits::range(lower, upper) };
        let name = spec.name.clone().unwrap_or_else(|| self.names[i].clone());
        let mimic = spec.mimic.as_ref().map(|(joint, m, offset)| (joint.clone(), *m, spec.si(kind, *offset)));
        Ok(Some(Move { name, kind, axis, at, limits, mimic }))
    }

    fn build(self, moves: &[Option<Move>]) -> Result<Robot, FormatError> {
        let nodes = &self.tree.nodes;
        // A link's frame is its node's, moved to the joint's axis where that is elsewhere.
        let link_in_node: Vec<Pose> =
            moves.iter().map(|m| Pose::from_translation(m.as_ref().map_or(Vec3::ZERO, |m| m.at))).collect();
        let tops: Vec<usize> = self.tree.children(None).collect();
        let is_root = |i: usize| moves[i].is_none() && apart(&nodes[i].in_parent, &Pose::IDENTITY) <= SAME;
        let own_root = !(tops.len() == 1 && is_root(tops[0]));
        let mut links = self.names.clone();
        let root = links.len();
        if own_root {
            links.push(self.own_root.clone());
        }
        let mut joints = Vec::new();
        let mut joint_names = Names::default();
        for (i, node) in nodes.iter().enumerate() {
            if node.parent.is_none() && !own_root {
                continue;
            }
            let parent_link = node.parent.map_or(Pose::IDENTITY, |p| link_in_node[p]);
            let fixed = Move {
                name: self.names[i].clone(),
                kind: JointKind::Fixed,
                axis: Vec3::X,
                at: Vec3::ZERO,
                limits: Limits::UNLIMITED,
                mimic: None,
            };
            let moved = moves[i].as_ref().unwrap_or(&fixed);
            joints.push(Joint {
                name: joint_names.unique(named(&moved.name)),
                kind: moved.kind,
                parent: LinkId(node.parent.unwrap_or(root)),
                child: LinkId(i),
                origin: parent_link.inverse_mul(&(node.in_parent * link_in_node[i])),
                axis: moved.axis,
                limits: moved.limits,
                mimic: None,
            });
        }
        self.follow(moves, &mut joints)?;
        let name = if self.tree.name.is_empty() { "model".to_owned() } else { self.tree.name.clone() };
        let chain = Chain::new(name, links, joints).map_err(|e| FormatError::new(self.file, None, e.to_string()))?;
        let mut robot = Robot::new(chain);
        for (i, node) in self.tree.nodes.into_iter().enumerate() {
            for mesh in node.meshes {
                let name = mesh.name.clone();
                let shape = Shape::Mesh(Arc::new(mesh.into_trimesh(self.file)?));
                robot.bodies[i].push(Body { name, shape, in_link: link_in_node[i].inverse() });
            }
        }
        Ok(robot)
    }

    fn follow(&self, moves: &[Option<Move>], joints: &mut [Joint]) -> Result<(), FormatError> {
        for i in 0..joints.len() {
            let Some((name, multiplier, offset)) = moves[joints[i].child.0].as_ref().and_then(|m| m.mimic.clone())
            else {
                continue;
            };
            let Some(source) = joints.iter().position(|j| j.name == name && j.kind.moves()) else {
                let what = format!("the joint `{}` follows `{name}`, which does not move or exist", joints[i].name);
                return Err(FormatError::new(self.file, None, what).hint("the name of another joint that moves"));
            };
            joints[i].mimic = Some(Mimic { joint: JointId(source), multiplier, offset });
        }
        Ok(())
    }
}

fn tell_tracks(
    builder: &Builder<'_>,
    moves: &[Option<Move>],
    specs: &[JointSpec],
    file: &Path,
    beside: &Path,
    warnings: &mut Warnings,
) {
    let said = |i: usize| specs.iter().any(|s| s.node == builder.names[i]);
    let unsaid: Vec<String> = moves
        .iter()
        .enumerate()
        .filter(|(i, _)| !said(*i))
        .filter_map(|(_, m)| {
            let Move { name, kind, axis, limits, .. } = m.as_ref()?;
            let axis = show(*axis);
            Some(match kind {
                JointKind::Prismatic => {
                    format!("`{name}` slides along {axis}, {:.4} to {:.4} m", limits.lower, limits.upper)
                }
                JointKind::Continuous => format!("`{name}` turns endlessly about {axis}"),
                _ => format!(
                    "`{name}` turns about {axis}, {:.2} to {:.2} deg",
                    limits.lower.to_degrees(),
                    limits.upper.to_degrees()
                ),
            })
        })
        .collect();
    if unsaid.is_empty() {
        return;
    }
    let what = format!(
        "joints, axes (in the node's frame) and limits are taken from the tracks; speeds are unknown: {}",
        unsaid.join("; ")
    );
    let hint = format!("where that is wrong, [joint.NODE] with axis, min, max, speed in {}", beside.display());
    warnings.push(Warning::new(file, None, what).hint(hint));
}

/// Farthest of turn (rad) and way (m) between two poses.
pub(super) fn apart(a: &Pose, b: &Pose) -> f64 {
    (a.rotation.inverse() * b.rotation).angle().max(a.translation.distance(b.translation))
}

fn named(name: &str) -> &str {
    if name.is_empty() { "node" } else { name }
}
