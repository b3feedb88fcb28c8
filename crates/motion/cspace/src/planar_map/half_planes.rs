//! Intersection of half planes: moves lines that do not touch it inward.

use super::normals::{MAX_NORMALS, OutlineNormals};

/// Moves every line that does not touch the outline inward until it does; false if the outline is empty.
///
/// Lines are sorted by direction, so one pass with a double-ended queue finds the corners in order.
pub(super) fn tighten(normals: &OutlineNormals, far: &mut [f32]) -> bool {
    let line = |k: usize| HalfPlane { x: f64::from(normals.x[k]), y: f64::from(normals.y[k]), far: f64::from(far[k]) };
    let mut queue = [HalfPlane { x: 0.0, y: 0.0, far: 0.0 }; MAX_NORMALS];
    let (mut front, mut back) = (0, 0);
    for next in (0..normals.count).map(line) {
        while back - front >= 2 && next.excludes(queue[back - 2].intersection(queue[back - 1])) {
            back -= 1;
        }
        while back - front >= 2 && next.excludes(queue[front].intersection(queue[front + 1])) {
            front += 1;
        }
        if back > front && queue[back - 1].cross(next) <= 0.0 {
            return false;
        }
        queue[back] = next;
        back += 1;
    }
    while back - front > 2 && queue[front].excludes(queue[back - 2].intersection(queue[back - 1])) {
        back -= 1;
    }
    while back - front > 2 && queue[back - 1].excludes(queue[front].intersection(queue[front + 1])) {
        front += 1;
    }
    if back - front < 3 {
        return false;
    }
    let mut corners = [[0.0; 2]; MAX_NORMALS];
    let kept = &queue[front..back];
    for (i, corner) in corners[..kept.len()].iter_mut().enumerate() {
        *corner = kept[i].intersection(kept[(i + 1) % kept.len()]);
    }
    for k in 0..normals.count {
        let (x, y) = (f64::from(normals.x[k]), f64::from(normals.y[k]));
        let reach = corners[..kept.len()].iter().map(|c| c[0] * x + c[1] * y).fold(f64::NEG_INFINITY, f64::max);
        far[k] = far[k].min(reach as f32 + 1e-6 * reach.abs() as f32);
    }
    true
}

#[derive(Clone, Copy)]
struct HalfPlane {
    x: f64,
    y: f64,
    far: f64,
}

impl HalfPlane {
    fn cross(self, o: Self) -> f64 {
        self.x * o.y - self.y * o.x
    }

    fn intersection(self, o: Self) -> [f64; 2] {
        let over = 1.0 / self.cross(o);
        [(self.far * o.y - o.far * self.y) * over, (o.far * self.x - self.far * o.x) * over]
    }

    fn excludes(self, [x, y]: [f64; 2]) -> bool {
        self.x * x + self.y * y > self.far
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normals() -> OutlineNormals {
        OutlineNormals::new([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].into_iter(), 0.92)
    }

    #[test]
    fn slanted_lines_move_to_the_corners_of_a_square() {
        let normals = normals();
        let mut far: Vec<f32> = (0..normals.count)
            .map(|k| if normals.x[k].abs().max(normals.y[k].abs()) > 0.999 { 1.0 } else { 5.0 })
            .collect();
        assert!(tighten(&normals, &mut far));
        for k in 0..normals.count {
            assert!((far[k] - normals.x[k].abs() - normals.y[k].abs()).abs() < 1e-5, "{k}: {}", far[k]);
        }
    }

    #[test]
    fn an_empty_intersection_is_reported() {
        let normals = normals();
        let mut far: Vec<f32> = (0..normals.count).map(|k| if normals.x[k] < -0.999 { -2.0 } else { 1.0 }).collect();
        assert!(!tighten(&normals, &mut far));
    }
}
