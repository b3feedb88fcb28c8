//! Progressive level of detail (Reichenbach and Kovačić 2003).
//!
//! Distant pairs are compared by one box each, approaching pairs deeper in the box trees of their meshes, near pairs
//! exactly.

use elbowroom_proximity::contact::Detail;

/// Policy of an [approaching-pairs query](crate::Checker::approaching): which pairs it reports, at which level of detail.
///
/// The choice depends on distance and speed. A pair stays coarse only if it is proven to be farther apart than `exact_m`
/// and not to meet within `exact_s`. Nearer or faster pairs are measured exactly.
///
/// ```
/// use elbowroom_scene::{Detail, LevelOfDetail};
/// let policy = LevelOfDetail { exact_m: 0.1, exact_s: 0.5, ..LevelOfDetail::default() };
/// assert_eq!(policy.depth(3.0, 0.4), Detail::Boxes(0)); // boxes 3 m apart, at 0.4 m/s
/// assert_eq!(policy.depth(0.4, 1.0), Detail::Boxes(1)); // 0.4 s by these boxes: smaller ones may be farther apart
/// assert_eq!(policy.depth(0.2, 1.0), Detail::Boxes(2));
/// assert_eq!(policy.depth(0.02, 1.0), Detail::Exact);
/// assert_eq!(policy.depth(f64::NAN, 0.0), Detail::Exact);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelOfDetail {
    /// Distance beyond the margin, metres. Nearer pairs are measured exactly.
    pub exact_m: f64,
    /// Time to contact, seconds. Pairs that may meet sooner are measured exactly.
    pub exact_s: f64,
    /// Distance beyond the margin, metres.
    ///
    /// Pairs proven to be farther apart are not reported, unless they may meet within `exact_s`.
    pub within_m: f64,
    /// Whether pairs may stay coarse. If false, every reported pair is measured exactly.
    pub progressive: bool,
}

impl Default for LevelOfDetail {
    /// Exact below 0.1 m or 0.3 s, reported up to 1 m.
    fn default() -> Self {
        Self { exact_m: 0.1, exact_s: 0.3, within_m: 1.0, progressive: true }
    }
}

/// Per depth of the box trees: the least gap of the outermost boxes at which that depth is tried.
///
/// A gap is a fraction of the distance below which a pair is measured exactly. Below the last fraction, smaller boxes
/// would hardly prove more.
const LEAST_GAP_SHARE: [f64; 3] = [1.0, 0.5, 0.1];

impl LevelOfDetail {
    /// Distance (m) below which a pair is measured exactly, for points that approach each other at most at `closing_m_s`.
    fn exact_below(&self, closing_m_s: f64) -> f64 {
        let ahead = if self.exact_s > 0.0 { self.exact_s * closing_m_s.max(0.0) } else { 0.0 };
        let needed = self.exact_m.max(ahead);
        if needed.is_nan() || closing_m_s.is_nan() || self.exact_m.is_nan() || self.exact_s.is_nan() {
            f64::INFINITY
        } else {
            needed
        }
    }

    /// The level of detail at which to start with a pair: the nearer and faster, the deeper.
    ///
    /// The outermost boxes of the pair are `lower_bound_m` apart; `closing_m_s` is the fastest approach of any of its
    /// points.
    pub fn depth(&self, lower_bound_m: f64, closing_m_s: f64) -> Detail {
        let needed = self.exact_below(closing_m_s);
        let far = |share: &f64| lower_bound_m > needed * share;
        match LEAST_GAP_SHARE.iter().position(far) {
            Some(depth) if self.progressive => Detail::Boxes(depth as u8),
            _ => Detail::Exact,
        }
    }
}
