//! Generators of pseudo-random numbers, the same on every machine.
//!
//! Each function advances a state of 64 bits, which starts as the seed, and returns 64 bits. The sequences never
//! change: tests with fixed results (golden hashes, thresholds that a seed was found to meet) depend on them.
//!
//! ```
//! use elbowroom_testkit::random::SplitMix;
//! let mut random = SplitMix(7);
//! let values: Vec<f64> = (0..100).map(|_| random.unit()).collect();
//! assert!(values.iter().all(|x| (0.0..1.0).contains(x)));
//! ```

/// `SplitMix64` (Steele, Lea, Flood: *Fast splittable pseudorandom number generators*, 2014). Any seed is valid.
pub fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Xorshift with the shifts 13, 7, 17 (Marsaglia: *Xorshift RNGs*, 2003). The seed must not be 0, which gives only
/// zeros.
pub fn xorshift(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}

/// The linear congruential generator of Knuth's MMIX. Any seed is valid; the low bits have short periods.
pub fn linear_congruential(state: &mut u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    *state
}

/// A number in `[0, 1)` from the upper 53 bits.
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Xorshift64* with the shifts 12, 25, 27 (Vigna: *An experimental exploration of Marsaglia's xorshift generators,
/// scrambled*, 2016). The seed must not be 0, which gives only zeros.
fn xorshift_star(state: &mut u64) -> u64 {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    state.wrapping_mul(0x2545_f491_4f6c_dd1d)
}

/// A generator with its state, and the draws that tests need. `$shift` drops low bits with short periods.
macro_rules! generator {
    ($(#[$documentation:meta])* $name:ident, $step:path, $shift:literal) => {
        $(#[$documentation])*
        #[derive(Debug, Clone)]
        pub struct $name(pub u64);

        impl $name {
            /// The next 64 bits.
            pub fn bits(&mut self) -> u64 {
                $step(&mut self.0)
            }

            /// A number in `[0, 1)`.
            pub fn unit(&mut self) -> f64 {
                unit(self.bits())
            }

            /// A number in `[low, high)`.
            pub fn between(&mut self, low: f64, high: f64) -> f64 {
                low + (high - low) * self.unit()
            }

            /// Numbers in `[-largest, largest)`, such as the coordinates of a vector.
            pub fn within<const N: usize>(&mut self, largest: f64) -> [f64; N] {
                std::array::from_fn(|_| self.between(-largest, largest))
            }

            /// A whole number below `count`, the remainder of the bits; 0 for a count of 0.
            pub fn below(&mut self, count: usize) -> usize {
                ((self.bits() >> $shift) % count.max(1) as u64) as usize
            }

            /// A whole number below `count`, which is at least 1: [`Self::unit`] times the count.
            pub fn index(&mut self, count: usize) -> usize {
                ((self.unit() * count as f64) as usize).min(count - 1)
            }
        }
    };
}

generator! {
    /// Numbers of [`linear_congruential`] from a seed.
    ///
    /// ```
    /// let mut random = elbowroom_testkit::random::Random(1);
    /// assert!((2.0..3.0).contains(&random.between(2.0, 3.0)) && random.below(4) < 4);
    /// ```
    Random, linear_congruential, 11
}

generator! {
    /// Numbers of [`split_mix`] from a seed.
    SplitMix, split_mix, 0
}

generator! {
    /// Numbers of [`xorshift`] from a seed.
    Xorshift, xorshift, 0
}

generator! {
    /// Numbers of Xorshift64* (Vigna 2016) from a seed.
    XorshiftStar, xorshift_star, 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first three numbers from a seed.
    fn first(generator: fn(&mut u64) -> u64, mut seed: u64) -> [u64; 3] {
        std::array::from_fn(|_| generator(&mut seed))
    }

    /// Golden hashes of other crates depend on these sequences.
    #[test]
    fn the_sequences_are_the_published_ones() {
        let split = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!(first(split_mix, 1_234_567), split);
        assert_eq!(first(xorshift, 1), [1_082_269_761, 1_152_992_998_833_853_505, 11_177_516_664_432_764_457]);
        assert_eq!(
            first(linear_congruential, 0),
            [1_442_695_040_888_963_407, 1_876_011_003_808_476_466, 11_166_244_414_315_200_793]
        );
        assert_eq!(
            first(xorshift_star, 1),
            [5_180_492_295_206_395_165, 12_380_297_144_915_551_517, 13_389_498_078_930_870_103]
        );
    }

    #[test]
    fn numbers_are_below_one() {
        assert_eq!(unit(0), 0.0);
        assert_eq!(unit(u64::MAX), 1.0 - f64::EPSILON / 2.0);
    }

    /// Golden hashes of other crates depend on these draws, too.
    #[test]
    fn draws_are_made_of_the_next_bits() {
        let (mut random, mut bits) = (Random(3), Random(3));
        assert_eq!(random.unit(), unit(bits.bits()));
        assert_eq!(random.between(-2.0, 4.0), -2.0 + 6.0 * bits.unit());
        assert_eq!(random.within::<2>(0.5), [bits.unit() - 0.5, bits.unit() - 0.5]);
        assert_eq!(random.below(10), ((bits.bits() >> 11) % 10) as usize);
        assert_eq!(random.index(10), (10.0 * bits.unit()) as usize);
        assert_eq!(SplitMix(3).below(10), (SplitMix(3).bits() % 10) as usize);
        assert_eq!((random.below(0), random.below(1), random.index(1)), (0, 0, 0));
    }
}
