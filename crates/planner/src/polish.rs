//! Shorter with the same ends: corners left out where the way past them is clear, and pulled taut.

use elbowroom_cspace::{Cell, Table};

use crate::sight::is_clear;
use crate::space::{Point, Scale, Space};

/// Up to so many corners every pair is looked at.
const FEW: usize = 24;
const ROUNDS: usize = 6;
/// How far a corner is moved at once, cells.
const STEPS: [i32; 5] = [16, 8, 4, 2, 1];

/// Memory, used again.
#[derive(Debug, Default)]
pub(crate) struct Polish {
    other: Vec<Point>,
    length: Vec<f64>,
    next: Vec<usize>,
}

/// What is polished.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub table: &'a Table,
    pub space: &'a Space,
    pub scale: Scale,
}

impl Polish {
    pub fn run(&mut self, ground: Ground, points: &mut Vec<Point>) {
        self.skip_ahead(ground, points);
        self.choose(ground, points);
        for _ in 0..ROUNDS {
            let before = ground.scale.length(points);
            (1..points.len().saturating_sub(1)).for_each(|i| pull(ground, points, i, &STEPS));
            self.choose(ground, points);
            if ground.scale.length(points) > before * 0.999 {
                break;
            }
        }
    }

    /// From each point to a far one that it sees, found by doubling and halving.
    fn skip_ahead(&mut self, ground: Ground, points: &mut Vec<Point>) {
        self.other.clear();
        let mut at = 0;
        while at + 1 < points.len() {
            self.other.push(points[at]);
            let sees = |to: usize| is_clear(ground.table, points[at], points[to]);
            let (mut near, mut hop) = (at + 1, 2);
            while at + hop < points.len() && sees(at + hop) {
                near = at + hop;
                hop *= 2;
            }
            let mut far = (at + hop).min(points.len());
            while near + 1 < far {
                let middle = usize::midpoint(near, far);
                if sees(middle) { near = middle } else { far = middle }
            }
            at = near;
        }
        self.other.extend(points.last());
        std::mem::swap(&mut self.other, points);
    }

    /// The shortest choice of the points, in their order.
    fn choose(&mut self, ground: Ground, points: &mut Vec<Point>) {
        let count = points.len();
        if !(3..=FEW).contains(&count) {
            return;
        }
        self.length.clear();
        self.length.resize(count, 0.0);
        self.next.clear();
        self.next.resize(count, count - 1);
        for i in (0..count - 1).rev() {
            self.length[i] = f64::INFINITY;
            for j in i + 1..count {
                let length = ground.scale.distance(points[i], points[j]) + self.length[j];
                // The next point is always in sight: it may be met through cells, not only straight.
                if length < self.length[i] && (j == i + 1 || is_clear(ground.table, points[i], points[j])) {
                    (self.length[i], self.next[i]) = (length, j);
                }
            }
        }
        let (mut write, mut read) = (0, 0);
        while read != count - 1 {
            points[write] = points[read];
            (write, read) = (write + 1, self.next[read]);
        }
        points[write] = points[read];
        points.truncate(write + 1);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.other.capacity() * size_of::<Point>() + (self.length.capacity() + self.next.capacity()) * 8
    }
}

/// Moves a corner to where the way over it is shorter.
pub(crate) fn pull(ground: Ground, points: &mut [Point], i: usize, steps: &[i32]) {
    let (before, after) = (points[i - 1], points[i + 1]);
    let over = |p: Point| ground.scale.distance(before, p) + ground.scale.distance(p, after);
    for &step in steps {
        let mut moves = 0;
        while let Some(better) = best_move(ground, points[i], step, over, |p| {
            is_clear(ground.table, before, p) && is_clear(ground.table, p, after)
        }) {
            points[i] = better;
            moves += 1;
            if moves == 8 {
                break;
            }
        }
    }
}

fn best_move(
    ground: Ground,
    from: Point,
    step: i32,
    over: impl Fn(Point) -> f64,
    clear: impl Fn(Point) -> bool,
) -> Option<Point> {
    let (mut best, mut least) = (None, over(from) * (1.0 - 1e-9));
    for n in (0..27).filter(|&n| n != 13) {
        let shift = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
        let Some(cell) = shifted(ground, from, shift.map(|s: i32| s * step)) else { continue };
        let to = ground.space.middle(cell);
        let length = over(to);
        if length < least && clear(to) {
            (best, least) = (Some(to), length);
        }
    }
    best
}

/// The cell so many further from a point; `None` outside the table.
pub(crate) fn shifted(ground: Ground, from: Point, shift: [i32; 3]) -> Option<Cell> {
    let shape = ground.table.shape();
    let along = |i: usize| {
        let k = from[i].floor() as i64 + i64::from(shift[i]);
        usize::try_from(k).ok().filter(|&k| k < shape[i]).map(|k| k as u16)
    };
    Some([along(0)?, along(1)?, along(2)?])
}
