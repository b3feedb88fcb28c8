//! The nearest free cell to a configuration.

use elbowroom_cspace::CellIndex;

use crate::grid_space::{CellScale, GridPoint, GridSpace};

/// Finds the accepted cell whose centre is nearest to a point within a radius, and its distance (weighted radians).
pub(crate) fn nearest_cell(
    space: &GridSpace,
    scale: CellScale,
    point: GridPoint,
    radius: f64,
    mut accept: impl FnMut(CellIndex) -> bool,
) -> Option<(CellIndex, f64)> {
    let shape = space.grid().shape();
    let range = |i: usize| {
        // A joint of weight 0 is searched over its whole range.
        let cells = if scale.0[i] > 0.0 { radius / scale.0[i] } else { f64::INFINITY };
        let low = (point[i] - cells).floor().max(0.0) as usize;
        low..((point[i] + cells).floor() + 1.0).clamp(0.0, shape[i] as f64) as usize
    };
    let mut best: Option<(CellIndex, f64)> = None;
    for i in range(0) {
        for j in range(1) {
            for k in range(2) {
                let cell = [i as u16, j as u16, k as u16];
                let far = scale.distance(space.center(cell), point);
                if far <= radius && best.is_none_or(|(_, least)| far < least) && accept(cell) {
                    best = Some((cell, far));
                }
            }
        }
    }
    best
}
