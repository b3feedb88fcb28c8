//! Continuous witness points: for parallel or nearly parallel faces or edges, the witness points are not unique, and
//! rounding would decide.
//!
//! Pairs of points are tied if their distance exceeds the smallest distance by at most [`TIE_TOLERANCE`] of the
//! sizes. The tied pair nearest to an anchor point is returned. The anchor is between the centres of the two shapes,
//! near the centre of the smaller one, and moves with them. So for parallel faces the result is the centre of the
//! patch in which they overlap, or the point of the patch nearest to it, and it changes continuously with the poses.

mod choice;
mod patch_query;
mod polygon;
mod support_feature;
mod tolerances;

pub(crate) use choice::WitnessChoice;
pub(crate) use patch_query::{PatchQuery, alternating_projections, anchor_between, widest_gap};
pub(crate) use polygon::Polygon;
pub(crate) use support_feature::SupportFeature;
pub(crate) use tolerances::{MIN_PATCH_SIZE, PatchTolerances, TIE_TOLERANCE};
