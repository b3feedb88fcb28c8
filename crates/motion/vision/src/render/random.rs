//! Pseudo-random numbers for synthetic images.

/// Xorshift64* (Marsaglia, Vigna): generates the same numbers on every machine.
#[derive(Debug, Clone)]
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        random.next();
        random
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// An approximately normal number, mean 0, standard deviation 1: the sum of four uniform bytes.
    pub(super) fn normal(&mut self) -> f64 {
        let [a, b, c, d, ..] = self.next().to_be_bytes();
        let sum = u32::from(a) + u32::from(b) + u32::from(c) + u32::from(d);
        (f64::from(sum) - 510.0) / 147.8
    }
}
