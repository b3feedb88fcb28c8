//! In which directions an outline is touched by its lines.

use super::lanes::WIDTH;

/// Most directions of an outline: sixteen of the obstacle's own, the rest to round corners.
pub(super) const MOST: usize = 64;
/// Room for them and a whole vector of padding.
pub(super) const SIZE: usize = MOST + WIDTH;
/// Directions of the obstacle's own that are used.
const OWN: usize = 16;
/// Closer directions than 0.1 degrees (sine) are taken as one.
const SAME: f32 = 0.0017;

/// Unit normals in counter-clockwise order, in the plane; padded with the first.
#[derive(Debug, Clone)]
pub(super) struct Fan {
    pub count: usize,
    pub x: [f32; SIZE],
    pub y: [f32; SIZE],
}

impl Fan {
    /// The directions given (any length, any order; zeros are left out) and more between them, so that neighbours are at
    /// most an angle of cosine `apart` (0.97 or less) apart: lines that far apart round the corners.
    pub fn new(own: impl Iterator<Item = [f32; 2]>, apart: f32) -> Self {
        let (sorted, count) = sorted(own);
        let mut fan = Self { count: 0, x: [0.0; SIZE], y: [0.0; SIZE] };
        for i in 0..count {
            let next = sorted[(i + 1) % count];
            fan.push(sorted[i]);
            fan.round(sorted[i], next, apart, 5);
        }
        let (x, y) = (fan.x[0], fan.y[0]);
        fan.x[fan.count..].fill(x);
        fan.y[fan.count..].fill(y);
        fan
    }

    fn push(&mut self, [x, y]: [f32; 2]) {
        if self.count < MOST {
            (self.x[self.count], self.y[self.count]) = (x, y);
            self.count += 1;
        }
    }

    /// Directions between `a` and `b`, halving.
    fn round(&mut self, a: [f32; 2], b: [f32; 2], apart: f32, depth: u32) {
        let (dot, cross) = (a[0] * b[0] + a[1] * b[1], a[0] * b[1] - a[1] * b[0]);
        if depth == 0 || (dot > apart && cross >= 0.0) {
            return;
        }
        // Beyond half a turn the sum points the wrong way; close to it, nowhere.
        let middle = if dot < -0.9 || cross < 0.0 { [-a[1], a[0]] } else { unit([a[0] + b[0], a[1] + b[1]]) };
        self.round(a, middle, apart, depth - 1);
        self.push(middle);
        self.round(middle, b, apart, depth - 1);
    }
}

/// Unit vectors sorted by angle, without doubles.
struct Sorted {
    found: [[f32; 2]; OWN],
    keys: [f32; OWN],
    count: usize,
}

impl Sorted {
    fn insert(&mut self, direction: [f32; 2]) {
        let direction = unit(direction);
        let (key, count) = (turn(direction), self.count);
        if count == OWN || !key.is_finite() {
            return;
        }
        let at = self.keys[..count].iter().position(|&k| k > key).unwrap_or(count);
        if count > 0 && [(at + count - 1) % count, at % count].into_iter().any(|k| same(self.found[k], direction)) {
            return;
        }
        self.found.copy_within(at..count, at + 1);
        self.keys.copy_within(at..count, at + 1);
        (self.found[at], self.keys[at]) = (direction, key);
        self.count += 1;
    }
}

fn sorted(own: impl Iterator<Item = [f32; 2]>) -> ([[f32; 2]; OWN], usize) {
    let mut list = Sorted { found: [[0.0; 2]; OWN], keys: [0.0; OWN], count: 0 };
    own.for_each(|direction| list.insert(direction));
    if list.count < 3 {
        // One or two would leave the outline open.
        for axis in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
            list.insert(axis);
        }
    }
    (list.found, list.count)
}

fn same(a: [f32; 2], b: [f32; 2]) -> bool {
    (a[0] * b[1] - a[1] * b[0]).abs() < SAME && a[0] * b[0] + a[1] * b[1] > 0.0
}

fn unit([x, y]: [f32; 2]) -> [f32; 2] {
    let over = 1.0 / (x * x + y * y).sqrt();
    [x * over, y * over]
}

/// Grows with the angle from 0 to 4.
fn turn([x, y]: [f32; 2]) -> f32 {
    let along = x / (x.abs() + y.abs());
    if y < 0.0 { 3.0 + along } else { 1.0 - along }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(own: &[[f32; 2]]) -> usize {
        let fan = Fan::new(own.iter().copied(), 0.92);
        for i in 0..fan.count {
            let j = (i + 1) % fan.count;
            let (a, b) = ([fan.x[i], fan.y[i]], [fan.x[j], fan.y[j]]);
            assert!((a[0].hypot(a[1]) - 1.0).abs() < 1e-6);
            let (dot, cross) = (a[0] * b[0] + a[1] * b[1], a[0] * b[1] - a[1] * b[0]);
            assert!(cross > 0.0 && dot > 0.92, "{own:?}: {a:?} {b:?}");
        }
        fan.count
    }

    #[test]
    fn directions_go_round_once_and_leave_no_gap() {
        assert_eq!(check(&[[1.0, 0.0], [0.0, 2.0], [-1.0, 0.0], [0.0, -0.1]]), 16);
        check(&[]);
        check(&[[0.3, -0.2]]);
        check(&[[1.0, 0.0], [-1.0, 1e-4]]);
        check(&[[1.0, 0.0], [1.0, 1e-5], [1.0, -1e-5], [f32::NAN, 1.0], [0.0, 0.0]]);
    }

    #[test]
    fn there_is_always_room() {
        let own = |i: u32| if i < 16 { [(0.023 * i as f32).cos(), (0.023 * i as f32).sin()] } else { [0.0; 2] };
        let fan = Fan::new((0..40).map(own), 0.978);
        assert!(fan.count < MOST, "{}", fan.count);
    }

    #[test]
    fn own_directions_are_kept() {
        let own = [[1.0, 0.13], [-0.7, 0.3], [0.2, -1.0]];
        let fan = Fan::new(own.into_iter(), 0.97);
        for o in own {
            let found = (0..fan.count).any(|i| (fan.x[i] * o[1] - fan.y[i] * o[0]).abs() < 1e-6);
            assert!(found, "{o:?}");
        }
    }
}
