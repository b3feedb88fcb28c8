//! Around a small obstacle with one corner: tried before anything is searched.

use crate::polish::{Ground, pull, shifted};
use crate::sight::is_clear;
use crate::space::Point;

/// How far aside the corner is tried, cells.
const ASIDE: [i32; 6] = [2, 4, 7, 11, 16, 24];
/// How far the corner is moved at once to pull it taut, cells.
const STEPS: [i32; 1] = [2];
/// So often the way from what is blocked to the corner is halved.
const HALVINGS: usize = 4;

/// A corner that sees both ends, pulled taut, beside the middle of a blocked part; from the smallest step aside that has
/// one. What is blocked is hardly slimmer than a third of the part: no smaller step is tried.
pub(crate) fn sidestep(ground: Ground, [from, to]: [Point; 2], blocked: [Point; 2]) -> Option<Point> {
    let about = [0, 1, 2].map(|i| 0.5 * (blocked[0][i] + blocked[1][i]));
    let across = (0..3).map(|i| (blocked[0][i] - blocked[1][i]).abs()).fold(0.0, f64::max);
    let over = |p: Point| ground.scale.distance(from, p) + ground.scale.distance(p, to);
    let leg = [0, 1, 2].map(|i| to[i] - from[i]);
    for aside in ASIDE.into_iter().filter(|&aside| f64::from(aside) * 3.0 >= across || aside == 24) {
        let (mut best, mut least) = (None, f64::INFINITY);
        for n in (0..27).filter(|&n| n != 13) {
            let shift = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
            if runs_along(leg, shift.map(f64::from)) {
                continue;
            }
            let Some(cell) = shifted(ground, about, shift.map(|s: i32| s * aside)) else { continue };
            let corner = ground.space.middle(cell);
            let length = over(corner);
            let free = length < least && !ground.table.is_blocked(cell);
            if free && is_clear(ground.table, corner, from) && is_clear(ground.table, corner, to) {
                (best, least) = (Some(corner), length);
            }
        }
        if let Some(corner) = best {
            let mut points = [from, drawn_in(ground, [from, to], about, corner), to];
            pull(ground, &mut points, 1, &STEPS);
            return Some(points[1]);
        }
    }
    None
}

/// True for a direction less than 45° from that of the leg, either way: it does not lead aside.
fn runs_along(leg: Point, direction: Point) -> bool {
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    2.0 * dot(leg, direction).powi(2) > dot(leg, leg) * dot(direction, direction)
}

/// The corner, as near to `about` as both ends are still seen from.
fn drawn_in(ground: Ground, [from, to]: [Point; 2], about: Point, corner: Point) -> Point {
    let (mut blocked, mut best) = (about, corner);
    for _ in 0..HALVINGS {
        let middle = [0, 1, 2].map(|i| 0.5 * (blocked[i] + best[i]));
        let Some(cell) = shifted(ground, middle, [0; 3]) else { break };
        let middle = ground.space.middle(cell);
        if middle == best {
            break;
        }
        if is_clear(ground.table, middle, from) && is_clear(ground.table, middle, to) {
            best = middle;
        } else {
            blocked = middle;
        }
    }
    best
}
