//! What a simulated robot carries: exchanged tools and gripped parts, as its controller reports them to the node.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRobot};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_sim::motion::{GripAction, ProgramClock};
use elbowroom_spatial::Pose;

use crate::messages::AttachedVolume;

/// Where the objects of a cell are, as far as the simulated robots of this process have moved them.
pub(crate) struct SimulatedObjects {
    cell: Arc<Cell>,
    /// Per object where a robot has released it; `None` before.
    released: RefCell<Vec<Option<Pose>>>,
}

impl SimulatedObjects {
    pub(crate) fn new(cell: &Arc<Cell>) -> Rc<Self> {
        Rc::new(Self { cell: cell.clone(), released: RefCell::new(vec![None; cell.objects.len()]) })
    }

    /// Pose in the world at a time since the start, s.
    fn pose(&self, object: ObjectId, t_s: f64) -> Pose {
        let moving = self.cell.moving_objects.iter().find(|m| m.object == object);
        let by_itself = || moving.map_or(self.cell.objects[object.0].in_world, |m| m.pose(t_s));
        self.released.borrow()[object.0].unwrap_or_else(by_itself)
    }

    fn release(&self, object: ObjectId, in_world: Pose) {
        self.released.borrow_mut()[object.0] = Some(in_world);
    }
}

/// An object in the hand.
struct Held {
    object: ObjectId,
    link: LinkId,
    in_link: Pose,
}

/// The volumes that are on a simulated robot only at times.
pub(crate) struct CarriedVolumes {
    setup: MonitorSetup,
    /// With the tools as they are now.
    robot: CellRobot,
    state: ChainState,
    objects: Rc<SimulatedObjects>,
    held: Vec<Held>,
    volumes: Vec<AttachedVolume>,
}

impl CarriedVolumes {
    /// As at the start of the cell: with the tools that are mounted, and nothing in the hand.
    pub(crate) fn new(cell: &Cell, robot: RobotId, setup: MonitorSetup, objects: Rc<SimulatedObjects>) -> Self {
        let robot = cell.robots[robot.0].clone();
        let state = ChainState::new(&robot.robot.chain);
        let mut carried = Self { setup, robot, state, objects, held: Vec::new(), volumes: Vec::new() };
        carried.list();
        carried
    }

    /// The volumes for the joint state.
    pub(crate) fn volumes(&self) -> &[AttachedVolume] {
        &self.volumes
    }

    /// Carries out what the program has exchanged, gripped and released since the last call. `t_s` is the time since the start.
    pub(crate) fn follow(&mut self, program: &mut ProgramClock, t_s: f64) {
        let (tools, grips) = (program.take_tools(), program.take_grips());
        if tools.is_empty() && grips.is_empty() {
            return;
        }
        for tool in tools {
            self.robot = self.robot.with_tool(tool);
        }
        self.state.q.copy_from_slice(&program.point().q);
        self.robot.robot.chain.forward(&mut self.state);
        for action in &grips {
            self.apply(action, t_s);
        }
        self.list();
    }

    fn apply(&mut self, action: &GripAction, t_s: f64) {
        let link_in_world = self.robot.base_in_world * self.state.link_in_root(action.link);
        if let Some(i) = self.held.iter().position(|held| held.object == action.object) {
            let held = self.held.swap_remove(i);
            self.objects.release(held.object, link_in_world * held.in_link);
        }
        if action.grips {
            let planned = action.attachment.as_ref().map(|a| a.in_link);
            let where_it_is = || link_in_world.inverse_mul(&self.objects.pose(action.object, t_s));
            let in_link = planned.unwrap_or_else(where_it_is);
            self.held.push(Held { object: action.object, link: action.link, in_link });
        }
    }

    /// Lists what is mounted and held now.
    fn list(&mut self) {
        let Self { setup, robot, held, volumes, .. } = self;
        volumes.clear();
        for tool in robot.tools.iter().filter(|tool| tool.mounted) {
            let of_tool = setup.tool_volumes(tool.link);
            volumes.extend(of_tool.map(|(volume, v)| AttachedVolume { volume, in_link: v.in_link }));
        }
        for held in held.iter() {
            // What a program grips has a volume.
            let volume = setup.gripped_volume(held.object, held.link, &held.in_link);
            volumes.extend(volume.map(|(volume, in_link)| AttachedVolume { volume, in_link }));
        }
    }
}
