//! Arm with the dimensions of the Comau SMART NS16 (arc version); the solids are original.

use elbowroom_spatial::Vec3;

use super::arm::{self, Colours, X, Y, Z};
use super::model::{Form, Joint, Robot};
use super::parts::{bolt, bolts, motor, skin};
use crate::solid::outline::{Outline, circle, rounded_rectangle, tapered_slot};
use crate::solid::{Mesh, along_minus_x, along_minus_y, along_x, along_y, extrude, lathe, ring, upright};
use std::f64::consts::{FRAC_PI_2, PI};

const ABOUT: &str = "
     Dimensions of the Comau SMART NS16, arc version; solids and colours are our own, and so are the signs and zeros:
     base_link stands on the floor, x forward, z up. At zero the upper arm is vertical and the forearm horizontal,
     pointing forward. joint_2 positive: the upper arm leans forward. joint_3 positive: the forearm dips.
     joint_5 positive: the hand dips. joint_1 turns about z up, joint_4 and joint_6 about x forward.
     tool0 lies on the flange, z out of it, x up at zero. Speeds are those usual for a 16 kg arm.
     The ranges are the published figures, counted from our zeros. The maker counts joint_3 from the straight arm and
     the other way round, where the forearm dips 80 and rises 200 degrees from our zero instead of 110 and 170.
";

const COLOURS: Colours = Colours { paint: [0.86, 0.24, 0.12], cast: [0.25, 0.26, 0.28] };

/// The whole robot.
pub fn robot() -> Robot {
    Robot {
        name: "ns16",
        about: ABOUT,
        form: Form::Urdf,
        links: arm::of_meshes([base(), column(), upper_arm(), elbow(), forearm(), wrist(), flange()], &COLOURS),
        joints: joints(),
        disabled: Vec::new(),
    }
}

fn joints() -> Vec<Joint> {
    // z of tool0 is x of link_6, x of tool0 is z of link_6.
    let tool_rpy = [PI, -FRAC_PI_2, 0.0];
    let axes = [
        ("joint_1", [0.0, 0.0, 0.251], Z, [-180.0, 180.0], 175.0),
        ("joint_2", [0.3, 0.0, 0.349], Y, [-50.0, 95.0], 155.0),
        ("joint_3", [0.0, 0.0, 0.7], Y, [-170.0, 110.0], 175.0),
        ("joint_4", [0.238, 0.0, 0.185], X, [-360.0, 360.0], 360.0),
        ("joint_5", [0.386, 0.0, 0.0], Y, [-180.0, 180.0], 375.0),
        ("joint_6", [0.106, 0.0, 0.0], X, [-360.0, 360.0], 550.0),
    ];
    arm::joints(&axes, [[0.014, 0.0, 0.0], tool_rpy])
}

/// Foot plate with four bolts, cast pedestal with gussets, cable box at the back.
fn base() -> Mesh {
    let mut mesh = Mesh::new();
    let pedestal = [
        [0.250, 0.020],
        [0.245, 0.042],
        [0.218, 0.062],
        [0.196, 0.105],
        [0.186, 0.150],
        [0.184, 0.185],
        [0.196, 0.202],
        [0.212, 0.208],
        [0.214, 0.238],
        [0.206, 0.249],
    ];
    mesh.add(&upright([0.0; 3]), &extrude(&rounded_rectangle(0.54, 0.54, 0.07, 6), 0.0, 0.036, 0.007));
    mesh.add(&upright([0.0; 3]), &lathe(&pedestal, 48));
    for (x, y) in [(0.21, 0.21), (-0.21, 0.21), (-0.21, -0.21), (0.21, -0.21)] {
        mesh.add(&upright([x, y, 0.030]), &bolt(0.021, 0.024));
        mesh.add(&upright([x, y, 0.033]), &lathe(&[[0.032, 0.0], [0.032, 0.008]], 16));
    }
    let cable_box = extrude(&rounded_rectangle(0.13, 0.20, 0.02, 3), 0.0, 0.14, 0.010);
    mesh.add(&upright([-0.215, 0.0, 0.050]), &cable_box);
    for y in [-0.05, 0.05] {
        mesh.add(
            &along_minus_x([-0.27, y, 0.12]),
            &lathe(&[[0.026, 0.0], [0.026, 0.022], [0.019, 0.026], [0.019, 0.045]], 16),
        );
    }
    mesh
}

/// Turntable, the leaning column with the shoulder housing, motors of axes 1 and 2.
fn column() -> Mesh {
    let mut mesh = Mesh::new();
    let table = [[0.200, 0.002], [0.208, 0.009], [0.208, 0.048], [0.198, 0.060]];
    mesh.add(&upright([0.0; 3]), &lathe(&table, 44));
    let section = |z: f64, x: f64, depth: f64, width: f64, y: f64| (Vec3::new(x, y, z), [depth, width], 0.045);
    let rows = [
        section(0.045, 0.015, 0.350, 0.310, 0.010),
        section(0.090, 0.035, 0.335, 0.285, 0.012),
        section(0.150, 0.090, 0.310, 0.240, 0.016),
        section(0.210, 0.160, 0.290, 0.210, 0.018),
        section(0.270, 0.230, 0.275, 0.196, 0.020),
        section(0.330, 0.280, 0.250, 0.190, 0.020),
        section(0.390, 0.298, 0.190, 0.184, 0.020),
    ];
    mesh.add(&upright([0.0; 3]), &skin(&rows, 4, |[x, y]| Vec3::new(x, y, 0.0)));
    let shoulder = [0.3, 0.0, 0.349];
    mesh.add(&along_y([0.3, -0.084, 0.349]), &extrude(&circle(0.148, 36), 0.0, 0.218, 0.014));
    mesh.add(&along_y([0.3, 0.0, 0.349]), &bolts(0.128, 12, 0.134, 0.006));
    mesh.add(&along_y([0.3, 0.128, shoulder[2]]), &motor(0.080, 0.185));
    mesh.add(&upright([-0.105, 0.0, 0.050]), &motor(0.082, 0.285));
    mesh
}

/// The tapered upper arm, beside the shoulder so that the forearm can pass; covers over both its gears.
fn upper_arm() -> Mesh {
    let mut mesh = Mesh::new();
    let inner = 0.078;
    mesh.add(&along_minus_y([0.0; 3]), &extrude(&tapered_slot(0.134, 0.106, 0.7, 0.028, 16), inner, 0.192, 0.026));
    let cover =
        |radius: f64| lathe(&[[radius, 0.0], [radius, 0.016], [radius * 0.94, 0.026], [radius * 0.70, 0.030]], 36);
    mesh.add(&along_minus_y([0.0, -0.184, 0.0]), &cover(0.100));
    mesh.add(&along_minus_y([0.0; 3]), &bolts(0.083, 10, 0.2125, 0.007));
    mesh.add(&along_minus_y([0.0, -0.184, 0.7]), &cover(0.078));
    mesh.add(&along_minus_y([0.0, 0.0, 0.7]), &bolts(0.064, 8, 0.2125, 0.006));
    let rail = extrude(&rounded_rectangle(0.075, 0.36, 0.030, 5), 0.185, 0.212, 0.009);
    mesh.add(&along_minus_y([0.0, 0.0, 0.355]), &rail);
    // The inner side: a boss around each gear, up to the neighbours.
    mesh.add(&along_minus_y([0.0, -0.070, 0.0]), &lathe(&[[0.104, 0.0], [0.104, 0.012]], 36));
    mesh.add(&along_minus_y([0.0, -0.071, 0.7]), &lathe(&[[0.080, 0.0], [0.080, 0.012]], 36));
    mesh
}

/// Elbow gear and its motor, the rise to the forearm axis, the housing with the three wrist motors behind it.
fn elbow() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&along_y([0.0, -0.074, 0.0]), &extrude(&circle(0.110, 32), 0.0, 0.166, 0.012));
    mesh.add(&along_y([0.0; 3]), &bolts(0.092, 10, 0.092, 0.006));
    mesh.add(&along_y([0.0, 0.088, 0.0]), &motor(0.062, 0.155));
    let rise = [
        (Vec3::new(0.0, 0.008, 0.0), [0.205, 0.150], 0.035),
        (Vec3::new(0.004, 0.006, 0.060), [0.215, 0.150], 0.035),
        (Vec3::new(0.016, 0.002, 0.110), [0.250, 0.149], 0.035),
        (Vec3::new(0.030, 0.0, 0.150), [0.290, 0.147], 0.035),
    ];
    mesh.add(&upright([0.0; 3]), &skin(&rise, 4, |[x, y]| Vec3::new(x, y, 0.0)));
    let housing = [
        (Vec3::new(-0.150, 0.0, 0.185), [0.140, 0.165], 0.040),
        (Vec3::new(-0.138, 0.0, 0.185), [0.154, 0.184], 0.050),
        (Vec3::new(0.060, 0.0, 0.185), [0.154, 0.184], 0.055),
        (Vec3::new(0.150, 0.0, 0.185), [0.154, 0.172], 0.070),
        (Vec3::new(0.225, 0.0, 0.185), [0.152, 0.156], 0.075),
    ];
    mesh.add(&upright([0.0; 3]), &skin(&housing, 4, |[y, z]| Vec3::new(0.0, y, z)));
    mesh.add(&along_x([0.216, 0.0, 0.185]), &lathe(&[[0.084, 0.0], [0.084, 0.016], [0.079, 0.020]], 36));
    for (y, z, radius, length) in
        [(0.0, 0.229, 0.036, 0.165), (0.037, 0.150, 0.032, 0.140), (-0.037, 0.150, 0.032, 0.140)]
    {
        mesh.add(&along_minus_x([-0.144, y, z]), &wrist_motor(radius, length));
    }
    mesh
}

fn wrist_motor(radius: f64, length: f64) -> Mesh {
    let body = [
        [radius, 0.0],
        [radius, length * 0.55],
        [radius * 0.90, length * 0.58],
        [radius * 0.90, length * 0.66],
        [radius, length * 0.69],
        [radius, length * 0.93],
        [radius * 0.82, length],
    ];
    lathe(&body, 18)
}

/// Turning collar, tapered tube, fork around the wrist.
fn forearm() -> Mesh {
    let mut mesh = Mesh::new();
    let tube = [
        [0.072, -0.006],
        [0.078, 0.000],
        [0.078, 0.026],
        [0.071, 0.034],
        [0.068, 0.080],
        [0.061, 0.190],
        [0.057, 0.240],
        [0.052, 0.290],
        [0.040, 0.306],
    ];
    mesh.add(&along_x([0.0; 3]), &lathe(&tube, 40));
    mesh.add(&along_x([0.0; 3]), &bolts(0.064, 8, 0.030, 0.007));
    let shoulder = [
        (Vec3::new(0.205, 0.0, 0.0), [0.094, 0.086], 0.036),
        (Vec3::new(0.245, 0.0, 0.0), [0.128, 0.098], 0.030),
        (Vec3::new(0.320, 0.0, 0.0), [0.132, 0.096], 0.022),
    ];
    mesh.add(&upright([0.0; 3]), &skin(&shoulder, 4, |[y, z]| Vec3::new(0.0, y, z)));
    for side in [1.0, -1.0] {
        // The outline's v runs from the wrist back along the forearm.
        let turned: Outline = tapered_slot(0.049, 0.043, 0.086, 0.0, 12).iter().map(|&[u, v]| [-v, u]).collect();
        let cheek = if side > 0.0 { along_y([0.386, 0.0, 0.0]) } else { along_minus_y([0.386, 0.0, 0.0]) };
        mesh.add(&cheek, &extrude(&turned, 0.041, 0.066, 0.008));
        mesh.add(&cheek, &lathe(&[[0.036, 0.060], [0.036, 0.070], [0.030, 0.075]], 24));
    }
    mesh
}

/// The hand between the cheeks of the fork, bored along its axis.
fn wrist() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&along_y([0.0, -0.0425, 0.0]), &extrude(&circle(0.046, 32), 0.0, 0.085, 0.005));
    let snout = [
        [0.018, 0.030],
        [0.038, 0.030],
        [0.040, 0.036],
        [0.040, 0.072],
        [0.044, 0.078],
        [0.044, 0.098],
        [0.041, 0.101],
        [0.018, 0.101],
    ];
    mesh.add(&along_x([0.0; 3]), &ring(&snout, 36));
    let cover = extrude(&rounded_rectangle(0.040, 0.050, 0.010, 3), 0.030, 0.0445, 0.004);
    mesh.add(&upright([0.036, 0.0, 0.0]), &cover);
    mesh
}

/// Flange disc with its bore and a circle of bolts; its face is tool0.
fn flange() -> Mesh {
    let mut mesh = Mesh::new();
    let disc = [
        [0.0125, -0.0045],
        [0.0395, -0.0045],
        [0.0400, -0.0030],
        [0.0400, 0.0050],
        [0.0390, 0.0060],
        [0.0315, 0.0060],
        [0.0315, 0.0132],
        [0.0307, 0.0140],
        [0.0125, 0.0140],
    ];
    mesh.add(&along_x([0.0; 3]), &ring(&disc, 40));
    mesh.add(&along_x([0.0; 3]), &bolts(0.0357, 8, 0.0055, 0.0033));
    mesh
}
