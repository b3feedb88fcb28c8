//! Converts intervals of θ3 to spans of cells.

use std::f64::consts::{FRAC_PI_2, TAU};

use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdFloat, SimdFrom, SimdMask, i32x16, mask32x16};

use super::simd_math::{ANGLE_ERROR, Lanes, splat};
use crate::{GridAxis, Layer, RowSpan};

/// The axis of θ3 in cell coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpanWriter {
    /// Cells per radian.
    pub scale: f32,
    /// Cell coordinate of the direction that continues the upper arm.
    pub zero: f32,
    /// Number of cells in a whole turn.
    turn: f32,
    /// Number of cells of the axis.
    count: f32,
    /// Widening of every interval, in cells.
    margin: f32,
    last: u16,
    /// Whether the axis is longer than a turn: then an interval may appear more than twice.
    exceeds_turn: bool,
}

/// Sixteen rows to write.
#[derive(Clone, Copy)]
pub(super) struct RowBatch {
    /// Index of the first row.
    pub row: u32,
    /// One bit per row, set if all cells are blocked.
    pub full: u16,
    /// One bit per row, set if the cells of the interval are blocked.
    pub hit: u16,
}

const LANE_NUMBERS: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

impl SpanWriter {
    pub fn new(elbow: &GridAxis) -> Self {
        let scale = 1.0 / elbow.step();
        Self {
            scale: scale as f32,
            // θ3 = −90° continues the upper arm.
            zero: ((-FRAC_PI_2 - elbow.min()) * scale) as f32,
            turn: (TAU * scale) as f32,
            count: elbow.count() as f32,
            // Error of the angle, and rounding of a cell coordinate to f32.
            margin: ANGLE_ERROR * scale as f32 + 1e-6 * (TAU * scale) as f32,
            last: elbow.count() as u16 - 1,
            exceeds_turn: TAU * scale < elbow.count() as f64,
        }
    }

    /// Writes the spans of rows that are blocked as a whole.
    pub fn write_full(&self, row: u32, full: u16, layer: &mut Layer) {
        let mut rest = full;
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            layer.spans.push(RowSpan { row: row + lane, first: 0, last: self.last });
        }
    }

    /// Writes the spans of sixteen rows: all cells of full rows, `lo..=hi` (cell coordinates, any turn) of hit rows.
    #[inline(always)]
    pub fn write<S: Simd>(&self, simd: S, rows: RowBatch, [lo, hi]: [Lanes<S>; 2], layer: &mut Layer) {
        let RowBatch { row, full, hit } = rows;
        let turn = splat(simd, self.turn);
        let lo = lo - splat(simd, self.margin);
        let hi = hi + splat(simd, self.margin);
        let turns = (lo * splat(simd, 1.0 / self.turn)).floor() * turn;
        let (a, b) = (lo - turns, hi - turns);
        let all = (b - a).simd_ge(turn).to_bitmask() as u16 & hit;
        let first: i32x16<S> = a.min(splat(simd, self.count)).floor().to_int();
        let last: i32x16<S> = b.min(turn + turn).floor().to_int();
        let wrapped: i32x16<S> = (b - turn).max(splat(simd, -1.0)).min(splat(simd, self.count)).floor().to_int();
        let full = full | all;
        let hit = hit & !full;
        let twice = wrapped.simd_ge(i32x16::splat(simd, 0)).to_bitmask() as u16 & hit;
        if self.exceeds_turn || twice != 0 {
            let rows = RowBatch { row, full, hit };
            return self.write_singly(rows, [first.to_array(), last.to_array(), wrapped.to_array()], layer);
        }
        let end = i32x16::splat(simd, i32::from(self.last));
        let whole = mask32x16::from_bitmask(simd, u64::from(full));
        let inside = whole | mask32x16::from_bitmask(simd, u64::from(hit)) & first.simd_le(end);
        let zero = i32x16::splat(simd, 0);
        let (first, last) = (whole.select(zero, first), whole.select(end, last.min(end)));
        // Packs both ends into one number; rows that are kept move to the front.
        let ends = (first + (last << 16)).compress(inside).to_array();
        let lanes = i32x16::simd_from(simd, LANE_NUMBERS).compress(inside).to_array();
        let count = inside.to_bitmask().count_ones() as usize;
        layer.spans.extend(lanes[..count].iter().zip(&ends[..count]).map(|(&lane, &ends)| RowSpan {
            row: row + lane as u32,
            first: ends as u16,
            last: (ends >> 16) as u16,
        }));
    }

    /// Whether the cell of an angle, radians, is off the axis or in one of the spans; `base` is the cell coordinate of
    /// angle 0.
    #[cfg(test)]
    pub fn contains(&self, spans: &[&RowSpan], angle: f64, base: f64) -> bool {
        let turn = f64::from(self.turn);
        let cell = (angle * f64::from(self.scale) + base).rem_euclid(turn);
        (0..=(f64::from(self.count) / turn) as u32).map(|k| cell + turn * f64::from(k)).all(|cell| {
            let inside = |span: &&&RowSpan| u32::from(span.first) <= cell as u32 && cell as u32 <= u32::from(span.last);
            cell >= f64::from(self.count) || spans.iter().find(inside).is_some()
        })
    }

    fn write_singly(&self, rows: RowBatch, [first, last, wrapped]: [[i32; 16]; 3], layer: &mut Layer) {
        let mut rest = rows.full | rows.hit;
        while rest != 0 {
            let lane = rest.trailing_zeros();
            rest &= rest - 1;
            let row = rows.row + lane;
            if rows.full >> lane & 1 == 1 {
                layer.spans.push(RowSpan { row, first: 0, last: self.last });
                continue;
            }
            let lane = lane as usize;
            self.write_wrapped(row, first[lane], last[lane], wrapped[lane], layer);
        }
    }

    /// Writes an interval of one row; angles in radians; `base` is the cell coordinate of angle 0.
    pub fn write_interval(&self, row: u32, base: f32, [lo, hi]: [f64; 2], layer: &mut Layer) {
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
            layer.spans.push(RowSpan { row, first, last });
        }
    }

    /// Writes the interval in the turn in which it begins, and the part that continues from the previous turn.
    fn write_wrapped(&self, row: u32, first: i32, last: i32, wrapped: i32, layer: &mut Layer) {
        let end = i32::from(self.last);
        if self.exceeds_turn {
            return self.write_every_turn(row, first, last, layer);
        }
        if wrapped >= 0 {
            layer.spans.push(RowSpan { row, first: 0, last: wrapped.min(end) as u16 });
        }
        if first <= end {
            layer.spans.push(RowSpan { row, first: first as u16, last: last.min(end) as u16 });
        }
    }

    #[cold]
    fn write_every_turn(&self, row: u32, first: i32, last: i32, layer: &mut Layer) {
        let turns = (self.count / self.turn).ceil() as i32;
        for k in -1..=turns {
            let shift = f64::from(self.turn) * f64::from(k);
            let first = (f64::from(first) + shift).floor().max(0.0);
            // Both ends were rounded down: the upper one represents the end of its cell.
            let last = (f64::from(last) + 1.0 + shift).floor().min(f64::from(self.last));
            if first <= last {
                layer.spans.push(RowSpan { row, first: first as u16, last: last as u16 });
            }
        }
    }
}
