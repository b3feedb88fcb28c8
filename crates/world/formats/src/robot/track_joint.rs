//! Joints inferred from animation tracks: finds the axis of rotation or translation of a node's keys.

use std::f64::consts::{PI, TAU};

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::nodetree::Node;

/// The motion of a node's keys.
pub(super) enum TrackJoint {
    /// The node does not move.
    None,
    /// The motion of a joint.
    Joint(InferredJoint),
    /// A motion that no single joint makes, with a description for messages.
    NoJoint(String),
}

/// An inferred joint, in the rest frame of the node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InferredJoint {
    pub(super) kind: JointKind,
    pub(super) axis: Vec3,
    /// A point on the axis, m; zero if the origin is on the axis.
    pub(super) at: Vec3,
    /// Range of the keys, rad or m; the rest frame is 0.
    pub(super) lower: f64,
    pub(super) upper: f64,
}

/// Angle (rad) below which a rotation is a rounding error of single precision.
const NOISE_RAD: f64 = 1e-5;
/// Angle (rad) below which directions are equal.
const SAME_DIRECTION_RAD: f64 = 2e-3;
/// Distance, as a fraction of the model's size, below which a translation is a rounding error.
const NOISE: f64 = 1e-5;
/// Largest deviation of a rotating node from its circle, as a fraction of the model's size.
const MAX_DEVIATION: f64 = 1e-3;

/// Infers the joint of a node's keys. The direction of the first motion is positive. `size` is the size of the model, m.
pub(super) fn infer_joint(node: &Node, size: f64) -> TrackJoint {
    if node.track.is_empty() {
        return TrackJoint::None;
    }
    let rest = node.in_parent;
    let mut poses = vec![(0.0, Pose::IDENTITY)];
    poses.extend(node.track.iter().map(|k| (k.time_s, rest.inverse_mul(&k.in_parent))));
    let turns: Vec<Vec3> =
        poses.windows(2).map(|w| (w[0].1.rotation.inverse() * w[1].1.rotation).to_rotation_vector()).collect();
    let largest_turn = turns.iter().fold(Vec3::ZERO, |most, w| if w.length() > most.length() { *w } else { most });
    if largest_turn.length() > NOISE_RAD {
        infer_rotation(&poses, &turns, largest_turn, size)
    } else {
        infer_translation(&poses, size)
    }
}

fn infer_rotation(poses: &[(f64, Pose)], turns: &[Vec3], largest_turn: Vec3, size: f64) -> TrackJoint {
    let axis = direction(turns, largest_turn, NOISE_RAD);
    let deviates = |w: &Vec3, axis: Vec3| {
        (*w - axis * w.dot(axis)).length() > SAME_DIRECTION_RAD * largest_turn.length() + NOISE_RAD
    };
    if turns.iter().any(|w| deviates(w, axis)) {
        let steps = || turns.iter().zip(poses.windows(2)).filter(|(w, _)| w.length() > NOISE_RAD);
        let unit = |w: &Vec3| snapped(w.try_normalize().unwrap_or(Vec3::Z));
        let first = steps().next().map_or(axis, |(w, _)| unit(w));
        let other = steps().find(|(w, _)| deviates(w, first)).map_or_else(String::new, |(w, p)| {
            format!(", but about {} between {:.2} s and {:.2} s", show_vector(unit(w)), p[0].0, p[1].0)
        });
        return TrackJoint::NoJoint(format!("rotates about {} at first{other}", show_vector(first)));
    }
    let mut angle = 0.0;
    let angles: Vec<f64> = std::iter::once(0.0)
        .chain(turns.iter().map(|w| {
            angle += w.dot(axis);
            angle
        }))
        .collect();
    let at = centre(poses, &angles, axis);
    let at = if at.length() < NOISE * size { Vec3::ZERO } else { at };
    for ((time, pose), angle) in poses.iter().zip(&angles) {
        let on_circle = at - Rotation::from_axis_angle(axis, *angle) * at;
        if pose.translation.distance(on_circle) > MAX_DEVIATION * size {
            return TrackJoint::NoJoint(format!(
                "rotates about {} and translates at once: at {time:.2} s it is {:.4} m off its circle",
                show_vector(axis),
                pose.translation.distance(on_circle)
            ));
        }
    }
    let range = range(&angles);
    let whole_turns = angle / TAU;
    let is_continuous = angle.abs() > PI && (whole_turns - whole_turns.round()).abs() < 1e-3;
    let kind = if is_continuous { JointKind::Continuous } else { JointKind::Revolute };
    TrackJoint::Joint(InferredJoint { kind, axis, at, lower: range.0, upper: range.1 })
}

/// The point of the axis nearest to the origin, computed from the key with the best-conditioned rotation.
fn centre(poses: &[(f64, Pose)], angles: &[f64], axis: Vec3) -> Vec3 {
    let best = |a: &(&(f64, Pose), &f64), b: &(&(f64, Pose), &f64)| {
        let size = |angle: f64| (angle * 0.5).sin().abs();
        size(*a.1).total_cmp(&size(*b.1))
    };
    let Some(((_, pose), angle)) = poses.iter().zip(angles).max_by(best) else { return Vec3::ZERO };
    let (sine, cosine) = (angle * 0.5).sin_cos();
    if sine.abs() < 1e-4 {
        return Vec3::ZERO;
    }
    let t = pose.translation;
    let across = t - axis * t.dot(axis);
    (across + axis.cross(across) * (cosine / sine)) * 0.5
}

fn infer_translation(poses: &[(f64, Pose)], size: f64) -> TrackJoint {
    let translations: Vec<Vec3> = poses.iter().map(|(_, pose)| pose.translation).collect();
    let longest = translations.iter().fold(Vec3::ZERO, |most, w| if w.length() > most.length() { *w } else { most });
    if longest.length() <= NOISE * size {
        return TrackJoint::None;
    }
    let axis = direction(&translations, longest, NOISE * size);
    for (way, (time, _)) in translations.iter().zip(poses) {
        if (*way - axis * way.dot(axis)).length() > SAME_DIRECTION_RAD * longest.length() + NOISE * size {
            return TrackJoint::NoJoint(format!(
                "translates along {} at first, but has left this line at {time:.2} s",
                show_vector(axis)
            ));
        }
    }
    let (lower, upper) = range(&translations.iter().map(|w| w.dot(axis)).collect::<Vec<_>>());
    TrackJoint::Joint(InferredJoint { kind: JointKind::Prismatic, axis, at: Vec3::ZERO, lower, upper })
}

/// The common direction of vectors that point back and forth along `longest`.
///
/// Its sign is that of the first vector that is longer than `noise`.
fn direction(vectors: &[Vec3], longest: Vec3, noise: f64) -> Vec3 {
    let sum = vectors.iter().fold(Vec3::ZERO, |sum, v| if v.dot(longest) < 0.0 { sum - *v } else { sum + *v });
    let axis = sum.try_normalize().or(longest.try_normalize()).unwrap_or(Vec3::Z);
    let first = vectors.iter().find(|v| v.length() > noise).copied().unwrap_or(axis);
    snapped(if first.dot(axis) < 0.0 { -axis } else { axis })
}

/// The coordinate axis, if the direction is one within single precision; else the direction.
fn snapped(axis: Vec3) -> Vec3 {
    let exact = axis.to_array().map(|x| if x.abs() < 1e-6 { 0.0 } else { x });
    Vec3::from(exact).try_normalize().unwrap_or(axis)
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((0.0, 0.0), |(low, high): (f64, f64), v| (low.min(*v), high.max(*v)))
}

/// Formats a vector with few digits, for messages.
pub(super) fn show_vector(v: Vec3) -> String {
    let number = |x: f64| {
        let text = format!("{:.4}", x + 0.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    };
    let [x, y, z] = v.to_array().map(number);
    format!("[{x}, {y}, {z}]")
}
