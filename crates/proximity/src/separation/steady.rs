//! Steady witness points where faces or edges are parallel, or nearly so ([`crate::patch`]): of two convex cores, and of
//! a mesh and a convex core.

use elbowroom_spatial::{Pose, Vec3};

use super::core::{Core, Gap};
use super::flat::{ball, faces, is_corner, nearest, normal, wide};
use crate::mesh::BoxProbe;
use crate::patch::{Facing, GRAIN, Polygon, SMALL, Wide, between, settled};
use crate::shape::hull::farthest;
use crate::triangle::nearest_on_triangle;
use crate::{Shape, TriMesh};

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
    let of_a = turned(wide(a, seen_by_a, grain, small), a_in_b);
    if !of_a.meets(wide(b, -sight, grain, small), grain, small) {
        return gap;
    }
    let ends = |d: Vec3| {
        let low = a_in_b.transform_point(a.support(a_in_b.inverse_transform_vector(d)));
        [low.dot(d), b.support(-d).dot(d)]
    };
    // Points that are very close give a direction with few digits; a face's normal has all.
    let middle_a = a_in_b.transform_point(middle_a);
    let of_a = normal(a, seen_by_a, a_in_b.inverse_transform_point(middle_b));
    let of_b = normal(b, -sight, middle_a);
    let along = farthest_apart([sight, a_in_b.transform_vector(of_a), -of_b], &ends);
    let middle = between(middle_a, radius_a, middle_b, radius_b);
    let mut choice = Choice::new(Facing { along, ends: ends(along), grain, middle }, small, &gap);
    faces(a, a_in_b.inverse_transform_vector(along), &mut |of_a| {
        let of_a = Polygon::new(of_a.iter().map(|p| a_in_b.transform_point(*p)));
        faces(b, -along, &mut |of_b| {
            if let Some((on_a, on_b, patch)) = choice.facing.pair(&of_a, &Polygon::new(of_b.iter().copied())) {
                choice.offer(0, on_a, on_b, patch);
            }
        });
    });
    let Some((on_a, _)) = choice.best() else { return gap };
    let onto_a = |q: Vec3| a_in_b.transform_point(nearest(a, a_in_b.inverse_transform_point(q)));
    let (on_a, on_b) = settled(on_a, &onto_a, &|p| nearest(b, p));
    moved(gap, on_a, on_b, grain)
}

/// False where a line along the unit vector `direction` certainly has no choice beside `b`, with `way` from its nearest point
/// to that of `b`; all in the frame of `b`, and without a root.
#[inline]
pub(super) fn may_have_choice(direction: Vec3, b: &Shape, way: Vec3) -> bool {
    /// Lines that are less parallel than this are within the grain over a few millimetres at most; squared cosine.
    const PARALLEL: f64 = 0.98;
    const SLOPE: f64 = GRAIN / SMALL;
    let along = direction.dot(way);
    if along * along > SLOPE * SLOPE * way.length_squared() {
        return false;
    }
    let d = direction;
    match b {
        Shape::Capsule(_) => d.z * d.z > PARALLEL,
        Shape::Cylinder(_) => d.z * d.z > PARALLEL || way.x.abs().max(way.y.abs()) <= SLOPE * way.z.abs(),
        _ => {
            let (w, least) = (way.abs(), SLOPE * way.abs().max_element());
            let across = |v: f64| u8::from(v <= least);
            let edge = (d.x * d.x).max(d.y * d.y).max(d.z * d.z) > PARALLEL;
            edge || across(w.x) + across(w.y) + across(w.z) == 2
        }
    }
}

/// As [`steady`], of a mesh (first) and a core in the mesh's frame; `nearest_triangle` is the one with the gap's point, and
/// `spread` whether pairs as near were seen elsewhere.
pub(super) fn steady_of_mesh(
    mesh: &TriMesh,
    core: &Core,
    core_in_mesh: &Pose,
    gap: Gap,
    nearest_triangle: usize,
    spread: f64,
) -> Gap {
    let Some((radius_b, middle_b)) = ball(core) else { return gap };
    let Some(sight) = (gap.on_b - gap.on_a).try_normalize() else { return gap };
    let (grain, small) = grain_of_mesh(mesh, radius_b);
    let back = |d: Vec3| core_in_mesh.inverse_transform_vector(d);
    let t = mesh.corners(nearest_triangle);
    let flat = || {
        let of_a = Wide::of(t.iter().copied(), farthest(&t, sight), sight, grain, small);
        of_a.meets(turned(wide(core, back(-sight), grain, small), core_in_mesh), grain, small)
    };
    if !(spread > small || flat()) {
        return gap;
    }
    let ends = |d: Vec3| {
        let high = t.iter().fold(f64::NEG_INFINITY, |most: f64, p| most.max(d.dot(*p)));
        [high, core_in_mesh.transform_point(core.support(back(-d))).dot(d)]
    };
    let of_triangle = (t[1] - t[0]).cross(t[2] - t[0]).try_normalize().unwrap_or(sight);
    let of_triangle = if of_triangle.dot(sight) < 0.0 { -of_triangle } else { of_triangle };
    let of_core = -core_in_mesh.transform_vector(normal(core, back(-sight), back(-sight)));
    let along = farthest_apart([sight, of_triangle, of_core], &ends);
    let (center, radius_a) = mesh.tree.ball();
    let middle = between(center, radius_a, core_in_mesh.transform_point(middle_b), radius_b);
    let mut choice = Choice::new(Facing { along, ends: ends(along), grain, middle }, small, &gap);
    let reach = gap.distance + 2.0 * grain;
    let limit = BoxProbe::limit(&mesh.tree, reach);
    let onto_core = |p: Vec3| core_in_mesh.transform_point(nearest(core, core_in_mesh.inverse_transform_point(p)));
    mesh.tree.visit(&BoxProbe::new(&mesh.tree, &super::mesh::bounds(core), core_in_mesh), limit, &mut |number| {
        let corners = mesh.corners(number);
        if choice.is_beaten(nearest_on_triangle(middle, corners)) {
            return limit;
        }
        let of_a = Polygon::new(corners);
        faces(core, back(-along), &mut |of_b| {
            let of_b = Polygon::new(of_b.iter().map(|p| core_in_mesh.transform_point(*p)));
            let Some((on_a, _, patch)) = choice.facing.pair(&of_a, &of_b) else { return };
            let (on_a, on_b) = settled(on_a, &|q| nearest_on_triangle(q, corners), &onto_core);
            if (on_a - on_b).length_squared() <= reach * reach {
                choice.offer(number, on_a, on_b, patch);
            }
        });
        limit
    });
    let Some((on_a, on_b)) = choice.best() else { return gap };
    moved(gap, on_a, on_b, grain)
}

/// What counts as as near, and what as a point, of a mesh and a core of this radius, m.
pub(super) fn grain_of_mesh(mesh: &TriMesh, radius: f64) -> (f64, f64) {
    let size = mesh.tree.ball().1 + radius;
    (GRAIN * size, SMALL * size)
}

/// Of several directions the one in which the two are farthest apart.
fn farthest_apart(directions: [Vec3; 3], ends: &dyn Fn(Vec3) -> [f64; 2]) -> Vec3 {
    let apart = |d: &Vec3| ends(*d)[1] - ends(*d)[0];
    directions.into_iter().max_by(|d, e| apart(d).total_cmp(&apart(e))).unwrap_or(directions[0])
}

fn turned(wide: Wide, to: &Pose) -> Wide {
    if let Wide::Edge(u, width) = wide { Wide::Edge(to.transform_vector(u), width) } else { wide }
}

/// The gap with other points, unless they are farther apart than is as good as equal: a direction without digits proves
/// nothing.
fn moved(gap: Gap, on_a: Vec3, on_b: Vec3, grain: f64) -> Gap {
    let apart = on_a.distance(on_b);
    if apart <= gap.distance + 2.0 * grain { Gap { apart, on_a, on_b, ..gap } } else { gap }
}

/// The pair of points nearest to the middle among those offered.
struct Choice {
    facing: Facing,
    small: f64,
    /// What was found first.
    first: Vec3,
    /// There is a choice: points lie apart.
    open: bool,
    /// Scores that differ by less are equal, and the smaller number counts: so nothing depends on the order.
    step: f64,
    best: Option<(f64, usize, Vec3, Vec3)>,
}

impl Choice {
    fn new(facing: Facing, small: f64, gap: &Gap) -> Self {
        Self { facing, small, first: gap.on_a, open: false, step: 1e-3 * small, best: None }
    }

    /// True where whatever has this point nearest to the middle would not be taken.
    fn is_beaten(&self, nearest: Vec3) -> bool {
        self.open && self.best.is_some_and(|b| nearest.distance(self.facing.middle) > (b.0 + 1.0) * self.step)
    }

    fn offer(&mut self, number: usize, on_a: Vec3, on_b: Vec3, patch: f64) {
        self.open |= patch > self.small || on_a.distance(self.first) > self.small;
        let score = (on_a.distance(self.facing.middle) / self.step).round();
        if self.best.is_none_or(|b| (score, number) < (b.0, b.1)) {
            self.best = Some((score, number, on_a, on_b));
        }
    }

    fn best(&self) -> Option<(Vec3, Vec3)> {
        self.best.filter(|_| self.open).map(|b| (b.2, b.3))
    }
}
