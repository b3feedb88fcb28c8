//! `[avoidance.ROBOT]`: avoidance of dynamic obstacles by a robot.

use elbowroom_avoidance::{AvoiderSettings, Rules};
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_robot::{ObjectId, RobotId};

use super::mechanism;
use super::robot::robot_of;
use super::schema::{AVOIDANCE, names};
use super::tools::with_exchanged_tools;
use crate::{AvoidanceSpec, Cell, Units, parse_rules};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Range of the speed of an evasion, m/s.
const SPEEDS_M_S: (f64, f64) = (0.01, 20.0);
/// Range of the clearance, m; rules limit it further.
const CLEARANCES_M: (f64, f64) = (1e-4, 5.0);
/// Smallest return speed, as a fraction of the joints' speeds.
const MIN_RETURN: f64 = 0.01;
/// Range of the stall timeout, s.
const STALL_TIMEOUTS_S: (f64, f64) = (0.01, 60.0);

/// Longest time for which motions are predicted, s.
const MAX_HORIZON_S: f64 = 10.0;
/// Largest noise of an observation, m.
const MAX_NOISE_M: f64 = 0.5;
/// Longest delay of an observation, ms.
const MAX_DELAY_MS: f64 = 2000.0;
/// Longest time of a plan, and its default, ms. The default is a little more than plans took in the documented runs.
const MAX_PLAN_MS: f64 = 10_000.0;
const PLAN_MS: f64 = 70.0;

pub(super) fn read(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("avoidance")? {
        t.only(&names(&[AVOIDANCE]))?;
        let (robot, of_table) = robot_of(name, &t, &cell.robots)?;
        mechanism::refuse_table(&t, of_table, "avoids nothing")?;
        cell.robots[robot.0].avoidance = Some(spec(&t, cell, robot)?);
    }
    Ok(())
}

fn spec(t: &Table<'_>, cell: &Cell, own: RobotId) -> Result<AvoidanceSpec> {
    let units = cell.units;
    if let Some(robot) = with_exchanged_tools(&cell.robots) {
        let what = format!(
            "`{}`: avoidance does not see tools that are changed, as those of robot \"{}\"",
            t.name, robot.name
        );
        return Err(t.error(what).hint("mounted tools only, or no avoidance"));
    }
    let settings = settings(t, units)?;
    let noise_m = t.get("noise").map_or(Ok(0.0), |v| {
        let most = MAX_NOISE_M / units.length.to_metres(1.0);
        let hint = "noise = 10   (standard deviation of an observed position, in the cell's unit of length)";
        up_to(&v, most, "in the unit of length of the cell", hint).map(|n| units.length.to_metres(n))
    })?;
    let delay_s = t.get("delay_ms").map_or(Ok(0.0), |v| {
        up_to(&v, MAX_DELAY_MS, "ms", "delay_ms = 60   (age of an observation)").map(|ms| 1e-3 * ms)
    })?;
    let plan_ms = t.get("plan_ms").map_or(Ok(PLAN_MS), |v| {
        up_to(&v, MAX_PLAN_MS, "ms", "plan_ms = 70   (computing time of a path, in simulated time)")
    })?;
    let rules = t.get("rules").map_or_else(|| Ok(Rules::default()), |v| rules(&v))?;
    let reach = rules.reach_m();
    if settings.reactive.clearance_m >= reach {
        let what = format!("is not less than the {} range of the rules", units.show_length(reach));
        // Without the key the default clearance is too large for the rules.
        let error = t
            .get("clearance")
            .map_or_else(|| t.error(format!("`{}`: the default clearance {what}", t.name)), |v| v.error(&what));
        return Err(error.hint("clearance = 50, or rules with a wider range of proximity"));
    }
    let objects = match t.get("objects") {
        None => cell.moving_objects.iter().map(|m| m.object).collect(),
        Some(v) => v.list("objects = [\"cart\"]")?.iter().map(|v| object(v, cell)).collect::<Result<_>>()?,
    };
    let robots = match t.get("robots") {
        None => (0..cell.robots.len()).map(RobotId).filter(|r| *r != own).collect(),
        Some(v) => v.list("robots = [\"r2\"]")?.iter().map(|v| neighbour(v, cell, own)).collect::<Result<_>>()?,
    };
    let replan = t.flag_or("replan", true)?;
    Ok(AvoidanceSpec { rules, settings, objects, robots, replan, noise_m, delay_s, plan_s: 1e-3 * plan_ms })
}

/// Speeds, distances and times.
fn settings(t: &Table<'_>, units: Units) -> Result<AvoiderSettings> {
    let mut settings = AvoiderSettings::default();
    if let Some(v) = t.get("speed") {
        settings.reactive.speed_m_s = length(&v, units, SPEEDS_M_S, "per second")?;
    }
    if let Some(v) = t.get("clearance") {
        settings.reactive.clearance_m = length(&v, units, CLEARANCES_M, "")?;
    }
    settings.return_speed_fraction = t.get("return_speed").map(|v| return_speed(&v)).transpose()?;
    if let Some(v) = t.get("stall_timeout") {
        settings.stall_timeout_s = v.positive()?;
        if !within(STALL_TIMEOUTS_S, settings.stall_timeout_s) {
            let (least, most) = STALL_TIMEOUTS_S;
            let what = format!("is {} s, and can be {least} to {most} s", settings.stall_timeout_s);
            return Err(v
                .error(what)
                .hint("stall_timeout = 0.6   (seconds without progress before another path is planned)"));
        }
    }
    settings.escape.clearance_m = settings.reactive.clearance_m;
    if let Some(v) = t.get("horizon") {
        settings.escape.horizon_s = up_to(&v, MAX_HORIZON_S, "s", "horizon = 3   (seconds; 0: no prediction)")?;
    }
    Ok(settings)
}

/// The speed of detours and returns, as a fraction of the joints' speeds.
fn return_speed(v: &Value<'_>) -> Result<f64> {
    let fraction = v.percent()?;
    if fraction < MIN_RETURN {
        let what = "is less than 1 percent: the robot would hardly return";
        return Err(v.error(what).hint("return_speed = 50   (percent)"));
    }
    Ok(fraction)
}

/// A length (m), or with `per` a speed, within its range.
fn length(v: &Value<'_>, units: Units, bounds: (f64, f64), per: &str) -> Result<f64> {
    let metres = units.positive_length(v)?;
    if within(bounds, metres) {
        return Ok(metres);
    }
    let show = |m: f64| format!("{} {per}", units.show_length(m)).trim_end().to_owned();
    let (least, most) = (show(bounds.0), show(bounds.1));
    let sense = if metres < bounds.0 { bounds.0 } else { bounds.1 };
    let number = (sense / units.length.to_metres(1.0) * 1e6).round() / 1e6;
    // The number as written: a tiny number must not be rounded to 0.
    let what = format!("is {}, and can be {least} to {most}", v.number()?);
    Err(v
        .error(what)
        .hint(format!("{} = {number}, or a number between; or leave it out: a default fits most", v.key())))
}

/// A number from 0 to `most`.
fn up_to(v: &Value<'_>, most: f64, unit: &str, hint: &str) -> Result<f64> {
    let number = v.number()?;
    if within((0.0, most), number) {
        return Ok(number);
    }
    Err(v.error(format!("is {number}, and can be 0 to {most} {unit}")).hint(hint))
}

fn within((least, most): (f64, f64), v: f64) -> bool {
    (least..=most).contains(&v)
}

fn object(v: &Value<'_>, cell: &Cell) -> Result<ObjectId> {
    let name = v.text()?;
    cell.objects.iter().position(|o| o.name == name).map(ObjectId).ok_or_else(|| {
        v.error(format!("names the object \"{name}\", which is not in this cell"))
            .hint(suggest::hint(name, cell.objects.iter().map(|o| o.name.as_str())))
    })
}

fn neighbour(v: &Value<'_>, cell: &Cell, own: RobotId) -> Result<RobotId> {
    let name = v.text()?;
    let others = || cell.robots.iter().enumerate().filter(|(i, _)| RobotId(*i) != own);
    if name == cell.robots[own.0].name {
        return Err(v.error(format!("names \"{name}\" itself")).hint("robots = [], or the names of others"));
    }
    others().find(|(_, r)| r.name == name).map(|(i, _)| RobotId(i)).ok_or_else(|| {
        v.error(format!("names the robot \"{name}\", which is not in this cell"))
            .hint(suggest::hint(name, others().map(|(_, r)| r.name.as_str())))
    })
}

/// The rules of the named file; its errors carry its own lines.
fn rules(v: &Value<'_>) -> Result<Rules> {
    let path = v.file.parent().unwrap_or(v.file).join(v.text()?);
    let text = std::fs::read_to_string(&path).map_err(|e| {
        v.error(format!("names {}, which cannot be read: {e}", path.display()))
            .hint("rules = \"my_rules.toml\", written by `elbowroom rules --write my_rules.toml`")
    })?;
    parse_rules(&path, &text)
}
