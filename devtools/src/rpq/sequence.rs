//! Equidistributed points: the additive recurrence of Roberts ("R-sequence", 2018).

/// Points of the unit cube of `dimensions`, evenly spread for any number of points.
///
/// Coordinate i of point n is the fraction of 1/2 + n / φⁱ⁺¹, where φ is the root of x^(dimensions + 1) = x + 1.
pub struct Sequence {
    steps: Vec<f64>,
}

impl Sequence {
    pub fn new(dimensions: usize) -> Self {
        let mut phi = 1.5_f64;
        // The iteration x ← (1 + x)^(1 / (d + 1)) contracts.
        for _ in 0..200 {
            phi = (1.0 + phi).powf(1.0 / (dimensions + 1) as f64);
        }
        let powers = std::iter::successors(Some(1.0 / phi), |step| Some(step / phi));
        Self { steps: powers.take(dimensions).collect() }
    }

    /// Returns point `n`, each coordinate in [0, 1).
    pub fn point(&self, n: usize) -> impl Iterator<Item = f64> + '_ {
        self.steps.iter().map(move |step| (0.5 + step * (n + 1) as f64).fract())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_one_dimension_it_is_the_golden_section() {
        let x: Vec<f64> = Sequence::new(1).point(0).collect();
        assert!((x[0] - (0.5 + 0.618_033_988_749_895_f64).fract()).abs() < 1e-12);
    }

    #[test]
    fn every_coordinate_is_spread_evenly() {
        let sequence = Sequence::new(12);
        let mut bins = [[0_usize; 10]; 12];
        for n in 0..5000 {
            for (bin, x) in bins.iter_mut().zip(sequence.point(n)) {
                bin[(x * 10.0) as usize] += 1;
            }
        }
        for bin in bins.as_flattened() {
            assert!((480..=520).contains(bin), "{bins:?}");
        }
    }
}
