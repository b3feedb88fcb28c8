//! How fast a moving region goes.

use elbowroom_formats::FormatError;

use super::outline::Outline;
use super::profile::{Profile, Rider};
use crate::{Cell, CellRegion, Drive, Follow};

/// Largest speed (m/s) of any point of the region by what it follows; 0 for one that stands.
pub(super) fn fastest(cell: &Cell, region: &CellRegion) -> Result<f64, FormatError> {
    let Some(follow) = region.follow else { return Ok(0.0) };
    let in_source = region.region.anchor * region.region.shape_in_anchor;
    match follow {
        Follow::Encoder(e) => Ok(cell.encoders[e].fastest(0.0, cell.max_s)),
        Follow::Object(o) => {
            let drive = cell.movers.iter().find(|m| m.object == o).map(|m| &m.drive);
            let rotated = Outline::new(&region.region.shape, &in_source);
            Ok(match drive {
                None => 0.0,
                Some(Drive::Belt(encoder)) => encoder.fastest(0.0, cell.max_s),
                Some(Drive::Way(way)) => way.fastest(rotated.farthest_m()),
            })
        }
        Follow::Poses(p) => {
            let outline = Outline::new(&region.region.shape, &in_source);
            let rates = cell.pose_tracks[p].rates();
            // A half-space that does not turn is nowhere faster than its origin.
            let of = |(_, speed, turn): (f64, f64, f64)| {
                if turn > 0.0 { speed + turn * outline.farthest_m() } else { speed }
            };
            Ok(rates.map(of).fold(0.0, f64::max))
        }
        Follow::Robot { robot, link, in_link } => {
            let outline = Outline::new(&region.region.shape, &(in_link * in_source));
            let profile = Profile::of(cell, robot, &[Rider { link, outline }])?;
            Ok(profile.paces[0].fastest_m_s)
        }
    }
}
