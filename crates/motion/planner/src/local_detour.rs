//! Detours around a small obstacle with one corner, tried before a search.

use crate::grid_shortcutting::{PathContext, neighbour_shifts, pull_corner, shifted_cell};
use crate::grid_space::GridPoint;
use crate::line_of_sight::line_of_sight;

/// Offsets of the corner, cells.
const OFFSETS: [i32; 6] = [2, 4, 7, 11, 16, LARGEST_OFFSET];
const LARGEST_OFFSET: i32 = 24;
/// The blocked part is at most so many times as long as an obstacle is wide: smaller offsets are skipped.
const MAX_BLOCKED_PER_WIDTH: f64 = 3.0;
/// Steps by which the corner is moved to shorten the path, cells.
const STEPS: [i32; 1] = [2];
/// Bisections between the blocked part and the corner.
const HALVINGS: usize = 4;

/// A corner with line of sight to both ends, beside the centre of a blocked part, at the smallest offset that has one, then
/// moved to shorten the path. An obstacle is hardly narrower than a third of the blocked part: smaller offsets are skipped.
pub(crate) fn single_corner_detour(
    context: PathContext,
    [from, to]: [GridPoint; 2],
    blocked: [GridPoint; 2],
) -> Option<GridPoint> {
    let about = [0, 1, 2].map(|i| 0.5 * (blocked[0][i] + blocked[1][i]));
    let across = (0..3).map(|i| (blocked[0][i] - blocked[1][i]).abs()).fold(0.0, f64::max);
    let over = |p: GridPoint| context.scale.distance(from, p) + context.scale.distance(p, to);
    let segment = [0, 1, 2].map(|i| to[i] - from[i]);
    let may_clear = |offset: i32| f64::from(offset) * MAX_BLOCKED_PER_WIDTH >= across || offset == LARGEST_OFFSET;
    for offset in OFFSETS.into_iter().filter(|&offset| may_clear(offset)) {
        let (mut best, mut least) = (None, f64::INFINITY);
        for shift in neighbour_shifts() {
            if is_along(segment, shift.map(f64::from)) {
                continue;
            }
            let Some(cell) = shifted_cell(context, about, shift.map(|s| s * offset)) else { continue };
            let corner = context.space.center(cell);
            let length = over(corner);
            let free = length < least && !context.occupancy.is_blocked(cell);
            if free && line_of_sight(context.occupancy, corner, from) && line_of_sight(context.occupancy, corner, to) {
                (best, least) = (Some(corner), length);
            }
        }
        if let Some(corner) = best {
            let mut points = [from, moved_toward(context, [from, to], about, corner), to];
            pull_corner(context, &mut points, 1, &STEPS);
            return Some(points[1]);
        }
    }
    None
}

/// True for a direction less than 45° from that of the segment, in either sense: it does not lead aside.
fn is_along(segment: GridPoint, direction: GridPoint) -> bool {
    let dot = |a: GridPoint, b: GridPoint| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    2.0 * dot(segment, direction).powi(2) > dot(segment, segment) * dot(direction, direction)
}

/// The corner moved toward `about` as far as it keeps line of sight to both ends.
fn moved_toward(context: PathContext, [from, to]: [GridPoint; 2], about: GridPoint, corner: GridPoint) -> GridPoint {
    let (mut blocked, mut best) = (about, corner);
    for _ in 0..HALVINGS {
        let middle = [0, 1, 2].map(|i| 0.5 * (blocked[i] + best[i]));
        let Some(cell) = shifted_cell(context, middle, [0; 3]) else { break };
        let middle = context.space.center(cell);
        if middle == best {
            break;
        }
        if line_of_sight(context.occupancy, middle, from) && line_of_sight(context.occupancy, middle, to) {
            best = middle;
        } else {
            blocked = middle;
        }
    }
    best
}
