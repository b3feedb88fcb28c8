//! Robots from node trees: every node is a link; animation tracks, a joints file, or options define the joints.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::Shape;
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};

use super::joint_candidates::missing_joints_warning;
use super::pose_difference::{SAME_POSE, pose_difference};
use super::track_joint::{InferredJoint, TrackJoint, infer_joint, show_vector};
use crate::Diagnostic;
use crate::joints::{AxisFrame, JointSpec};
use crate::names::{UniqueNames, list_names};
use crate::nodetree::NodeTree;
use crate::warning_list::WarningList;

/// Largest number of links of a robot, which bounds the size of its allowed collision matrix.
pub const MAX_LINKS: usize = 2000;

/// Converts a tree to a robot.
///
/// `file` is named in messages; `default_path` is the joints file in which joints can be specified.
pub(super) fn robot(
    tree: NodeTree,
    specs: &[JointSpec],
    file: &Path,
    default_path: &Path,
    warnings: &mut WarningList,
) -> Result<Robot, Diagnostic> {
    if tree.nodes.len() > MAX_LINKS {
        let what = format!("has {} nodes; a robot has at most {MAX_LINKS} links", tree.nodes.len());
        return Err(Diagnostic::new(file, None, what).hint("the robot alone, without its surroundings"));
    }
    let builder = RobotBuilder::new(tree, file);
    let node_joints = builder.node_joints(specs, warnings)?;
    if node_joints.iter().all(Option::is_none) && specs.is_empty() {
        warnings.extend(missing_joints_warning(&builder.tree, &builder.names, file, default_path));
    }
    warn_of_inferred_joints(&builder, &node_joints, specs, file, default_path, warnings);
    builder.build(&node_joints)
}

/// The joint between a node and its parent.
#[derive(Debug, Clone)]
pub(super) struct NodeJoint {
    name: String,
    kind: JointKind,
    /// Axis in the node's frame.
    axis: Vec3,
    /// Origin of the link in the node's frame, m.
    at: Vec3,
    limits: Limits,
    mimic: Option<(String, f64, f64)>,
}

struct RobotBuilder<'a> {
    tree: NodeTree,
    /// Unique names, one per node.
    names: Vec<String>,
    /// Name of the root link that is added if the file has none.
    own_root: String,
    frames: Vec<Pose>,
    file: &'a Path,
}

impl<'a> RobotBuilder<'a> {
    fn new(tree: NodeTree, file: &'a Path) -> Self {
        let mut taken = UniqueNames::default();
        let names = tree.nodes.iter().map(|n| taken.unique(named(&n.name))).collect();
        let own_root = taken.unique(named(&tree.name));
        let frames = tree.in_world();
        Self { tree, names, own_root, frames, file }
    }

    /// The joint of each node; `None` if it is fixed.
    fn node_joints(
        &self,
        specs: &[JointSpec],
        warnings: &mut WarningList,
    ) -> Result<Vec<Option<NodeJoint>>, Diagnostic> {
        let size = self.tree.aabb().extent().max_element();
        let size = if size.is_finite() && size > 0.0 { size } else { 1.0 };
        let mut by_node: HashMap<usize, &JointSpec> = HashMap::new();
        for spec in specs {
            if by_node.insert(self.node(spec)?, spec).is_some() {
                return Err(spec.error(format!("`{}` is named twice", spec.node)).hint("one entry per node"));
            }
        }
        let mut node_joints = Vec::with_capacity(self.tree.nodes.len());
        for (i, node) in self.tree.nodes.iter().enumerate() {
            let spec = by_node.get(&i).copied();
            let inferred = match infer_joint(node, size) {
                TrackJoint::Joint(inferred) => Some(inferred),
                TrackJoint::None => None,
                TrackJoint::NoJoint(how) => {
                    if spec.is_none_or(|s| s.axis.is_none()) {
                        let what = format!(
                            "the track of `{}` is not that of a joint: it {how}; the node is fixed",
                            self.names[i]
                        );
                        warnings.push_with(|| {
                            Diagnostic::new(self.file, None, what)
                                .hint("keys that rotate about one axis, or the axis in a file of joints")
                        });
                    }
                    None
                }
            };
            node_joints.push(match spec {
                Some(spec) => self.specified_joint(i, spec, inferred)?,
                None => inferred.map(|f| self.inferred(i, f)),
            });
        }
        Ok(node_joints)
    }

    fn node(&self, spec: &JointSpec) -> Result<usize, Diagnostic> {
        if let Some(i) = self.names.iter().position(|n| *n == spec.node) {
            return Ok(i);
        }
        let what = format!("there is no node `{}` in {}", spec.node, self.file.display());
        let close = |n: &&String| n.eq_ignore_ascii_case(&spec.node);
        let hint = self.names.iter().find(close).map_or_else(
            || format!("one of {}", list_names(self.names.iter().map(String::as_str))),
            |close| format!("[joint.{}]", crate::joints::key(close)),
        );
        Err(spec.error(what).hint(hint))
    }

    fn inferred(&self, i: usize, inferred: InferredJoint) -> NodeJoint {
        let InferredJoint { kind, axis, at, lower, upper } = inferred;
        NodeJoint { name: self.names[i].clone(), kind, axis, at, limits: Limits::range(lower, upper), mimic: None }
    }

    /// The joint that the user specifies. The track supplies values that are not specified.
    fn specified_joint(
        &self,
        i: usize,
        spec: &JointSpec,
        inferred: Option<InferredJoint>,
    ) -> Result<Option<NodeJoint>, Diagnostic> {
        let bounded = spec.min.is_some() || spec.max.is_some();
        let kind = spec.kind.or(inferred.map(|f| f.kind));
        let kind = kind.unwrap_or(if bounded { JointKind::Revolute } else { JointKind::Continuous });
        // With limits, a joint whose track makes whole turns is bounded.
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
        let axis = match (spec.axis, inferred) {
            (Some(axis), _) => into_node.transform_vector(axis).try_normalize().unwrap_or(Vec3::Z),
            (None, Some(inferred)) => inferred.axis,
            (None, None) => {
                let what = format!("`{}` has no axis, and no track to take it from", spec.node);
                return Err(spec.error(what).hint("axis = \"z\"   (x, y, z, -x, -y, -z, or a vector: [0, 0, 1])"));
            }
        };
        let at = match (spec.at, inferred) {
            (Some(at), _) => into_node.transform_point(at),
            (None, Some(inferred)) => inferred.at,
            (None, None) => Vec3::ZERO,
        };
        let same_sense = inferred.filter(|f| (f.kind == JointKind::Prismatic) == (kind == JointKind::Prismatic));
        let end = |is_specified: Option<f64>, track: fn(&InferredJoint) -> f64| {
            is_specified.map(|v| spec.si(kind, v)).or(same_sense.map(|f| track(&f)))
        };
        let (lower, upper) = match (end(spec.min, |f| f.lower), end(spec.max, |f| f.upper)) {
            _ if kind == JointKind::Continuous => (f64::NEG_INFINITY, f64::INFINITY),
            (Some(lower), Some(upper)) if lower <= upper => (lower, upper),
            _ => {
                let what = format!("the joint of `{}` has no range: it needs min and max", spec.node);
                return Err(spec
                    .error(what)
                    .hint("min = -180, max = 180; or kind = \"continuous\" for unlimited rotation"));
            }
        };
        let rate = |v: Option<f64>| v.map(|v| spec.si(kind, v));
        let limits =
            Limits { velocity: rate(spec.speed), acceleration: rate(spec.acceleration), ..Limits::range(lower, upper) };
        let name = spec.name.clone().unwrap_or_else(|| self.names[i].clone());
        let mimic = spec.mimic.as_ref().map(|(joint, m, offset)| (joint.clone(), *m, spec.si(kind, *offset)));
        Ok(Some(NodeJoint { name, kind, axis, at, limits, mimic }))
    }

    fn build(self, node_joints: &[Option<NodeJoint>]) -> Result<Robot, Diagnostic> {
        let nodes = &self.tree.nodes;
        // The frame of a link is the frame of its node, translated to the axis of the joint.
        let link_in_node: Vec<Pose> =
            node_joints.iter().map(|m| Pose::from_translation(m.as_ref().map_or(Vec3::ZERO, |m| m.at))).collect();
        let tops: Vec<usize> = self.tree.children(None).collect();
        let is_root =
            |i: usize| node_joints[i].is_none() && pose_difference(&nodes[i].in_parent, &Pose::IDENTITY) <= SAME_POSE;
        let own_root = !(tops.len() == 1 && is_root(tops[0]));
        let mut links = self.names.clone();
        let root = links.len();
        if own_root {
            links.push(self.own_root.clone());
        }
        let mut joints = Vec::new();
        let mut joint_names = UniqueNames::default();
        for (i, node) in nodes.iter().enumerate() {
            if node.parent.is_none() && !own_root {
                continue;
            }
            let parent_link = node.parent.map_or(Pose::IDENTITY, |p| link_in_node[p]);
            let fixed = NodeJoint {
                name: self.names[i].clone(),
                kind: JointKind::Fixed,
                axis: Vec3::X,
                at: Vec3::ZERO,
                limits: Limits::UNLIMITED,
                mimic: None,
            };
            let moved = node_joints[i].as_ref().unwrap_or(&fixed);
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
        self.set_mimics(node_joints, &mut joints)?;
        let name = if self.tree.name.is_empty() { "model".to_owned() } else { self.tree.name.clone() };
        let chain = Chain::new(name, links, joints).map_err(|e| Diagnostic::new(self.file, None, e))?;
        let mut robot = Robot::new(chain);
        for (i, node) in self.tree.nodes.into_iter().enumerate() {
            for mesh in node.meshes {
                let name = mesh.name.clone();
                let shape = Shape::Mesh(Arc::new(mesh.into_trimesh(self.file)?));
                robot.colliders[i].push(Collider { name, shape, in_link: link_in_node[i].inverse() });
            }
        }
        Ok(robot)
    }

    fn set_mimics(&self, node_joints: &[Option<NodeJoint>], joints: &mut [Joint]) -> Result<(), Diagnostic> {
        for i in 0..joints.len() {
            let Some((name, multiplier, offset)) =
                node_joints[joints[i].child.0].as_ref().and_then(|m| m.mimic.clone())
            else {
                continue;
            };
            let Some(source) = joints.iter().position(|j| j.name == name && j.kind.moves()) else {
                let what = format!("the joint `{}` follows `{name}`, which does not move or exist", joints[i].name);
                return Err(Diagnostic::new(self.file, None, what).hint("the name of another joint that moves"));
            };
            joints[i].mimic = Some(Mimic { joint: JointId(source), multiplier, offset });
        }
        Ok(())
    }
}

fn warn_of_inferred_joints(
    builder: &RobotBuilder<'_>,
    node_joints: &[Option<NodeJoint>],
    specs: &[JointSpec],
    file: &Path,
    default_path: &Path,
    warnings: &mut WarningList,
) {
    let is_specified = |i: usize| specs.iter().any(|s| s.node == builder.names[i]);
    let inferred_list: Vec<String> = node_joints
        .iter()
        .enumerate()
        .filter(|(i, _)| !is_specified(*i))
        .filter_map(|(_, m)| {
            let NodeJoint { name, kind, axis, limits, .. } = m.as_ref()?;
            let axis = show_vector(*axis);
            Some(match kind {
                JointKind::Prismatic => {
                    format!("`{name}` translates along {axis}, {:.4} to {:.4} m", limits.lower, limits.upper)
                }
                JointKind::Continuous => format!("`{name}` rotates without limits about {axis}"),
                _ => format!(
                    "`{name}` rotates about {axis}, {:.2} to {:.2} deg",
                    limits.lower.to_degrees(),
                    limits.upper.to_degrees()
                ),
            })
        })
        .collect();
    if inferred_list.is_empty() {
        return;
    }
    let what = format!(
        "joints, axes (in the node's frame) and limits are taken from the tracks; speeds are unknown: {}",
        inferred_list.join("; ")
    );
    let hint = format!("where that is wrong, [joint.NODE] with axis, min, max, speed in {}", default_path.display());
    warnings.push(Diagnostic::new(file, None, what).hint(hint));
}

fn named(name: &str) -> &str {
    if name.is_empty() { "node" } else { name }
}
