//! Where the objects of a live cell are.

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, Object};
use elbowroom_spatial::Pose;

use super::perceived_obstacles::PerceivedObstacle;
use super::surroundings::Surroundings;
use crate::hand::Hand;
use crate::motion::GripAction;

/// Where the objects of a cell are: where the cell file puts them, where a robot has released them, or in a hand.
#[derive(Debug, Clone)]
pub struct ObjectPlaces {
    /// Per object where a robot has released it.
    released: Vec<Option<Pose>>,
    /// Per object how a robot holds it.
    held: Vec<Option<Attachment>>,
}

impl ObjectPlaces {
    /// At the start of a cell.
    pub fn new(cell: &Cell) -> Self {
        Self { released: vec![None; cell.objects.len()], held: vec![None; cell.objects.len()] }
    }

    /// Executes a step of a program that grips or releases an object. `at` is the robot with its present tool, in this state;
    /// `t_s` is the time since the start, s.
    pub fn apply(
        &mut self,
        cell: &Cell,
        (robot, at): (RobotId, &CellRobot),
        action: &GripAction,
        state: &ChainState,
        t_s: f64,
    ) {
        let object = action.object.0;
        if let Some(held) = self.held[object].take_if(|held| held.robot == robot) {
            self.released[object] = Some(at.base_in_world * state.link_in_root(held.link) * held.in_link);
        }
        if action.grips {
            let in_hand = || {
                let in_world = self.placed(cell, action.object, t_s);
                Hand::of(at).attachment(robot, state, &cell.objects[object].shape, &in_world)
            };
            self.held[object] = Some(action.attachment.clone().unwrap_or_else(in_hand));
        }
    }

    /// The objects that a robot holds: the link that holds each, and its pose in that link.
    pub fn held_by(&self, robot: RobotId) -> impl Iterator<Item = (ObjectId, LinkId, Pose)> + '_ {
        let held = self.held.iter().enumerate().filter_map(|(object, held)| Some((ObjectId(object), held.as_ref()?)));
        held.filter(move |(_, held)| held.robot == robot).map(|(object, held)| (object, held.link, held.in_link))
    }

    /// Everything around the robots, with obstacles that sensors saw.
    pub fn surroundings(
        &self,
        cell: &Cell,
        states: &[ChainState],
        t_s: f64,
        perceived: Vec<PerceivedObstacle>,
    ) -> Surroundings {
        let object = |(i, object): (usize, &Object)| {
            let in_hand = self.held[i].as_ref().map(|held| {
                let base = cell.robots[held.robot.0].base_in_world;
                base * states[held.robot.0].link_in_root(held.link) * held.in_link
            });
            Object { in_world: in_hand.unwrap_or_else(|| self.placed(cell, ObjectId(i), t_s)), ..object.clone() }
        };
        Surroundings {
            states: states.to_vec(),
            objects: cell.objects.iter().enumerate().map(object).collect(),
            attachments: self.held.clone(),
            perceived,
        }
    }

    /// Pose in the world of an object that nobody holds.
    fn placed(&self, cell: &Cell, object: ObjectId, t_s: f64) -> Pose {
        let moving = cell.moving_objects.iter().find(|m| m.object == object);
        let by_itself = || moving.map_or(cell.objects[object.0].in_world, |m| m.pose(t_s));
        self.released[object.0].unwrap_or_else(by_itself)
    }
}
