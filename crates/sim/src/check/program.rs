//! What each robot's program does to what its monitor guards.

use elbowroom_cell::Cell;
use elbowroom_formats::FormatError;
use elbowroom_monitor::{Guards, Volume};

use super::outline::SphereSweptHull;
use super::profile::{LinkSolid, Profile, StoppingProfile};

/// A robot's program and the guarded volumes that it moves.
pub(super) struct RobotProgram {
    pub volumes: Vec<Volume>,
    pub profile: Profile,
}

impl RobotProgram {
    /// The paces of the volumes that count for these guards.
    pub fn stopping_profiles(&self, guards: Guards) -> impl Iterator<Item = &StoppingProfile> {
        self.volumes
            .iter()
            .zip(&self.profile.stopping_profiles)
            .filter(move |(v, _)| v.part.counts_for(guards))
            .map(|(_, p)| p)
    }
}

pub(super) fn programs(cell: &Cell) -> Result<Vec<RobotProgram>, FormatError> {
    let of = |index: usize| {
        let volumes = cell.robots[index].guarded_volumes();
        let solids: Vec<_> = volumes
            .iter()
            .map(|v| LinkSolid { link: v.link, hull: SphereSweptHull::new(&v.shape, &v.in_link) })
            .collect();
        Ok(RobotProgram { profile: Profile::of(cell, index, &solids)?, volumes })
    };
    (0..cell.robots.len()).map(of).collect()
}
