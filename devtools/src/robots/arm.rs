//! Common structure of six-axis arms: how their links are connected.

use super::model::{Joint, Link, Primitive, Turn};
use crate::solid::Mesh;

/// Axes of joints.
pub const X: [f64; 3] = [1.0, 0.0, 0.0];
pub const X_BACK: [f64; 3] = [-1.0, 0.0, 0.0];
pub const Y: [f64; 3] = [0.0, 1.0, 0.0];
pub const Z: [f64; 3] = [0.0, 0.0, 1.0];
pub const Z_DOWN: [f64; 3] = [0.0, 0.0, -1.0];

/// Colours of an arm with a steel flange. Red, green, blue, 0 to 1.
pub struct Colours {
    /// Colour from the turntable to the forearm.
    pub paint: [f64; 3],
    /// Colour of base and wrist.
    pub cast: [f64; 3],
}

const STEEL: [f64; 3] = [0.72, 0.73, 0.75];

/// Names from the base to the frame on the flange.
const LINKS: [&str; 8] = ["base_link", "link_1", "link_2", "link_3", "link_4", "link_5", "link_6", "tool0"];

/// A joint's name, its place in the previous link (m), its axis, its range (degrees), its speed (degrees per second).
pub type Axis = (&'static str, [f64; 3], [f64; 3], [f64; 2], f64);

/// Links of meshes, base to flange, and a bare frame.
pub fn of_meshes(parts: [Mesh; 7], colours: &Colours) -> Vec<Link> {
    links(parts.map(|mesh| (Some(mesh), Vec::new())), colours)
}

/// Links of primitives, base to flange, and a bare frame.
pub fn of_primitives(parts: [Vec<Primitive>; 7], colours: &Colours) -> Vec<Link> {
    links(parts.map(|primitives| (None, primitives)), colours)
}

fn links(parts: [(Option<Mesh>, Vec<Primitive>); 7], &Colours { paint, cast }: &Colours) -> Vec<Link> {
    let colours = [cast, paint, paint, paint, paint, cast, STEEL, STEEL];
    let parts = parts.into_iter().chain([(None, Vec::new())]);
    let named = LINKS.into_iter().zip(parts).zip(colours);
    named.map(|((name, (solid, primitives)), colour)| Link { name, solid, primitives, colour }).collect()
}

/// Six revolute joints, base to flange, and the place of the bare frame on the last link: metres; roll, pitch, yaw.
pub fn joints(axes: &[Axis; 6], [frame_xyz, frame_rpy]: [[f64; 3]; 2]) -> Vec<Joint> {
    let turning = |(i, &(name, xyz, axis, range_deg, speed_deg_s)): (usize, &Axis)| Joint {
        name,
        parent: LINKS[i],
        child: LINKS[i + 1],
        xyz,
        rpy: [0.0; 3],
        turns: Some(Turn { axis, range_deg, speed_deg_s }),
    };
    let (parent, child) = (LINKS[6], LINKS[7]);
    let frame = Joint { name: "flange", parent, child, xyz: frame_xyz, rpy: frame_rpy, turns: None };
    axes.iter().enumerate().map(turning).chain([frame]).collect()
}
