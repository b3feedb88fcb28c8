//! Parts that programs grip, and tools that they exchange, inside regions.

use elbowroom_cell::{Cell, CellRegion, CellRobot};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Presence, RegionKind, Volume};
use elbowroom_proximity::{Shape, within};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use super::program::{Mount, PlannedMount, RobotProgram};
use crate::hand::{Hand, MAX_GRIP_DISTANCE_M};
use crate::motion::GripAction;

/// A region at its pose before any motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedRegion<'a> {
    pub region: &'a CellRegion,
    pub in_world: Pose,
}

/// A part or tool that is, or may be, inside a region when it is mounted. From then on it counts as a part of the
/// robot.
pub(super) struct MountedOverlap<'a> {
    /// The step, such as `grips "crate"`.
    pub step: String,
    /// Name of the part or tool.
    pub name: &'a str,
    /// False if its place is known only during the run.
    pub is_certain: bool,
}

impl<'a> MountedOverlap<'a> {
    /// Finds the first overlap of a program with a region that does not move.
    pub fn find(cell: &'a Cell, robot: RobotId, program: &'a RobotProgram, region: PlacedRegion<'_>) -> Option<Self> {
        program.mounts.iter().find_map(|mount| {
            let mut state = ChainState::new(&mount.robot.robot.chain);
            state.q.copy_from_slice(&mount.q);
            mount.robot.robot.chain.forward(&mut state);
            RobotAtMount { cell, id: robot, mount, state, region }.overlap()
        })
    }
}

/// A robot at the moment when its program mounts something.
struct RobotAtMount<'a, 'r> {
    cell: &'a Cell,
    id: RobotId,
    mount: &'a PlannedMount,
    state: ChainState,
    region: PlacedRegion<'r>,
}

impl<'a> RobotAtMount<'a, '_> {
    fn overlap(&self) -> Option<MountedOverlap<'a>> {
        let at = &self.mount.robot;
        // A robot inside an exchange region holds it, or has entered by itself.
        let exchange = matches!(self.region.region.region.kind, RegionKind::Exchange { .. });
        if exchange && at.guarded_volumes().iter().any(|v| v.presence != Presence::Detached && self.is_inside(v)) {
            return None;
        }
        match &self.mount.what {
            Mount::Part(action) => self.part(action),
            Mount::Tool(tool) => {
                let after = at.with_tool(*tool);
                let is_new = |v: &Volume| {
                    let mounted = |robot: &CellRobot| robot.payload.tools.iter().any(|t| t.link == v.link && t.mounted);
                    mounted(&after) && !mounted(at)
                };
                let name = &at.payload.tools[*tool].name;
                let step = format!("exchanges its tool for \"{name}\"");
                let enters = after.guarded_volumes().iter().any(|v| is_new(v) && self.is_inside(v));
                enters.then(|| MountedOverlap { step, name, is_certain: true })
            }
        }
    }

    fn part(&self, action: &GripAction) -> Option<MountedOverlap<'a>> {
        let name = &self.cell.objects[action.object.0].name;
        let found = |is_certain: bool| MountedOverlap { step: format!("grips \"{name}\""), name, is_certain };
        if let Some(attachment) = &action.attachment {
            let held = self.cell.volumes_holding(self.id, &[(action.object, attachment.clone())]);
            return held.last().is_some_and(|v| self.is_inside(v)).then(|| found(true));
        }
        let volume = self.cell.gripped_volume(self.id, action.object, action.link);
        let PlacedRegion { region, in_world } = self.region;
        if !volume.part.counts_for(region.region.guards) {
            return None;
        }
        let reach_m = MAX_GRIP_DISTANCE_M + diameter_m(&volume.shape);
        let hand = Hand::of(&self.mount.robot);
        (hand.distance_m(&self.state, &region.region.shape, &in_world) <= reach_m).then(|| found(false))
    }

    fn is_inside(&self, volume: &Volume) -> bool {
        let PlacedRegion { region, in_world } = &self.region;
        let at = self.mount.robot.base_in_world * self.state.link_in_root(volume.link) * volume.in_link;
        volume.part.counts_for(region.region.guards) && within(&volume.shape, &at, &region.region.shape, in_world, 0.0)
    }
}

fn diameter_m(shape: &Shape) -> f64 {
    shape.aabb(&Pose::IDENTITY).extent().length()
}
