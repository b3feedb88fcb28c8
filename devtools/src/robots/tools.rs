//! Tools in the flange frame: mounted at the origin, z out of the flange.

use super::model::File;
use crate::solid::outline::{circle, rounded_rectangle};
use crate::solid::{Mesh, along_minus_x, along_x, along_y, binary_stl, extrude, lathe, upright};

/// Returns every tool's mesh.
pub fn files() -> Result<Vec<File>, String> {
    let named = |name: &str, mesh: Mesh| -> Result<File, String> {
        mesh.check().map_err(|e| format!("{name}: {e}"))?;
        Ok((format!("tools/{name}.stl"), binary_stl(&mesh)))
    };
    Ok(vec![
        named("torch", torch())?,
        named("gripper", gripper())?,
        named("mill", mill())?,
        named("ball_probe", ball_probe())?,
    ])
}

/// A mill of 3 mm with a round end in a drive of 24 mm; its tip is at z = 0.140 m.
fn mill() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&upright([0.0; 3]), &lathe(&[[0.019, 0.0], [0.020, 0.001], [0.020, 0.010], [0.018, 0.012]], 28));
    mesh.add(&upright([0.0; 3]), &lathe(&[[0.012, 0.009], [0.012, 0.080], [0.006, 0.092], [0.005, 0.094]], 24));
    let mut cutter = vec![[0.0015, 0.090]];
    cutter.extend(round_end(0.0015, 0.140, 5));
    mesh.add(&upright([0.0; 3]), &lathe(&cutter, 14));
    mesh
}

/// A ball of 16 mm on a stem of 8 mm; it ends at z = 0.120 m.
fn ball_probe() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&upright([0.0; 3]), &lathe(&[[0.019, 0.0], [0.020, 0.001], [0.020, 0.010], [0.018, 0.012]], 28));
    mesh.add(&upright([0.0; 3]), &lathe(&[[0.004, 0.009], [0.004, 0.110]], 20));
    let mut ball: Vec<_> = round_end(0.008, 0.120, 9).iter().rev().map(|&[r, z]| [r, 0.224 - z]).collect();
    ball.pop();
    ball.extend(round_end(0.008, 0.120, 9));
    mesh.add(&upright([0.0; 3]), &lathe(&ball, 36));
    mesh
}

/// The profile of a half ball that ends nearly at `z`, from its equator on.
fn round_end(radius: f64, z: f64, steps: usize) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * k as f64 / (steps as f64 + 0.5)).sin_cos();
        [radius * cos, z - radius + radius * sin]
    };
    (0..=steps).map(at).collect()
}

/// A straight welding torch for an arm with a hollow wrist: 80 × 80 × 250 mm, its contact tip at z = 0.250 m.
fn torch() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&upright([0.0; 3]), &lathe(&[[0.039, 0.0], [0.040, 0.001], [0.040, 0.013], [0.038, 0.015]], 36));
    let shock_sensor = [[0.034, 0.012], [0.034, 0.030], [0.036, 0.033], [0.036, 0.050], [0.030, 0.056]];
    mesh.add(&upright([0.0; 3]), &lathe(&shock_sensor, 32));
    mesh.add(&upright([0.0; 3]), &extrude(&rounded_rectangle(0.064, 0.052, 0.010, 3), 0.050, 0.092, 0.005));
    for x in [-0.026, 0.026] {
        mesh.add(&along_y([x, -0.029, 0.071]), &lathe(&[[0.005, 0.0], [0.005, 0.058]], 6));
    }
    let neck = [[0.019, 0.060], [0.019, 0.150], [0.017, 0.154], [0.017, 0.172]];
    mesh.add(&upright([0.0; 3]), &lathe(&neck, 28));
    let nozzle = [[0.0185, 0.166], [0.0200, 0.170], [0.0200, 0.205], [0.0150, 0.222], [0.0130, 0.236], [0.0115, 0.238]];
    mesh.add(&upright([0.0; 3]), &lathe(&nozzle, 28));
    mesh.add(&upright([0.0; 3]), &lathe(&[[0.0045, 0.230], [0.0045, 0.246], [0.0012, 0.2465], [0.0010, 0.250]], 16));
    // Gas and water connections on either side.
    mesh.add(&along_minus_x([-0.012, 0.0, 0.112]), &lathe(&[[0.006, 0.0], [0.006, 0.024], [0.0045, 0.026]], 12));
    mesh.add(&along_x([0.012, 0.0, 0.126]), &lathe(&[[0.006, 0.0], [0.006, 0.024], [0.0045, 0.026]], 12));
    mesh
}

/// A parallel gripper, half open: palm, rails, two stepped fingers; 0.17 m long.
fn gripper() -> Mesh {
    let mut mesh = Mesh::new();
    mesh.add(&upright([0.0; 3]), &lathe(&[[0.039, 0.0], [0.040, 0.001], [0.040, 0.013], [0.038, 0.015]], 36));
    mesh.add(&upright([0.0; 3]), &extrude(&rounded_rectangle(0.070, 0.130, 0.012, 4), 0.012, 0.082, 0.006));
    mesh.add(&along_y([0.0, -0.075, 0.084]), &extrude(&circle(0.010, 20), 0.0, 0.150, 0.002));
    for side in [-1.0, 1.0] {
        let y = side * 0.045;
        mesh.add(&upright([0.0, y, 0.0]), &extrude(&rounded_rectangle(0.046, 0.030, 0.005, 3), 0.078, 0.106, 0.004));
        mesh.add(
            &upright([0.0, y + side * 0.005, 0.0]),
            &extrude(&rounded_rectangle(0.030, 0.014, 0.003, 3), 0.100, 0.170, 0.003),
        );
        mesh.add(
            &upright([0.0, y - side * 0.006, 0.0]),
            &extrude(&rounded_rectangle(0.026, 0.012, 0.002, 2), 0.140, 0.169, 0.002),
        );
    }
    mesh
}
