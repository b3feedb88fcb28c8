//! Rows in which the wrist's sphere meets the outline in several arcs, one by one.

use std::f64::consts::TAU;

use super::fan::{Fan, MOST};
use super::outline::Outline;

/// Calls `found(lo, hi)` for every interval of directions in which the end of a link of length `reach`, held at `at`
/// (shoulder's frame), lies inside the outline. Angles in radians, `lo ≤ hi`.
pub(super) fn each(outline: &Outline, fan: &Fan, at: [f64; 2], reach: f64, mut found: impl FnMut(f64, f64)) {
    // Each line frees the directions around its normal that lead beyond it; what no line frees is inside.
    let mut free = [(0.0, 0.0); MOST];
    let mut count = 0;
    for k in 0..fan.count {
        let (x, y) = (f64::from(fan.x[k]), f64::from(fan.y[k]));
        let gap = f64::from(outline.far[k]) - x * at[0] - y * at[1];
        if gap < -reach {
            return;
        }
        if gap < reach {
            let (middle, half) = (y.atan2(x), (gap / reach).acos());
            free[count] = (middle - half, middle + half);
            count += 1;
        }
    }
    let free = &mut free[..count];
    let Some(start) = free.iter().map(|f| f.0).min_by(f64::total_cmp) else { return found(0.0, TAU) };
    for f in free.iter_mut() {
        let turn = ((f.0 - start) / TAU).floor() * TAU;
        *f = (f.0 - turn, f.1 - turn);
    }
    free.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut reached = start;
    for &(from, to) in free.iter() {
        if from > reached {
            found(reached, from);
        }
        reached = reached.max(to);
    }
    if start + TAU > reached {
        found(reached, start + TAU);
    }
}
