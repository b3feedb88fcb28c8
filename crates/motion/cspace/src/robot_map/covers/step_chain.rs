//! The joints that move the covers, each with a frame whose z axis is along the joint's axis.

use elbowroom_kinematics::LinkId;
use elbowroom_kinematics::motion_bound::{JointRate, SpeedBound};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_validity::{AxisCylinder, Ball};

use super::super::driven_chain::{DrivenChain, DrivingJoint};
use super::super::rigid_groups::relative_pose;
use crate::GridAxis;

/// A moving joint.
#[derive(Debug, Clone)]
pub(super) struct Step {
    /// The step that carries this one; `None` if the base carries it.
    pub parent: Option<usize>,
    /// Frame of the step with the map's axes at 0, in the frame of the parent or in the world.
    pub at_zero: Pose,
    /// Index of the map's axis.
    pub axis: usize,
    /// Multiplier of the axis's value.
    pub multiplier: f64,
    pub turns: bool,
    /// Range of the step's value, rad or m.
    range: [f64; 2],
    /// The link that the step moves, and the step's frame in it.
    child: LinkId,
    frame_in_child: Pose,
}

impl Step {
    /// The motion of the joint at a value.
    pub fn moved(&self, value: f64) -> Pose {
        if self.turns {
            Pose::new(Rotation::from_axis_angle(Vec3::Z, value), Vec3::ZERO)
        } else {
            Pose::from_translation(Vec3::Z * value)
        }
    }
}

/// All steps, parents before children.
#[derive(Debug, Clone, Default)]
pub(super) struct StepChain {
    pub steps: Vec<Step>,
}

impl StepChain {
    /// Adds the steps of a path of joints from the root; returns their indices.
    pub fn add_path(&mut self, chain: &DrivenChain, axes: &[GridAxis], joints: &[DrivingJoint]) -> Vec<usize> {
        let mut path: Vec<usize> = Vec::new();
        for joint in joints {
            let known = self.steps.iter().position(|step| step.child == joint.child);
            let step = known.unwrap_or_else(|| self.add(chain, axes, joint, path.last().copied()));
            path.push(step);
        }
        path
    }

    fn add(&mut self, chain: &DrivenChain, axes: &[GridAxis], joint: &DrivingJoint, parent: Option<usize>) -> usize {
        let mut state = chain.state();
        chain.set_axes(&mut state, &vec![0.0; axes.len()]);
        let frame_in_child = Pose::new(Rotation::from_z(joint.along), Vec3::ZERO);
        let in_parent = match parent.map(|p| &self.steps[p]) {
            Some(p) => p.frame_in_child.inverse() * relative_pose(&state, p.child, joint.child),
            None => chain.link_in_world(&state, joint.child),
        };
        let axis = &axes[joint.axis];
        let ends = [axis.border(0), axis.border(axis.count())].map(|q| q * joint.multiplier);
        self.steps.push(Step {
            parent,
            at_zero: in_parent * frame_in_child,
            axis: joint.axis,
            multiplier: joint.multiplier,
            turns: joint.turns,
            range: [ends[0].min(ends[1]), ends[0].max(ends[1])],
            child: joint.child,
            frame_in_child,
        });
        self.steps.len() - 1
    }

    /// Frames of all steps relative to the first step, which only the base carries.
    pub fn seen_from_first(&self, values: &[f64; 3]) -> Vec<Pose> {
        let mut frames: Vec<Pose> = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let value = values[step.axis] * step.multiplier;
            frames.push(match step.parent {
                None => Pose::IDENTITY,
                Some(parent) => frames[parent] * step.at_zero * step.moved(value),
            });
        }
        frames
    }

    /// Pose of the frame of a step's child link in the step's frame.
    pub fn child_in_frame(&self, step: usize) -> Pose {
        self.steps[step].frame_in_child.inverse()
    }

    /// Largest distances of a point of the last frame of a path from the axes of the path's steps, m.
    pub fn lever_arms(&self, path: &[usize], p: Vec3) -> Vec<f64> {
        let mut cylinder = AxisCylinder::around(std::iter::once(Ball { centre: p, radius: 0.0 }));
        let mut levers = vec![0.0; path.len()];
        for (lever, &at) in levers.iter_mut().zip(path).rev() {
            let step = &self.steps[at];
            *lever = cylinder.radius;
            if !step.turns {
                cylinder = cylinder.slid(step.range[0], step.range[1]);
            }
            cylinder = cylinder.seen_from(&step.at_zero);
        }
        levers
    }

    /// Bound of the motion of a point with these lever arms within a box of joint values with these half widths.
    pub fn motion(&self, path: &[usize], levers: &[f64], half: &[f64; 3]) -> PointMotion {
        let rates = path.iter().zip(levers).map(|(&at, &lever_m)| {
            let step = &self.steps[at];
            let rate = half[step.axis] * step.multiplier.abs();
            if step.turns { JointRate::Revolute { rate, lever_m } } else { JointRate::Prismatic { rate } }
        });
        let bound = SpeedBound::of_joints(rates);
        PointMotion { path_m: bound.speed, curvature_m: 0.5 * bound.acceleration }
    }
}

/// Bound of the motion of a point from the centre of a box of joint values to any point of the box.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointMotion {
    /// Length of the point's path, m.
    pub path_m: f64,
    /// Distance of the end from the point to which the velocity at the centre leads, m.
    pub curvature_m: f64,
}
