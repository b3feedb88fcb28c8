//! Collisions during a run, and poses of the objects that move or are carried.

use elbowroom_cell::{Cell, ObjectMotion};
use elbowroom_kinematics::ChainState;
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_scene::{FirstContact, FirstContacts, MovedObject, Object};

use super::carried_parts::CarriedParts;
use super::simulated_robot::SimulatedRobot;
use crate::motion::ProgramClock;
use crate::recording::{Collision, ObjectTrack};
use crate::replanning::{PerceivedObstacle, Surroundings};

/// Finds contacts between two instants, and tracks the objects.
pub(super) struct ContactRecorder<'a> {
    cell: &'a Cell,
    pub checker: FirstContacts<'a>,
    pub parts: CarriedParts<'a>,
    /// The objects of the last tracks, which move only when a robot carries them.
    gripped: Vec<ObjectId>,
    pub objects: Vec<ObjectTrack>,
    /// Time of the last check, s.
    checked_s: f64,
}

impl<'a> ContactRecorder<'a> {
    /// Creates a recorder. `models` are the robots with all their tools.
    pub fn new(cell: &'a Cell, models: &'a [Robot]) -> Self {
        let placed = models.iter().zip(&cell.robots).map(|(model, r)| (model, r.base_in_world));
        let moving: Vec<ObjectId> = cell.moving_objects.iter().map(|m| m.object).collect();
        let mut rules = cell.pair_rules.all();
        rules.extend(cell.opened_pairs());
        let mut checker = FirstContacts::new(placed.collect(), &cell.objects).skipping(rules).moving(&moving);
        for (robot, r) in cell.robots.iter().enumerate() {
            let absent = r.payload.tools.iter().filter(|t| !t.mounted);
            absent.for_each(|tool| checker.set_present(RobotId(robot), tool.link, false, &[]));
        }
        let gripped: Vec<ObjectId> = CarriedParts::gripped_by_programs(cell).collect();
        let track = |o: &ObjectId| ObjectTrack { name: cell.objects[o.0].name.clone(), poses: Vec::new() };
        let objects = moving.iter().chain(&gripped).map(track).collect();
        Self { cell, checker, parts: CarriedParts::new(cell), gripped, objects, checked_s: 0.0 }
    }

    /// Everything around the robots now, including obstacles that sensors saw.
    pub fn surroundings(&self, states: &[ChainState], perceived: Vec<PerceivedObstacle>) -> Surroundings {
        let in_world = |o: usize| self.checker.object_in_world(ObjectId(o));
        let object = |(o, object): (usize, &Object)| Object { in_world: in_world(o), ..object.clone() };
        Surroundings {
            states: states.to_vec(),
            objects: self.cell.objects.iter().enumerate().map(object).collect(),
            attachments: self.parts.attachments().to_vec(),
            perceived,
        }
    }

    /// Records the contacts since the last instant. A collision of two robots is listed for both.
    pub fn check(&mut self, t_s: f64, robots: &mut [SimulatedRobot<'_>], states: &[ChainState]) {
        let Self { cell, checker, parts, checked_s, .. } = self;
        let before = std::mem::replace(checked_s, t_s);
        let motions: Vec<(ObjectId, ObjectMotion<'_>)> = cell
            .moving_objects
            .iter()
            .filter(|m| !parts.is_taken(m.object))
            .map(|m| (m.object, m.motion_between(before, t_s)))
            .collect();
        let moved: Vec<MovedObject<'_>> = motions
            .iter()
            .map(|(object, motion)| MovedObject { object: *object, path: motion, jumps: motion.jumps() })
            .collect();
        let set_down: Vec<ObjectId> = robots.iter().flat_map(|r| ProgramClock::objects_set_down(&r.clock)).collect();
        for object in (0..cell.objects.len()).map(ObjectId) {
            checker.set_down(object, set_down.contains(&object));
        }
        let name = |m: GeometryId| match m {
            GeometryId::Object(o) => parts.name(o),
            link @ GeometryId::Link { .. } => cell.part_name(link),
        };
        let robot = |m: GeometryId| match m {
            GeometryId::Link { robot, .. } => Some(robot.0),
            GeometryId::Object(o) => parts.carrier(o).map(|r| r.0),
        };
        let states: Vec<&ChainState> = states.iter().collect();
        checker.check(&states, &moved, |FirstContact { a, b, fraction }| {
            // A contact at the end of the step gets exactly the time of the tick.
            let t_s = if fraction < 1.0 { before + fraction * (t_s - before) } else { t_s };
            let collision = Collision { t_s, a: name(a), b: name(b) };
            let mut concerned: Vec<usize> = [robot(a), robot(b)].into_iter().flatten().collect();
            concerned.dedup();
            for robot in concerned {
                robots[robot].track.collisions.push(collision.clone());
            }
        });
        self.record_objects(t_s);
    }

    fn record_objects(&mut self, t_s: f64) {
        let Self { cell, checker, parts, objects, gripped, .. } = self;
        let moving = cell
            .moving_objects
            .iter()
            .map(|m| if parts.is_taken(m.object) { checker.object_in_world(m.object) } else { m.pose(t_s) });
        let poses = moving.chain(gripped.iter().map(|o| checker.object_in_world(*o)));
        objects.iter_mut().zip(poses).for_each(|(track, pose)| track.poses.push(pose));
    }
}
