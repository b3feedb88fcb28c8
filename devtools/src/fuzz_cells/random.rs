//! Random numbers from a seed, the same on every machine (`SplitMix64`).

use elbowroom_testkit::random::SplitMix;

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random(SplitMix);

impl Random {
    /// Returns the stream of one case of a run.
    pub fn of_case(seed: u64, case: u64) -> Self {
        let mut stream = SplitMix(seed ^ case.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        stream.bits();
        Self(stream)
    }

    /// Returns a number in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    /// Returns a number in `low..high`, with four digits after the decimal point, so that cells are readable.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        rounded(low + (high - low) * self.unit())
    }

    /// Returns a number in `low..high`, with every factor equally likely; both positive.
    pub fn scaled(&mut self, low: f64, high: f64) -> f64 {
        rounded(low * (high / low).powf(self.unit()))
    }

    /// Returns a whole number in `low..=high`.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + self.0.below(high - low + 1)
    }

    /// Returns true in this percentage of cases.
    pub fn percent(&mut self, share: u32) -> bool {
        self.unit() * 100.0 < f64::from(share)
    }

    /// Returns one of the values.
    pub fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.whole(0, of.len() - 1)]
    }

    /// Returns a vector with each coordinate within `most` of 0.
    pub fn vector(&mut self, most: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-most, most))
    }
}

/// Rounds to four digits after the decimal point.
pub fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
