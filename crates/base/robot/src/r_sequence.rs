//! A low-discrepancy sequence of joint configurations.

use elbowroom_kinematics::{Chain, ChainState};

/// Roberts' R-sequence: evenly spread points of the unit cube in any dimension, identical on every machine.
///
/// The points are multiples of powers of the generalized golden ratio (Roberts, "The unreasonable effectiveness of
/// quasirandom sequences", 2018).
#[derive(Debug, Clone)]
pub struct RSequence {
    steps: Vec<f64>,
}

impl RSequence {
    /// Creates the sequence in the unit cube of `dimensions` dimensions.
    pub fn new(dimensions: usize) -> Self {
        // The positive root of x^(d+1) = x + 1 by Newton's method, in plain arithmetic: equal on every machine.
        let mut phi = 2.0_f64;
        for _ in 0..64 {
            let power = (0..dimensions).fold(1.0, |p, _| p * phi);
            phi -= (power * phi - phi - 1.0) / ((dimensions as f64 + 1.0) * power - 1.0).max(f64::MIN_POSITIVE);
        }
        let mut step = 1.0;
        let mut next = || {
            step /= phi;
            step
        };
        Self { steps: (0..dimensions).map(|_| next()).collect() }
    }

    /// Sets a chain to point `n`, scaled to the joint limits (±π for a rotation without limits, ±1 m for a slide without
    /// limits), and computes forward kinematics. `axis` is the point's coordinate for the first joint of the chain.
    pub fn set_state(&self, chain: &Chain, state: &mut ChainState, n: u64, axis: usize) {
        for i in 0..chain.dof() {
            let (lower, upper) = range(chain, i);
            state.q[i] = lower + (upper - lower) * self.at(n, axis + i);
        }
        chain.forward(state);
    }

    /// Coordinate `axis` of point `n`, 0 ≤ x < 1.
    fn at(&self, n: u64, axis: usize) -> f64 {
        (0.5 + n as f64 * self.steps[axis]).fract()
    }
}

/// The range from which samples of a joint are taken, rad or m.
fn range(chain: &Chain, index: usize) -> (f64, f64) {
    let joint = &chain.joints()[chain.active_joints()[index].0];
    let most = if joint.kind.turns() { std::f64::consts::PI } else { 1.0 };
    let end = |v: f64, sign: f64| if v.is_finite() { v } else { sign * most };
    (end(joint.limits.lower, -1.0), end(joint.limits.upper, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_the_square_evenly() {
        let golden = RSequence::new(1).steps[0];
        assert!((golden - 0.618_033_988_749_895).abs() < 1e-14, "{golden}");
        let s = RSequence::new(2);
        let mut cells = [[0; 10]; 10];
        for n in 0..10_000 {
            cells[(s.at(n, 0) * 10.0) as usize][(s.at(n, 1) * 10.0) as usize] += 1;
        }
        assert!(cells.iter().flatten().all(|c| (90..=110).contains(c)), "{cells:?}");
    }
}
