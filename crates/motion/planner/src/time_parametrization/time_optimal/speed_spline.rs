//! Speed splines: the squared speed `x(s)` as a quadratic B-spline over a path grid, from rest to rest.
//!
//! On the first and the last interval, beside a rest, the jerk is constant: `x ∝ s^(4/3)`, therefore `s̈ = x / 1.5s`,
//! which is a linear relation between the first two coefficients. Between these intervals x has a continuous derivative
//! `x′ = 2s̈`.

use super::path_grid::PathGrid;
use super::path_speed::{SpeedLaw, SpeedPiece};

/// Linear maps from three neighbouring coefficients to `x`, `b = s̈` and `c = s⃛/ṡ` at a point of an interval.
pub(super) type LocalMap = [[f64; 3]; 3];

/// The spline's knots. Coefficients are numbered like the grid's intervals; the first and the last are padding.
#[derive(Debug)]
pub(super) struct SpeedSpline<'g> {
    grid: &'g PathGrid,
}

impl<'g> SpeedSpline<'g> {
    /// Creates a spline on a grid with at least three intervals.
    pub fn new(grid: &'g PathGrid) -> Self {
        Self { grid }
    }

    /// Spacing in the spline: 0 beside a rest.
    fn spacing(&self, interval: usize) -> f64 {
        if interval == 0 || interval + 1 == self.grid.intervals() { 0.0 } else { self.grid.spacing(interval) }
    }

    /// Maps from the coefficients `interval − 1`, `interval` and `interval + 1`, at a fraction of an interval.
    pub fn local_map(&self, interval: usize, share: f64) -> LocalMap {
        let h = self.grid.spacing(interval);
        let [left, right] = [self.spacing(interval - 1) + h, h + self.spacing(interval + 1)];
        let begin = [h / left, 1.0 - h / left, 0.0];
        let slopes = [[-1.0 / left, 1.0 / left, 0.0], [0.0, -1.0 / right, 1.0 / right]];
        let mut map = [[0.0; 3]; 3];
        for i in 0..3 {
            let c = (slopes[1][i] - slopes[0][i]) / h;
            let offset = share * h;
            map[0][i] = begin[i] + offset * (2.0 * slopes[0][i] + offset * c);
            map[1][i] = slopes[0][i] + offset * c;
            map[2][i] = c;
        }
        self.eliminate_padding(interval, h, &mut map);
        map
    }

    /// Replaces the outermost coefficient by means of the relation beside a rest.
    fn eliminate_padding(&self, interval: usize, h: f64, map: &mut LocalMap) {
        let last = self.grid.intervals() - 1;
        for row in map {
            if interval == 1 {
                row[1] += row[0] / (1.0 + h / (1.5 * self.grid.spacing(0)));
                row[0] = 0.0;
            }
            if interval + 1 == last {
                row[1] += row[2] / (1.0 + h / (1.5 * self.grid.spacing(last)));
                row[2] = 0.0;
            }
        }
    }

    /// The motion and its duration.
    pub fn pieces(&self, coefficients: &[f64]) -> (Vec<SpeedPiece>, f64) {
        let (count, nodes) = (self.grid.intervals(), &self.grid.nodes);
        let mut pieces = Vec::with_capacity(count);
        let mut time = 0.0;
        let mut push = |position: f64, (law, seconds): (SpeedLaw, f64)| {
            pieces.push(SpeedPiece { time, position, seconds, law });
            time += seconds;
        };
        let at = |interval: usize, share: f64| apply(&self.local_map(interval, share), around(coefficients, interval));
        push(0.0, SpeedLaw::from_rest(self.grid.spacing(0), at(1, 0.0)[0].sqrt()));
        for n in 1..count - 1 {
            let ([x, b, c], [end, ..]) = (at(n, 0.0), at(n, 1.0));
            push(nodes[n], SpeedLaw::linear(self.grid.spacing(n), x, end, b, c));
        }
        push(nodes[count - 1], SpeedLaw::to_rest(self.grid.spacing(count - 1), at(count - 2, 1.0)[0].sqrt()));
        (pieces, time)
    }
}

/// The coefficients that affect an interval.
#[inline]
pub(super) fn around(coefficients: &[f64], interval: usize) -> [f64; 3] {
    let c = &coefficients[interval - 1..=interval + 1];
    [c[0], c[1], c[2]]
}

/// `x`, `b` and `c` from the coefficients around an interval.
#[inline]
pub(super) fn apply(map: &LocalMap, coefficients: [f64; 3]) -> [f64; 3] {
    map.map(|row| row[0] * coefficients[0] + row[1] * coefficients[1] + row[2] * coefficients[2])
}
