//! Faces, axes and edges tried one by one, for what is so nearly parallel that steps do not show which way is nearer.

use elbowroom_spatial::{Pose, Vec3};

use super::Cores;
use crate::Cuboid;
use crate::separation::core::{Core, Gap};
use crate::separation::segment::{Segment, nearest_to_box, nearest_to_cylinder};

/// The best support planes among the faces' normals, the directions across axes and the products of axes near `v`.
pub(super) fn lower_bound(cores: &Cores, v: Vec3) -> f64 {
    let Some(v) = v.try_normalize() else { return 0.0 };
    let mut best = cores.plane_gap(v);
    let r = cores.a_in_b.rotation;
    let (of_a, of_b) = ([r.x_axis(), r.y_axis(), r.z_axis()], [Vec3::X, Vec3::Y, Vec3::Z]);
    let mut ask = |d: Vec3| {
        // Anything farther off is no neighbour of the wanted direction.
        if d.dot(v).abs() > 0.99
            && let Some(d) = d.try_normalize()
        {
            best = best.max(cores.plane_gap(if d.dot(v) < 0.0 { -d } else { d }));
        }
    };
    for e in of_a.into_iter().chain(of_b) {
        ask(e);
        ask(v - e * v.dot(e));
    }
    for x in of_a {
        for y in of_b {
            if let Some(d) = x.cross(y).try_normalize() {
                ask(d);
            }
        }
    }
    best
}

/// Witness points on the faces' outermost points and on the edges of boxes, where they are nearer; bounds from all
/// normals.
pub(super) fn improve(cores: &Cores, mut gap: Gap) -> Gap {
    let a_in_b = cores.a_in_b;
    let mut offer = |on_a: Vec3, on_b: Vec3| {
        let distance = (on_a - on_b).length();
        if distance < gap.distance {
            gap = Gap { distance, on_a, on_b, ..gap };
        }
    };
    let r = a_in_b.rotation;
    for axis in [Vec3::X, Vec3::Y, Vec3::Z, r.x_axis(), r.y_axis(), r.z_axis()] {
        for d in [axis, -axis] {
            let on_a = cores.low_of_a(d);
            offer(on_a, cores.b.project(on_a).point);
            let on_b = cores.b.support(d);
            offer(cores.onto_a(on_b).point, on_b);
        }
    }
    if let Core::Cuboid(solid) = cores.a {
        for edge in edges(solid, a_in_b) {
            if let Some((on_edge, on_b)) = nearest_to_edge(&edge, cores.b) {
                offer(on_edge, on_b);
            }
        }
    }
    if let Core::Cuboid(solid) = cores.b {
        for edge in edges(solid, &a_in_b.inverse()) {
            if let Some((on_edge, on_a)) = nearest_to_edge(&edge, cores.a) {
                offer(a_in_b.transform_point(on_a), a_in_b.transform_point(on_edge));
            }
        }
    }
    let lower = gap.lower.max(lower_bound(cores, gap.on_a - gap.on_b)).min(gap.distance);
    Gap { lower, ..gap }
}

fn nearest_to_edge(edge: &Segment, solid: &Core) -> Option<(Vec3, Vec3)> {
    let p = match solid {
        Core::Cuboid(c) => nearest_to_box(edge, c),
        Core::Cylinder(c) => nearest_to_cylinder(edge, c),
        _ => return None,
    };
    Some((p, solid.project(p).point))
}

/// The twelve edges of a box.
fn edges(solid: &Cuboid, in_frame: &Pose) -> impl Iterator<Item = Segment> {
    let (h, in_frame) = (solid.half_extents, *in_frame);
    (0..12).map(move |i| {
        let (along, signs) = (i / 4, i % 4);
        let mut middle = [0.0; 3];
        middle[(along + 1) % 3] = if signs & 1 == 0 { 1.0 } else { -1.0 };
        middle[(along + 2) % 3] = if signs & 2 == 0 { 1.0 } else { -1.0 };
        let direction = [Vec3::X, Vec3::Y, Vec3::Z][along];
        Segment {
            middle: in_frame.transform_point(h.scale(middle.into())),
            direction: in_frame.transform_vector(direction),
            half: h[along],
        }
    })
}
