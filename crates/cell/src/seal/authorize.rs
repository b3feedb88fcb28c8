//! Whether a class may make an edit: asked of the monitors' own configurations.

use elbowroom_monitor::{AccessClass, Configuration, Edit, EditError, Region};

use super::Result;
use crate::{Cell, configure};

/// Applies what differs between two cells to the configuration of each robot's monitor, on behalf of the class.
pub(super) fn authorize(who: AccessClass, before: &Cell, after: &Cell) -> Result<std::result::Result<(), EditError>> {
    let setups = configure::setups(before)?;
    let allowed = setups.into_iter().enumerate().try_for_each(|(robot, setup)| {
        let mut configuration = setup.configuration;
        for edit in edits(&configuration, robot, before, after) {
            configuration.edit(who, edit)?;
        }
        Ok(())
    });
    Ok(allowed)
}

/// The edits that lead from one cell to the other, as far as they concern a robot.
fn edits(configuration: &Configuration, robot: usize, before: &Cell, after: &Cell) -> Vec<Edit> {
    let known = |name: &str| configuration.region(name).is_some();
    let now = |name: &str| after.regions.iter().find(|r| r.region.name == name);
    let mut edits = Vec::new();
    for old in before.regions.iter().filter(|r| known(&r.region.name)) {
        match now(&old.region.name) {
            None => edits.push(Edit::Remove(old.region.name.clone())),
            Some(new) if new.region.checksum() != old.region.checksum() => edits.push(Edit::Change(alone(&new.region))),
            Some(_) => {}
        }
    }
    let is_new = |name: &str| !before.regions.iter().any(|r| r.region.name == name);
    for new in after.regions.iter().filter(|r| r.robots.contains(&robot) && is_new(&r.region.name)) {
        edits.push(Edit::Add(alone(&new.region)));
    }
    if after.laws != before.laws {
        let stopping_distance = configuration.laws().stopping_distance.clone();
        edits.push(Edit::Laws(elbowroom_monitor::Laws { stopping_distance, ..after.laws.laws.clone() }));
    }
    edits
}

/// Which source it follows is said by the configuration that it will be part of.
fn alone(region: &Region) -> Box<Region> {
    Box::new(Region { follow: None, ..region.clone() })
}
