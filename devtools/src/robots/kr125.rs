//! Arm with the dimensions of the KUKA KR125, the robot of the paper on joint-space models; the solids are original.

use super::arm::{self, Colours, X_BACK, Y, Z_DOWN};
use super::model::{Form, Joint, Primitive, PrimitiveKind, Robot};
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

const COLOURS: Colours = Colours { paint: [0.95, 0.46, 0.10], cast: [0.22, 0.23, 0.25] };

/// Height of the frame of joint 1 above the floor, m.
const FOOT: f64 = 0.35;
/// Distance from the elbow to the frame of joint 4, m.
const HALF_WAY: f64 = 0.55;

/// The whole robot.
pub fn robot() -> Robot {
    Robot {
        name: "kr125",
        about: ABOUT,
        form: Form::Urdf,
        links: arm::of_primitives([base(), column(), upper_arm(), elbow(), forearm(), wrist(), flange()], &COLOURS),
        joints: joints(),
        disabled: vec![
            // Within the limits of joint 5 the flange never reaches the fork.
            ("link_3", "link_5", "Never"),
            ("link_4", "link_6", "Never"),
        ],
    }
}

fn joints() -> Vec<Joint> {
    let tool_rpy = [0.0, FRAC_PI_2, 0.0];
    let axes = [
        ("joint_1", [0.0, 0.0, FOOT], Z_DOWN, [-185.0, 185.0], 100.0),
        ("joint_2", [0.41, 0.0, 0.515], Y, [-130.0, 3.0], 100.0),
        ("joint_3", [1.0, 0.0, 0.0], Y, [-120.0, 148.0], 100.0),
        ("joint_4", [HALF_WAY, 0.0, 0.045], X_BACK, [-350.0, 350.0], 154.0),
        ("joint_5", [0.45, 0.0, 0.0], Y, [-120.0, 120.0], 167.0),
        ("joint_6", [0.0, 0.0, 0.0], X_BACK, [-350.0, 350.0], 251.0),
    ];
    arm::joints(&axes, [[0.21, 0.0, 0.0], tool_rpy])
}

/// A base plate and a pedestal.
fn base() -> Vec<Primitive> {
    vec![cuboid([0.0, 0.0, 0.02], [0.9, 0.9, 0.04]), upright([0.0, 0.0, 0.19], 0.34, 0.30)]
}

/// A round part about axis 1, and the support of the shoulder.
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

/// A cylinder along y.
fn across(at: [f64; 3], radius: f64, length: f64) -> Primitive {
    Primitive { kind: PrimitiveKind::Cylinder { radius, length }, at, rpy: [FRAC_PI_2, 0.0, 0.0] }
}

/// A cylinder along x.
fn along(at: [f64; 3], radius: f64, length: f64) -> Primitive {
    Primitive { kind: PrimitiveKind::Cylinder { radius, length }, at, rpy: [0.0, FRAC_PI_2, 0.0] }
}
