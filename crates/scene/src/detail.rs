//! Which pairs are looked at how closely: far ones by one box, approaching ones deeper, near ones exactly (S4).

use elbowroom_proximity::contact::Detail;
use elbowroom_spatial::Vec3;

use crate::Member;

/// Which pairs are told, and how closely each is looked at: a choice by distance and speed.
///
/// A pair may stay coarse only where it is proven to be farther than `exact_m`, and not to meet within `exact_s`. So what
/// is told coarsely cannot matter; nearer or faster pairs are measured exactly.
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
    /// Pairs nearer than this beyond their margin are measured exactly, metres.
    pub exact_m: f64,
    /// Pairs that may meet sooner than this are measured exactly, seconds.
    pub exact_s: f64,
    /// Pairs that are certainly farther than this beyond their margin are not told, metres, unless they may meet within
    /// `exact_s`.
    pub within_m: f64,
    /// False: every pair that is told is measured exactly.
    pub progressive: bool,
}

impl Default for LevelOfDetail {
    /// Exact below 0.1 m and 0.3 s, told up to 1 m.
    fn default() -> Self {
        Self { exact_m: 0.1, exact_s: 0.3, within_m: 1.0, progressive: true }
    }
}

/// Share of the distance where exactness begins that the boxes around all of the meshes must have between them for a level
/// to be worth a look; below the last, smaller boxes would hardly prove more.
const WORTH: [f64; 3] = [1.0, 0.5, 0.1];

impl LevelOfDetail {
    /// Metres below which a pair is measured exactly whose points come nearer by no more than `closing_m_s`.
    pub fn exact_below(&self, closing_m_s: f64) -> f64 {
        let ahead = if self.exact_s > 0.0 { self.exact_s * closing_m_s.max(0.0) } else { 0.0 };
        let needed = self.exact_m.max(ahead);
        if needed.is_nan() || closing_m_s.is_nan() || self.exact_m.is_nan() || self.exact_s.is_nan() {
            f64::INFINITY
        } else {
            needed
        }
    }

    /// Where to begin with a pair whose boxes have so much between them, metres, by the fastest approach of any of its
    /// points: the nearer and the faster, the deeper.
    pub fn depth(&self, lower_bound_m: f64, closing_m_s: f64) -> Detail {
        let needed = self.exact_below(closing_m_s);
        let far = |share: &f64| lower_bound_m > needed * share;
        match WORTH.iter().position(far) {
            Some(depth) if self.progressive => Detail::Boxes(depth as u8),
            _ => Detail::Exact,
        }
    }
}

/// A pair, how far apart it is, and when it may meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// The first of the pair, in the order of the pair matrix.
    pub a: Member,
    /// The other.
    pub b: Member,
    /// Proven: metres between the solids, less the pair's margin, are not less; 0 on contact.
    pub lower_bound: f64,
    /// The distance less the margin where [`Approach::detail`] is exact; else the lower bound again. Never too large.
    pub metres: f64,
    /// Nearest point on the solid of `a`, in the world; where not exact, a point of the boxes that are nearest, or near them.
    pub on_a: Vec3,
    /// The same of `b`.
    pub on_b: Vec3,
    /// How fast the two points come nearer, m/s; negative where they part.
    pub closing_m_s: f64,
    /// Metres over that speed, seconds: right if these points meet and go on as they do. Infinite where they part.
    pub estimate_s: f64,
    /// Proven: no contact (margin included) sooner, seconds, so long as the velocities of both frames' origins and their
    /// angular velocities stay what they are. Joints at constant rates bend a link's way: [`sweep`](crate::Checker::sweep)
    /// proves that. At most the horizon asked for.
    pub earliest_s: f64,
    /// How closely the pair was looked at.
    pub detail: Detail,
}
