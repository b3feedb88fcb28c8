//! Arm with the dimensions of the KUKA KR150, the robot of the paper on kinematics from 3-D models; the solids are
//! original.

use std::f64::consts::FRAC_PI_2;

use elbowroom_spatial::Vec3;

use super::arm::{self, Colours, X_BACK, Y, Z_DOWN};
use super::model::{Form, Joint, Robot};
use super::parts::{bolt, skin};
use crate::solid::outline::{Outline, rounded_rectangle, tapered_slot};
use crate::solid::{Mesh, along_minus_x, along_minus_y, along_x, along_y, extrude, lathe, ring, upright};

const ABOUT: &str = "
     Dimensions, ranges and speeds of the KUKA KR150, with its signs and zeros; solids and colours are our own.
     base_link stands on the floor, x forward, z up. At zero the arm is stretched forward.
     joint_a1 positive turns to the right, seen from above. joint_a2 and joint_a3 positive: what they carry dips; the
     upper arm stands upright at -90 degrees. joint_a4 and joint_a6 turn about x backward, joint_a5 positive dips.
     tool0 lies on the flange, z out of it, x down at zero.
";

const COLOURS: Colours = Colours { paint: [0.93, 0.45, 0.11], cast: [0.22, 0.23, 0.25] };

/// Height of the shoulder, and its distance in front of axis 1, m.
const SHOULDER: [f64; 2] = [0.75, 0.35];
/// Distance between shoulder and elbow, m.
const UPPER_ARM: f64 = 1.25;
/// Distance from the elbow down to the axis of the forearm, at zero joint values, m.
const DROP: f64 = 0.055;
/// Distance from above the elbow to the wrist, m.
const FOREARM: f64 = 1.1;
/// Distance from the wrist to the flange, m.
const HAND: f64 = 0.23;
/// Height of the bearing of axis 1, m.
const BEARING: f64 = 0.32;

/// The whole robot.
pub fn robot() -> Robot {
    Robot {
        name: "kr150",
        about: ABOUT,
        form: Form::Tds,
        links: arm::of_meshes([base(), carousel(), upper_arm(), elbow(), forearm(), wrist(), flange()], &COLOURS),
        joints: joints(),
        disabled: vec![("link_4", "link_6", "Never")],
    }
}

fn joints() -> Vec<Joint> {
    let [height, offset] = SHOULDER;
    let tool_rpy = [0.0, FRAC_PI_2, 0.0];
    let axes = [
        ("joint_a1", [0.0, 0.0, height], Z_DOWN, [-185.0, 185.0], 110.0),
        ("joint_a2", [offset, 0.0, 0.0], Y, [-146.0, 0.0], 110.0),
        ("joint_a3", [UPPER_ARM, 0.0, 0.0], Y, [-119.0, 155.0], 100.0),
        ("joint_a4", [0.0, 0.0, -DROP], X_BACK, [-350.0, 350.0], 170.0),
        ("joint_a5", [FOREARM, 0.0, 0.0], Y, [-125.0, 125.0], 170.0),
        ("joint_a6", [HAND, 0.0, 0.0], X_BACK, [-350.0, 350.0], 238.0),
    ];
    arm::joints(&axes, [[0.0; 3], tool_rpy])
}

/// Foot plate, cast pedestal, cable box at the back.
fn base() -> Mesh {
    let mut mesh = Mesh::new();
    let pedestal = [[0.40, 0.03], [0.385, 0.07], [0.35, 0.12], [0.335, 0.22], [0.36, 0.25], [0.37, BEARING - 0.004]];
    mesh.add(&upright([0.0; 3]), &extrude(&rounded_rectangle(0.83, 0.83, 0.12, 3), 0.0, 0.06, 0.010));
    mesh.add(&upright([0.0; 3]), &lathe(&pedestal, 32));
    for (x, y) in [(0.33, 0.33), (-0.33, 0.33), (-0.33, -0.33), (0.33, -0.33)] {
        mesh.add(&upright([x, y, 0.05]), &bolt(0.030, 0.040));
    }
    let box_behind = extrude(&rounded_rectangle(0.20, 0.30, 0.03, 2), 0.0, 0.22, 0.0);
    mesh.add(&upright([-0.40, 0.0, 0.05]), &box_behind);
    mesh
}

/// Turntable and turret up to the shoulder, beside which the upper arm turns; motors of axes 1 and 2.
fn carousel() -> Mesh {
    let mut mesh = Mesh::new();
    let bottom = BEARING - SHOULDER[0];
    let table = [[0.36, bottom + 0.004], [0.375, bottom + 0.015], [0.375, bottom + 0.085], [0.35, bottom + 0.105]];
    mesh.add(&upright([0.0; 3]), &lathe(&table, 32));
    let section = |z: f64, x: f64, depth: f64, width: f64, y: f64| (Vec3::new(x, y, bottom + z), [depth, width], 0.07);
    let turret = [
        section(0.08, 0.00, 0.62, 0.56, 0.03),
        section(0.16, 0.04, 0.60, 0.48, 0.06),
        section(0.26, 0.13, 0.58, 0.38, 0.08),
        section(0.36, 0.24, 0.50, 0.32, 0.09),
        section(0.43, 0.33, 0.40, 0.29, 0.095),
    ];
    mesh.add(&upright([0.0; 3]), &skin(&turret, 4, |[x, y]| Vec3::new(x, y, 0.0)));
    let x = SHOULDER[1];
    mesh.add(&along_y([x, -0.055, 0.0]), &drum(0.225, 0.30, 32));
    mesh.add(&along_y([x, 0.238, 0.0]), &motor(0.105, 0.27, 20));
    mesh.add(&upright([-0.18, 0.06, bottom + 0.09]), &motor(0.105, 0.40, 20));
    mesh
}

/// Tapered upper arm, beside shoulder and elbow, with covers over both gears and a rail for the cables.
fn upper_arm() -> Mesh {
    let mut mesh = Mesh::new();
    // The outline runs along its v, which is along the link's x.
    let plate: Outline = tapered_slot(0.215, 0.165, UPPER_ARM, 0.045, 12).iter().map(|&[u, v]| [v, -u]).collect();
    mesh.add(&along_minus_y([0.0; 3]), &extrude(&plate, 0.065, 0.235, 0.03));
    let cover = |radius: f64| lathe(&[[radius, 0.0], [radius, 0.02], [radius * 0.9, 0.034]], 28);
    mesh.add(&along_minus_y([0.0, -0.230, 0.0]), &cover(0.155));
    mesh.add(&along_minus_y([UPPER_ARM, -0.230, 0.0]), &cover(0.115));
    mesh.add(&along_minus_y([0.0, -0.056, 0.0]), &lathe(&[[0.165, 0.0], [0.165, 0.02]], 28));
    mesh.add(&along_minus_y([UPPER_ARM, -0.056, 0.0]), &lathe(&[[0.125, 0.0], [0.125, 0.02]], 28));
    let rail = extrude(&rounded_rectangle(0.62, 0.13, 0.05, 3), 0.228, 0.268, 0.0);
    mesh.add(&along_minus_y([0.62, 0.0, 0.0]), &rail);
    mesh
}

/// Gear of axis 3 and its motor, the housing about the forearm's axis, and behind it the wrist's motors as counterweight.
fn elbow() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&along_y([0.0, -0.055, 0.0]), &drum(0.175, 0.225, 28));
    mesh.add(&along_y([0.0, 0.163, 0.0]), &motor(0.085, 0.23, 20));
    let at = |x: f64, depth: f64, width: f64, radius: f64| (Vec3::new(x, 0.035, -DROP), [depth, width], radius);
    let housing = [
        at(-0.42, 0.20, 0.22, 0.05),
        at(-0.39, 0.26, 0.28, 0.06),
        at(-0.12, 0.26, 0.29, 0.07),
        at(0.10, 0.25, 0.28, 0.09),
        (Vec3::new(0.24, 0.01, -DROP), [0.24, 0.25], 0.11),
        (Vec3::new(0.36, 0.0, -DROP), [0.23, 0.23], 0.11),
    ];
    mesh.add(&upright([0.0; 3]), &skin(&housing, 4, |[y, z]| Vec3::new(0.0, y, z)));
    for (y, z, radius, length) in
        [(0.035, 0.03, 0.062, 0.24), (-0.035, -0.115, 0.055, 0.21), (0.105, -0.115, 0.055, 0.21)]
    {
        mesh.add(&along_minus_x([-0.41, y, z]), &motor(radius, length, 16));
    }
    mesh
}

/// The tube that turns about its axis, and the fork around the wrist.
fn forearm() -> Mesh {
    let mut mesh = Mesh::new();
    let tube =
        [[0.118, 0.365], [0.125, 0.375], [0.125, 0.42], [0.112, 0.44], [0.104, 0.70], [0.092, 0.86], [0.07, 0.90]];
    mesh.add(&along_x([0.0; 3]), &lathe(&tube, 32));
    let fork = [
        (Vec3::new(0.78, 0.0, 0.0), [0.16, 0.16], 0.06),
        (Vec3::new(0.86, 0.0, 0.0), [0.22, 0.17], 0.05),
        (Vec3::new(0.96, 0.0, 0.0), [0.23, 0.16], 0.03),
    ];
    mesh.add(&upright([0.0; 3]), &skin(&fork, 4, |[y, z]| Vec3::new(0.0, y, z)));
    for cheek in [along_y([FOREARM, 0.0, 0.0]), along_minus_y([FOREARM, 0.0, 0.0])] {
        let outline: Outline = tapered_slot(0.085, 0.075, 0.17, 0.0, 6).iter().map(|&[u, v]| [-v, u]).collect();
        mesh.add(&cheek, &extrude(&outline, 0.075, 0.118, 0.012));
        mesh.add(&cheek, &lathe(&[[0.062, 0.108], [0.062, 0.124], [0.052, 0.132]], 20));
    }
    mesh
}

/// The wrist between the cheeks of the fork.
fn wrist() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&along_y([0.0, -0.073, 0.0]), &drum(0.080, 0.146, 28));
    let snout = [
        [0.030, 0.05],
        [0.066, 0.05],
        [0.070, 0.06],
        [0.070, 0.13],
        [0.078, 0.14],
        [0.078, 0.192],
        [0.074, 0.198],
        [0.030, 0.198],
    ];
    mesh.add(&along_x([0.0; 3]), &ring(&snout, 28));
    mesh
}

/// Flange disc with its bore and bolts; its face is tool0.
fn flange() -> Mesh {
    let mut mesh = Mesh::new();
    let disc = [
        [0.025, -0.030],
        [0.078, -0.030],
        [0.080, -0.026],
        [0.080, -0.012],
        [0.076, -0.008],
        [0.0625, -0.008],
        [0.0625, -0.001],
        [0.0615, 0.0],
        [0.025, 0.0],
    ];
    mesh.add(&along_x([0.0; 3]), &ring(&disc, 32));
    mesh
}

/// A drum upright on z = 0, with both rims bevelled.
fn drum(radius: f64, length: f64, segments: usize) -> Mesh {
    let bevel = radius * 0.07;
    lathe(&[[radius - bevel, 0.0], [radius, bevel], [radius, length - bevel], [radius - bevel, length]], segments)
}

/// A motor of a length, standing on z = 0: body and cap.
fn motor(radius: f64, length: f64, segments: usize) -> Mesh {
    let narrow = radius * 0.92;
    let body = [
        [radius, 0.0],
        [radius, length * 0.60],
        [narrow, length * 0.63],
        [narrow, length * 0.94],
        [radius * 0.7, length],
    ];
    lathe(&body, segments)
}
