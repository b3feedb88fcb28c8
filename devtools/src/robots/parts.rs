//! Parts of arms: motors, bolts, skins.

use elbowroom_spatial::Vec3;

use crate::solid::outline::{circle, rounded_rectangle};
use crate::solid::{Mesh, along_minus_x, extrude, lathe, loft, upright};

/// Makes a motor of a length, standing on z = 0: mounting flange, finned body, end cap.
pub fn motor(radius: f64, length: f64) -> Mesh {
    let mut mesh = Mesh::new();
    let body = [
        [radius * 1.14, 0.0],
        [radius * 1.14, 0.012],
        [radius * 1.08, 0.017],
        [radius * 0.94, 0.020],
        [radius * 0.94, length * 0.62],
        [radius, length * 0.64],
        [radius, length * 0.90],
        [radius * 0.93, length * 0.965],
        [radius * 0.80, length],
    ];
    mesh.add(&upright([0.0; 3]), &lathe(&body, 26));
    let plug = extrude(&rounded_rectangle(radius * 0.7, radius * 0.6, radius * 0.12, 2), 0.0, radius * 0.30, 0.004);
    mesh.add(&along_minus_x([-radius * 0.85, 0.0, length * 0.77]), &plug);
    mesh
}

/// Makes a hexagon head standing on z = 0.
pub fn bolt(radius: f64, height: f64) -> Mesh {
    lathe(&[[radius, 0.0], [radius, height * 0.85], [radius * 0.88, height]], 6)
}

/// Makes bolt heads on a circle about z, sunk a little into the plane at `z`.
pub fn bolts(circle_radius: f64, count: usize, z: f64, radius: f64) -> Mesh {
    let mut mesh = Mesh::new();
    let sunk = radius * 0.5;
    for [x, y] in circle(circle_radius, count) {
        mesh.add(&upright([x, y, z - sunk]), &bolt(radius, sunk + radius * 0.9));
    }
    mesh
}

/// Makes a loft of rounded rectangles `(centre, size, corner radius)` with `arc` edges to a corner; `plane` maps the
/// flat section into space.
pub fn skin(rows: &[(Vec3, [f64; 2], f64)], arc: usize, plane: impl Fn([f64; 2]) -> Vec3) -> Mesh {
    let section = |&(center, [width, height], radius): &(Vec3, [f64; 2], f64)| {
        let outline = rounded_rectangle(width, height, radius, arc);
        outline.into_iter().map(|flat| center + plane(flat)).collect()
    };
    loft(&rows.iter().map(section).collect::<Vec<_>>())
}
