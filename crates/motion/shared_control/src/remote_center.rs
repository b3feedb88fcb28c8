//! A remote centre of motion: a fixed point through which the shaft of a tool passes.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{LinearConstraint, NavigatorError};

/// Distance of the shaft from the point that needs no correction, metres. It makes the direction of the shaft continuous
/// while the tip passes the point.
const TOLERANCE_M: f64 = 1e-6;
/// Motion of the tip that a correction must be worth, metres: smaller ones are rounding.
const ROUNDING_M: f64 = 1e-9;
/// Halvings in the search for the largest travel.
const HALVINGS: usize = 24;
/// Fraction of the radius from which the tool turns with its tip instead of moving as it is.
const PIVOTING: f64 = 0.9;

/// A fixed point of entry: the shaft of a tool slides through it, turns about itself and pivots about the point, and does
/// nothing else.
///
/// The shaft is the line through the tool point along an axis of the tool, which points from the shaft to the tip. The depth
/// is the length of the shaft beyond the point; it is negative while the tip is before the point.
///
/// ```
/// use elbowroom_shared_control::Guide;
/// use elbowroom_spatial::{Pose, Vec3};
/// // The tip is 50 mm beyond the origin, and the hand draws it 50 mm aside.
/// let port = Guide::entry(Vec3::ZERO, Vec3::Z, 0.0, (f64::NEG_INFINITY, f64::INFINITY))?;
/// let tool = Pose::from_translation(Vec3::Z * 0.05);
/// let hand = Pose::from_translation(Vec3::new(0.05, 0.0, 0.05));
/// let tilted = port.clone().toward(&tool, &hand);
/// assert_eq!(tilted.translation, hand.translation);
/// assert!(port.distance_m(&tilted) < 2e-6 && (tilted.rotation.angle() - 45_f64.to_radians()).abs() < 1e-4);
/// # Ok::<(), elbowroom_shared_control::NavigatorError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RemoteCenter {
    at: Vec3,
    axis_in_tool: Vec3,
    radius_m: f64,
    depth_m: (f64, f64),
}

/// A travel of the tip, and the turn about it that keeps the shaft at the point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PivotMotion {
    /// Motion of the tip, metres, world axes.
    pub travel: Vec3,
    /// Rotation vector of the turn, rad, world axes.
    pub turn: Vec3,
}

impl PivotMotion {
    /// The pose after a fraction of the motion.
    pub fn carried(&self, tool: &Pose, fraction: f64) -> Pose {
        let rotation = if self.turn == Vec3::ZERO {
            tool.rotation
        } else {
            (Rotation::from_rotation_vector(self.turn * fraction) * tool.rotation).renormalized()
        };
        Pose::new(rotation, tool.translation + self.travel * fraction)
    }
}

impl RemoteCenter {
    /// The point at which a shaft enters (world, metres), with the direction of the shaft in the frame of the tool point.
    /// The shaft passes within `radius_m` of the point, and its depth stays within `depth_m`.
    pub(crate) fn new(
        at: Vec3,
        axis_in_tool: Vec3,
        radius_m: f64,
        depth_m: (f64, f64),
    ) -> Result<Self, NavigatorError> {
        let axis_in_tool = axis_in_tool.try_normalize().filter(|_| at.is_finite());
        let axis_in_tool = axis_in_tool.ok_or(NavigatorError::GuideDirection)?;
        NavigatorError::check_not_negative(&[("the radius of a guide", radius_m)])?;
        if !(depth_m.0 < depth_m.1) {
            return Err(NavigatorError::GuideDepth { least_m: depth_m.0, most_m: depth_m.1 });
        }
        Ok(Self { at, axis_in_tool, radius_m, depth_m })
    }

    /// The point, in the world, metres.
    pub fn at(&self) -> Vec3 {
        self.at
    }

    /// Direction of the shaft towards the tip, a unit vector in the frame of the tool point.
    pub fn axis_in_tool(&self) -> Vec3 {
        self.axis_in_tool
    }

    /// Largest distance of the shaft from the point, metres.
    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Least and largest length of the shaft beyond the point, metres; infinite without a limit.
    pub fn depth_m(&self) -> (f64, f64) {
        self.depth_m
    }

    /// Length of the shaft beyond the point, metres; negative while the tip is before it.
    fn depth_of(&self, tool: &Pose) -> f64 {
        (tool.translation - self.at).dot(self.axis(tool.rotation))
    }

    /// Distance of the shaft, as a line without end, from the point, metres.
    pub(crate) fn offset_m(&self, tool: &Pose) -> f64 {
        (tool.translation - self.at).cross(self.axis(tool.rotation)).length()
    }

    fn axis(&self, rotation: Rotation) -> Vec3 {
        rotation * self.axis_in_tool
    }

    fn allowed_m(&self) -> f64 {
        self.radius_m.max(TOLERANCE_M)
    }

    /// The angle by which a tool that was placed elsewhere must turn until its shaft is at the point, rad; 0 if it is there.
    pub(crate) fn missed_rad(&self, tool: &Pose) -> f64 {
        self.correction(tool.translation, tool.rotation, self.side(tool)).length()
    }

    /// 1 if the tip is beyond the point, −1 if it is before it.
    fn side(&self, tool: &Pose) -> f64 {
        if self.depth_of(tool) < 0.0 { -1.0 } else { 1.0 }
    }

    /// The depths that the tool may take next: one that is not in the range yet may be withdrawn, but comes no deeper than it
    /// is, or than the range.
    fn depths(&self, depth_m: f64) -> (f64, f64) {
        let (least_m, most_m) = self.depth_m;
        let is_in = depth_m >= least_m - TOLERANCE_M;
        (if is_in { least_m.min(depth_m) } else { f64::NEG_INFINITY }, most_m.max(depth_m))
    }

    /// The reachable pose for a hand: the tip at the desired place, and the tool turned by the least angle with which the
    /// shaft passes through the point. If the hand is on the other side of the point, the tool first slides there along
    /// itself.
    pub(crate) fn toward(&self, tool: &Pose, desired: &Pose) -> Pose {
        let axis = self.axis(tool.rotation);
        let depth_m = self.depth_of(tool);
        let (least_m, most_m) = self.depths(depth_m);
        let out = desired.translation - self.at;
        let (side, wanted_m) = (self.side(tool), out.dot(axis));
        let tip = if wanted_m * side >= 0.0 {
            let wanted_m = side * out.length();
            let kept_m = wanted_m.clamp(least_m, most_m);
            let direction = (out * side).try_normalize().unwrap_or(axis);
            // Without a limit the desired place itself, to the last bit.
            if kept_m == wanted_m { desired.translation } else { self.at + direction * kept_m }
        } else {
            tool.translation + axis * (wanted_m.clamp(least_m, most_m) - depth_m)
        };
        let side = self.side(&Pose::new(tool.rotation, tip));
        Pose::new(self.aligned(tip, desired.rotation, side), tip)
    }

    /// The tool turned in place to the orientation nearest to that of the hand with which the shaft passes through the point.
    /// If the shaft then enters by another length, the tool slides by the difference, to stay within its depths.
    pub(crate) fn turned(&self, tool: &Pose, hand: Rotation) -> Pose {
        let end = Pose::new(self.aligned(tool.translation, hand, self.side(tool)), tool.translation);
        Pose::new(end.rotation, end.translation + self.slide(tool, &end))
    }

    /// How far a tool of which a motion begins and ends at these poses must slide along itself, to stay within its depths.
    fn slide(&self, tool: &Pose, end: &Pose) -> Vec3 {
        let (least_m, most_m) = self.depths(self.depth_of(tool));
        let depth_m = self.depth_of(end);
        self.axis(end.rotation) * (depth_m.clamp(least_m, most_m) - depth_m)
    }

    /// Largest slide of [`Self::turned`] per angle, m/rad.
    pub(crate) fn slide_per_angle_m(&self) -> f64 {
        2.0 * self.allowed_m()
    }

    /// The orientation nearest to a given one with which the shaft passes through the point.
    fn aligned(&self, tip: Vec3, rotation: Rotation, side: f64) -> Rotation {
        let turn = self.correction(tip, rotation, side);
        if turn == Vec3::ZERO { rotation } else { (Rotation::from_rotation_vector(turn) * rotation).renormalized() }
    }

    /// The least turn (rotation vector) with which the shaft passes through the point.
    fn correction(&self, tip: Vec3, rotation: Rotation, side: f64) -> Vec3 {
        let out = (tip - self.at) * side;
        let axis = self.axis(rotation);
        let across = axis.cross(out);
        let distance_m = out.length();
        if distance_m <= self.allowed_m() {
            return Vec3::ZERO;
        }
        let angle = across.length().atan2(axis.dot(out));
        let turn = angle - (self.allowed_m() / distance_m).asin();
        if turn * distance_m <= ROUNDING_M {
            return Vec3::ZERO;
        }
        // A shaft the wrong way round turns about any axis.
        across.try_normalize().unwrap_or_else(|| axis.any_perpendicular()) * turn
    }

    /// The motion of a tool whose tip travels, with the turn that keeps the shaft at the point, at most by this angle
    /// (rad). The depth stays within its range.
    pub(crate) fn motion(&self, tool: &Pose, travel: Vec3, most_rad: f64) -> PivotMotion {
        let tip = tool.translation + travel;
        let moved = Pose::new(tool.rotation, tip);
        let turn = self.correction(tip, tool.rotation, self.side(&moved));
        let length = turn.length();
        let turn = if length > most_rad { turn * (most_rad / length) } else { turn };
        let end = PivotMotion { travel, turn }.carried(tool, 1.0);
        PivotMotion { travel: travel + self.slide(tool, &end), turn }
    }

    /// A velocity of the tip (m/s) without what turns the tool too fast in one step: of the part across the shaft as much as
    /// turns it by `most_rad` in `step_s` seconds.
    pub(crate) fn slowed_aside(&self, tool: &Pose, velocity: Vec3, step_s: f64, most_rad: f64) -> Vec3 {
        let axis = self.axis(tool.rotation);
        let along = axis * axis.dot(velocity);
        let aside = velocity - along;
        along + aside * largest(|fraction| self.turns_within(tool, (along + aside * fraction) * step_s, most_rad))
    }

    /// The fraction of a travel that turns the tool by at most this angle, rad.
    pub(crate) fn turnable_fraction(&self, tool: &Pose, travel: Vec3, most_rad: f64) -> f64 {
        largest(|fraction| self.turns_within(tool, travel * fraction, most_rad))
    }

    fn turns_within(&self, tool: &Pose, travel: Vec3, most_rad: f64) -> bool {
        let moved = Pose::new(tool.rotation, tool.translation + travel);
        self.correction(moved.translation, moved.rotation, self.side(&moved)).length() <= most_rad
    }

    /// A constraint on a point of the tool (world) as one on the tip, which carries the point around the fixed point; `None`
    /// for a point that the tip hardly moves.
    ///
    /// With the depth s, the axis d and the arm r from the tip to the point, the point moves by v + (d × v / s) × r.
    pub(crate) fn at_tip(&self, tool: &Pose, point: Vec3, constraint: LinearConstraint) -> Option<LinearConstraint> {
        if self.offset_m(tool) < PIVOTING * self.radius_m {
            return Some(constraint);
        }
        let LinearConstraint { normal, least } = constraint;
        let (axis, depth_m) = (self.axis(tool.rotation), self.depth_of(tool));
        let arm = point - tool.translation;
        let scaled = normal * (depth_m + axis.dot(arm)) - arm * normal.dot(axis);
        let length = scaled.length();
        // Where neither end of the lever is left, the motion of the tip says nothing.
        let is_usable = length > TOLERANCE_M && length > TOLERANCE_M * depth_m.abs();
        is_usable.then(|| LinearConstraint {
            normal: scaled * (depth_m.signum() / length),
            least: least * (depth_m.abs() / length),
        })
    }
}

/// The largest fraction up to 1 that is admissible, if a smaller one than an admissible one is too; 0 if none is.
fn largest(is_admissible: impl Fn(f64) -> bool) -> f64 {
    if is_admissible(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_admissible(middle) { low = middle } else { high = middle }
    }
    low
}
