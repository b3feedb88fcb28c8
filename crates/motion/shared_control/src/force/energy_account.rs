//! What was put in, what is stored, and what is left of it.

/// The energy of a virtual body: it never stores more than was put in.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct EnergyAccount {
    put_in_j: f64,
    stored_j: f64,
}

impl EnergyAccount {
    /// Energy comes from outside: from the hand, or from surroundings that move. Negative: it goes there.
    pub fn put_in(&mut self, energy_j: f64) {
        self.put_in_j += energy_j;
        self.stored_j += energy_j;
    }

    /// Energy that may be stored now.
    pub fn stored_j(&self) -> f64 {
        self.stored_j
    }

    /// What is stored after a motion, at most what was; the rest has become heat.
    pub fn keep(&mut self, stored_j: f64) {
        self.stored_j = stored_j.min(self.stored_j);
    }

    /// What has become heat, J: put in and not stored.
    pub fn dissipated_j(&self) -> f64 {
        self.put_in_j - self.stored_j
    }
}
