//! How near to a corner a blend may begin: its triangle must lie in free cells.

use elbowroom_cspace::Table;

use crate::sight::box_is_free;
use crate::space::Point;

/// A triangle is halved so often before it counts as not free.
const DEPTH: u32 = 7;

/// True where every cell that the triangle touches is free; may be false where only its neighbours are blocked.
pub(super) fn triangle_is_free(table: &Table, corners: [Point; 3]) -> bool {
    halved(table, corners, DEPTH)
}

fn halved(table: &Table, [a, b, c]: [Point; 3], depth: u32) -> bool {
    let low = [0, 1, 2].map(|i| a[i].min(b[i]).min(c[i]));
    let high = [0, 1, 2].map(|i| a[i].max(b[i]).max(c[i]));
    if box_is_free(table, low, high) {
        return true;
    }
    if depth == 0 {
        return false;
    }
    // The longest edge first in the list.
    let far = |p: Point, q: Point| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>();
    let (ab, bc, ca) = (far(a, b), far(b, c), far(c, a));
    let [p, q, tip] = if ab >= bc && ab >= ca {
        [a, b, c]
    } else if bc >= ca {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let middle = [0, 1, 2].map(|i| 0.5 * (p[i] + q[i]));
    halved(table, [p, middle, tip], depth - 1) && halved(table, [middle, q, tip], depth - 1)
}
