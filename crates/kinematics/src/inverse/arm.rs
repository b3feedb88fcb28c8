//! The joints between root and tip, fixed ones merged.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::forward::principal;
use crate::{Chain, JointKind, LinkId};

/// A moving joint on the way to the tip.
#[derive(Debug, Clone)]
pub struct Segment {
    /// This joint's frame in the one before, everything fixed between them included.
    pub origin: Pose,
    pub slides: bool,
    pub axis: Vec3,
    /// Index and sign where the axis is a coordinate axis.
    pub principal: Option<(usize, f64)>,
    /// Which of the arm's variables drives it.
    pub variable: usize,
    pub multiplier: f64,
    pub offset: f64,
}

impl Segment {
    /// Velocity of the point `tip` (m per unit of the variable) and angular velocity, in the root.
    #[inline]
    pub fn twist(&self, at: &AxisInRoot, tip: Vec3) -> (Vec3, Vec3) {
        let axis = at.axis * self.multiplier;
        if self.slides { (axis, Vec3::ZERO) } else { (axis.cross(tip - at.origin), axis) }
    }
}

/// An independent joint that moves the tip.
#[derive(Debug, Clone)]
pub struct Variable {
    pub name: String,
    /// Where it stands in the chain's `q`.
    pub q_index: usize,
    pub lower: f64,
    pub upper: f64,
    pub turns: bool,
    /// A full turn leaves the tip where it is.
    pub wraps: bool,
}

/// The way from the root to the tip.
#[derive(Debug, Clone)]
pub struct Arm {
    pub segments: Vec<Segment>,
    pub variables: Vec<Variable>,
    /// The tip (tool included) in the last segment's frame.
    pub tip_in_last: Pose,
    /// No pose of the tip is farther from the first joint's origin, m. Infinite with an endless slide.
    pub reach: f64,
}

/// Where a segment's axis is in the root.
#[derive(Debug, Clone, Copy)]
pub struct AxisInRoot {
    pub origin: Vec3,
    pub axis: Vec3,
}

impl Arm {
    pub fn new(chain: &Chain, tip: LinkId, tip_offset: Pose) -> Self {
        let mut arm = Self { segments: Vec::new(), variables: Vec::new(), tip_in_last: Pose::IDENTITY, reach: 0.0 };
        let mut pending = Pose::IDENTITY;
        for id in chain.path(tip) {
            let joint = &chain.joints[id.0];
            pending = pending * joint.origin;
            if let Some(drive) = chain.drives[id.0] {
                let variable = arm.variable(chain, drive.index);
                arm.segments.push(Segment {
                    origin: pending,
                    slides: joint.kind == JointKind::Prismatic,
                    axis: joint.axis,
                    principal: principal(joint.axis),
                    variable,
                    multiplier: drive.multiplier,
                    offset: drive.offset,
                });
                pending = Pose::IDENTITY;
            }
        }
        arm.set_tip(pending * tip_offset);
        for (i, variable) in arm.variables.iter_mut().enumerate() {
            let whole = |s: &Segment| s.variable != i || (!s.slides && s.multiplier.fract() == 0.0);
            variable.wraps = variable.turns && arm.segments.iter().all(whole);
        }
        arm
    }

    /// Ends the arm at another frame of its last link.
    pub fn set_tip(&mut self, tip_in_last: Pose) {
        self.tip_in_last = tip_in_last;
        self.reach = self.reach_bound();
    }

    fn variable(&mut self, chain: &Chain, q_index: usize) -> usize {
        if let Some(known) = self.variables.iter().position(|v| v.q_index == q_index) {
            return known;
        }
        let joint = &chain.joints[chain.active[q_index].0];
        self.variables.push(Variable {
            name: joint.name.clone(),
            q_index,
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            turns: joint.kind.turns(),
            wraps: false,
        });
        self.variables.len() - 1
    }

    fn reach_bound(&self) -> f64 {
        let stroke = |s: &Segment| {
            let v = &self.variables[s.variable];
            let at = |q: f64| (s.multiplier * q + s.offset).abs();
            if s.slides { at(v.lower).max(at(v.upper)) } else { 0.0 }
        };
        let offsets = self.segments.iter().skip(1).map(|s| s.origin.translation.length()).sum::<f64>();
        self.segments.iter().map(stroke).sum::<f64>() + offsets + self.tip_in_last.translation.length()
    }

    /// A length that makes metres comparable with radians.
    pub fn scale(&self) -> f64 {
        let offsets = self.segments.iter().skip(1).map(|s| s.origin.translation.length()).sum::<f64>()
            + self.tip_in_last.translation.length();
        if offsets > 1e-6 { 0.5 * offsets } else { 1.0 }
    }

    /// The tip in the root; `axes` (one per segment) get every axis on the way.
    pub fn tip_in_root(&self, x: &[f64], axes: &mut [AxisInRoot]) -> Pose {
        let mut at = Pose::IDENTITY;
        for (segment, out) in self.segments.iter().zip(axes) {
            at = at * segment.origin;
            let value = segment.multiplier * x[segment.variable] + segment.offset;
            let axis = at.rotation * segment.axis;
            if segment.slides {
                at.translation += axis * value;
            } else {
                at.rotation = match segment.principal {
                    Some((axis, sign)) => at.rotation.turned_about(axis, sign * value),
                    None => at.rotation * Rotation::from_axis_angle(segment.axis, value),
                };
            }
            *out = AxisInRoot { origin: at.translation, axis };
        }
        at * self.tip_in_last
    }
}

/// The rotation vector, in the root, that turns `current` into `wanted`. Exact to rounding even for tiny turns.
pub fn turn_between(current: Rotation, wanted: Rotation) -> Vec3 {
    let (mut sine, mut trace) = (Vec3::ZERO, 0.0);
    for i in 0..3 {
        sine += current.axis(i).cross(wanted.axis(i)) * 0.5;
        trace += current.axis(i).dot(wanted.axis(i));
    }
    let cosine = 0.5 * (trace - 1.0);
    let length = sine.length();
    if cosine < -0.99 {
        return (wanted * current.inverse()).to_rotation_vector();
    }
    if length < 1e-9 { sine } else { sine * (length.atan2(cosine) / length) }
}
