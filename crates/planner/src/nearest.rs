//! The nearest free cell to a configuration.

use elbowroom_cspace::Cell;

use crate::space::{Point, Scale, Space};

/// The accepted cell whose middle is nearest to a point, and how far that is (weighted radians), within a radius.
pub(crate) fn nearest(
    space: &Space,
    scale: Scale,
    point: Point,
    radius: f64,
    mut accept: impl FnMut(Cell) -> bool,
) -> Option<(Cell, f64)> {
    let shape = space.grid().shape();
    let range = |i: usize| {
        // A joint that does not count is searched all along.
        let cells = if scale.0[i] > 0.0 { radius / scale.0[i] } else { f64::INFINITY };
        let low = (point[i] - cells).floor().max(0.0) as usize;
        low..((point[i] + cells).floor() + 1.0).clamp(0.0, shape[i] as f64) as usize
    };
    let mut best: Option<(Cell, f64)> = None;
    for i in range(0) {
        for j in range(1) {
            for k in range(2) {
                let cell = [i as u16, j as u16, k as u16];
                let far = scale.distance(space.middle(cell), point);
                if far <= radius && best.is_none_or(|(_, least)| far < least) && accept(cell) {
                    best = Some((cell, far));
                }
            }
        }
    }
    best
}
