//! Arm with the dimensions of the Stäubli RX60B, the robot of the paper's test of proximity queries; the solids are
//! original.

use std::f64::consts::FRAC_PI_2;

use elbowroom_spatial::Vec3;

use super::arm::{self, Colours, Y, Z};
use super::model::{Form, Joint, Robot};
use super::parts::{bolt, skin};
use crate::solid::outline::{circle, rounded_rectangle, tapered_slot};
use crate::solid::{Mesh, along_minus_x, along_minus_y, along_y, extrude, lathe, ring, upright};

const ABOUT: &str = "
     Dimensions of the Staubli RX60B as commonly published; solids and colours are our own, and so are the signs:
     base_link stands on the floor, x forward, z up. At zero the arm stands straight up. joint_2, joint_3 and joint_5
     positive: what they carry leans forward. joint_1, joint_4 and joint_6 turn about z up.
     tool0 lies on the flange, z out of it. The forearm runs 49 mm beside the axis of the base.
     23,012 triangles in all, as many as the model of the paper's test has.
";

const COLOURS: Colours = Colours { paint: [0.93, 0.77, 0.16], cast: [0.30, 0.31, 0.33] };

/// Number of edges around the large round parts.
const ROUND: usize = 66;

/// The whole robot.
pub fn robot() -> Robot {
    Robot {
        name: "rx60b",
        about: ABOUT,
        form: Form::Urdf,
        links: arm::of_meshes([base(), shoulder(), upper_arm(), elbow(), forearm(), wrist(), flange()], &COLOURS),
        joints: joints(),
        disabled: Vec::new(),
    }
}

fn joints() -> Vec<Joint> {
    let axes = [
        ("joint_1", [0.0, 0.0, 0.341], Z, [-160.0, 160.0], 287.0),
        ("joint_2", [0.0; 3], Y, [-127.5, 127.5], 287.0),
        ("joint_3", [0.0, 0.049, 0.290], Y, [-134.5, 134.5], 319.0),
        ("joint_4", [0.0, 0.0, 0.100], Z, [-270.0, 270.0], 410.0),
        ("joint_5", [0.0, 0.0, 0.210], Y, [-109.5, 120.5], 320.0),
        ("joint_6", [0.0; 3], Z, [-270.0, 270.0], 700.0),
    ];
    arm::joints(&axes, [[0.0, 0.0, 0.065], [0.0; 3]])
}

/// Foot with four bolts, waisted pedestal, cable box with two plugs at the back.
fn base() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&upright([0.0; 3]), &extrude(&rounded_rectangle(0.26, 0.26, 0.045, 9), 0.0, 0.024, 0.006));
    let waist = (0..=10).map(|i| {
        let t = f64::from(i) / 10.0;
        [0.126 - 0.020 * (std::f64::consts::PI * t).sin() - 0.012 * t, 0.018 + 0.160 * t]
    });
    let profile: Vec<[f64; 2]> = waist.chain([[0.118, 0.186], [0.118, 0.198], [0.112, 0.2005]]).collect();
    mesh.add(&upright([0.0; 3]), &lathe(&profile, ROUND));
    for (x, y) in [(0.105, 0.105), (-0.105, 0.105), (-0.105, -0.105), (0.105, -0.105)] {
        mesh.add(&upright([x, y, 0.020]), &lathe(&[[0.010, 0.0], [0.010, 0.012], [0.0085, 0.014]], 12));
    }
    mesh.add(&upright([-0.108, 0.0, 0.040]), &extrude(&rounded_rectangle(0.07, 0.12, 0.012, 4), 0.0, 0.09, 0.006));
    for y in [-0.03, 0.03] {
        let plug = [[0.018, 0.0], [0.018, 0.014], [0.013, 0.018], [0.013, 0.030]];
        mesh.add(&along_minus_x([-0.139, y, 0.085]), &lathe(&plug, 24));
    }
    mesh
}

/// Turntable, the housing that rises from it, the barrel of axis 2 with its cover and screws.
fn shoulder() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&upright([0.0; 3]), &lathe(&drum(0.114, [-0.138, -0.096], 0.008, 4), ROUND));
    let section = |z: f64, depth: f64, width: f64, y: f64| (Vec3::new(0.0, y, z), [depth, width], 0.042);
    let rows = [
        section(-0.104, 0.205, 0.160, 0.020),
        section(-0.080, 0.200, 0.160, 0.026),
        section(-0.055, 0.190, 0.160, 0.032),
        section(-0.025, 0.180, 0.160, 0.037),
        section(0.005, 0.172, 0.160, 0.040),
        section(0.035, 0.160, 0.158, 0.040),
        section(0.060, 0.135, 0.150, 0.040),
    ];
    mesh.add(&upright([0.0; 3]), &upright_skin(&rows));
    mesh.add(&along_y([0.0; 3]), &lathe(&drum(0.095, [-0.045, 0.125], 0.014, 6), ROUND));
    mesh.add(&along_y([0.0, 0.120, 0.0]), &cap(0.068, 0.020, 36));
    mesh.add(&along_y([0.0; 3]), &screws(0.0745, 10, 0.125, 0.005));
    mesh
}

/// The tapered upper arm beside shoulder and elbow, covers over both its gears, a rib between them.
fn upper_arm() -> Mesh {
    let mut mesh = Mesh::new();
    let body = extrude(&tapered_slot(0.098, 0.086, 0.290, 0.016, 18), 0.048, 0.136, 0.018);
    mesh.add(&along_minus_y([0.0; 3]), &body);
    for (z, radius, count) in [(0.0, 0.074, 10), (0.290, 0.063, 8)] {
        mesh.add(&along_minus_y([0.0, -0.132, z]), &cap(radius, 0.018, ROUND));
        mesh.add(&along_minus_y([0.0, 0.0, z]), &screws(radius + 0.0055, count, 0.136, 0.0045));
    }
    mesh.add(&along_minus_y([0.0, 0.0, 0.145]), &extrude(&rounded_rectangle(0.05, 0.12, 0.02, 6), 0.130, 0.146, 0.006));
    // The inner side: a boss around each gear, up to the neighbours.
    mesh.add(&along_minus_y([0.0, -0.0455, 0.0]), &lathe(&[[0.080, 0.0], [0.080, 0.008]], ROUND));
    mesh.add(&along_minus_y([0.0, -0.0455, 0.290]), &lathe(&[[0.070, 0.0], [0.070, 0.008]], ROUND));
    mesh
}

/// The barrel of axis 3, the housing that rises to the collar of axis 4, and the motor at its side.
fn elbow() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&along_y([0.0; 3]), &lathe(&drum(0.083, [-0.0935, 0.078], 0.013, 5), ROUND));
    let rows = [
        (Vec3::new(0.0, -0.006, -0.020), [0.140, 0.150], 0.036),
        (Vec3::new(0.0, -0.006, 0.015), [0.150, 0.150], 0.040),
        (Vec3::new(0.0, -0.004, 0.045), [0.146, 0.146], 0.048),
        (Vec3::new(0.0, 0.0, 0.070), [0.138, 0.138], 0.056),
        (Vec3::new(0.0, 0.0, 0.088), [0.130, 0.130], 0.062),
    ];
    mesh.add(&upright([0.0; 3]), &upright_skin(&rows));
    mesh.add(&upright([0.0; 3]), &lathe(&drum(0.063, [0.080, 0.0985], 0.004, 3), ROUND));
    let motor = [[0.052, 0.0], [0.052, 0.008], [0.046, 0.012], [0.046, 0.050], [0.048, 0.053], [0.043, 0.062]];
    mesh.add(&along_y([0.0, 0.074, 0.0]), &lathe(&motor, 44));
    mesh.add(&along_y([0.0; 3]), &screws(0.0615, 10, 0.078, 0.0045));
    mesh
}

/// Turning collar and tapered tube, the fork around the wrist.
fn forearm() -> Mesh {
    let mut mesh = Mesh::new();
    let taper = (0..=6).map(|i| {
        let t = f64::from(i) / 6.0;
        [0.058 - 0.016 * (FRAC_PI_2 * t).sin(), 0.022 + 0.110 * t]
    });
    let tube: Vec<[f64; 2]> =
        [[0.056, 0.0005], [0.061, 0.004], [0.061, 0.018]].into_iter().chain(taper).chain([[0.030, 0.142]]).collect();
    mesh.add(&upright([0.0; 3]), &lathe(&tube, ROUND));
    let rows = [
        (Vec3::new(0.0, 0.0, 0.090), [0.066, 0.072], 0.030),
        (Vec3::new(0.0, 0.0, 0.112), [0.074, 0.094], 0.030),
        (Vec3::new(0.0, 0.0, 0.135), [0.078, 0.104], 0.028),
        (Vec3::new(0.0, 0.0, 0.152), [0.074, 0.104], 0.026),
    ];
    mesh.add(&upright([0.0; 3]), &upright_skin(&rows));
    for cheek in [along_y([0.0, 0.0, 0.210]), along_minus_y([0.0, 0.0, 0.210])] {
        // The v of the outline runs along z or against it: the part is turned so that it points back to the tube.
        let back = if cheek.transform_vector(Vec3::Y).z < 0.0 { 1.0 } else { -1.0 };
        let slot = tapered_slot(0.038, 0.034, 0.078, 0.0, 12);
        let outline: Vec<[f64; 2]> = slot.iter().map(|&[u, v]| [u * back, v * back]).collect();
        mesh.add(&cheek, &extrude(&outline, 0.034, 0.052, 0.006));
        mesh.add(&cheek, &lathe(&drum(0.028, [0.048, 0.058], 0.004, 2), 36));
    }
    mesh
}

/// The hand between the cheeks of the fork, bored along its axis.
fn wrist() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&along_y([0.0; 3]), &lathe(&drum(0.036, [-0.0335, 0.0335], 0.005, 4), 50));
    let snout = [
        [0.012, 0.020],
        [0.027, 0.020],
        [0.029, 0.026],
        [0.029, 0.040],
        [0.032, 0.044],
        [0.032, 0.054],
        [0.030, 0.056],
        [0.012, 0.056],
    ];
    mesh.add(&upright([0.0; 3]), &ring(&snout, 48));
    mesh
}

/// Flange disc with its bore and a circle of screws; its face is tool0.
fn flange() -> Mesh {
    let mut mesh = Mesh::new();
    let disc = [
        [0.0100, 0.0565],
        [0.0295, 0.0565],
        [0.0300, 0.0575],
        [0.0300, 0.0610],
        [0.0290, 0.0620],
        [0.0230, 0.0620],
        [0.0230, 0.0645],
        [0.0225, 0.0650],
        [0.0100, 0.0650],
    ];
    mesh.add(&upright([0.0; 3]), &ring(&disc, 52));
    mesh.add(&upright([0.0; 3]), &screws(0.0262, 6, 0.0620, 0.0024));
    mesh
}

/// Profile of a cylinder from `z[0]` to `z[1]` whose edges are rounded with radius `rim`, `arc` edges each.
fn drum(radius: f64, z: [f64; 2], rim: f64, arc: usize) -> Vec<[f64; 2]> {
    let step = |i: usize| {
        let (sin, cos) = (FRAC_PI_2 * i as f64 / arc as f64).sin_cos();
        [radius - rim * (1.0 - sin), rim * (1.0 - cos)]
    };
    let lower = (0..=arc).map(|i| [step(i)[0], z[0] + step(i)[1]]);
    let upper = (0..=arc).rev().map(|i| [step(i)[0], z[1] - step(i)[1]]);
    lower.chain(upper).collect()
}

/// A domed cover that stands on z = 0.
fn cap(radius: f64, height: f64, segments: usize) -> Mesh {
    const ARC: usize = 5;
    let dome = (0..=ARC).map(|i| {
        let (sin, cos) = (FRAC_PI_2 * 0.8 * i as f64 / ARC as f64).sin_cos();
        [radius * (0.7 + 0.3 * cos), height * (0.4 + 0.6 * sin)]
    });
    lathe(&[[radius, 0.0]].into_iter().chain(dome).collect::<Vec<_>>(), segments)
}

/// Hexagon heads on a circle about z, sunk a little into the plane at `z`.
fn screws(circle_radius: f64, count: usize, z: f64, radius: f64) -> Mesh {
    let mut mesh = Mesh::new();
    for [x, y] in circle(circle_radius, count) {
        mesh.add(&upright([x, y, z - radius * 0.5]), &bolt(radius, radius * 1.2));
    }
    mesh
}

/// A loft along z of rounded rectangles `(centre, size, corner radius)`.
fn upright_skin(rows: &[(Vec3, [f64; 2], f64)]) -> Mesh {
    skin(rows, 8, |[x, y]| Vec3::new(x, y, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_as_many_triangles_as_the_paper_says() {
        let per_link: Vec<(&str, usize)> =
            robot().links.iter().filter_map(|l| Some((l.name, l.solid.as_ref()?.triangles.len()))).collect();
        let total: usize = per_link.iter().map(|(_, count)| count).sum();
        assert_eq!(total, 23_012, "{per_link:?}");
    }
}
