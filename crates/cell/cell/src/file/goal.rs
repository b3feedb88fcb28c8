//! Goals of moves: joint values, the name of a state, or a pose of the TCP.

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_kinematics::inverse::ConfigurationChoice;

use super::robot::joint_values;
use super::schema::{GOAL, POSE, names};
use crate::{CellRobot, MoveTarget, TcpTarget, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Reads a pose, joint values, or the name of a state of the robot. `along_a_line` is true for a linear move.
pub(super) fn read(
    to: &Value<'_>,
    example: &str,
    units: Units,
    robot: &CellRobot,
    along_a_line: bool,
) -> Result<MoveTarget> {
    if to.is_table() {
        return tcp(&to.table(example)?, units, robot, along_a_line).map(MoveTarget::Tcp);
    }
    configuration(to, "neither joint values, a pose, nor the name of a state", example, units, robot)
        .map(MoveTarget::Joints)
}

/// Joint values, or the name of a state of the robot.
fn configuration(v: &Value<'_>, neither: &str, example: &str, units: Units, robot: &CellRobot) -> Result<Vec<f64>> {
    if v.is_list() {
        return joint_values(v, &robot.robot.chain, units);
    }
    let Ok(name) = v.text() else {
        return Err(v.error(format!("is {neither}")).hint(example));
    };
    robot.state(name).map(<[f64]>::to_vec).ok_or_else(|| {
        let known = robot.states.iter().map(|(name, _)| name.as_str());
        v.error(format!("names the state \"{name}\", which robot \"{}\" does not have", robot.name))
            .hint(suggest::hint(name, known))
    })
}

/// `{ at, rpy, configuration, near }`.
fn tcp(t: &Table<'_>, units: Units, robot: &CellRobot, along_a_line: bool) -> Result<TcpTarget> {
    t.only(&names(&[POSE, GOAL]))?;
    let choices = [t.get("configuration"), t.get("near")];
    if let (true, Some(v)) = (along_a_line, choices.iter().flatten().next()) {
        let what = "chooses a configuration, and a linear move keeps the one that it begins in";
        return Err(v.error(what).hint("a joint move to the begin of the line, with the configuration"));
    }
    let [configuration, near] = choices;
    Ok(TcpTarget {
        in_world: units.place(t)?,
        configuration: configuration.map_or(Ok(ConfigurationChoice::default()), |v| choice(&v, robot))?,
        near: near.map(|v| near_values(&v, units, robot)).transpose()?,
    })
}

fn near_values(v: &Value<'_>, units: Units, robot: &CellRobot) -> Result<Vec<f64>> {
    let example = "near = [0, -20, 90, 0, 40, 0]   (or: near = \"home\", a state of the robot)";
    configuration(v, "neither joint values nor the name of a state", example, units, robot)
}

/// `["front", "up", "no_flip"]`.
fn choice(v: &Value<'_>, robot: &CellRobot) -> Result<ConfigurationChoice> {
    const EXAMPLE: &str = "configuration = [\"front\", \"up\", \"no_flip\"]   (or some of them)";
    let words = v.list(EXAMPLE)?.iter().map(Value::text).collect::<Result<Vec<_>>>()?;
    let choice = ConfigurationChoice::from_words(words.iter().copied())
        .map_err(|e| v.error(format!("does not choose: {e}")).hint(EXAMPLE))?;
    if robot.ik_solver().configuration(&robot.start).is_none() {
        let what = format!("needs six axes with a spherical wrist, which robot \"{}\" does not have", robot.name);
        return Err(v.error(what).hint("near = joint values; the nearest solution to them is taken"));
    }
    Ok(choice)
}
