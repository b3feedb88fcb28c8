//! The order of triangles in the tree: neighbours in space become neighbours in memory.
//!
//! The triangles below a node are one run. Its length is a power of the arity times the leaf size, so the tree needs
//! no pointers. Splits are chosen by the surface-area heuristic (Goldsmith and Salmon, 1987; binned as in Wald,
//! 2007), only among ranks for which every run but the last is full.

use elbowroom_spatial::Vec3;
use rayon::prelude::*;

use super::node::{ARITY, LEAF_SIZE};
use super::unit_frame::UnitFrame;

/// Bins per axis of the split search.
const BINS: usize = 16;
/// Number of triangles below which a second thread costs more than it saves.
const PARALLEL_RUN: usize = 16_384;
/// Smallest number of elements that one thread fills.
const FILLED_RUN: usize = 1024;

/// The bounds of a triangle, for sorting.
#[derive(Clone, Copy)]
struct TriangleBounds {
    low: [f32; 3],
    high: [f32; 3],
    triangle: u32,
}

impl TriangleBounds {
    /// Twice the middle of its box along an axis.
    #[inline]
    fn middle(&self, axis: usize) -> f32 {
        self.low[axis] + self.high[axis]
    }
}

#[derive(Clone, Copy)]
struct Bin {
    low: [f32; 3],
    high: [f32; 3],
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3], count: 0 };

    #[inline]
    fn add(&mut self, o: &Self) {
        for k in 0..3 {
            self.low[k] = self.low[k].min(o.low[k]);
            self.high[k] = self.high[k].max(o.high[k]);
        }
        self.count += o.count;
    }

    /// Half the surface of the box.
    #[inline]
    fn area(&self) -> f32 {
        let e: [f32; 3] = std::array::from_fn(|k| (self.high[k] - self.low[k]).max(0.0));
        e[0] * e[1] + e[1] * e[2] + e[2] * e[0]
    }
}

/// Triangle indices in tree order.
pub(super) fn order_triangles(vertices: &[Vec3], triangles: &[[u32; 3]], frame: &UnitFrame) -> Vec<u32> {
    let blank = TriangleBounds { low: [0.0; 3], high: [0.0; 3], triangle: 0 };
    let mut items = vec![blank; triangles.len()];
    fill(&mut items, |i, item| *item = bounds_of(i, vertices, triangles, frame));
    let mut capacity = LEAF_SIZE;
    while capacity * ARITY < items.len() {
        capacity *= ARITY;
    }
    arrange(&mut items, capacity);
    items.iter().map(|i| i.triangle).collect()
}

/// Runs `work` on every element with its index, in parallel if there are many.
pub(super) fn fill<T: Send>(all: &mut [T], work: impl Fn(usize, &mut T) + Send + Sync) {
    if all.len() < 2 * FILLED_RUN {
        all.iter_mut().enumerate().for_each(|(i, one)| work(i, one));
    } else {
        all.par_iter_mut().with_min_len(FILLED_RUN).enumerate().for_each(|(i, one)| work(i, one));
    }
}

fn bounds_of(triangle: usize, vertices: &[Vec3], triangles: &[[u32; 3]], frame: &UnitFrame) -> TriangleBounds {
    let mut item = TriangleBounds { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3], triangle: triangle as u32 };
    for v in triangles[triangle] {
        let p = frame.to_units(vertices[v as usize]).to_array();
        for k in 0..3 {
            item.low[k] = item.low[k].min(p[k] as f32);
            item.high[k] = item.high[k].max(p[k] as f32);
        }
    }
    item
}

/// Sorts one run; `capacity` is the capacity of the largest subtree that can be below it.
fn arrange(items: &mut [TriangleBounds], mut capacity: usize) {
    if items.len() <= LEAF_SIZE {
        return;
    }
    while items.len() <= capacity {
        capacity /= ARITY;
    }
    let at = split(items, capacity);
    let (left, right) = items.split_at_mut(at);
    if left.len().min(right.len()) >= PARALLEL_RUN {
        rayon::join(|| arrange(left, capacity), || arrange(right, capacity));
    } else {
        arrange(left, capacity);
        arrange(right, capacity);
    }
}

/// Partitions the triangles by the best split and returns its rank, a multiple of `capacity`.
fn split(items: &mut [TriangleBounds], capacity: usize) -> usize {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for item in items.iter() {
        for k in 0..3 {
            low[k] = low[k].min(item.middle(k));
            high[k] = high[k].max(item.middle(k));
        }
    }
    let runs = items.len().div_ceil(capacity);
    let mut best = (f32::INFINITY, 0, (runs / 2).max(1));
    let scale: [f32; 3] = std::array::from_fn(|k| BINS as f32 / (high[k] - low[k]).max(f32::MIN_POSITIVE));
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    for item in items.iter() {
        let one = Bin { low: item.low, high: item.high, count: 1 };
        for k in 0..3 {
            bins[k][(((item.middle(k) - low[k]) * scale[k]) as usize).min(BINS - 1)].add(&one);
        }
    }
    for axis in 0..3 {
        if high[axis] > low[axis] {
            let found = cheapest(&bins[axis], capacity, runs);
            if found.0 < best.0 {
                best = (found.0, axis, found.1);
            }
        }
    }
    let at = best.2 * capacity;
    let axis = best.1;
    items
        .select_nth_unstable_by(at, |a, b| a.middle(axis).total_cmp(&b.middle(axis)).then(a.triangle.cmp(&b.triangle)));
    at
}

/// The cheapest split between bins: its cost, and the number of runs to its left.
fn cheapest(bins: &[Bin; BINS], capacity: usize, runs: usize) -> (f32, usize) {
    let mut right = [Bin::EMPTY; BINS];
    let mut all = Bin::EMPTY;
    for n in (1..BINS).rev() {
        all.add(&bins[n]);
        right[n] = all;
    }
    let mut left = Bin::EMPTY;
    let mut best = (f32::INFINITY, 1);
    for n in 1..BINS {
        left.add(&bins[n - 1]);
        let at = ((left.count + capacity / 2) / capacity).clamp(1, runs - 1);
        // Rounding the rank to full runs moves so many triangles to the other side.
        let moved = (at * capacity).abs_diff(left.count) as f32;
        let larger = left.area().max(right[n].area());
        let cost = left.area() * left.count as f32 + right[n].area() * right[n].count as f32 + moved * larger;
        if cost < best.0 {
            best = (cost, at);
        }
    }
    best
}
