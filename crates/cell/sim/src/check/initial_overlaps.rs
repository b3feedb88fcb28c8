//! Robots that overlap regions at their start.

use elbowroom_cell::{Cell, CellRegion, CellRegionId, Frames};
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::within;
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use super::program::RobotProgram;

/// States of the robots before any motion.
pub(super) fn start_states(cell: &Cell, programs: &[RobotProgram]) -> Vec<ChainState> {
    let start_state = |(robot, p): (&elbowroom_cell::CellRobot, &RobotProgram)| {
        let mut state = ChainState::new(&robot.robot.chain);
        state.q.copy_from_slice(&p.profile.start);
        robot.robot.chain.forward_motion(&mut state);
        state
    };
    cell.robots.iter().zip(programs).map(start_state).collect()
}

/// Pose of a region in the world before any motion.
pub(super) fn region_at_start(cell: &Cell, region: &CellRegion, states: &[ChainState]) -> Pose {
    let carrier = region.follow.map(|follow| Frames::new(cell).source(&follow, states, 0.0).pose);
    let anchor = carrier.map_or(region.region.anchor, |c| c * region.region.anchor);
    anchor * region.region.shape_in_anchor
}

/// Pairs (region, robot) in which a guarded volume overlaps the region at the start.
pub(super) fn initial_overlaps(
    cell: &Cell,
    programs: &[RobotProgram],
    states: &[ChainState],
) -> Vec<(CellRegionId, RobotId)> {
    let mut pairs = Vec::new();
    for (index, r) in cell.regions.iter().enumerate() {
        let region_in_world = region_at_start(cell, r, states);
        for robot in &r.robots {
            let (state, base) = (&states[robot.0], cell.robots[robot.0].base_in_world);
            let overlaps = |v: &&elbowroom_monitor::Volume| {
                let in_world = base * state.link_in_root(v.link) * v.in_link;
                within(&v.shape, &in_world, &r.region.shape, &region_in_world, 0.0)
            };
            let guarded = |v: &&elbowroom_monitor::Volume| {
                v.presence != elbowroom_monitor::Presence::Detached && v.part.counts_for(r.region.guards)
            };
            if programs[robot.0].volumes.iter().filter(guarded).any(|v| overlaps(&v)) {
                pairs.push((CellRegionId(index), *robot));
            }
        }
    }
    pairs
}
