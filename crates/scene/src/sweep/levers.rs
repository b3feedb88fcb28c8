//! How far the points of members can be from the joints that carry them.

use elbowroom_kinematics::{JointId, JointKind, LinkId};
use elbowroom_spatial::{Pose, Vec3};

use super::speed::Speed;
use crate::{Level, Scene};

/// What is constant: joints above each link, corners around each member.
#[derive(Debug)]
pub(super) struct Levers {
    /// Per robot and joint.
    joints: Vec<Vec<Lever>>,
    /// Per robot and link: the joints from the root to it.
    paths: Vec<Vec<Vec<JointId>>>,
    /// Per model: points of its frame that it lies between; `None` where it has no end.
    corners: Vec<Option<[Vec3; 8]>>,
}

#[derive(Debug)]
struct Lever {
    kind: JointKind,
    child: LinkId,
    /// Value of the joint: `multiplier·q[index] + offset`.
    index: usize,
    multiplier: f64,
    offset: f64,
    /// In the child's frame.
    axis: Vec3,
    /// Of the child at value 0, in the parent's frame, metres.
    origin: Vec3,
    /// The axis in the parent's frame.
    slide: Vec3,
}

/// Joint values of a robot over time: `from + rate·t`.
pub(super) struct Turned<'a> {
    pub from: &'a [f64],
    pub rate: &'a [f64],
}

impl Levers {
    pub fn new(scene: &Scene, level: Level) -> Self {
        let chains = || scene.robots.iter().map(|r| &r.robot.chain);
        let joints = chains().map(|c| {
            let lever = |(i, j): (usize, &elbowroom_kinematics::Joint)| {
                let id = JointId(i);
                let (source, multiplier, offset) =
                    c.mimic_source(id).map_or((id, 1.0, 0.0), |m| (m.joint, m.multiplier, m.offset));
                Lever {
                    kind: j.kind,
                    child: j.child,
                    index: c.q_index(source).unwrap_or(usize::MAX),
                    multiplier,
                    offset,
                    axis: j.axis,
                    origin: j.origin.translation,
                    slide: j.origin.rotation * j.axis,
                }
            };
            c.joints().iter().enumerate().map(lever).collect()
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

    /// Number of joints above the link that has most.
    pub fn longest(&self) -> usize {
        self.paths.iter().flatten().map(Vec::len).max().unwrap_or(0)
    }

    pub fn corners(&self, model: usize) -> Option<&[Vec3; 8]> {
        self.corners[model].as_ref()
    }

    /// Distance (m) of the farthest point from the model's origin; infinite where it has no end.
    pub fn radius(&self, model: usize) -> f64 {
        self.corners(model).map_or(f64::INFINITY, |c| c.iter().map(|p| p.length()).fold(0.0, f64::max))
    }

    /// The same where there is an end, else 0.
    pub fn extent(&self, model: usize) -> f64 {
        self.corners(model).map_or(0.0, |_| self.radius(model))
    }

    /// Number of joints that two links of a robot have in common above them.
    pub fn common(&self, robot: usize, a: LinkId, b: LinkId) -> usize {
        let of = |l: LinkId| &self.paths[robot][l.0];
        of(a).iter().zip(of(b)).take_while(|(x, y)| x == y).count()
    }

    /// The link below the first `cut` joints on the way to a link; `None` for the root.
    pub fn above(&self, robot: usize, link: LinkId, cut: usize) -> Option<LinkId> {
        let last = cut.checked_sub(1)?;
        self.paths[robot][link.0].get(last).map(|j| self.joints[robot][j.0].child)
    }

    /// Adds the bounds of a model that hangs on a link (at `carried` in the link's frame), one per number of joints
    /// that are left out above: from none to all. Returns the sum of the lengths its place is computed from, metres.
    pub fn speeds(
        &self,
        (robot, link): (usize, LinkId),
        model: usize,
        carried: Option<Pose>,
        turned: &Turned,
        out: &mut Vec<Speed>,
    ) -> f64 {
        let path = &self.paths[robot][link.0];
        let begin = out.len();
        out.resize(begin + path.len() + 1, Speed::REST);
        let mut size = self.extent(model) + carried.map_or(0.0, |c| c.translation.length());
        let mut speed = Speed::REST;
        // Farthest point from the origin of the frame below the joint.
        let mut ball = self.farthest(model, carried, Vec3::length);
        // The next joint's place in that frame, at both ends of the motion.
        let mut next: Option<([Vec3; 2], f64)> = None;
        for (i, id) in path.iter().enumerate().rev() {
            let j = &self.joints[robot][id.0];
            let value = |q: f64| j.multiplier * q + j.offset;
            let (rate, ends) = match (turned.rate.get(j.index), turned.from.get(j.index)) {
                (Some(r), Some(q)) if j.kind.moves() => ((j.multiplier * r).abs(), [value(*q), value(q + r)]),
                _ => (0.0, [0.0; 2]),
            };
            let mut place = [j.origin; 2];
            if j.kind == JointKind::Prismatic {
                place = ends.map(|v| j.origin + j.slide * v);
                speed = speed.shifted(rate);
            } else if rate > 0.0 || rate.is_nan() {
                let off = |p: Vec3| (p - j.axis * p.dot(j.axis)).length();
                let lever = match next {
                    None => self.farthest(model, carried, off),
                    Some((place, ball)) => off(place[0]).max(off(place[1])) + ball,
                };
                speed = speed.turned(rate, lever);
            }
            if j.kind.turns() {
                // An angle is told apart from the next to the rounding of its size.
                size += ends[0].abs().max(ends[1].abs()) * ball;
            }
            out[begin + i] = speed.careful();
            let step = place[0].length().max(place[1].length());
            size += step;
            next = Some((place, ball));
            ball += step;
        }
        if size.is_finite() { size } else { 0.0 }
    }

    /// The largest of a length over the corners, in the carrier's frame; infinite where there is no end.
    fn farthest(&self, model: usize, carried: Option<Pose>, length: impl Fn(Vec3) -> f64) -> f64 {
        let Some(corners) = self.corners(model) else { return f64::INFINITY };
        let place = |p: &Vec3| carried.map_or(*p, |c| c.transform_point(*p));
        corners.iter().map(|p| length(place(p))).fold(0.0, f64::max)
    }
}
