//! Speed bounds of links and of objects attached to them, relative to the root or any link in between.

use elbowroom_kinematics::motion_bound::SpeedBound;
use elbowroom_kinematics::{JointCoupling, JointId, JointKind, LinkId};
use elbowroom_robot::RobotId;
use elbowroom_spatial::{Pose, Vec3};

use crate::{Level, Scene};

/// The constant data: joints of each robot, joints above each link, bounding box of each model.
#[derive(Debug)]
pub(super) struct LinkBounds {
    /// Per robot and joint.
    joints: Vec<Vec<JointGeometry>>,
    /// Per robot and link: the joints from the root to it.
    paths: Vec<Vec<Vec<JointId>>>,
    /// Per model: the corners of its bounding box in its own frame; `None` if it is unbounded.
    corners: Vec<Option<[Vec3; 8]>>,
}

#[derive(Debug)]
struct JointGeometry {
    kind: JointKind,
    child: LinkId,
    coupling: Option<JointCoupling>,
    /// The axis in the child's frame.
    axis: Vec3,
    /// Origin of the child at value 0, in the parent's frame, metres.
    origin: Vec3,
    /// The axis in the parent's frame.
    axis_in_parent: Vec3,
}

/// Joint values of a robot over time: `from + rate·t`.
#[derive(Clone, Copy)]
pub(super) struct JointRates<'a> {
    pub from: &'a [f64],
    pub rate: &'a [f64],
}

impl LinkBounds {
    pub fn new(scene: &Scene, level: Level) -> Self {
        let chains = || scene.robots.iter().map(|r| &r.robot.chain);
        let joints = chains().map(|c| {
            let geometry = |(i, j): (usize, &elbowroom_kinematics::Joint)| JointGeometry {
                kind: j.kind,
                child: j.child,
                coupling: c.coupling(JointId(i)),
                axis: j.axis,
                origin: j.origin.translation,
                axis_in_parent: j.origin.rotation * j.axis,
            };
            c.joints().iter().enumerate().map(geometry).collect()
        });
        let paths = chains().map(|c| (0..c.links().len()).map(|l| c.path(LinkId(l))).collect());
        let corners = scene.models.iter().map(|m| {
            let all = m.at(level).iter().map(|s| s.bounds).reduce(|a, b| a.union(&b))?;
            let pick = |k: usize, bit: usize, i: usize| if k & bit == 0 { all.min[i] } else { all.max[i] };
            let corners = std::array::from_fn(|k| Vec3::new(pick(k, 1, 0), pick(k, 2, 1), pick(k, 4, 2)));
            corners.iter().all(|c: &Vec3| c.length().is_finite()).then_some(corners)
        });
        Self { joints: joints.collect(), paths: paths.collect(), corners: corners.collect() }
    }

    /// The largest number of joints above a link.
    pub fn longest_path(&self) -> usize {
        self.paths.iter().flatten().map(Vec::len).max().unwrap_or(0)
    }

    pub fn corners(&self, model: usize) -> Option<&[Vec3; 8]> {
        self.corners[model].as_ref()
    }

    /// Distance (m) of the farthest corner from the model's origin; infinite if it is unbounded.
    pub fn radius(&self, model: usize) -> f64 {
        self.corners(model).map_or(f64::INFINITY, |c| c.iter().map(|p| p.length()).fold(0.0, f64::max))
    }

    /// The radius (m) of a bounded model, else 0.
    pub fn finite_radius(&self, model: usize) -> f64 {
        self.corners(model).map_or(0.0, |_| self.radius(model))
    }

    /// Number of joints that the paths from the root to two links of a robot share.
    pub fn common_joints(&self, robot: RobotId, a: LinkId, b: LinkId) -> usize {
        let of = |l: LinkId| &self.paths[robot.0][l.0];
        of(a).iter().zip(of(b)).take_while(|(x, y)| x == y).count()
    }

    /// The link below the first `cut` joints of the path to a link; `None` for the root.
    pub fn link_below(&self, robot: RobotId, link: LinkId, cut: usize) -> Option<LinkId> {
        let last = cut.checked_sub(1)?;
        self.paths[robot.0][link.0].get(last).map(|j| self.joints[robot.0][j.0].child)
    }

    /// Appends the speed bounds of a model on a link, and returns the sum (m) of the lengths that determine its pose.
    ///
    /// `in_link` is the pose of an attached object. The bounds are one per number of joints left out from the root on,
    /// from none to all.
    pub fn append_bounds(
        &self,
        robot: RobotId,
        link: LinkId,
        model: usize,
        in_link: Option<Pose>,
        rates: JointRates,
        out: &mut Vec<SpeedBound>,
    ) -> f64 {
        let path = &self.paths[robot.0][link.0];
        let begin = out.len();
        out.resize(begin + path.len() + 1, SpeedBound::REST);
        let mut size = self.finite_radius(model) + in_link.map_or(0.0, |p| p.translation.length());
        let mut bound = SpeedBound::REST;
        // The farthest point from the origin of the frame below the joint.
        let mut radius = self.farthest_corner(model, in_link, Vec3::length);
        // The origin of the next joint in that frame, at both ends of the motion, and the radius there.
        let mut next: Option<([Vec3; 2], f64)> = None;
        for (i, id) in path.iter().enumerate().rev() {
            let j = &self.joints[robot.0][id.0];
            let (rate, ends) = j.rate_and_ends(rates);
            let mut origin = [j.origin; 2];
            if j.kind == JointKind::Prismatic {
                origin = ends.map(|v| j.origin + j.axis_in_parent * v);
                bound = bound.prismatic(rate);
            } else if rate > 0.0 || rate.is_nan() {
                let off_axis = |p: Vec3| (p - j.axis * p.dot(j.axis)).length();
                let lever_arm = match next {
                    None => self.farthest_corner(model, in_link, off_axis),
                    Some((origin, radius)) => off_axis(origin[0]).max(off_axis(origin[1])) + radius,
                };
                bound = bound.revolute(rate, lever_arm);
            }
            if j.kind.turns() {
                // The rounding of an angle is relative to its size.
                size += ends[0].abs().max(ends[1].abs()) * radius;
            }
            out[begin + i] = bound.rounded_up();
            let step = origin[0].length().max(origin[1].length());
            size += step;
            next = Some((origin, radius));
            radius += step;
        }
        if size.is_finite() { size } else { 0.0 }
    }

    /// The largest length over all corners, in the link's frame; infinite if the model is unbounded.
    fn farthest_corner(&self, model: usize, in_link: Option<Pose>, length: impl Fn(Vec3) -> f64) -> f64 {
        let Some(corners) = self.corners(model) else { return f64::INFINITY };
        let place = |p: &Vec3| in_link.map_or(*p, |c| c.transform_point(*p));
        corners.iter().map(|p| length(place(p))).fold(0.0, f64::max)
    }
}

impl JointGeometry {
    /// Absolute rate of the joint, and its values at both ends of the motion; 0 if it is fixed.
    fn rate_and_ends(&self, rates: JointRates) -> (f64, [f64; 2]) {
        let Some(c) = self.coupling else { return (0.0, [0.0; 2]) };
        match (rates.rate.get(c.index), rates.from.get(c.index)) {
            (Some(r), Some(q)) => {
                let value = |q: f64| c.multiplier * q + c.offset;
                ((c.multiplier * r).abs(), [value(*q), value(q + r)])
            }
            _ => (0.0, [0.0; 2]),
        }
    }
}
