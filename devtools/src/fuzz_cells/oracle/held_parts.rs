//! Objects in the hands of robots, by the steps that the recording names.

use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use elbowroom_sim::{Recording, RunEvent};

use super::arm::Arm;
use super::frame::Frame;
use super::guarded::Guarded;

/// A grip: from the tick of the step until that of its end, the object is a part of the robot.
#[derive(Debug)]
pub struct Grip {
    pub robot: usize,
    pub object: usize,
    pub from: usize,
    /// The tick of the release, or the end of the run.
    pub to: usize,
    object_in_flange: Frame,
}

/// Returns the grips in the order in which they begin. An object is where it was put down, at first where the cell has it.
pub fn grips(cell: &Cell, recording: &Recording, arms: &[Arm]) -> Vec<Grip> {
    let mut grips: Vec<Grip> = Vec::new();
    let mut objects: Vec<Frame> = cell.objects.iter().map(|o| Frame::of(&o.in_world)).collect();
    for event in &recording.events {
        let robot = cell.robots.iter().position(|r| r.name == event.robot);
        let object = cell.objects.iter().position(|o| o.name == event.region);
        let (Some(robot), Some(object)) = (robot, object) else { continue };
        // A work-piece that robots carry as one has its own check.
        if cell.guidance.virtual_robot_of(RobotId(robot)).is_some() {
            continue;
        }
        let tick = (event.t_s / recording.tick_s).round() as usize;
        let Some(sample) = recording.robots[robot].samples.get(tick) else { continue };
        let flange = arms[robot].frames(&sample.q)[cell.robots[robot].flange.0];
        match event.event {
            RunEvent::Grip => {
                let object_in_flange = objects[object].seen_from(&flange);
                grips.push(Grip { robot, object, from: tick, to: usize::MAX, object_in_flange });
            }
            RunEvent::Release => {
                let is_held = |g: &&mut Grip| g.robot == robot && g.object == object && g.to == usize::MAX;
                if let Some(grip) = grips.iter_mut().find(is_held) {
                    grip.to = tick;
                    objects[object] = flange.then(&grip.object_in_flange);
                }
            }
            _ => {}
        }
    }
    grips
}

impl Grip {
    /// The object as a part of the robot that can count.
    pub fn guarded(&self, cell: &Cell) -> Guarded {
        let flange = cell.robots[self.robot].flange.0;
        Guarded::held(flange, self.object_in_flange, &cell.objects[self.object].shape, self.from..self.to)
    }
}
