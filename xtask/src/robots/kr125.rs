//! An arm with the dimensions of the KUKA KR125, the robot of the paper on joint-space models; solids of our own.

use super::{Form, Joint, Link, Primitive, PrimitiveKind, Robot, Turn};
use std::f64::consts::FRAC_PI_2;

const ABOUT: &str = "
     Dimensions of the KUKA KR125 as its published Denavit-Hartenberg table has them, and its signs and zeros; solids and
     colours are our own. base_link stands on the floor, x forward, z up. At zero the arm is stretched forward.
     joint_1 positive turns to the right, seen from above. joint_2 and joint_3 positive: what they carry dips; the
     upper arm stands upright at -90 degrees. joint_4 and joint_6 turn about x backward, joint_5 positive dips.
     tool0 lies on the flange, z out of it, x down at zero.
     All solids are convex, and within the capsules and the sphere of the planar arm KR125 of the joint-space map;
     what is not, turns about axis 1 and is round.
";

const PAINT: [f64; 3] = [0.95, 0.46, 0.10];
const CAST: [f64; 3] = [0.22, 0.23, 0.25];
const STEEL: [f64; 3] = [0.72, 0.73, 0.75];

/// Height of the frame of joint 1 above the floor, metres.
const FOOT: f64 = 0.35;
/// From the elbow to the frame of joint 4, metres.
const HALF_WAY: f64 = 0.55;

/// The whole robot.
pub fn robot() -> Robot {
    let solid = |name, primitives, colour| Link { name, solid: None, primitives, colour };
    Robot {
        name: "kr125",
        about: ABOUT,
        form: Form::Urdf,
        links: vec![
            solid("base_link", base(), CAST),
            solid("link_1", column(), PAINT),
            solid("link_2", upper_arm(), PAINT),
            solid("link_3", elbow(), PAINT),
            solid("link_4", forearm(), PAINT),
            solid("link_5", wrist(), CAST),
            solid("link_6", flange(), STEEL),
            solid("tool0", Vec::new(), STEEL),
        ],
        joints: joints(),
        disabled: vec![
            // Within the limits of joint 5 the flange stays clear of the fork.
            ("link_3", "link_5", "Never"),
            ("link_4", "link_6", "Never"),
        ],
    }
}

fn joints() -> Vec<Joint> {
    const X_BACK: [f64; 3] = [-1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    let turning = |name, parent, child, xyz, axis, range_deg, speed_deg_s| {
        let turns = Some(Turn { axis, range_deg, speed_deg_s });
        Joint { name, parent, child, xyz, rpy: [0.0; 3], turns }
    };
    let tool_rpy = [0.0, FRAC_PI_2, 0.0];
    vec![
        turning("joint_1", "base_link", "link_1", [0.0, 0.0, FOOT], [0.0, 0.0, -1.0], [-185.0, 185.0], 100.0),
        turning("joint_2", "link_1", "link_2", [0.41, 0.0, 0.515], Y, [-130.0, 3.0], 100.0),
        turning("joint_3", "link_2", "link_3", [1.0, 0.0, 0.0], Y, [-120.0, 148.0], 100.0),
        turning("joint_4", "link_3", "link_4", [HALF_WAY, 0.0, 0.045], X_BACK, [-350.0, 350.0], 154.0),
        turning("joint_5", "link_4", "link_5", [0.45, 0.0, 0.0], Y, [-120.0, 120.0], 167.0),
        turning("joint_6", "link_5", "link_6", [0.0, 0.0, 0.0], X_BACK, [-350.0, 350.0], 251.0),
        Joint { name: "flange", parent: "link_6", child: "tool0", xyz: [0.21, 0.0, 0.0], rpy: tool_rpy, turns: None },
    ]
}

/// A foot plate and a pedestal.
fn base() -> Vec<Primitive> {
    vec![cuboid([0.0, 0.0, 0.02], [0.9, 0.9, 0.04]), upright([0.0, 0.0, 0.19], 0.34, 0.30)]
}

/// Round about axis 1, and what carries the shoulder.
fn column() -> Vec<Primitive> {
    vec![
        upright([0.0, 0.0, 0.10], 0.38, 0.16),
        upright([0.0, 0.0, 0.30], 0.33, 0.26),
        cuboid([0.36, 0.0, 0.46], [0.12, 0.20, 0.12]),
        across([0.41, 0.0, 0.515], 0.13, 0.28),
    ]
}

/// A beam with a hub at either end.
fn upper_arm() -> Vec<Primitive> {
    vec![
        across([0.0, 0.0, 0.0], 0.155, 0.24),
        cuboid([0.5, 0.0, 0.0], [0.9, 0.16, 0.24]),
        across([1.0, 0.0, 0.0], 0.13, 0.26),
    ]
}

/// Hub, the wrist's motors behind it, the forearm's first half.
fn elbow() -> Vec<Primitive> {
    vec![
        across([0.0, 0.0, 0.0], 0.15, 0.24),
        cuboid([0.01, 0.0, 0.03], [0.26, 0.20, 0.16]),
        along([0.325, 0.0, 0.045], 0.125, 0.45),
    ]
}

/// The forearm's second half and the fork of the wrist: turns about x.
fn forearm() -> Vec<Primitive> {
    vec![
        along([0.145, 0.0, 0.0], 0.105, 0.29),
        cuboid([0.385, 0.085, 0.0], [0.25, 0.03, 0.14]),
        cuboid([0.385, -0.085, 0.0], [0.25, 0.03, 0.14]),
    ]
}

/// Between the fork's prongs.
fn wrist() -> Vec<Primitive> {
    vec![across([0.0, 0.0, 0.0], 0.07, 0.13), along([0.07, 0.0, 0.0], 0.065, 0.12)]
}

fn flange() -> Vec<Primitive> {
    vec![along([0.17, 0.0, 0.0], 0.08, 0.08)]
}

fn cuboid(at: [f64; 3], size: [f64; 3]) -> Primitive {
    Primitive { kind: PrimitiveKind::Box(size), at, rpy: [0.0; 3] }
}

fn upright(at: [f64; 3], radius: f64, length: f64) -> Primitive {
    Primitive { kind: PrimitiveKind::Cylinder { radius, length }, at, rpy: [0.0; 3] }
}

/// Along y.
fn across(at: [f64; 3], radius: f64, length: f64) -> Primitive {
    Primitive { kind: PrimitiveKind::Cylinder { radius, length }, at, rpy: [FRAC_PI_2, 0.0, 0.0] }
}

/// Along x.
fn along(at: [f64; 3], radius: f64, length: f64) -> Primitive {
    Primitive { kind: PrimitiveKind::Cylinder { radius, length }, at, rpy: [0.0, FRAC_PI_2, 0.0] }
}
