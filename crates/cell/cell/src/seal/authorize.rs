//! Whether an access class may make an edit: decided by the monitors' configurations.

use elbowroom_monitor::{AccessClass, Configuration, ConfigurationEdit, EditError, Region};
use elbowroom_robot::RobotId;

use super::result::Result;
use crate::{Cell, configure};

/// Applies the differences between two cells to the configuration of each robot's monitor, on behalf of a class.
pub(super) fn authorize(who: AccessClass, before: &Cell, after: &Cell) -> Result<std::result::Result<(), EditError>> {
    let setups = configure::setups(before)?;
    let allowed = setups.into_iter().enumerate().try_for_each(|(robot, setup)| {
        let mut configuration = setup.configuration;
        for edit in edits(&configuration, RobotId(robot), before, after) {
            configuration.edit(who, edit)?;
        }
        Ok(())
    });
    Ok(allowed)
}

/// The edits from one cell to the other that affect a robot.
fn edits(configuration: &Configuration, robot: RobotId, before: &Cell, after: &Cell) -> Vec<ConfigurationEdit> {
    let known = |name: &str| configuration.region(name).is_some();
    let now = |name: &str| after.regions.iter().find(|r| r.region.name == name);
    let mut edits = Vec::new();
    for old in before.regions.iter().filter(|r| known(&r.region.name)) {
        match now(&old.region.name) {
            None => edits.push(ConfigurationEdit::Remove(old.region.name.clone())),
            Some(new) if new.region.checksum() != old.region.checksum() => {
                edits.push(ConfigurationEdit::Change(alone(&new.region)));
            }
            Some(_) => {}
        }
    }
    let is_new = |name: &str| !before.regions.iter().any(|r| r.region.name == name);
    for new in after.regions.iter().filter(|r| r.robots.contains(&robot) && is_new(&r.region.name)) {
        edits.push(ConfigurationEdit::Add(alone(&new.region)));
    }
    if after.monitoring != before.monitoring {
        let stopping_distance = configuration.laws().stopping_distance.clone();
        edits.push(ConfigurationEdit::Laws(elbowroom_monitor::Laws {
            stopping_distance,
            ..after.monitoring.laws.clone()
        }));
    }
    edits
}

/// The region without its source, whose index depends on the configuration.
fn alone(region: &Region) -> Box<Region> {
    Box::new(Region { follow: None, ..region.clone() })
}
