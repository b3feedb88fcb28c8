//! Penetration depth of the cores of two primitives: searches for the direction of least overlap, without
//! allocation.
//!
//! The overlap along a direction is the support function of the difference `B - A`. The difference of segments, boxes and
//! cylinders is a Minkowski sum of segments and discs, and its boundary point nearest to an inner point lies
//! - on a flat face: its normal is an axis of a frame, or the cross product of two segments' directions;
//! - on a surface ruled by one segment: the normal is perpendicular to that segment, which leaves one angle;
//! - for two cylinders, on the curved surface swept by both rims: two angles are free.
//!
//! It is never on a convex edge: an adjacent face is nearer.

use std::f64::consts::{PI, TAU};

use elbowroom_spatial::{Pose, Vec3};

use crate::separation::core::Core;

/// Number of directions sampled around each segment before the best is refined.
const SAMPLES_AROUND: usize = 24;

/// Number of directions sampled on the sphere before the best ones are refined.
const SAMPLES_ON_SPHERE: usize = 96;

/// Number of samples that are refined.
const STARTS: usize = 4;

/// Largest number of descent steps.
const MAX_STEPS: usize = 200;

/// The least overlap so far.
struct Best<F> {
    overlap: F,
    depth: f64,
    direction: Vec3,
}

impl<F: Fn(Vec3) -> f64> Best<F> {
    fn offer(&mut self, d: Vec3) -> f64 {
        let depth = (self.overlap)(d);
        if depth < self.depth {
            (self.depth, self.direction) = (depth, d);
        }
        depth
    }

    fn offer_both(&mut self, v: Vec3) {
        if let Some(d) = v.try_normalize() {
            self.offer(d);
            self.offer(-d);
        }
    }

    /// Offers the best direction perpendicular to the unit vector `axis`: samples, then a golden-section search around
    /// the best.
    fn offer_around(&mut self, axis: Vec3) {
        let (x, y) = (axis.any_perpendicular(), axis.cross(axis.any_perpendicular()));
        let at = |angle: f64| x * angle.cos() + y * angle.sin();
        let step = TAU / SAMPLES_AROUND as f64;
        let mut best = (f64::INFINITY, 0.0);
        for k in 0..SAMPLES_AROUND {
            let angle = step * k as f64;
            let depth = self.offer(at(angle));
            best = if depth < best.0 { (depth, angle) } else { best };
        }
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut lo, mut hi) = (best.1 - step, best.1 + step);
        let (mut s, mut t) = (hi - golden * (hi - lo), lo + golden * (hi - lo));
        let (mut at_s, mut at_t) = (self.offer(at(s)), self.offer(at(t)));
        while hi - lo > 1e-9 {
            if at_s < at_t {
                (hi, t, at_t) = (t, s, at_s);
                s = hi - golden * (hi - lo);
                at_s = self.offer(at(s));
            } else {
                (lo, s, at_s) = (s, t, at_t);
                t = lo + golden * (hi - lo);
                at_t = self.offer(at(t));
            }
        }
    }

    /// Pattern search from `d`: descent by steps of shrinking size in six directions.
    fn descend(&mut self, mut d: Vec3) {
        let (mut depth, mut step, mut phase) = (self.offer(d), 0.1, 0.0);
        for _ in 0..MAX_STEPS {
            if step <= 1e-8 {
                break;
            }
            let (x, y) = (d.any_perpendicular(), d.cross(d.any_perpendicular()));
            let mut next = (depth, d);
            for k in 0..6 {
                let (sin, cos) = (phase + PI / 3.0 * f64::from(k)).sin_cos();
                let Some(tilted) = (d + (x * cos + y * sin) * step).try_normalize() else { continue };
                let there = self.offer(tilted);
                next = if there < next.0 { (there, tilted) } else { next };
            }
            // Progress within rounding must not enlarge the steps; otherwise the search would not end.
            step *= if next.0 < depth - 1e-14 * depth.abs() { 1.2 } else { 0.5 };
            phase += 0.4;
            (depth, d) = next;
        }
    }
}

/// Least overlap of the cores, and the unit direction (frame of b) in which to move a. Negative if the cores are
/// apart.
pub(super) fn least_overlap(a: &Core, b: &Core, a_in_b: &Pose) -> (f64, Vec3) {
    let overlap = |d: Vec3| {
        let low_of_a = a_in_b.transform_point(a.support(-a_in_b.inverse_transform_vector(d)));
        (b.support(d) - low_of_a).dot(d)
    };
    let mut best = Best { overlap, depth: f64::INFINITY, direction: Vec3::Z };
    let r = a_in_b.rotation;
    let (of_a, of_b) = ([r.x_axis(), r.y_axis(), r.z_axis()], [Vec3::X, Vec3::Y, Vec3::Z]);
    for &u in &of_a {
        best.offer_both(u);
        for &v in &of_b {
            best.offer_both(u.cross(v));
        }
    }
    let between = a_in_b.translation;
    for &v in
        of_b.iter().chain(&[between, between - r.z_axis() * between.dot(r.z_axis()), between - Vec3::Z * between.z])
    {
        best.offer_both(v);
    }
    let curved = |c: &Core| matches!(c, Core::Cylinder(_));
    if curved(a) || curved(b) {
        for &axis in segments(a, &of_a).iter().chain(segments(b, &of_b)) {
            best.offer_around(axis);
        }
    }
    if curved(a) && curved(b) {
        refine(&mut best);
    }
    (best.depth, best.direction)
}

/// The directions of the segments whose Minkowski sum is the core.
fn segments<'a>(core: &Core, axes: &'a [Vec3; 3]) -> &'a [Vec3] {
    match core {
        Core::Cuboid(_) => axes,
        Core::Point => &[],
        _ => &axes[2..],
    }
}

/// Descends from the best direction so far and from the best samples spread evenly over the sphere.
fn refine<F: Fn(Vec3) -> f64>(best: &mut Best<F>) {
    let mut starts = [(f64::INFINITY, best.direction); STARTS];
    for k in 0..SAMPLES_ON_SPHERE {
        // The samples are a Fibonacci lattice.
        let z = 1.0 - (2 * k + 1) as f64 / SAMPLES_ON_SPHERE as f64;
        let (rho, angle) = ((1.0 - z * z).sqrt(), k as f64 * PI * (3.0 - 5.0_f64.sqrt()));
        let d = Vec3::new(rho * angle.cos(), rho * angle.sin(), z);
        let depth = best.offer(d);
        if let Some(worst) = starts.iter_mut().max_by(|x, y| x.0.total_cmp(&y.0))
            && depth < worst.0
        {
            *worst = (depth, d);
        }
    }
    best.descend(best.direction);
    for (_, d) in starts {
        best.descend(d);
    }
}
