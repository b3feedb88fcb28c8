//! Continuous witness points: where faces or edges are parallel, or nearly so, the witness points are not unique, and rounding
//! would choose among them.
//!
//! Among the pairs of points that are tied, no farther apart than the least distance and [`TIE_TOLERANCE`] of the sizes, the
//! one nearest to an anchor point is returned. The anchor is between the centres of the two shapes, near that of the
//! smaller, and moves with them. So for parallel faces the result is the centre of the patch in which they overlap, or the
//! point of the patch nearest to it, and it changes continuously with the poses.

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
