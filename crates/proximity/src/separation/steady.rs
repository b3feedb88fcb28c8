//! Steady witness points of boxes and hulls whose faces or edges are parallel, or nearly so ([`crate::patch`]).

use elbowroom_spatial::{Pose, Vec3};

use super::core::{Core, Gap};
use crate::patch::{Facing, GRAIN, Polygon, SMALL, Wide, between, settled};
use crate::{ConvexHull, Cuboid};

/// The gap with its points moved to where they are steady; as it is where there is no choice.
pub(super) fn steady(a: &Core, b: &Core, a_in_b: &Pose, gap: Gap) -> Gap {
    let Some((radius_a, middle_a)) = ball(a) else { return gap };
    let Some((radius_b, middle_b)) = ball(b) else { return gap };
    let Some(sight) = (gap.on_b - gap.on_a).try_normalize() else { return gap };
    let size = radius_a + radius_b;
    let (grain, small) = (GRAIN * size, SMALL * size);
    let seen_by_a = a_in_b.inverse_transform_vector(sight);
    // Most nearest points are corners of one of the two: the cheap test comes first.
    let flatness = 2.0 * grain / small;
    if is_corner(b, -sight, gap.on_b, flatness * radius_b)
        || is_corner(a, seen_by_a, a_in_b.inverse_transform_point(gap.on_a), flatness * radius_a)
    {
        return gap;
    }
    let (of_a, of_b) = (wide(a, seen_by_a, grain, small), wide(b, -sight, grain, small));
    let of_a = if let Wide::Edge(u, width) = of_a { Wide::Edge(a_in_b.transform_vector(u), width) } else { of_a };
    if !of_a.meets(of_b, grain, small) {
        return gap;
    }
    let middle = between(a_in_b.transform_point(middle_a), radius_a, middle_b, radius_b);
    let ends = |d: Vec3| {
        let low = a_in_b.transform_point(a.support(a_in_b.inverse_transform_vector(d)));
        [low.dot(d), b.support(-d).dot(d)]
    };
    let apart = |d: &Vec3| ends(*d)[1] - ends(*d)[0];
    // Points that are very close give a direction with few digits; a face's normal has all.
    let all = [sight, a_in_b.transform_vector(normal(a, seen_by_a)), -normal(b, -sight)];
    let along = all.into_iter().max_by(|d, e| apart(d).total_cmp(&apart(e))).unwrap_or(sight);
    let facing = Facing { along, ends: ends(along), grain, middle };
    let (mut best, mut open) = (None::<(Vec3, Vec3)>, false);
    faces(a, a_in_b.inverse_transform_vector(along), &mut |of_a| {
        let of_a: [Vec3; 4] = of_a.map(|p| a_in_b.transform_point(p));
        faces(b, -along, &mut |of_b| {
            let Some((on_a, on_b, patch)) = facing.pair(&Polygon::new(&of_a), &Polygon::new(&of_b)) else { return };
            open |= patch > small;
            if best.is_none_or(|b| (on_a - middle).length_squared() < (b.0 - middle).length_squared()) {
                best = Some((on_a, on_b));
            }
        });
    });
    let Some((on_a, _)) = best.filter(|_| open) else { return gap };
    let (on_a, on_b) =
        settled(on_a, &|q| a_in_b.transform_point(nearest(a, a_in_b.inverse_transform_point(q))), &|p| nearest(b, p));
    // A direction without digits proves nothing.
    let most = gap.distance + 2.0 * grain;
    if (on_a - on_b).length_squared() <= most * most { Gap { on_a, on_b, ..gap } } else { gap }
}

/// True where no corner but one lies less than `depth` (m) behind `top`, the farthest point along a unit vector.
fn is_corner(core: &Core, along: Vec3, top: Vec3, depth: f64) -> bool {
    match core {
        Core::Cuboid(c) => {
            // The corner after the farthest is behind it by the least of these.
            let (h, d) = (c.half_extents, along.abs());
            2.0 * (h.x * d.x).min(h.y * d.y).min(h.z * d.z) > depth
        }
        Core::Hull(h) => {
            let least = top.dot(along) - depth;
            h.vertices().iter().filter(|v| v.dot(along) > least).count() < 2
        }
        _ => true,
    }
}

fn nearest(core: &Core, p: Vec3) -> Vec3 {
    match core {
        Core::Cuboid(c) => c.nearest(p),
        Core::Hull(h) => h.nearest(p),
        _ => p,
    }
}

/// Radius about a middle; `None` for what is round.
fn ball(core: &Core) -> Option<(f64, Vec3)> {
    match core {
        Core::Cuboid(c) => Some((c.half_extents.length(), Vec3::ZERO)),
        Core::Hull(h) => Some((0.5 * h.aabb().extent().length(), h.aabb().center())),
        _ => None,
    }
}

fn wide(core: &Core, along: Vec3, grain: f64, small: f64) -> Wide {
    match core {
        Core::Cuboid(c) => wide_of_box(c, along, grain, small),
        Core::Hull(h) => Wide::of(h.vertices().iter().copied(), h.support(along), along, grain, small),
        _ => Wide::Point,
    }
}

/// The axes of a box that lie across the direction.
fn wide_of_box(c: &Cuboid, along: Vec3, grain: f64, small: f64) -> Wide {
    let (mut found, mut width) = (Wide::Point, 0.0_f64);
    for k in 0..3 {
        let (length, slope) = (2.0 * c.half_extents[k], along[k].abs());
        if length > small && slope * small < grain {
            let axis = [Vec3::X, Vec3::Y, Vec3::Z][k];
            found = if matches!(found, Wide::Point) { Wide::Edge(axis, 0.0) } else { return Wide::Face };
        } else {
            width = width.max(length.min(grain / slope));
        }
    }
    if let Wide::Edge(axis, _) = found { Wide::Edge(axis, width) } else { found }
}

/// Normal of the face that looks along the direction most.
fn normal(core: &Core, along: Vec3) -> Vec3 {
    match core {
        Core::Cuboid(_) => {
            let axis = face_axis(along);
            [Vec3::X, Vec3::Y, Vec3::Z][axis] * along[axis].signum()
        }
        Core::Hull(h) => h.most_along(along),
        _ => along,
    }
}

fn face_axis(along: Vec3) -> usize {
    let d = along.abs();
    let first = usize::from(d.y > d.x);
    if d.z > d[first] { 2 } else { first }
}

/// The faces that look along the direction most; a triangle has its last corner twice. Where an edge is farthest, one of
/// its two faces is enough.
fn faces(core: &Core, along: Vec3, each: &mut dyn FnMut([Vec3; 4])) {
    match core {
        Core::Cuboid(c) => each(side(c, along)),
        Core::Hull(h) => triangles(h, along, each),
        _ => {}
    }
}

fn side(c: &Cuboid, along: Vec3) -> [Vec3; 4] {
    let k = face_axis(along);
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| {
        let mut p = [0.0; 3];
        (p[i], p[j], p[k]) = (u * c.half_extents[i], v * c.half_extents[j], c.half_extents[k].copysign(along[k]));
        Vec3::from(p)
    })
}

/// Triangles whose normals differ by less than this from the one that looks along the direction most are one face.
const FLAT: f64 = 1e-6;

fn triangles(hull: &ConvexHull, along: Vec3, each: &mut dyn FnMut([Vec3; 4])) {
    let most = hull.most_along(along);
    for (number, normal) in hull.normals().enumerate() {
        if (normal - most).length_squared() < FLAT * FLAT {
            let [p, q, r] = hull.corners(number);
            each([p, q, r, r]);
        }
    }
}
