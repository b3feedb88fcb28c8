//! Independent forward kinematics of the oracle, and bounds of how far a joint can move a point.

use elbowroom_cell::CellRobot;
use elbowroom_kinematics::JointKind;
use elbowroom_spatial::Vec3;

use super::frame::Frame;

/// A robot as joints from the root outwards.
#[derive(Debug)]
pub struct Arm {
    base: Frame,
    joints: Vec<ArmJoint>,
    links: usize,
    root: usize,
    /// Number of independent joints.
    pub dof: usize,
}

#[derive(Debug)]
struct ArmJoint {
    parent: usize,
    child: usize,
    origin: Frame,
    axis: Vec3,
    kind: JointKind,
    /// Index in q, factor and offset; `None` for a fixed joint.
    driven: Option<(usize, f64, f64)>,
    /// Largest stroke of a prismatic joint, m.
    stroke: f64,
}

impl Arm {
    pub fn new(robot: &CellRobot) -> Self {
        let chain = &robot.robot.chain;
        let joint = |id: &elbowroom_kinematics::JointId| {
            let j = &chain.joints()[id.0];
            let (source, factor, offset) =
                j.mimic.as_ref().map_or((*id, 1.0, 0.0), |m| (m.joint, m.multiplier, m.offset));
            let moves = j.kind != JointKind::Fixed;
            let limits = chain.joints()[source.0].limits;
            let farthest = limits.lower.abs().max(limits.upper.abs()) * factor.abs() + offset.abs();
            ArmJoint {
                parent: j.parent.0,
                child: j.child.0,
                origin: Frame::of(&j.origin),
                axis: j.axis,
                kind: j.kind,
                driven: chain.q_index(source).filter(|_| moves).map(|q| (q, factor, offset)),
                stroke: if j.kind == JointKind::Prismatic { farthest } else { 0.0 },
            }
        };
        Self {
            base: Frame::of(&robot.base_in_world),
            joints: chain.topological_order().iter().map(joint).collect(),
            links: chain.links().len(),
            root: chain.root().0,
            dof: chain.dof(),
        }
    }

    /// Computes every link's frame in the world.
    pub fn frames(&self, q: &[f64]) -> Vec<Frame> {
        let mut frames = vec![self.base; self.links];
        frames[self.root] = self.base;
        for j in &self.joints {
            let value = j.driven.map_or(0.0, |(index, factor, offset)| q[index] * factor + offset);
            let moved = match j.kind {
                JointKind::Fixed => Frame::IDENTITY,
                JointKind::Prismatic => Frame::shift(j.axis * value),
                _ => Frame::turn(j.axis, value),
            };
            frames[j.child] = frames[j.parent].then(&j.origin).then(&moved);
        }
        frames
    }

    /// Computes, per value of q, the largest motion (m per rad or m) of a point within `radius_m` of the link's origin,
    /// whatever the other joints do.
    pub fn lever_arms(&self, link: usize, radius_m: f64) -> Vec<f64> {
        let mut lever_arms = vec![0.0; self.dof];
        let (mut at, mut reach) = (link, radius_m);
        while let Some(j) = self.joints.iter().find(|j| j.child == at) {
            if let Some((index, factor, _)) = j.driven {
                lever_arms[index] += factor.abs() * if j.kind == JointKind::Prismatic { 1.0 } else { reach };
            }
            reach += j.origin.at.length() + j.stroke;
            at = j.parent;
        }
        lever_arms
    }
}
