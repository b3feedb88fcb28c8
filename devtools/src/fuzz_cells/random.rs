//! Random numbers from a seed, the same on every machine (`SplitMix64`).

use elbowroom_testkit::random::SplitMix;

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random {
    stream: SplitMix,
    /// Choice of rare features; `None` for a stream without them.
    rare: Option<Rare>,
}

/// Rare features of cells have a stream of their own: the rest of a cell is the same with and without them.
#[derive(Debug, Clone)]
struct Rare {
    stream: SplitMix,
    /// Number of the case, if it is one of the first: these have the features in turn, so that few cells have them all.
    turn: Option<u64>,
}

impl Random {
    /// Returns the stream of one case of a run, without rare features.
    pub fn of_case(seed: u64, case: u64) -> Self {
        let mut stream = SplitMix(seed ^ case.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        stream.bits();
        Self { stream, rare: None }
    }

    /// Adds rare features, at random or in turn.
    #[must_use]
    pub fn with_rare_features(self, turn: Option<u64>) -> Self {
        let mut stream = SplitMix(self.stream.0 ^ 0x5851_F42D_4C95_7F2D);
        stream.bits();
        Self { rare: Some(Rare { stream, turn }), ..self }
    }

    /// Whether a cell has a rare feature: in the first cases each `of`th has the feature of this slot, later ones have it
    /// in this percentage of cases. Returns the random numbers of the feature.
    pub fn rare(&mut self, slot: u64, of: u64, percent: u32) -> Option<Self> {
        let Rare { stream, turn } = self.rare.as_mut()?;
        let drawn = stream.unit() * 100.0 < f64::from(percent);
        let is_chosen = turn.map_or(drawn, |turn| turn % of == slot);
        let own = SplitMix(stream.bits());
        is_chosen.then_some(Self { stream: own, rare: None })
    }

    /// Returns a whole number below `count`: in turn in the first cases, later any.
    pub fn in_turn(&mut self, count: usize) -> usize {
        let drawn = self.whole(0, count - 1);
        self.turn().map_or(drawn, |turn| turn as usize % count)
    }

    /// Returns true in the first cases, later in this percentage of cases.
    pub fn first_or_percent(&mut self, share: u32) -> bool {
        self.percent(share) || self.is_first()
    }

    /// Whether this is one of the first cases, which have the rare features in turn.
    pub fn is_first(&self) -> bool {
        self.turn().is_some()
    }

    fn turn(&self) -> Option<u64> {
        self.rare.as_ref()?.turn
    }

    /// Returns a number in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.stream.unit()
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
        low + self.stream.below(high - low + 1)
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
