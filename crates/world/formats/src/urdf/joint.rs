//! Joints: kinds, limits, mimics.

use std::collections::HashMap;

use elbowroom_kinematics::{JointKind, Limits};
use roxmltree::Node;

use super::model::{UrdfJoint, UrdfLink, UrdfMimic};
use super::parser::UrdfParser;
use crate::cycles::find_cycles;
use crate::names::list_names;
use crate::tokens::{show, show_name};
use crate::{Diagnostic, xml};

const LIMIT: &str = "<limit lower=\"-3.14\" upper=\"3.14\" velocity=\"1.5\" effort=\"0\"/>, or type=\"continuous\"";

impl UrdfParser<'_> {
    pub(super) fn joints(&mut self, root: Node<'_, '_>, links: &[UrdfLink]) -> Result<Vec<UrdfJoint>, Diagnostic> {
        let index: HashMap<&str, usize> = links.iter().enumerate().map(|(i, l)| (l.name.as_str(), i)).collect();
        let nodes: Vec<_> = xml::children(root, "joint").collect();
        let mut numbers: HashMap<&str, usize> = HashMap::new();
        for (i, node) in nodes.iter().enumerate() {
            let name = self.required(*node, "name")?;
            if let Some(first) = numbers.insert(name, i) {
                let what = format!(
                    "a second joint `{}`; the first is on line {}",
                    show_name(name),
                    self.lines.line_at(nodes[first].range().start)
                );
                return Err(self.error(*node, what).hint("a name of its own for each joint"));
            }
        }
        let mut joints = Vec::with_capacity(nodes.len());
        for node in &nodes {
            joints.push(self.joint(*node, &index, &numbers)?);
        }
        self.check_mimics(&nodes, &mut joints)?;
        self.check_velocity_limits(&nodes, &joints);
        Ok(joints)
    }

    /// Adds one warning for all joints without a velocity limit. A joint that follows another needs none.
    fn check_velocity_limits(&mut self, nodes: &[Node<'_, '_>], joints: &[UrdfJoint]) {
        let lacks = |j: &UrdfJoint| j.kind.moves() && j.mimic.is_none() && j.limits.velocity.is_none();
        let Some(first) = joints.iter().position(lacks) else { return };
        let names: Vec<_> = joints.iter().filter(|j| lacks(j)).map(|j| show_name(&j.name)).collect();
        let list = list_names(names.iter().map(String::as_str));
        let what = match names.len() {
            1 => format!("the joint {list} has no velocity limit, or 0"),
            n => format!("{n} joints have no velocity limit, or 0: {list}"),
        };
        let node = xml::child(nodes[first], "limit").unwrap_or(nodes[first]);
        self.warn(node, what, "<limit velocity=\"1.5\" …/>, in rad/s or m/s");
    }

    fn joint(
        &mut self,
        node: Node<'_, '_>,
        links: &HashMap<&str, usize>,
        joints: &HashMap<&str, usize>,
    ) -> Result<UrdfJoint, Diagnostic> {
        let name = self.required(node, "name")?.to_owned();
        let kind = self.kind(node)?;
        let limits = self.limits(node, kind)?;
        Ok(UrdfJoint {
            line: self.lines.line_at(node.range().start),
            kind,
            parent: self.end(node, "parent", links)?,
            child: self.end(node, "child", links)?,
            origin: self.origin(node)?,
            axis: self.axis(node, kind.moves())?,
            limits,
            mimic: self.mimic(node, joints)?,
            name,
        })
    }

    fn kind(&self, node: Node<'_, '_>) -> Result<JointKind, Diagnostic> {
        let kind = self.required(node, "type")?;
        let instead = match kind {
            "fixed" => return Ok(JointKind::Fixed),
            "revolute" => return Ok(JointKind::Revolute),
            "continuous" => return Ok(JointKind::Continuous),
            "prismatic" => return Ok(JointKind::Prismatic),
            "floating" => {
                "type=\"fixed\" here, and the robot's base pose in the cell file; or six joints in a row, three prismatic and three revolute"
            }
            "planar" => "two prismatic joints and one continuous joint in a row",
            "screw" | "universal" | "ball" | "spherical" => {
                "revolute and prismatic joints in a row; <mimic> couples them"
            }
            _ => "type=\"revolute\", \"continuous\", \"prismatic\" or \"fixed\"",
        };
        let line = xml::attribute_line(node, "type");
        let name = node.attribute("name").unwrap_or_default();
        let what = format!("the joint `{}` is of type `{}`, which is not read", show_name(name), show(kind.as_bytes()));
        Err(Diagnostic::new(self.file, line, what).hint(instead))
    }

    fn end(
        &self,
        node: Node<'_, '_>,
        element: &'static str,
        links: &HashMap<&str, usize>,
    ) -> Result<usize, Diagnostic> {
        let hint = format!("<{element} link=\"NAME\"/>");
        let end = xml::child(node, element)
            .ok_or_else(|| self.error(node, format!("the joint has no {element}")).hint(hint))?;
        let link = self.required(end, "link")?;
        links.get(link).copied().ok_or_else(|| {
            let what = format!("there is no link `{}`", show_name(link));
            let line = xml::attribute_line(end, "link");
            Diagnostic::new(self.file, line, what)
                .hint(format!("<link name=\"{}\"/>, or the name of another link", show_name(link)))
        })
    }

    fn limits(&mut self, joint: Node<'_, '_>, kind: JointKind) -> Result<Limits, Diagnostic> {
        if !kind.moves() {
            return Ok(Limits::UNLIMITED);
        }
        let bounded = kind != JointKind::Continuous;
        let name = show_name(joint.attribute("name").unwrap_or_default());
        let Some(node) = xml::child(joint, "limit") else {
            if bounded {
                return Err(self.error(joint, format!("the joint `{name}` has no <limit>")).hint(LIMIT));
            }
            return Ok(Limits::UNLIMITED);
        };
        let (lower, upper) = if bounded { self.bounds(node, &name)? } else { (f64::NEG_INFINITY, f64::INFINITY) };
        let velocity = self.number(node, "velocity")?.filter(|&v| v != 0.0);
        if velocity.is_some_and(|v| v < 0.0) {
            return Err(self
                .error(node, format!("the velocity limit of `{name}` is negative"))
                .hint("velocity=\"1.5\", in rad/s or m/s"));
        }
        // Not in the specification, but some tools write it, with a prefix (drake) or without.
        let acceleration =
            node.attributes().find(|a| a.name() == "acceleration").and_then(|a| a.value().trim().parse().ok());
        let acceleration = acceleration.filter(|a: &f64| a.is_finite() && *a > 0.0);
        let effort = self.number(node, "effort")?.filter(|&e| e > 0.0);
        Ok(Limits { velocity, acceleration, effort, ..Limits::range(lower, upper) })
    }

    fn bounds(&mut self, node: Node<'_, '_>, name: &str) -> Result<(f64, f64), Diagnostic> {
        let (lower, upper) = (self.number(node, "lower")?, self.number(node, "upper")?);
        if lower.is_none() && upper.is_none() {
            return Err(self.error(node, format!("the limit of `{name}` has neither lower nor upper")).hint(LIMIT));
        }
        if lower.is_none() || upper.is_none() {
            self.warn(node, format!("one bound of `{name}` is missing and taken as 0"), "lower=\"…\" upper=\"…\"");
        }
        let (lower, upper) = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
        if lower > upper {
            let what = format!("the joint `{name}` has lower={lower} above upper={upper}");
            return Err(self.error(node, what).hint(format!("lower=\"{upper}\" upper=\"{lower}\"")));
        }
        Ok((lower, upper))
    }

    fn mimic(&self, joint: Node<'_, '_>, joints: &HashMap<&str, usize>) -> Result<Option<UrdfMimic>, Diagnostic> {
        let Some(node) = xml::child(joint, "mimic") else { return Ok(None) };
        let source = self.required(node, "joint")?;
        let source = joints.get(source).copied().ok_or_else(|| {
            let what = format!("there is no joint `{}` to follow", show_name(source));
            self.error(node, what)
                .hint("<mimic joint=\"NAME\" multiplier=\"1\" offset=\"0\"/> with the name of a joint")
        })?;
        let multiplier = self.number(node, "multiplier")?.unwrap_or(1.0);
        Ok(Some(UrdfMimic { joint: source, multiplier, offset: self.number(node, "offset")?.unwrap_or(0.0) }))
    }

    /// Checks that a fixed joint neither mimics nor is mimicked, and that mimics form no cycle.
    fn check_mimics(&mut self, nodes: &[Node<'_, '_>], joints: &mut [UrdfJoint]) -> Result<(), Diagnostic> {
        for i in 0..joints.len() {
            let Some(mimic) = joints[i].mimic else { continue };
            let node = xml::child(nodes[i], "mimic").unwrap_or(nodes[i]);
            if !joints[i].kind.moves() {
                self.warn(
                    node,
                    "a fixed joint cannot follow another; its <mimic> is ignored",
                    "type=\"revolute\", or no <mimic>",
                );
                joints[i].mimic = None;
            } else if !joints[mimic.joint].kind.moves() {
                let what = format!("follows the fixed joint `{}`", show_name(&joints[mimic.joint].name));
                return Err(self.error(node, what).hint("the name of a joint that moves"));
            }
        }
        match find_cycles(joints.len(), |i| joints[i].mimic.map(|m| m.joint)).first() {
            Some(&i) => Err(self
                .error(nodes[i], "mimic joints that follow each other in a cycle")
                .hint("one joint of them without <mimic>")),
            None => Ok(()),
        }
    }
}
