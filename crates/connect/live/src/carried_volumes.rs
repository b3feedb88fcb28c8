//! Volumes that a simulated robot carries: exchanged tools and gripped parts, as its controller reports them to the node.

use std::sync::{Arc, Mutex};

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRobot};
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;
use elbowroom_sim::motion::ProgramClock;
use elbowroom_sim::replanning::ObjectPlaces;

use crate::locked::locked;
use crate::messages::AttachedVolume;

/// Volumes that are on a simulated robot only at times.
pub(crate) struct CarriedVolumes {
    cell: Arc<Cell>,
    id: RobotId,
    setup: MonitorSetup,
    /// The robot with its present tools.
    robot: CellRobot,
    state: ChainState,
    /// Where the objects of the cell are, as far as the simulated robots of this process have moved them.
    objects: Arc<Mutex<ObjectPlaces>>,
    volumes: Vec<AttachedVolume>,
}

impl CarriedVolumes {
    /// Creates the volumes at the start of the cell: with the mounted tools, without a gripped part.
    pub(crate) fn new(cell: &Arc<Cell>, id: RobotId, setup: MonitorSetup, objects: Arc<Mutex<ObjectPlaces>>) -> Self {
        let robot = cell.robots[id.0].clone();
        let state = ChainState::new(&robot.robot.chain);
        let mut carried = Self { cell: cell.clone(), id, setup, robot, state, objects, volumes: Vec::new() };
        carried.list();
        carried
    }

    /// Attached volumes for the joint state.
    pub(crate) fn volumes(&self) -> &[AttachedVolume] {
        &self.volumes
    }

    /// Applies the exchanges, grips and releases of the program since the last call. `t_s` is the time since the start.
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
        let mut objects = locked(&self.objects);
        for action in &grips {
            objects.apply(&self.cell, (self.id, &self.robot), action, &self.state, t_s);
        }
        drop(objects);
        self.list();
    }

    /// Lists the tools and parts that are mounted and held now.
    fn list(&mut self) {
        let Self { id, setup, robot, objects, volumes, .. } = self;
        volumes.clear();
        for tool in robot.payload.tools.iter().filter(|tool| tool.mounted) {
            let of_tool = setup.tool_volumes(tool.link);
            volumes.extend(of_tool.map(|(volume, v)| AttachedVolume { volume, in_link: v.in_link }));
        }
        let objects = locked(objects);
        for (object, link, in_link) in objects.held_by(*id) {
            // A part that a program grips has a volume.
            let volume = setup.gripped_volume(object, link, &in_link);
            volumes.extend(volume.map(|(volume, in_link)| AttachedVolume { volume, in_link }));
        }
    }
}
