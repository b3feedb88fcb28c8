//! Robots that overlap regions at their start.

use elbowroom_cell::{Cell, CellRegionId, Frames};
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::within;
use elbowroom_robot::RobotId;

use super::program::RobotProgram;

/// The pairs (region, robot) where a guarded volume overlaps the region at the start.
pub(super) fn initial_overlaps(cell: &Cell, programs: &[RobotProgram]) -> Vec<(CellRegionId, RobotId)> {
    let start_state = |(robot, p): (&elbowroom_cell::CellRobot, &RobotProgram)| {
        let mut state = ChainState::new(&robot.robot.chain);
        state.q.copy_from_slice(&p.profile.start);
        robot.robot.chain.forward_motion(&mut state);
        state
    };
    let states: Vec<ChainState> = cell.robots.iter().zip(programs).map(start_state).collect();
    let frames = Frames::new(cell);
    let mut pairs = Vec::new();
    for (index, r) in cell.regions.iter().enumerate() {
        let carrier = r.follow.map(|follow| frames.source(&follow, &states, 0.0).pose);
        let anchor = carrier.map_or(r.region.anchor, |c| c * r.region.anchor);
        let region_in_world = anchor * r.region.shape_in_anchor;
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
