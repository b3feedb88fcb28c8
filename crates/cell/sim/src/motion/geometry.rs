//! Geometric path of a move, without time.

use elbowroom_kinematics::TrajectoryPoint;

use super::TcpLine;

/// The path of a move, over `s` from 0 to 1.
#[derive(Debug)]
pub enum MovePath {
    /// Straight in joint space.
    Joint {
        /// Joint values at s = 0.
        from: Vec<f64>,
        /// Joint values at s = 1.
        to: Vec<f64>,
    },
    /// TCP on a straight line.
    TcpLine(Box<TcpLine>),
}

impl MovePath {
    /// The joint values at `s`.
    pub fn at(&self, s: f64) -> TrajectoryPoint {
        match self {
            Self::Joint { from, to } => {
                let lerp = |(a, b): (&f64, &f64)| if s >= 1.0 { *b } else { a + (b - a) * s };
                let dq: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
                TrajectoryPoint { q: from.iter().zip(to).map(lerp).collect(), ddq: vec![0.0; dq.len()], dq }
            }
            Self::TcpLine(line) => line.at(s),
        }
    }

    /// Samples of the joint motion along the path: one for a joint move, whose derivatives are constant.
    pub fn samples(&self) -> Vec<TrajectoryPoint> {
        match self {
            Self::Joint { .. } => vec![self.at(0.0)],
            Self::TcpLine(line) => (0..=line.cells()).map(|i| self.at(i as f64 / line.cells() as f64)).collect(),
        }
    }

    /// Joint values at the end.
    pub fn end(&self) -> Vec<f64> {
        match self {
            Self::Joint { to, .. } => to.clone(),
            Self::TcpLine(line) => line.end().to_vec(),
        }
    }
}
