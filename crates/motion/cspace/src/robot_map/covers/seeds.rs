//! Seeds of the expansion of the joint-space paper (section IV), for any robot: configurations at which a link is nearest
//! to the obstacle's centre.

use super::box_division::BoxDivision;
use crate::CellIndex;

/// Number of values of each axis from which descents start.
const STARTS: usize = 4;
/// Steps of a descent, in cells, the largest first.
const STEPS: [isize; 4] = [16, 4, 2, 1];

/// Finds cells at which the links of each path are nearest to the centre of the obstacle, as far as descents along the
/// axes from a few cells find them.
pub(super) fn seeds(division: &mut BoxDivision<'_>, counts: [usize; 3]) -> Vec<CellIndex> {
    let start = |axis: usize, i: usize| (2 * i + 1) * counts[axis] / (2 * STARTS);
    let mut found = Vec::new();
    for (class, root) in division.roots() {
        for i in 0..STARTS {
            for j in 0..STARTS {
                for k in 0..STARTS {
                    let from = [start(0, i), start(1, j), start(2, k)];
                    found.push(descend(from, counts, |cell| division.distance_from_centre(class, root, cell)));
                }
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Moves to the best neighbour along the axes as long as one is better.
fn descend(from: [usize; 3], counts: [usize; 3], mut distance: impl FnMut([usize; 3]) -> f32) -> CellIndex {
    let (mut at, mut least) = (from, distance(from));
    for step in STEPS {
        loop {
            let mut best = (least, at);
            for (axis, &count) in counts.iter().enumerate() {
                for by in [-step, step] {
                    let Some(value) = at[axis].checked_add_signed(by).filter(|value| *value < count) else { continue };
                    let mut next = at;
                    next[axis] = value;
                    let found = distance(next);
                    if found < best.0 {
                        best = (found, next);
                    }
                }
            }
            if best.1 == at {
                break;
            }
            (least, at) = best;
        }
    }
    at.map(|value| value as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_descent_ends_at_a_least_distance() {
        let target = [37.0_f32, 3.0, 80.0];
        let distance = |cell: [usize; 3]| (0..3).map(|k| (cell[k] as f32 - target[k]).powi(2)).sum();
        assert_eq!(descend([5, 60, 20], [60, 70, 100], distance), [37, 3, 80]);
        assert_eq!(descend([5, 60, 20], [30, 70, 40], distance), [29, 3, 39]);
    }
}
