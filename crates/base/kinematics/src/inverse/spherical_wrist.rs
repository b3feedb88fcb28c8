//! Closed-form inverse kinematics of six axes with a spherical wrist.
//!
//! The axes are read as lines at joint values 0, so any convention of the file is accepted. With `z` along axis 1
//! and `y` along axis 2, the parameters of the ortho-parallel basis follow. The transform from the model's last
//! frame to the tip is a constant tool.

use std::f64::consts::PI;

use elbowroom_spatial::{Pose, Rotation, Vec3};
use rs_opw_kinematics::kinematic_traits::{Kinematics, Pose as OpwPose};
use rs_opw_kinematics::kinematics_impl::OPWKinematics;
use rs_opw_kinematics::parameters::opw_kinematics::Parameters;

use super::arm::{Arm, AxisInRoot};
use super::arm_configuration::{ArmConfiguration, Elbow, Shoulder, Wrist};
use super::rotation_error::rotation_error;
use super::sequence::quasirandom;

/// Deviation from perpendicular (rad) and from intersecting (m) below which axes count as perpendicular or
/// intersecting: files round π/2. The solutions are refined on the chain as written.
const SLACK: f64 = 1e-3;

/// Deviation of the model that is assumed at least: rounding.
const LEAST_DEVIATION: f64 = 1e-9;

/// The closed-form model of an arm.
#[derive(Clone)]
pub struct SphericalWrist {
    model: OPWKinematics,
    base_in_root: Pose,
    tool_in_flange: Pose,
    branches: Branches,
    lengths: Lengths,
    /// Bound on the difference between the poses of arm and model at the same joint values: rad, and parts of the arm's length.
    deviation: f64,
}

/// Lengths of the model, m.
#[derive(Debug, Clone, Copy)]
struct Lengths {
    /// From axis 1 to axis 2, ahead.
    shoulder: f64,
    /// From the plane of the arm to axis 1.
    aside: f64,
    upper_arm: f64,
    /// From axis 3 to the centre of the wrist.
    forearm: f64,
}

impl Lengths {
    fn of(parameters: &Parameters) -> Self {
        Self {
            shoulder: parameters.a1,
            aside: parameters.b.abs(),
            upper_arm: parameters.c2,
            forearm: parameters.a2.hypot(parameters.c3),
        }
    }

    fn sum(self) -> f64 {
        self.shoulder + self.aside + self.upper_arm + self.forearm
    }
}

/// Parameters that distinguish the branches.
#[derive(Debug, Clone, Copy)]
struct Branches {
    /// Sign: 1 if axis 2 as in the file, crossed with axis 1, points to the front.
    front: f64,
    /// Sign: 1 if axis 1 as in the file points away from the base.
    up: f64,
    /// Value of joint 5 at which axes 4 and 6 are aligned, nearest to the middle of its range, rad.
    straight: f64,
}

/// Whether each axis is perpendicular to the next, but for the second and the third, which are parallel.
fn has_right_angles([a1, a2, a3, a4, a5, a6]: &[AxisInRoot; 6]) -> bool {
    let perpendicular = |a: Vec3, b: Vec3| a.dot(b).abs() < SLACK;
    perpendicular(a1.axis, a2.axis)
        && a2.axis.cross(a3.axis).length() < SLACK
        && perpendicular(a3.axis, a4.axis)
        && perpendicular(a4.axis, a5.axis)
        && perpendicular(a5.axis, a6.axis)
}

impl SphericalWrist {
    /// Builds the model; `None` if the arm has another structure, or if the model does not reproduce it.
    pub fn detect(arm: &Arm) -> Option<Self> {
        if arm.joints.len() != 6 || arm.variables.len() != 6 {
            return None;
        }
        let plain = |j: &super::arm::ArmJoint| !j.prismatic && j.multiplier == 1.0 && j.offset == 0.0;
        if !arm.joints.iter().all(plain) || arm.joints.iter().enumerate().any(|(i, j)| j.variable != i) {
            return None;
        }
        let mut axes = [AxisInRoot { origin: Vec3::ZERO, axis: Vec3::ZERO }; 6];
        let tip_in_root = arm.tip_in_root(&[0.0; 6], &mut axes);
        let mut wrist = Self::from_axes(&axes, arm)?;
        let flange_in_root = wrist.base_in_root * wrist.flange_in_base(&[0.0; 6])?;
        wrist.tool_in_flange = flange_in_root.inverse() * tip_in_root;
        let (away_m, angle) = wrist.deviation(arm)?;
        wrist.deviation = 4.0 * angle.max(away_m / wrist.lengths.sum()) + LEAST_DEVIATION;
        (away_m < 10.0 * SLACK * arm.scale().max(1.0) && angle < 10.0 * SLACK).then_some(wrist)
    }

    fn from_axes(axes: &[AxisInRoot; 6], arm: &Arm) -> Option<Self> {
        let [a1, a2, a3, a4, a5, a6] = axes;
        let center = wrist_center(a4, a5, a6).filter(|_| has_right_angles(axes))?;
        // Offset of axis 2 from axis 1 along x.
        let z = a1.axis;
        let mut y = (a2.axis - z * z.dot(a2.axis)).try_normalize()?;
        let ahead = (a2.origin - a1.origin).dot(y.cross(z));
        let sign2 = if ahead < -1e-9 { -1 } else { 1 };
        y = y * f64::from(sign2);
        let x = y.cross(z);
        let base = Rotation::from_columns(x, y, z)?;
        let base_in_root = Pose::new(base, a1.origin + z * z.dot(a2.origin - a1.origin));
        let flat = |v: Vec3| {
            let local = base.inverse_rotate(v);
            (local.x, local.z)
        };
        let (ex, ez) = flat(a3.origin - a2.origin);
        let theta2 = ex.atan2(ez);
        let (wx, wz) = flat(center - a3.origin);
        let (dx, dz) = flat(a4.axis);
        let sign4 = if wx * dx + wz * dz < 0.0 { -1 } else { 1 };
        let (dx, dz) = (dx * f64::from(sign4), dz * f64::from(sign4));
        let theta23 = dx.atan2(dz);
        let forearm = base * Rotation::from_axis_angle(Vec3::Y, theta23);
        let u5 = forearm.inverse_rotate(a5.axis);
        let theta4 = (-u5.x).atan2(u5.y);
        let wrist4 = forearm * Rotation::from_axis_angle(Vec3::Z, theta4);
        let u6 = wrist4.inverse_rotate(a6.axis);
        let theta5 = u6.x.atan2(u6.z);
        let from_elbow = forearm.inverse_rotate(center - a3.origin);
        let parameters = Parameters {
            a1: snap(ahead.abs()),
            a2: snap(from_elbow.x),
            b: snap((center - a1.origin).dot(y)),
            c1: 0.0,
            c2: ex.hypot(ez),
            c3: from_elbow.z,
            c4: 0.0,
            offsets: [0.0, -theta2, theta2 - theta23, -theta4, -theta5, 0.0].map(within_a_turn),
            sign_corrections: [1, sign2, if a3.axis.dot(y) < 0.0 { -1 } else { 1 }, sign4, 1, 1],
            dof: 6,
        };
        let sound = parameters.c2 > 1e-6 && parameters.a2.hypot(parameters.c3) > 1e-6;
        let branches = Branches {
            front: f64::from(sign2),
            up: away_from_base(z, &base_in_root, arm),
            straight: straight(-theta5, arm),
        };
        sound.then(|| Self {
            lengths: Lengths::of(&parameters),
            deviation: 0.0,
            model: OPWKinematics::new(parameters),
            base_in_root,
            tool_in_flange: Pose::IDENTITY,
            branches,
        })
    }

    /// The branch that the joint values `q` belong to.
    pub fn configuration(&self, arm: &Arm, q: &[f64; 6]) -> Option<ArmConfiguration> {
        let mut axes = [AxisInRoot { origin: Vec3::ZERO, axis: Vec3::ZERO }; 6];
        arm.tip_in_root(q, &mut axes);
        let [a1, a2, a3, a4, a5, a6] = &axes;
        let center = wrist_center(a4, a5, a6)?;
        let Branches { front, up, straight } = self.branches;
        let ahead = (a2.axis * front).cross(a1.axis);
        let is_front = (center - a1.origin).dot(ahead) >= 0.0;
        // The triangle of axis 2, axis 3 and wrist centre in the plane of the arm; coordinates are ahead and up.
        let flat = |v: Vec3| (v.dot(ahead), v.dot(a1.axis * up));
        let (elbow, wrist) = (flat(a3.origin - a2.origin), flat(center - a2.origin));
        let turned = elbow.0 * wrist.1 - elbow.1 * wrist.0;
        Some(ArmConfiguration {
            shoulder: if is_front { Shoulder::Front } else { Shoulder::Back },
            elbow: if (turned <= 0.0) == is_front { Elbow::Up } else { Elbow::Down },
            wrist: if (q[4] - straight).sin() >= 0.0 { Wrist::NoFlip } else { Wrist::Flip },
        })
    }

    fn flange_in_base(&self, q: &[f64; 6]) -> Option<Pose> {
        let pose = self.model.try_forward(q).ok()?;
        let rotation = Rotation::from_quaternion_xyzw(pose.rotation.to_array())?;
        Some(Pose::new(rotation, Vec3::from(pose.translation.to_array())))
    }

    /// Largest distance (m) and angle (rad) between arm and model in sampled positions; `None` if the model has none.
    fn deviation(&self, arm: &Arm) -> Option<(f64, f64)> {
        let mut axes = [AxisInRoot { origin: Vec3::ZERO, axis: Vec3::ZERO }; 6];
        let (mut away_m, mut angle) = (0.0_f64, 0.0_f64);
        // NaN is too large.
        let larger = |known: f64, found: f64| known.max(if found.is_nan() { f64::INFINITY } else { found });
        for k in 0..16 {
            let q: [f64; 6] = std::array::from_fn(|i| 6.0 * (quasirandom(k, i, 6) - 0.5));
            let exact = arm.tip_in_root(&q, &mut axes);
            let model = self.base_in_root * self.flange_in_base(&q)? * self.tool_in_flange;
            away_m = larger(away_m, exact.translation.distance(model.translation));
            angle = larger(angle, rotation_error(exact.rotation, model.rotation).length());
        }
        Some((away_m, angle))
    }

    /// Up to eight solutions of the model, with angles near the seed and without regard to limits. If two axes of the
    /// wrist are aligned, axis 4 stays as near to the seed as possible.
    pub fn candidates(&self, target_in_root: &Pose, seed: &[f64; 6]) -> Vec<[f64; 6]> {
        let flange = self.flange_at(target_in_root);
        let rotation = OpwRotation::from_array(flange.rotation.to_quaternion_xyzw());
        let translation = flange.translation.to_array().into();
        match OpwPose::try_from_parts(translation, rotation) {
            Ok(pose) => self.model.inverse_continuing(&pose, seed),
            Err(_) => Vec::new(),
        }
    }
}

impl SphericalWrist {
    fn flange_at(&self, target_in_root: &Pose) -> Pose {
        self.base_in_root.inverse() * *target_in_root * self.tool_in_flange.inverse()
    }

    /// Largest difference (rad) between a solution of the arm and that of the model, away from singular positions.
    ///
    /// The deviation is enlarged by joint 3 or 1, and the result again by joint 5: each time at most by the inverse of
    /// [`least_sine`](Self::least_sine). So the cube root leaves a reserve of four.
    pub fn largest_difference(&self) -> f64 {
        self.deviation.cbrt()
    }

    /// Sine of an angle, or part of the arm's length, below which a position counts as singular.
    fn least_sine(&self) -> f64 {
        2.0 * self.deviation.cbrt()
    }

    /// Whether joints 1 to 3 of every solution of the arm are near those of a candidate: the wrist is neither above the base nor at
    /// an end of what the arm reaches.
    pub fn is_regular(&self, target_in_root: &Pose) -> bool {
        let Lengths { shoulder, aside, upper_arm, forearm } = self.lengths;
        let center = self.flange_at(target_in_root).translation;
        let length = self.lengths.sum();
        let beside_axis_1 = center.x.hypot(center.y);
        let ahead = (beside_axis_1 * beside_axis_1 - aside * aside).max(0.0).sqrt();
        // From the shoulder in front of axis 1, and from the one behind it. The sine of joint 3 grows like the root of the distance
        // from the end.
        let is_at_no_end = [ahead - shoulder, ahead + shoulder].iter().all(|ahead| {
            let away = ahead.hypot(center.z);
            let ends = [upper_arm + forearm, (upper_arm - forearm).abs()];
            ends.iter().all(|end| (away - end).abs() > 0.25 * self.least_sine().powi(2) * length)
        });
        beside_axis_1 - aside > self.least_sine() * length && is_at_no_end
    }

    /// Whether joints 4 to 6 of a candidate are near those of a solution: the axes of the wrist are not aligned.
    pub fn is_turned(&self, candidate: &[f64; 6]) -> bool {
        (candidate[4] - self.branches.straight).sin().abs() > self.least_sine()
    }
}

/// Sign: 1 if `axis_1` points from the arm's base to the arm.
fn away_from_base(axis_1: Vec3, shoulder_in_root: &Pose, arm: &Arm) -> f64 {
    let height = axis_1.dot(shoulder_in_root.translation - arm.base_in_root.translation);
    let along = if height.abs() > SLACK { height } else { axis_1.dot(arm.base_in_root.rotation * Vec3::Z) };
    if along < 0.0 { -1.0 } else { 1.0 }
}

/// The value nearest to the middle of the range of joint 5, of `aligned` and the values half turns away from it.
fn straight(aligned: f64, arm: &Arm) -> f64 {
    let range = &arm.variables[4];
    let middle = 0.5 * (range.lower + range.upper);
    let middle = if middle.is_finite() { middle } else { 0.0 };
    aligned + PI * ((middle - aligned) / PI).round()
}

type OpwRotation = rs_opw_kinematics::glam::DQuat;

/// The point where the three axes of the wrist intersect; `None` if they do not.
fn wrist_center(a4: &AxisInRoot, a5: &AxisInRoot, a6: &AxisInRoot) -> Option<Vec3> {
    let distance = |at: &AxisInRoot, p: Vec3| at.axis.cross(p - at.origin).length();
    // Axes 4 and 5 are perpendicular, so their common point is well defined; axes 4 and 6 may be parallel.
    let n = a4.axis.cross(a5.axis);
    let squared = n.length_squared();
    if squared < 0.5 {
        return None;
    }
    let t = (a5.origin - a4.origin).cross(a5.axis).dot(n) / squared;
    let center = a4.origin + a4.axis * t;
    (distance(a5, center) < SLACK && distance(a6, center) < SLACK).then_some(center)
}

/// Replaces a length that is zero but for rounding by exact zero: the model treats aligned axes as such only at
/// exact zeros.
fn snap(length: f64) -> f64 {
    if length.abs() < 1e-9 { 0.0 } else { length }
}

fn within_a_turn(angle: f64) -> f64 {
    angle % std::f64::consts::TAU
}
