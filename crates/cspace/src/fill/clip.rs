//! Lines that do not touch an outline, found and drawn in.

use super::fan::{Fan, MOST};

/// Moves every line that does not touch the outline to where it does; false where no point is inside.
///
/// Lines are in the order of their directions, so the outline's corners come in order and one pass around is enough
/// (intersection of half-planes with a double-ended queue).
pub(super) fn tighten(fan: &Fan, far: &mut [f32]) -> bool {
    let line = |k: usize| Line { x: f64::from(fan.x[k]), y: f64::from(fan.y[k]), far: f64::from(far[k]) };
    let mut queue = [Line { x: 0.0, y: 0.0, far: 0.0 }; MOST];
    let (mut front, mut back) = (0, 0);
    for next in (0..fan.count).map(line) {
        while back - front >= 2 && next.cuts(queue[back - 2].meets(queue[back - 1])) {
            back -= 1;
        }
        while back - front >= 2 && next.cuts(queue[front].meets(queue[front + 1])) {
            front += 1;
        }
        if back > front && queue[back - 1].cross(next) <= 0.0 {
            return false;
        }
        queue[back] = next;
        back += 1;
    }
    while back - front > 2 && queue[front].cuts(queue[back - 2].meets(queue[back - 1])) {
        back -= 1;
    }
    while back - front > 2 && queue[back - 1].cuts(queue[front].meets(queue[front + 1])) {
        front += 1;
    }
    if back - front < 3 {
        return false;
    }
    let mut corners = [[0.0; 2]; MOST];
    let kept = &queue[front..back];
    for (i, corner) in corners[..kept.len()].iter_mut().enumerate() {
        *corner = kept[i].meets(kept[(i + 1) % kept.len()]);
    }
    for k in 0..fan.count {
        let (x, y) = (f64::from(fan.x[k]), f64::from(fan.y[k]));
        let reach = corners[..kept.len()].iter().map(|c| c[0] * x + c[1] * y).fold(f64::NEG_INFINITY, f64::max);
        far[k] = far[k].min(reach as f32 + 1e-6 * reach.abs() as f32);
    }
    true
}

#[derive(Clone, Copy)]
struct Line {
    x: f64,
    y: f64,
    far: f64,
}

impl Line {
    fn cross(self, o: Self) -> f64 {
        self.x * o.y - self.y * o.x
    }

    fn meets(self, o: Self) -> [f64; 2] {
        let over = 1.0 / self.cross(o);
        [(self.far * o.y - o.far * self.y) * over, (o.far * self.x - self.far * o.x) * over]
    }

    fn cuts(self, [x, y]: [f64; 2]) -> bool {
        self.x * x + self.y * y > self.far
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fan() -> Fan {
        Fan::new([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].into_iter(), 0.92)
    }

    #[test]
    fn a_square_draws_the_slanted_lines_in() {
        let fan = fan();
        let mut far: Vec<f32> =
            (0..fan.count).map(|k| if fan.x[k].abs().max(fan.y[k].abs()) > 0.999 { 1.0 } else { 5.0 }).collect();
        assert!(tighten(&fan, &mut far));
        for k in 0..fan.count {
            assert!((far[k] - fan.x[k].abs() - fan.y[k].abs()).abs() < 1e-5, "{k}: {}", far[k]);
        }
    }

    #[test]
    fn nothing_inside_is_told() {
        let fan = fan();
        let mut far: Vec<f32> = (0..fan.count).map(|k| if fan.x[k] < -0.999 { -2.0 } else { 1.0 }).collect();
        assert!(!tighten(&fan, &mut far));
    }
}
