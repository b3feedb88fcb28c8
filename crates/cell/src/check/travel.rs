//! How fast a moving region goes.

use elbowroom_formats::FormatError;

use super::outline::Outline;
use super::profile::{Profile, Rider};
use crate::{Cell, CellRegion, Follow};

/// Largest speed (m/s) of any point of the region by what it follows; 0 for one that stands.
pub(super) fn fastest(cell: &Cell, region: &CellRegion) -> Result<f64, FormatError> {
    let Some(follow) = region.follow else { return Ok(0.0) };
    let in_source = region.region.anchor * region.region.shape_in_anchor;
    match follow {
        Follow::Encoder(e) => Ok(cell.encoders[e].fastest(0.0, cell.max_s)),
        Follow::Robot { robot, link, in_link } => {
            let outline = Outline::new(&region.region.shape, &(in_link * in_source));
            let profile = Profile::of(cell, robot, &[Rider { link, outline }])?;
            Ok(profile.paces[0].fastest_m_s)
        }
    }
}
