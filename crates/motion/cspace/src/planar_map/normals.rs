//! Normals of the lines that bound an outline.

use super::simd_math::WIDTH;

/// Largest number of normals of an outline: sixteen own directions of the obstacle, the rest to round corners.
pub(super) const MAX_NORMALS: usize = 64;
/// Length of the arrays: the normals and one vector of padding.
pub(super) const PADDED_NORMALS: usize = MAX_NORMALS + WIDTH;
/// Largest number of own directions of an obstacle.
const MAX_OWN: usize = 16;
/// Difference of directions up to which they count as one (sine of 0.1 degrees).
const SAME_DIRECTION_SINE: f32 = 0.0017;

/// Unit normals in counter-clockwise order, in the plane; padded with the first normal.
#[derive(Debug, Clone)]
pub(super) struct OutlineNormals {
    pub count: usize,
    pub x: [f32; PADDED_NORMALS],
    pub y: [f32; PADDED_NORMALS],
}

impl OutlineNormals {
    /// Sorts the given directions (any length, any order; zeros are ignored) and adds more directions between them, so
    /// that the cosine of the angle between neighbours is at least `spacing_cosine` (0.97 or less): the lines of the
    /// added directions round the corners.
    pub fn new(own: impl Iterator<Item = [f32; 2]>, spacing_cosine: f32) -> Self {
        let (sorted, count) = sorted(own);
        let mut normals = Self { count: 0, x: [0.0; PADDED_NORMALS], y: [0.0; PADDED_NORMALS] };
        for i in 0..count {
            let next = sorted[(i + 1) % count];
            normals.push(sorted[i]);
            normals.subdivide(sorted[i], next, spacing_cosine, 5);
        }
        let (x, y) = (normals.x[0], normals.y[0]);
        normals.x[normals.count..].fill(x);
        normals.y[normals.count..].fill(y);
        normals
    }

    fn push(&mut self, [x, y]: [f32; 2]) {
        if self.count < MAX_NORMALS {
            (self.x[self.count], self.y[self.count]) = (x, y);
            self.count += 1;
        }
    }

    /// Adds directions between `a` and `b` by bisection.
    fn subdivide(&mut self, a: [f32; 2], b: [f32; 2], spacing_cosine: f32, depth: u32) {
        let (dot, cross) = (a[0] * b[0] + a[1] * b[1], a[0] * b[1] - a[1] * b[0]);
        if depth == 0 || (dot > spacing_cosine && cross >= 0.0) {
            return;
        }
        // Beyond half a turn the sum points backwards; close to half a turn it vanishes.
        let middle = if dot < -0.9 || cross < 0.0 { [-a[1], a[0]] } else { unit([a[0] + b[0], a[1] + b[1]]) };
        self.subdivide(a, middle, spacing_cosine, depth - 1);
        self.push(middle);
        self.subdivide(middle, b, spacing_cosine, depth - 1);
    }
}

/// Unit vectors sorted by angle, without duplicates.
struct SortedDirections {
    found: [[f32; 2]; MAX_OWN],
    keys: [f32; MAX_OWN],
    count: usize,
}

impl SortedDirections {
    fn insert(&mut self, direction: [f32; 2]) {
        let direction = unit(direction);
        let (key, count) = (angle_key(direction), self.count);
        if count == MAX_OWN || !key.is_finite() {
            return;
        }
        let at = self.keys[..count].iter().position(|&k| k > key).unwrap_or(count);
        if count > 0
            && [(at + count - 1) % count, at % count].into_iter().any(|k| is_same_direction(self.found[k], direction))
        {
            return;
        }
        self.found.copy_within(at..count, at + 1);
        self.keys.copy_within(at..count, at + 1);
        (self.found[at], self.keys[at]) = (direction, key);
        self.count += 1;
    }
}

fn sorted(own: impl Iterator<Item = [f32; 2]>) -> ([[f32; 2]; MAX_OWN], usize) {
    let mut list = SortedDirections { found: [[0.0; 2]; MAX_OWN], keys: [0.0; MAX_OWN], count: 0 };
    own.for_each(|direction| list.insert(direction));
    if list.count < 3 {
        // One or two lines do not bound an outline.
        for axis in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
            list.insert(axis);
        }
    }
    (list.found, list.count)
}

fn is_same_direction(a: [f32; 2], b: [f32; 2]) -> bool {
    (a[0] * b[1] - a[1] * b[0]).abs() < SAME_DIRECTION_SINE && a[0] * b[0] + a[1] * b[1] > 0.0
}

fn unit([x, y]: [f32; 2]) -> [f32; 2] {
    let over = 1.0 / (x * x + y * y).sqrt();
    [x * over, y * over]
}

/// A number from 0 to 4 that increases with the angle.
fn angle_key([x, y]: [f32; 2]) -> f32 {
    let along = x / (x.abs() + y.abs());
    if y < 0.0 { 3.0 + along } else { 1.0 - along }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(own: &[[f32; 2]]) -> usize {
        let normals = OutlineNormals::new(own.iter().copied(), 0.92);
        for i in 0..normals.count {
            let j = (i + 1) % normals.count;
            let (a, b) = ([normals.x[i], normals.y[i]], [normals.x[j], normals.y[j]]);
            assert!((a[0].hypot(a[1]) - 1.0).abs() < 1e-6);
            let (dot, cross) = (a[0] * b[0] + a[1] * b[1], a[0] * b[1] - a[1] * b[0]);
            assert!(cross > 0.0 && dot > 0.92, "{own:?}: {a:?} {b:?}");
        }
        normals.count
    }

    #[test]
    fn normals_cover_one_turn_without_gaps() {
        assert_eq!(check(&[[1.0, 0.0], [0.0, 2.0], [-1.0, 0.0], [0.0, -0.1]]), 16);
        check(&[]);
        check(&[[0.3, -0.2]]);
        check(&[[1.0, 0.0], [-1.0, 1e-4]]);
        check(&[[1.0, 0.0], [1.0, 1e-5], [1.0, -1e-5], [f32::NAN, 1.0], [0.0, 0.0]]);
    }

    #[test]
    fn the_number_of_normals_stays_below_the_limit() {
        let own = |i: u32| if i < 16 { [(0.023 * i as f32).cos(), (0.023 * i as f32).sin()] } else { [0.0; 2] };
        let normals = OutlineNormals::new((0..40).map(own), 0.978);
        assert!(normals.count < MAX_NORMALS, "{}", normals.count);
    }

    #[test]
    fn own_directions_are_kept() {
        let own = [[1.0, 0.13], [-0.7, 0.3], [0.2, -1.0]];
        let normals = OutlineNormals::new(own.into_iter(), 0.97);
        for o in own {
            let found = (0..normals.count).any(|i| (normals.x[i] * o[1] - normals.y[i] * o[0]).abs() < 1e-6);
            assert!(found, "{o:?}");
        }
    }
}
