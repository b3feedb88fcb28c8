//! Joints out of tracks: the axis that a node's keys turn about or slide along.

use std::f64::consts::{PI, TAU};

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::nodetree::Node;

/// What the keys of a node say.
pub(super) enum Motion {
    /// They do not move it.
    None,
    /// They move it as a joint does.
    Joint(Found),
    /// They move it otherwise; in words.
    Unclear(String),
}

/// A joint, in the node's frame at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) kind: JointKind,
    pub(super) axis: Vec3,
    /// A point on the axis; zero where the origin is one.
    pub(super) at: Vec3,
    /// Ends of the keys, rad or m; the frame at rest is 0.
    pub(super) lower: f64,
    pub(super) upper: f64,
}

/// Rotations below this (rad) are noise of single precision.
const STILL_RAD: f64 = 1e-5;
/// Directions may differ by this (rad) and still be one.
const SAME_RAD: f64 = 2e-3;
/// Of the model's size: ways below this are noise.
const STILL: f64 = 1e-5;
/// Of the model's size: a turning node may stray so far from its circle.
const STRAY: f64 = 1e-3;

/// Finds the joint of a node's keys. The positive sense is that of its first motion. `size` is the model's (m).
pub(super) fn motion(node: &Node, size: f64) -> Motion {
    if node.track.is_empty() {
        return Motion::None;
    }
    let rest = node.in_parent;
    let mut poses = vec![(0.0, Pose::IDENTITY)];
    poses.extend(node.track.iter().map(|k| (k.time_s, rest.inverse_mul(&k.in_parent))));
    let turns: Vec<Vec3> =
        poses.windows(2).map(|w| (w[0].1.rotation.inverse() * w[1].1.rotation).to_rotation_vector()).collect();
    let widest = turns.iter().fold(Vec3::ZERO, |most, w| if w.length() > most.length() { *w } else { most });
    if widest.length() > STILL_RAD { turning(&poses, &turns, widest, size) } else { sliding(&poses, size) }
}

fn turning(poses: &[(f64, Pose)], turns: &[Vec3], widest: Vec3, size: f64) -> Motion {
    let axis = direction(turns, widest, STILL_RAD);
    let strays = |w: &Vec3, axis: Vec3| (*w - axis * w.dot(axis)).length() > SAME_RAD * widest.length() + STILL_RAD;
    if turns.iter().any(|w| strays(w, axis)) {
        let steps = || turns.iter().zip(poses.windows(2)).filter(|(w, _)| w.length() > STILL_RAD);
        let unit = |w: &Vec3| clean(w.try_normalize().unwrap_or(Vec3::Z));
        let first = steps().next().map_or(axis, |(w, _)| unit(w));
        let other = steps().find(|(w, _)| strays(w, first)).map_or_else(String::new, |(w, p)| {
            format!(", but about {} between {:.2} s and {:.2} s", show(unit(w)), p[0].0, p[1].0)
        });
        return Motion::Unclear(format!("turns about {} at first{other}", show(first)));
    }
    let mut angle = 0.0;
    let angles: Vec<f64> = std::iter::once(0.0)
        .chain(turns.iter().map(|w| {
            angle += w.dot(axis);
            angle
        }))
        .collect();
    let at = centre(poses, &angles, axis);
    let at = if at.length() < STILL * size { Vec3::ZERO } else { at };
    for ((time, pose), angle) in poses.iter().zip(&angles) {
        let on_circle = at - Rotation::from_axis_angle(axis, *angle) * at;
        if pose.translation.distance(on_circle) > STRAY * size {
            return Motion::Unclear(format!(
                "turns about {} and slides at once: at {time:.2} s it is {:.4} m off its circle",
                show(axis),
                pose.translation.distance(on_circle)
            ));
        }
    }
    let ends = ends(&angles);
    let whole_turns = angle / TAU;
    let endless = angle.abs() > PI && (whole_turns - whole_turns.round()).abs() < 1e-3;
    let kind = if endless { JointKind::Continuous } else { JointKind::Revolute };
    Motion::Joint(Found { kind, axis, at, lower: ends.0, upper: ends.1 })
}

/// The point of the axis next to the origin, from the key that shows it best.
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

fn sliding(poses: &[(f64, Pose)], size: f64) -> Motion {
    let ways: Vec<Vec3> = poses.iter().map(|(_, pose)| pose.translation).collect();
    let longest = ways.iter().fold(Vec3::ZERO, |most, w| if w.length() > most.length() { *w } else { most });
    if longest.length() <= STILL * size {
        return Motion::None;
    }
    let axis = direction(&ways, longest, STILL * size);
    for (way, (time, _)) in ways.iter().zip(poses) {
        if (*way - axis * way.dot(axis)).length() > SAME_RAD * longest.length() + STILL * size {
            return Motion::Unclear(format!(
                "slides along {} at first, but has left this line at {time:.2} s",
                show(axis)
            ));
        }
    }
    let (lower, upper) = ends(&ways.iter().map(|w| w.dot(axis)).collect::<Vec<_>>());
    Motion::Joint(Found { kind: JointKind::Prismatic, axis, at: Vec3::ZERO, lower, upper })
}

/// The common direction of vectors that point to and fro along `longest`, in the sense of the first that is longer than
/// `still`.
fn direction(vectors: &[Vec3], longest: Vec3, still: f64) -> Vec3 {
    let sum = vectors.iter().fold(Vec3::ZERO, |sum, v| if v.dot(longest) < 0.0 { sum - *v } else { sum + *v });
    let axis = sum.try_normalize().or(longest.try_normalize()).unwrap_or(Vec3::Z);
    let first = vectors.iter().find(|v| v.length() > still).copied().unwrap_or(axis);
    clean(if first.dot(axis) < 0.0 { -axis } else { axis })
}

/// An axis of the frame where it is one but for single precision.
fn clean(axis: Vec3) -> Vec3 {
    let exact = axis.to_array().map(|x| if x.abs() < 1e-6 { 0.0 } else { x });
    Vec3::from(exact).try_normalize().unwrap_or(axis)
}

fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((0.0, 0.0), |(low, high): (f64, f64), v| (low.min(*v), high.max(*v)))
}

/// A direction with few digits.
pub(super) fn show(v: Vec3) -> String {
    let number = |x: f64| {
        let text = format!("{:.4}", x + 0.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    };
    let [x, y, z] = v.to_array().map(number);
    format!("[{x}, {y}, {z}]")
}
