//! The maps of a robot without the links that may touch an object.

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_kinematics::LinkId;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};

use super::solids_map::SolidsMap;

/// The solids of a robot's maps: one map with all its links, and one for each set of links that must not touch an
/// object.
#[derive(Debug)]
pub(crate) struct LinkMaps {
    /// Map of all links.
    first: SolidsMap,
    /// Other maps, without the colliders of some links.
    others: Vec<(Vec<LinkId>, SolidsMap)>,
    /// Per object: index of its map, where 0 is the first; `None` if all links may touch it.
    of_object: Vec<Option<usize>>,
}

impl LinkMaps {
    pub fn new<E>(cell: &Cell, robot: RobotId, build: impl Fn(&CellRobot) -> Result<SolidsMap, E>) -> Result<Self, E> {
        let at = &cell.robots[robot.0];
        let mut maps = Self { first: build(at)?, others: Vec::new(), of_object: Vec::new() };
        for object in (0..cell.objects.len()).map(ObjectId) {
            let map = match links_that_may_touch(cell, robot, object) {
                None => None,
                Some(links) if links.is_empty() => Some(0),
                Some(links) => {
                    let known = maps.others.iter().position(|(known, _)| *known == links);
                    if known.is_none() {
                        let solids = build(&without_colliders(at, &links))?;
                        maps.others.push((links, solids));
                    }
                    Some(known.map_or(maps.others.len(), |known| known + 1))
                }
            };
            maps.of_object.push(map);
        }
        Ok(maps)
    }

    /// The map of all links.
    pub fn first(&self) -> &SolidsMap {
        &self.first
    }

    /// The map of all links, if every object uses it.
    pub fn of_every_link(&self) -> Option<&SolidsMap> {
        self.of_object.iter().all(|map| *map == Some(0)).then_some(&self.first)
    }

    /// The map of an object; `None` if all links may touch it, so that it blocks nothing.
    pub fn of(&self, object: ObjectId) -> Option<&SolidsMap> {
        self.of_object[object.0].map(|map| self.map(map))
    }

    /// Every map with its objects.
    pub fn each(&self) -> impl Iterator<Item = (&SolidsMap, Vec<ObjectId>)> {
        (0..=self.others.len()).map(move |map| {
            let objects = (0..self.of_object.len()).filter(move |o| self.of_object[*o] == Some(map));
            (self.map(map), objects.map(ObjectId).collect())
        })
    }

    fn map(&self, index: usize) -> &SolidsMap {
        if index == 0 { &self.first } else { &self.others[index - 1].1 }
    }
}

/// The links that may touch an object by the cell's file of pairs; `None` if all of them may.
fn links_that_may_touch(cell: &Cell, robot: RobotId, object: ObjectId) -> Option<Vec<LinkId>> {
    let may_touch = |link: &LinkId| {
        let link = GeometryId::Link { robot, link: *link };
        cell.pair_rules.given.skipped(link, GeometryId::Object(object)).is_some()
    };
    let all: Vec<LinkId> = cell.robots[robot.0].robot.links_with_colliders().collect();
    let some: Vec<LinkId> = all.iter().copied().filter(may_touch).collect();
    (some.is_empty() || some.len() < all.len()).then_some(some)
}

fn without_colliders(robot: &CellRobot, links: &[LinkId]) -> CellRobot {
    let mut robot = robot.clone();
    for link in links {
        robot.robot.colliders[link.0].clear();
    }
    robot
}
