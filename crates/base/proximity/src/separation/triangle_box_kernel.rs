//! Eight triangles and a box at once: the first step of [`projections::distance`](super::projections::distance) for each.
//!
//! Where faces are parallel, dozens of triangles are equally near, and the first step decides all of them. The arithmetic
//! is that of one triangle, so that answers do not depend on whether triangles are measured together.

// A kernel is compiled for the lowest instruction set unless it is inlined into the function that selects the set.
#![allow(clippy::inline_always)]

use elbowroom_spatial::Vec3;
use fearless_simd::{Simd, dispatch, f64x8, prelude::*};

use super::gap::{CONVERGED, Gap, rounding};
use crate::Cuboid;
use crate::bvh::LEAF_SIZE;
use crate::lanes::{V3, detected_simd_level};
use crate::triangle::SLENDER;

/// Number of triangles.
const LANES: usize = LEAF_SIZE;

type W<S> = f64x8<S>;
type M<S> = <W<S> as SimdBase<S>>::Mask;

/// Triangles in the frame of the box, metres.
#[derive(Debug, Clone)]
pub(super) struct TriangleLanes {
    /// `[corner][axis][lane]`
    corners: [[[f64; LANES]; 3]; 3],
    /// One bit per lane that has a triangle.
    set: u32,
}

impl TriangleLanes {
    pub const NONE: Self = Self { corners: [[[0.0; LANES]; 3]; 3], set: 0 };

    #[inline]
    pub fn set(&mut self, lane: usize, corners: &[Vec3; 3]) {
        self.set |= 1 << lane;
        for (to, p) in self.corners.iter_mut().zip(corners) {
            (to[0][lane], to[1][lane], to[2][lane]) = (p.x, p.y, p.z);
        }
    }
}

/// What the first step found about each triangle.
#[derive(Debug, Clone)]
pub(super) struct FirstSteps {
    distance: [f64; LANES],
    /// Proven lower bounds, metres.
    lower: [f64; LANES],
    /// Largest difference of the two that is an answer, metres.
    converged: [f64; LANES],
    /// Largest distance at which the points may coincide, metres.
    touching: [f64; LANES],
    /// One bit per lane that has a triangle.
    set: u32,
    on_triangle: [[f64; LANES]; 3],
    on_box: [[f64; LANES]; 3],
}

/// The answer of the first step for one triangle.
#[derive(Debug, Clone, Copy)]
pub(super) enum FirstStep {
    /// It is farther away than the limit.
    Farther,
    Measured(Gap),
    /// It needs more steps.
    Open,
}

impl FirstSteps {
    /// The first step of every lane.
    pub fn of(triangles: &TriangleLanes, solid: &Cuboid) -> Self {
        dispatch!(detected_simd_level(), simd => first_steps(simd, triangles, solid))
    }

    /// The answer for one lane.
    #[inline]
    pub fn answer(&self, lane: usize, limit: f64) -> FirstStep {
        if self.set >> lane & 1 == 0 {
            return FirstStep::Open;
        }
        let at = |p: &[[f64; LANES]; 3]| Vec3::new(p[0][lane], p[1][lane], p[2][lane]);
        let (distance, lower) = (self.distance[lane], self.lower[lane]);
        if !(distance > self.touching[lane]) {
            return FirstStep::Measured(Gap::touching(at(&self.on_triangle), at(&self.on_box)));
        }
        let lower = lower.max(0.0);
        if lower > limit {
            return FirstStep::Farther;
        }
        if !(distance - lower <= self.converged[lane]) {
            return FirstStep::Open;
        }
        let (on_a, on_b) = (at(&self.on_triangle), at(&self.on_box));
        FirstStep::Measured(Gap { distance, apart: distance, lower: lower.min(distance), on_a, on_b })
    }
}

#[inline(always)]
fn first_steps<S: Simd>(simd: S, triangles: &TriangleLanes, solid: &Cuboid) -> FirstSteps {
    let load = |p: &[[f64; LANES]; 3]| {
        V3(W::load_array_ref(simd, &p[0]), W::load_array_ref(simd, &p[1]), W::load_array_ref(simd, &p[2]))
    };
    let corners = [load(&triangles.corners[0]), load(&triangles.corners[1]), load(&triangles.corners[2])];
    let [a, b, c] = corners;
    let h = splat(simd, solid.half_extents);
    let minus_h = splat(simd, -solid.half_extents);
    let third = W::splat(simd, 3.0);
    let sum = a.plus(b).plus(c);
    let middle = V3(sum.0 / third, sum.1 / third, sum.2 / third);
    let clamp = |x: W<S>, lo: W<S>, hi: W<S>| x.max(lo).min(hi);
    let on_box = V3(clamp(middle.0, minus_h.0, h.0), clamp(middle.1, minus_h.1, h.1), clamp(middle.2, minus_h.2, h.2));
    let on_triangle = nearest_on_triangle(simd, on_box, corners);
    let apart = on_triangle.minus(on_box);
    let distance = apart.dot(apart).sqrt();
    let direction = V3(apart.0 / distance, apart.1 / distance, apart.2 / distance);
    let (low, high) = (
        lowest(corners, direction),
        V3(h.0.copysign(direction.0), h.1.copysign(direction.1), h.2.copysign(direction.2)),
    );
    let size = |p: V3<W<S>>| p.0.abs().max(p.1.abs()).max(p.2.abs());
    let scale =
        size(a).max(size(b)).max(size(c)) + (solid.half_extents.x + solid.half_extents.y + solid.half_extents.z);
    let error = scale * rounding(1.0);
    let lower = low.minus(high).dot(direction) - error;
    let mut out = FirstSteps {
        distance: [0.0; LANES],
        lower: [0.0; LANES],
        converged: [0.0; LANES],
        touching: [0.0; LANES],
        set: triangles.set,
        on_triangle: [[0.0; LANES]; 3],
        on_box: [[0.0; LANES]; 3],
    };
    distance.store_slice(&mut out.distance);
    lower.store_slice(&mut out.lower);
    (scale * CONVERGED).store_slice(&mut out.converged);
    error.store_slice(&mut out.touching);
    for (to, from) in [(&mut out.on_triangle, on_triangle), (&mut out.on_box, on_box)] {
        from.0.store_slice(&mut to[0]);
        from.1.store_slice(&mut to[1]);
        from.2.store_slice(&mut to[2]);
    }
    out
}

#[inline(always)]
fn splat<S: Simd>(simd: S, p: Vec3) -> V3<W<S>> {
    V3(W::splat(simd, p.x), W::splat(simd, p.y), W::splat(simd, p.z))
}

#[inline(always)]
fn select<S: Simd>(mask: M<S>, a: V3<W<S>>, b: V3<W<S>>) -> V3<W<S>> {
    V3(mask.select(a.0, b.0), mask.select(a.1, b.1), mask.select(a.2, b.2))
}

/// The corner farthest against the direction, the first of equal ones.
#[inline(always)]
fn lowest<S: Simd>([a, b, c]: [V3<W<S>>; 3], direction: V3<W<S>>) -> V3<W<S>> {
    let (x, y, z) = (a.dot(direction), b.dot(direction), c.dot(direction));
    let second = y.simd_lt(x);
    let (low, along) = (select(second, b, a), second.select(y, x));
    select(z.simd_lt(along), c, low)
}

/// As [`nearest_on_triangle`](crate::triangle::nearest_on_triangle).
#[inline(always)]
fn nearest_on_triangle<S: Simd>(simd: S, p: V3<W<S>>, [a, b, c]: [V3<W<S>>; 3]) -> V3<W<S>> {
    let zero = W::splat(simd, 0.0);
    let (ab, bc, ca) = (b.minus(a), c.minus(b), a.minus(c));
    let ac = c.minus(a);
    let n = ab.cross(ac);
    let wa = n.dot(b.minus(p).cross(bc));
    let wb = n.dot(c.minus(p).cross(ca));
    let wc = n.dot(a.minus(p).cross(ab));
    let is_inside = wa.simd_gt(zero) & wb.simd_gt(zero) & wc.simd_gt(zero);
    let sum = wa + wb + wc;
    let projected = a.plus(ab.times(wb / sum)).plus(ac.times(wc / sum));
    let longest = ab.dot(ab).max(bc.dot(bc)).max(ca.dot(ca));
    let is_slender = !(n.dot(n).simd_gt(longest * longest * SLENDER));
    let edge = nearest_on_edges(zero, p, [a, b, c]);
    let (to_edge, to_face) = (edge.minus(p), projected.minus(p));
    let is_edge_nearer = to_edge.dot(to_edge).simd_lt(to_face.dot(to_face));
    select(is_inside & !(is_slender & is_edge_nearer), projected, edge)
}

#[inline(always)]
fn nearest_on_edges<S: Simd>(zero: W<S>, p: V3<W<S>>, [a, b, c]: [V3<W<S>>; 3]) -> V3<W<S>> {
    let candidates = [(a, b), (b, c), (c, a)].map(|(from, to)| nearest_on_segment(zero, p, from, to));
    let square = |q: V3<W<S>>| q.minus(p).dot(q.minus(p));
    let [x, y, z] = [square(candidates[0]), square(candidates[1]), square(candidates[2])];
    let second = y.simd_lt(x);
    let (nearest, least) = (select(second, candidates[1], candidates[0]), second.select(y, x));
    select(z.simd_lt(least), candidates[2], nearest)
}

#[inline(always)]
fn nearest_on_segment<S: Simd>(zero: W<S>, p: V3<W<S>>, a: V3<W<S>>, b: V3<W<S>>) -> V3<W<S>> {
    let ab = b.minus(a);
    let along = p.minus(a).dot(ab);
    let square = ab.dot(ab);
    let between = a.plus(ab.times(along / square));
    let from_start = select(along.simd_ge(square), b, between);
    select(along.simd_gt(zero), from_start, a)
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::Pose;
    use proptest::prelude::*;

    use super::super::core::Core;
    use super::super::projections;
    use super::*;

    fn coordinate() -> impl Strategy<Value = f64> {
        // Many corners lie in planes of faces, or coincide.
        prop_oneof![-2.0..2.0, Just(0.5), Just(-0.25), Just(0.0), -1e-9..1e-9]
    }

    fn corner() -> impl Strategy<Value = Vec3> {
        (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn an_answer_is_to_the_bit_that_of_one_triangle(
            triangles in proptest::collection::vec([corner(), corner(), corner()], LANES),
            half in [0.01..1.0, 0.01..1.0, 0.01..1.0],
            limit in 0.0..3.0,
        ) {
            let solid = Cuboid { half_extents: half.into() };
            let mut lanes = TriangleLanes::NONE;
            for (lane, corners) in triangles.iter().enumerate() {
                lanes.set(lane, corners);
            }
            let steps = FirstSteps::of(&lanes, &solid);
            for (lane, corners) in triangles.iter().enumerate() {
                let alone = projections::distance(&Core::Triangle(*corners), &Core::Cuboid(solid), &Pose::IDENTITY, limit);
                match steps.answer(lane, limit) {
                    FirstStep::Open => {}
                    FirstStep::Farther => prop_assert!(alone.is_none()),
                    FirstStep::Measured(gap) => {
                        let alone = alone.expect("it is not farther");
                        let numbers = |g: Gap| (g.distance, g.apart, g.lower, g.on_a, g.on_b);
                        prop_assert_eq!(numbers(gap), numbers(alone));
                    }
                }
            }
        }
    }

    #[test]
    fn parallel_faces_need_one_step() {
        let solid = Cuboid { half_extents: Vec3::splat(0.5) };
        let mut lanes = TriangleLanes::NONE;
        for lane in 0..LANES {
            let shift = Vec3::new(0.04 * lane as f64 - 0.2, 0.0, 0.8);
            lanes.set(lane, &[Vec3::ZERO, Vec3::X * 0.1, Vec3::Y * 0.1].map(|p| p + shift));
        }
        let steps = FirstSteps::of(&lanes, &solid);
        for lane in 0..LANES {
            let FirstStep::Measured(gap) = steps.answer(lane, 1.0) else { panic!("lane {lane} is open") };
            assert!((gap.distance - 0.3).abs() < 1e-15);
            assert!(matches!(steps.answer(lane, 0.2), FirstStep::Farther));
        }
    }
}
