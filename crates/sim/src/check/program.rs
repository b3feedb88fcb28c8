//! The guarded volumes of each robot, and their speeds in its program.

use elbowroom_cell::Cell;
use elbowroom_formats::FormatError;
use elbowroom_monitor::{Guards, Volume};
use elbowroom_robot::RobotId;

use super::sphere_swept_hull::SphereSweptHull;
use super::stopping_profile::{LinkSolid, Profile, StoppingProfile};

/// The guarded volumes of a robot, and the motion profile of its program.
pub(super) struct RobotProgram {
    pub volumes: Vec<Volume>,
    pub profile: Profile,
}

impl RobotProgram {
    /// The stopping profiles of the volumes that count for these guards.
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
        Ok(RobotProgram { profile: Profile::of(cell, RobotId(index), &solids)?, volumes })
    };
    (0..cell.robots.len()).map(of).collect()
}
