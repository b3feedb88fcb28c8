//! Exhaustive search over faces, axes and edges near the witness points, if features are so nearly parallel that
//! iterations do not converge.

use elbowroom_spatial::{Pose, Vec3};

use super::core_pair::CorePair;
use super::local_features::{LocalFeatures, for_each_edge};
use crate::Cuboid;
use crate::separation::core::Core;
use crate::separation::gap::Gap;
use crate::separation::segment::{Segment, nearest_to_box, nearest_to_cylinder};

/// The best lower bound from support planes whose normals are normals of faces, directions perpendicular to edges,
/// or cross products of edges, all near the witness points.
pub(super) fn lower_bound(cores: &CorePair, gap: &Gap) -> f64 {
    let difference = gap.on_a - gap.on_b;
    let Some(v) = difference.try_normalize() else { return 0.0 };
    // Directions less aligned with the witness points are not considered. If the witness points are close together,
    // their direction is inaccurate.
    let alignment = if gap.distance > cores.close { 0.99 } else { 0.5 };
    let mut best = cores.plane_gap(v);
    let mut test = |d: Vec3| {
        if let Some(d) = d.try_normalize()
            && d.dot(v).abs() > alignment
        {
            best = best.max(cores.plane_gap(if d.dot(v) < 0.0 { -d } else { d }));
        }
    };
    let of_a = LocalFeatures::of(cores.a, cores.a_in_b.inverse_transform_point(gap.on_a), cores.close);
    let of_b = LocalFeatures::of(cores.b, gap.on_b, cores.close);
    let in_b = |d: &Vec3| cores.a_in_b.transform_vector(*d);
    of_a.normals.iter().map(in_b).for_each(&mut test);
    of_b.normals.iter().copied().for_each(&mut test);
    for x in of_a.edges.iter().map(in_b) {
        test(v - x * v.dot(x));
        of_b.edges.iter().for_each(|y| test(x.cross(*y)));
    }
    of_b.edges.iter().for_each(|y| test(v - *y * v.dot(*y)));
    best
}

/// Moves witness points to support points along the axes and to edges of boxes if these are nearer;
/// computes bounds from all normals.
pub(super) fn improve(cores: &CorePair, mut gap: Gap) -> Gap {
    let a_in_b = cores.a_in_b;
    let mut offer = |on_a: Vec3, on_b: Vec3| gap = nearer_of(gap, on_a, on_b);
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
    let gap = along_edges(cores, gap);
    gap.at_least(lower_bound(cores, &gap))
}

/// Moves witness points to edges of a hull or a triangle near the current ones.
fn along_edges(cores: &CorePair, gap: Gap) -> Gap {
    let (a_in_b, reach, mut best) = (cores.a_in_b, 1e3 * cores.close, gap);
    let segment = |from: Vec3, to: Vec3| {
        let half = 0.5 * (to - from);
        let direction = half.try_normalize()?;
        Some(Segment { middle: from + half, direction, half: half.length() })
    };
    for_each_edge(cores.a, a_in_b.inverse_transform_point(gap.on_a), reach, &mut |p, q| {
        let edge = segment(a_in_b.transform_point(p), a_in_b.transform_point(q));
        if let Some((on_edge, on_b)) = edge.and_then(|e| nearest_to_edge(&e, cores.b)) {
            best = nearer_of(best, on_edge, on_b);
        }
    });
    let b_in_a = a_in_b.inverse();
    for_each_edge(cores.b, gap.on_b, reach, &mut |p, q| {
        let edge = segment(b_in_a.transform_point(p), b_in_a.transform_point(q));
        if let Some((on_edge, on_a)) = edge.and_then(|e| nearest_to_edge(&e, cores.a)) {
            best = nearer_of(best, a_in_b.transform_point(on_a), a_in_b.transform_point(on_edge));
        }
    });
    best
}

fn nearer_of(gap: Gap, on_a: Vec3, on_b: Vec3) -> Gap {
    let distance = (on_a - on_b).length();
    if distance < gap.distance { Gap { distance, apart: distance, on_a, on_b, ..gap } } else { gap }
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
