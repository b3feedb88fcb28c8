//! Configurations of an arm at path times to come.

/// Where an arm that holds the work-piece will be at path times to come, in order.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    joints: usize,
    times_s: Vec<f64>,
    /// Per time the joint values, then those after its hand has moved back.
    values: Vec<f64>,
}

impl Trace {
    /// Memory for so many configurations.
    pub fn new(joints: usize, most: usize) -> Self {
        Self { joints, times_s: Vec::with_capacity(most), values: Vec::with_capacity(2 * most * joints) }
    }

    pub fn clear(&mut self) {
        self.times_s.clear();
        self.values.clear();
    }

    /// Adds the configuration at a path time (s), and the one after its hand has moved back.
    pub fn push(&mut self, path_s: f64, q: &[f64], retreated: &[f64]) {
        self.times_s.push(path_s);
        self.values.extend_from_slice(q);
        self.values.extend_from_slice(retreated);
    }

    /// The last configurations before a path time (s); `None` before the first.
    pub fn at(&self, path_s: f64) -> Option<(&[f64], &[f64])> {
        let k = self.times_s.partition_point(|s| *s <= path_s).checked_sub(1)?;
        Some(self.values.get(2 * k * self.joints..2 * (k + 1) * self.joints)?.split_at(self.joints))
    }
}
