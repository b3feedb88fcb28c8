//! From intervals of θ3 to spans of cells.

use std::f64::consts::{FRAC_PI_2, TAU};

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, i32x16};

use super::lanes::{ANGLE_ERROR, F, splat};
use crate::{Axis, Layer, Span};

/// θ3 in cells: what every row shares.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rows {
    /// Cells per radian.
    pub scale: f32,
    /// The cell coordinate of the direction that continues the upper arm.
    pub zero: f32,
    /// Cells of a whole turn.
    turn: f32,
    /// Cells of the axis.
    count: f32,
    /// Widening of every interval, in cells.
    margin: f32,
    last: u16,
    /// The axis is longer than a turn: an interval may appear more than twice.
    long: bool,
}

impl Rows {
    pub fn new(elbow: &Axis) -> Self {
        let scale = 1.0 / elbow.step();
        Self {
            scale: scale as f32,
            // θ3 = −90° continues the upper arm.
            zero: ((-FRAC_PI_2 - elbow.min()) * scale) as f32,
            turn: (TAU * scale) as f32,
            count: elbow.count() as f32,
            // The angle, and what f32 loses of a cell coordinate.
            margin: ANGLE_ERROR * scale as f32 + 1e-6 * (TAU * scale) as f32,
            last: elbow.count() as u16 - 1,
            long: TAU * scale < elbow.count() as f64,
        }
    }

    /// Spans of sixteen rows from `row` on: all cells where `full` has a bit, `lo..=hi` (cell coordinates, any turn)
    /// where `hit` has one.
    #[inline(always)]
    pub fn emit<S: Simd>(&self, simd: S, row: u32, full: u16, hit: u16, [lo, hi]: [F<S>; 2], layer: &mut Layer) {
        let turn = splat(simd, self.turn);
        let lo = lo - splat(simd, self.margin);
        let hi = hi + splat(simd, self.margin);
        let turns = (lo * splat(simd, 1.0 / self.turn)).floor() * turn;
        let (a, b) = (lo - turns, hi - turns);
        let all = (b - a).simd_ge(turn).to_bitmask() as u16 & hit;
        let first: i32x16<S> = a.min(splat(simd, self.count)).floor().to_int();
        let last: i32x16<S> = b.min(turn + turn).floor().to_int();
        let again: i32x16<S> = (b - turn).max(splat(simd, -1.0)).min(splat(simd, self.count)).floor().to_int();
        let (first, last, again) = (first.to_array(), last.to_array(), again.to_array());
        let full = full | all;
        let mut rest = full | hit;
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            let row = row + lane;
            if full >> lane & 1 == 1 {
                layer.spans.push(Span { row, first: 0, last: self.last });
                continue;
            }
            let lane = lane as usize;
            self.pieces(row, first[lane], last[lane], again[lane], layer);
        }
    }

    /// One row, angles in radians in f64; `base` is the cell coordinate of angle 0.
    pub fn emit_one(&self, row: u32, base: f32, [lo, hi]: [f64; 2], layer: &mut Layer) {
        let (scale, turn, margin) = (f64::from(self.scale), f64::from(self.turn), f64::from(self.margin));
        let lo = lo * scale + f64::from(base) - margin;
        let hi = hi * scale + f64::from(base) + margin;
        let (lo, hi) = if hi - lo >= turn { (0.0, f64::from(self.count)) } else { (lo, hi) };
        let from = (-hi / turn).ceil() as i32;
        for k in from.. {
            let shift = turn * f64::from(k);
            if lo + shift >= f64::from(self.count) {
                break;
            }
            let (first, last) = ((lo + shift).max(0.0) as u16, (hi + shift).min(f64::from(self.last)) as u16);
            layer.spans.push(Span { row, first, last });
        }
    }

    /// The interval from the turn it begins in, and what of it lies in the turn before.
    #[inline(always)]
    fn pieces(&self, row: u32, first: i32, last: i32, again: i32, layer: &mut Layer) {
        let end = i32::from(self.last);
        if self.long {
            return self.many(row, first, last, layer);
        }
        if again >= 0 {
            layer.spans.push(Span { row, first: 0, last: again.min(end) as u16 });
        }
        if first <= end {
            layer.spans.push(Span { row, first: first as u16, last: last.min(end) as u16 });
        }
    }

    #[cold]
    fn many(&self, row: u32, first: i32, last: i32, layer: &mut Layer) {
        let turns = (self.count / self.turn).ceil() as i32;
        for k in -1..=turns {
            let shift = f64::from(self.turn) * f64::from(k);
            let first = (f64::from(first) + shift).floor().max(0.0);
            // Both ends were rounded down: the upper one stands for the end of its cell.
            let last = (f64::from(last) + 1.0 + shift).floor().min(f64::from(self.last));
            if first <= last {
                layer.spans.push(Span { row, first: first as u16, last: last as u16 });
            }
        }
    }
}
