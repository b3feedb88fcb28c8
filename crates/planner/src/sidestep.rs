//! Around a small obstacle with one corner: tried before anything is searched.

use crate::polish::{Ground, pull, shifted};
use crate::sight::is_clear;
use crate::space::Point;

/// How far aside the corner is tried, cells.
const ASIDE: [i32; 6] = [2, 4, 7, 11, 16, 24];

/// A corner beside `about` that sees both ends, pulled taut; from the smallest step aside that has one.
pub(crate) fn sidestep(ground: Ground, [from, to]: [Point; 2], about: Point) -> Option<Point> {
    let over = |p: Point| ground.scale.distance(from, p) + ground.scale.distance(p, to);
    for aside in ASIDE {
        let (mut best, mut least) = (None, f64::INFINITY);
        for n in (0..27).filter(|&n| n != 13) {
            let shift = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
            let Some(cell) = shifted(ground, about, shift.map(|s: i32| s * aside)) else { continue };
            let corner = ground.space.middle(cell);
            let length = over(corner);
            let free = length < least && !ground.table.is_blocked(cell);
            if free && is_clear(ground.table, corner, from) && is_clear(ground.table, corner, to) {
                (best, least) = (Some(corner), length);
            }
        }
        if let Some(corner) = best {
            let mut points = [from, corner, to];
            pull(ground, &mut points, 1);
            return Some(points[1]);
        }
    }
    None
}
