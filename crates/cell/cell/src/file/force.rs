//! `[force.NAME]`: forces between guided tools and their surroundings.

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_robot::ObjectId;
use elbowroom_shared_control::force::{
    Aureole, BodySettings, ForceLaw, ForceProfile, ImpedancePort, ImpedanceSettings,
};

use super::fixture_tool::tool_of;
use super::schema::{FORCE, names};
use crate::force::{CellForce, ForceOther, ForceResponse};
use crate::{Cell, CellOperator, FixtureTool};

type Result<T> = std::result::Result<T, Diagnostic>;

const BETWEEN: &str = "between = [\"arm/tool\", \"bone\"]   (a guided tool, or its robot; an object or a fixture)";
/// Stiffness of a repulsion, and of the spring of `impedance`, N/m.
const STIFFNESS: f64 = 1000.0;
/// Stiffness of the coupling of `admittance`, N/m.
const COUPLING: f64 = 800.0;
/// Damping of `spring_damper`, N·s/m.
const DAMPING: f64 = 50.0;
/// Largest numbers, in the units of the keys.
const MOST_STIFFNESS: f64 = 1e6;
const MOST_DAMPING: f64 = 1e6;
const MOST_FORCE: f64 = 1e4;
const MOST_RANGE_M: f64 = 10.0;
const MOST_MASS_KG: f64 = 1e4;
const MOST_TANK_J: f64 = 10.0;
const MOST_REACTION_MS: f64 = 1e4;

/// The words of `law`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Law {
    Repulsive,
    Khatib,
    SpringDamper,
    Admittance,
    Impedance,
}

pub(super) fn read(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("force")? {
        let force = force(name, &t, cell)?;
        let has_response = |f: &&CellForce| f.tool == force.tool && f.response != ForceResponse::Field;
        if let Some(other) = cell.guidance.forces.iter().find(has_response)
            && force.response != ForceResponse::Field
        {
            let what = format!("`{}`: force \"{}\" says already how the tool answers", t.name, other.name);
            return Err(t.error(what).hint("one `admittance` or one `impedance` per tool"));
        }
        cell.guidance.forces.push(force);
    }
    Ok(())
}

fn force(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellForce> {
    t.only(&names(&[FORCE]))?;
    let law = t.need("law", "law = \"repulsive\"")?.word(&[
        ("repulsive", Law::Repulsive),
        ("khatib", Law::Khatib),
        ("spring_damper", Law::SpringDamper),
        ("admittance", Law::Admittance),
        ("impedance", Law::Impedance),
    ])?;
    refuse_keys_of_other_laws(t, law)?;
    let between = t.need("between", BETWEEN)?;
    let sides = between.list(BETWEEN)?;
    let [own, other] = &sides[..] else {
        return Err(between.error(format!("has {} names instead of two", sides.len())).hint(BETWEEN));
    };
    let (operator, whole_arm) = guided(own, cell)?;
    if !operator.switches.is_empty() {
        let what =
            format!("the stream of operator \"{}\" switches fixtures, which forces do not follow", operator.name);
        return Err(own.error(what).hint("a stream without the columns `fixture.NAME`, or no forces for this tool"));
    }
    let other = other_side(other, cell, operator.tool, whole_arm)?;
    let response = match law {
        Law::Admittance => ForceResponse::Admittance(body(t, cell)?),
        Law::Impedance => ForceResponse::Impedance(port(t, cell)?),
        _ => ForceResponse::Field,
    };
    let field = field(t, cell, law)?;
    Ok(CellForce { name: name.to_owned(), line: t.line, tool: operator.tool, whole_arm, other, response, field })
}

fn refuse_keys_of_other_laws(t: &Table<'_>, law: Law) -> Result<()> {
    let owned = [
        ("mass", Law::Admittance, "admittance"),
        ("jerk", Law::Admittance, "admittance"),
        ("tank", Law::Impedance, "impedance"),
        ("device_damping", Law::Impedance, "impedance"),
    ];
    if let Some(v) = t.get("largest_force").filter(|_| !matches!(law, Law::Admittance | Law::Impedance)) {
        return Err(v.error("belongs to `admittance` and `impedance`").hint("another law, or without this key"));
    }
    match owned.into_iter().filter(|(_, owner, _)| *owner != law).find_map(|(key, _, word)| Some((t.get(key)?, word))) {
        Some((v, word)) => {
            Err(v.error(format!("belongs to `law = \"{word}\"`")).hint("another law, or without this key"))
        }
        None => Ok(()),
    }
}

/// The operator of a tool, `"ROBOT/TOOL"`, or of an arm, `"ROBOT"`; true for an arm.
fn guided<'c>(v: &Value<'_>, cell: &'c Cell) -> Result<(&'c CellOperator, bool)> {
    let text = v.text()?;
    let (robot_name, tool_name) = text.split_once('/').map_or((text, None), |(robot, tool)| (robot, Some(tool)));
    let guided = || cell.guidance.operators.iter();
    let name = |operator: &CellOperator| cell.robots[operator.robot.0].name.as_str();
    let Some(operator) = guided().find(|operator| name(operator) == robot_name) else {
        let what = format!("names \"{robot_name}\", which no operator guides");
        let hint = suggest::hint(robot_name, guided().map(name));
        return Err(v.error(what).hint(if guided().len() == 0 { "a table [operator.NAME]".into() } else { hint }));
    };
    let Some(tool_name) = tool_name else { return Ok((operator, true)) };
    if tool_of(v, cell, operator.robot, tool_name)? != operator.tool {
        return Err(v.error("is not the tool that is guided").hint("the tool of the operator, or the robot alone"));
    }
    Ok((operator, false))
}

/// An object, or a fixture with a shield.
fn other_side(v: &Value<'_>, cell: &Cell, tool: FixtureTool, whole_arm: bool) -> Result<ForceOther> {
    let name = v.text()?;
    let fixtures = &cell.guidance.fixtures;
    if let Some(index) = fixtures.iter().position(|f| f.name == name) {
        if whole_arm || fixtures[index].tool != Some(tool) || !fixtures[index].active {
            let what = format!("is the fixture \"{name}\", which is not on for this tool: a shield is for one tool");
            return Err(v.error(what).hint("`tool` and `active` of the fixture, or an object"));
        }
        return Ok(ForceOther::Shield(index));
    }
    let names = || cell.objects.iter().map(|o| o.name.as_str()).chain(fixtures.iter().map(|f| f.name.as_str()));
    let Some(object) = cell.objects.iter().position(|o| o.name == name).map(ObjectId) else {
        let what = format!("names \"{name}\", which is neither an object nor a fixture of this cell");
        return Err(v.error(what).hint(suggest::hint(name, names())));
    };
    let shield = fixtures.iter().find(|f| f.protects == object && f.active && f.tool == Some(tool));
    match shield.filter(|_| !whole_arm) {
        Some(f) => Err(v.error("is guarded by a shield for this tool").hint(format!("the fixture: \"{}\"", f.name))),
        None => Ok(ForceOther::Object(object)),
    }
}

/// A number of a key, refused above a bound in its unit.
fn up_to(v: &Value<'_>, number: f64, most: f64, unit: &str) -> Result<f64> {
    if number <= most {
        return Ok(number);
    }
    Err(v.error(format!("is more than {most} {unit}")).hint(format!("at most {most} {unit}")))
}

/// A stiffness, N/m.
fn stiffness(t: &Table<'_>, default: f64) -> Result<f64> {
    t.get("stiffness").map_or(Ok(default), |v| up_to(&v, v.positive()?, MOST_STIFFNESS, "N/m"))
}

fn damping(t: &Table<'_>, default: f64) -> Result<f64> {
    t.get("damping").map_or(Ok(default), |v| up_to(&v, v.not_negative()?, MOST_DAMPING, "N·s/m"))
}

fn largest_force(t: &Table<'_>, default: f64) -> Result<f64> {
    t.get("largest_force").map_or(Ok(default), |v| up_to(&v, v.positive()?, MOST_FORCE, "N"))
}

/// The repulsion; `None` without a range.
fn field(t: &Table<'_>, cell: &Cell, law: Law) -> Result<Option<ForceLaw>> {
    let is_field = !matches!(law, Law::Admittance | Law::Impedance);
    let far = |v: &Value<'_>, range_m: f64| up_to(v, range_m, MOST_RANGE_M, "m");
    let range_m = match t.get("range") {
        Some(v) if is_field => far(&v, cell.units.positive_length(&v)?)?,
        Some(v) => far(&v, cell.units.not_negative_length(&v)?)?,
        None if is_field => cell.units.positive_length(&t.need("range", "range = 20")?)?,
        None => 0.0,
    };
    let deceleration = t.get("deceleration").map(|v| cell.units.positive_length(&v)).transpose()?;
    let reaction_ms = t.get("reaction_ms");
    let reaction_s =
        reaction_ms.as_ref().map_or(Ok(0.0), |v| up_to(v, v.not_negative()?, MOST_REACTION_MS, "ms"))? * 1e-3;
    if range_m == 0.0 {
        let of_a_range = reaction_ms.or_else(|| t.get("deceleration"));
        return match of_a_range.or_else(|| t.get("range").filter(|_| is_field)) {
            Some(v) => Err(v.error("changes nothing without a `range`").hint("range = 20")),
            None => Ok(None),
        };
    }
    let is_growing = reaction_s > 0.0 || deceleration.is_some();
    let aureole = is_growing.then_some(Aureole { reaction_s, deceleration_m_s2: deceleration.unwrap_or(f64::MAX) });
    let law = ForceLaw {
        field: if law == Law::Khatib { ForceProfile::Khatib } else { ForceProfile::Linear },
        range_m,
        stiffness_n_m: stiffness(t, if law == Law::Admittance { COUPLING } else { STIFFNESS })?,
        damping_n_s_m: match law {
            Law::SpringDamper => damping(t, DAMPING)?,
            Law::Repulsive | Law::Khatib => damping(t, 0.0)?,
            Law::Admittance | Law::Impedance => 0.0,
        },
        aureole,
    };
    law.check().map_err(|e| t.error(format!("`{}`: {e}", t.name)))?;
    Ok(Some(law))
}

fn body(t: &Table<'_>, cell: &Cell) -> Result<BodySettings> {
    let default = BodySettings::default();
    let mass_kg = t.get("mass").map_or(Ok(default.mass_kg), |v| up_to(&v, v.positive()?, MOST_MASS_KG, "kg"))?;
    let coupling_n_m = stiffness(t, COUPLING)?;
    Ok(BodySettings {
        mass_kg,
        coupling_n_m,
        damping_n_s_m: damping(t, 2.0 * (mass_kg * coupling_n_m).sqrt())?,
        largest_force_n: largest_force(t, default.largest_force_n)?,
        jerk_m_s3: t.get("jerk").map_or(Ok(default.jerk_m_s3), |v| cell.units.positive_length(&v))?,
    })
}

fn port(t: &Table<'_>, cell: &Cell) -> Result<ImpedanceSettings> {
    let default = ImpedanceSettings::default();
    let settings = ImpedanceSettings {
        stiffness_n_m: stiffness(t, STIFFNESS)?,
        damping_n_s_m: damping(t, 0.0)?,
        tank_j: t.get("tank").map_or(Ok(default.tank_j), |v| up_to(&v, v.positive()?, MOST_TANK_J, "J"))?,
        largest_force_n: largest_force(t, default.largest_force_n)?,
        ..default
    };
    let tick_s = cell.timing.tick_s;
    let port = ImpedancePort::new(settings).map_err(|e| t.error(format!("`{}`: {e}", t.name)))?;
    if let Some(v) = t.get("device_damping") {
        let (has, needs) = (v.not_negative()?, port.least_device_damping(tick_s));
        if has < needs {
            let most = 2.0 * (has - settings.damping_n_s_m) / tick_s;
            let what = format!("is {has} N·s/m; the wall needs {needs} at a tick of {} ms, or it shakes", tick_s * 1e3);
            let remedy = if most > 0.0 {
                format!("`stiffness` of at most {most}, or a shorter `tick_ms`")
            } else {
                format!("`damping` below {has}")
            };
            return Err(v.error(what).hint(remedy));
        }
    }
    Ok(settings)
}
