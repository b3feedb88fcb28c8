//! Objects that programs grip inside regions.

use elbowroom_cell::{Cell, CellRegion, CellRobot};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{RegionKind, Volume};
use elbowroom_proximity::{Shape, within};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use super::program::{PlannedGrip, RobotProgram};
use crate::hand::{Hand, MAX_GRIP_DISTANCE_M};

/// An object that is, or may be, inside a region when it is gripped: from then on it counts as a part of the robot.
pub(super) struct GripOverlap<'a> {
    /// Its name.
    pub object: &'a str,
    /// False where its place is known in the run only.
    pub is_certain: bool,
}

impl<'a> GripOverlap<'a> {
    /// The first one of a program in a fixed region.
    pub fn find(cell: &'a Cell, robot: RobotId, program: &RobotProgram, region: &CellRegion) -> Option<Self> {
        program.grips.iter().find_map(|grip| Self::of(cell, robot, program, grip, region))
    }

    fn of(
        cell: &'a Cell,
        robot: RobotId,
        program: &RobotProgram,
        grip: &PlannedGrip,
        region: &CellRegion,
    ) -> Option<Self> {
        let (at, object) = (&cell.robots[robot.0], &cell.objects[grip.action.object.0]);
        let mut state = ChainState::new(&at.robot.chain);
        state.q.copy_from_slice(&grip.q);
        at.robot.chain.forward(&mut state);
        let shape = &region.region.shape;
        let region_in_world = region.region.anchor * region.region.shape_in_anchor;
        let guards = region.region.guards;
        let is_inside = |v: &Volume| {
            v.part.counts_for(guards) && within(&v.shape, &in_world(at, &state, v), shape, &region_in_world, 0.0)
        };
        // A robot inside an exchange region holds it, or has entered by itself.
        let exchange = matches!(region.region.kind, RegionKind::Exchange { .. });
        if exchange && program.volumes.iter().any(is_inside) {
            return None;
        }
        let found = |is_certain: bool| Self { object: &object.name, is_certain };
        if let Some(attachment) = &grip.action.attachment {
            let held = cell.volumes_holding(robot, &[(grip.action.object, attachment.clone())]);
            return held.last().is_some_and(is_inside).then(|| found(true));
        }
        let volume = cell.gripped_volume(robot, grip.action.object, grip.action.link);
        if !volume.part.counts_for(guards) {
            return None;
        }
        let reach_m = MAX_GRIP_DISTANCE_M + diameter_m(&volume.shape);
        (Hand::of(at).distance_m(&state, shape, &region_in_world) <= reach_m).then(|| found(false))
    }
}

fn in_world(robot: &CellRobot, state: &ChainState, volume: &Volume) -> Pose {
    robot.base_in_world * state.link_in_root(volume.link) * volume.in_link
}

fn diameter_m(shape: &Shape) -> f64 {
    shape.aabb(&Pose::IDENTITY).extent().length()
}
