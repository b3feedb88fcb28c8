//! Directions of a link that meets an outline, one elbow at a time, in double precision: for rows in which the wrist's
//! sphere meets the outline in several arcs.

use std::f64::consts::TAU;

use super::normals::{MAX_NORMALS, OutlineNormals};
use super::outline::Outline;

/// Calls `found(lo, hi)` for every interval of directions in which the end of a link is inside the outline. The link
/// has length `reach` and its joint at `at` (shoulder's frame). Angles in radians, `lo ≤ hi`.
pub(super) fn for_each_inside(
    outline: &Outline,
    normals: &OutlineNormals,
    at: [f64; 2],
    reach: f64,
    mut found: impl FnMut(f64, f64),
) {
    // Each line excludes the directions around its normal that lead beyond it; all other directions are inside.
    let mut free = [(0.0, 0.0); MAX_NORMALS];
    let mut count = 0;
    for k in 0..normals.count {
        let (x, y) = (f64::from(normals.x[k]), f64::from(normals.y[k]));
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
    // The last interval may extend beyond the start.
    let mut reached = free.iter().map(|f| f.1 - TAU).fold(start, f64::max);
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

/// Directions from `at`, which is outside, in which a link of length `reach` meets the outline: lowest and highest
/// angle, radians; `None` if the link never meets it.
pub(super) fn visible_interval(
    outline: &Outline,
    normals: &OutlineNormals,
    at: [f64; 2],
    reach: f64,
) -> Option<(f64, f64)> {
    let line = |k: usize| [f64::from(normals.x[k]), f64::from(normals.y[k]), f64::from(outline.far[k])];
    let lines = || (0..normals.count).map(line).enumerate();
    let gap = |[x, y, far]: [f64; 3]| far - x * at[0] - y * at[1];
    // The line that `at` is farthest outside of: the whole outline is beyond it.
    let (_, nearest) = lines().min_by(|a, b| gap(a.1).total_cmp(&gap(b.1)))?;
    let ahead = [-nearest[0], -nearest[1]];
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, line) in lines() {
        let ([x, y, _], gap) = (line, gap(line));
        let along = x * at[1] - y * at[0];
        let half = (reach * reach - gap * gap).max(0.0).sqrt();
        let from = (f64::from(outline.from[k]) - along).max(-half);
        let to = (f64::from(outline.to[k]) - along).min(half);
        if from > to || gap.abs() > reach {
            continue;
        }
        for s in [from, to] {
            let (px, py) = (gap * x - s * y, gap * y + s * x);
            let tangent = (ahead[0] * py - ahead[1] * px) / (ahead[0] * px + ahead[1] * py).max(1e-12);
            (lo, hi) = (lo.min(tangent), hi.max(tangent));
        }
    }
    let middle = ahead[1].atan2(ahead[0]);
    (lo <= hi).then(|| (middle + lo.atan(), middle + hi.atan()))
}
