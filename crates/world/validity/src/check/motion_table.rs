//! Table of lever arms: how far each joint moves each link, and the two links of each pair against each other.

use crate::lanes::{LANES, Row};
use crate::model::{BatchedChain, CoveredRobot};

/// Lever arms of all links and pairs, sixteen columns at a time.
#[derive(Debug, Clone)]
pub(crate) struct MotionTable {
    /// Number of columns, a multiple of the lanes.
    pub columns: usize,
    /// Column of the first pair; the columns before it are links.
    first_pair: usize,
    /// Lever arms, per step and sixteen columns.
    pub lever_m: Vec<Row>,
    /// Per step: the longest lever arm of any body.
    longest_m: Vec<f64>,
    /// In the column of a pair: the sum of the radii of the two bounding spheres and the margin, m.
    root_radii_m: Vec<Row>,
}

impl MotionTable {
    pub fn new(robot: &CoveredRobot) -> Self {
        let first_pair = robot.covered_links.len();
        let columns = (first_pair + robot.pairs.len()).next_multiple_of(LANES);
        let rows = columns / LANES;
        let mut lever_m = vec![Row::ZERO; robot.chain.steps.len() * rows];
        let mut set = |step: usize, column: usize, lever: f32| {
            lever_m[step * rows + column / LANES].0[column % LANES] = lever;
        };
        let mut longest_m = vec![0.0_f64; robot.chain.steps.len()];
        for (column, body) in robot.covered_links.iter().enumerate() {
            for (step, &lever) in body.lever_m.iter().enumerate() {
                set(step, column, lever);
                longest_m[step] = longest_m[step].max(f64::from(lever));
            }
        }
        for (p, pair) in robot.pairs.iter().enumerate() {
            pair.joints.iter().for_each(|joint| set(joint.step, first_pair + p, joint.lever_m));
        }
        let mut root_radii_m = vec![Row::ZERO; rows];
        for (p, pair) in robot.pairs.iter().enumerate() {
            let column = first_pair + p;
            let radius = robot.bounding_radius_m(pair.a) + robot.bounding_radius_m(pair.b) + pair.margin_m;
            root_radii_m[column / LANES].0[column % LANES] = radius;
        }
        Self { columns, first_pair, lever_m, longest_m, root_radii_m }
    }

    pub fn root_radii_m(&self) -> &[Row] {
        &self.root_radii_m
    }

    /// Column of a pair of links. The column of a body is its index.
    pub fn pair(&self, index: usize) -> usize {
        self.first_pair + index
    }

    /// Upper bound on the motion of any point of the robot between two configurations, m.
    pub fn displacement_m(&self, chain: &BatchedChain, from: &[f64], to: &[f64]) -> f64 {
        let mut length = 0.0;
        for (step, lever) in chain.steps.iter().zip(&self.longest_m) {
            let change = (step.multiplier * (to[step.index] - from[step.index])).abs();
            if change != 0.0 {
                length += change * lever;
            }
        }
        length
    }
}
