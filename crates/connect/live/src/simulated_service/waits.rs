//! Who waits before an exchange region, and since when.

/// Since when each carriage waits without a reason.
pub(super) struct Waits {
    pub(super) since_us: Vec<Option<u64>>,
    /// True time of the last change of regions.
    pub(super) changed_us: u64,
}

impl Waits {
    pub(super) fn new(rails: usize) -> Self {
        Self { since_us: vec![None; rails], changed_us: 0 }
    }
}
