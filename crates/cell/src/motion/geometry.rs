//! Where a move leads, without time.

use super::Line;

/// Joint values along a parameter, with their first and second derivative by it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Point {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// dq/ds.
    pub first: Vec<f64>,
    /// d²q/ds².
    pub second: Vec<f64>,
}

/// The course of a move, over `s` from 0 to 1.
#[derive(Debug)]
pub enum Geometry {
    /// Straight in joint space.
    Joint {
        /// Joint values at s = 0.
        from: Vec<f64>,
        /// Joint values at s = 1.
        to: Vec<f64>,
    },
    /// TCP on a straight line.
    Line(Box<Line>),
}

impl Geometry {
    /// The joint values at `s`.
    pub fn at(&self, s: f64) -> Point {
        match self {
            Self::Joint { from, to } => {
                let lerp = |(a, b): (&f64, &f64)| if s >= 1.0 { *b } else { a + (b - a) * s };
                let first: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
                Point { q: from.iter().zip(to).map(lerp).collect(), second: vec![0.0; first.len()], first }
            }
            Self::Line(line) => line.at(s),
        }
    }

    /// Points that show how the joints move along the whole course: one for a joint move, whose derivatives are constant.
    pub fn probes(&self) -> Vec<Point> {
        match self {
            Self::Joint { .. } => vec![self.at(0.0)],
            Self::Line(line) => (0..=line.cells()).map(|i| self.at(i as f64 / line.cells() as f64)).collect(),
        }
    }

    /// Joint values at the end.
    pub fn end(&self) -> Vec<f64> {
        match self {
            Self::Joint { to, .. } => to.clone(),
            Self::Line(line) => line.end().to_vec(),
        }
    }
}
