//! Joint limits of `[robot.NAME]`: rates, stop time, tolerated overshoot.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_kinematics::{Chain, JointId, JointKind, JointLimits};

use crate::Units;
use crate::model_limits::{ACCELERATION_TIME_S, JERK_TIME_S, STOP_TIME_S};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Longest stop time, s.
const MAX_STOP_TIME_S: f64 = 60.0;
/// Largest speeds, accelerations and jerks, in the file's units.
const MAX_RATE: f64 = 1e9;
/// Largest tolerated overshoot of a joint limit, rad or m.
const MAX_OVERSHOOT: f64 = 0.5;

/// Default speed of revolute joints, rad/s.
const REVOLUTE_SPEED: f64 = std::f64::consts::PI;
/// Default speed of prismatic joints, m/s.
const PRISMATIC_SPEED: f64 = 1.0;

/// Motion limits per independent joint; what the file does not state comes from the model, else from defaults.
pub(super) fn read(
    name: &str,
    t: &Table<'_>,
    chain: &Chain,
    units: Units,
    warnings: &mut Vec<Diagnostic>,
) -> Result<Vec<JointLimits>> {
    let given = |key: &str| t.get(key).map(|v| rates(&v, chain, units)).transpose();
    let (speed, acceleration, jerk) = (given("speed")?, given("acceleration")?, given("jerk")?);
    let stop_time = t.get("stop_time").map_or(Ok(STOP_TIME_S), |v| stop_time(&v))?;
    let mut unknown = Vec::new();
    let mut limits = Vec::with_capacity(chain.dof());
    for (i, id) in chain.active_joints().iter().enumerate() {
        let joint = &chain.joints()[id.0];
        let sane = |v: Option<f64>| v.filter(|x| *x > 0.0 && x.is_finite());
        let velocity = speed.as_ref().map(|s| s[i]).or(sane(joint.limits.velocity)).unwrap_or_else(|| {
            unknown.push(joint.name.as_str());
            if joint.kind == JointKind::Prismatic { PRISMATIC_SPEED } else { REVOLUTE_SPEED }
        });
        let acceleration = acceleration
            .as_ref()
            .map(|a| a[i])
            .or(sane(joint.limits.acceleration))
            .unwrap_or(velocity / ACCELERATION_TIME_S);
        let jerk = jerk.as_ref().map_or(acceleration / JERK_TIME_S, |j| j[i]);
        let rates = JointLimits::new(velocity, acceleration, jerk).stopping_at(velocity / stop_time);
        limits.push(rates.within(joint.limits.lower, joint.limits.upper));
    }
    if !unknown.is_empty() {
        let what = format!(
            "the model of \"{name}\" gives no speed for {}: taken as 180 deg/s (1 m/s for prismatic joints)",
            unknown.join(", ")
        );
        warnings.push(
            Diagnostic::new(t.file, t.line, what).hint("speed = […]   (per joint, in the cell's units per second)"),
        );
    }
    Ok(limits)
}

/// Gives the chain the cell's speeds and tolerated overshoots, which the monitor uses for plausibility checks.
pub(super) fn set_plausible(t: &Table<'_>, chain: &mut Chain, cell_limits: &[JointLimits], units: Units) -> Result<()> {
    let overshoot = t.get("overshoot").map(|v| overshoot(&v, chain, units)).transpose()?;
    let has_speeds = t.get("speed").is_some();
    if !has_speeds && overshoot.is_none() {
        return Ok(());
    }
    let mut joints = chain.joints().to_vec();
    for (i, id) in chain.active_joints().iter().enumerate() {
        let limits = &mut joints[id.0].limits;
        if has_speeds {
            limits.velocity = Some(cell_limits[i].velocity);
        }
        limits.overshoot_tolerance = overshoot.as_ref().map(|overshoot| overshoot[i]);
    }
    *chain = Chain::new(chain.name(), chain.links().to_vec(), joints).map_err(|e| t.error(e))?;
    Ok(())
}

/// Time from full speed to rest, s.
fn stop_time(v: &Value<'_>) -> Result<f64> {
    let time_s = v.positive()?;
    if time_s > MAX_STOP_TIME_S {
        let what = format!("is {time_s} s: no robot brakes for that long");
        return Err(v.error(what).hint(format!("stop_time = 0.5   (at most {MAX_STOP_TIME_S})")));
    }
    Ok(time_s)
}

/// Rates: one number for all joints, or a list with one per joint.
fn rates(v: &Value<'_>, chain: &Chain, units: Units) -> Result<Vec<f64>> {
    let values = per_joint(v, chain, Value::positive)?;
    if let Some(value) = values.iter().find(|x| **x > MAX_RATE) {
        return Err(v.error(format!("has {value:e}: no joint is that fast")).hint(format!("at most {MAX_RATE:e}")));
    }
    Ok(values.iter().zip(prismatic(chain)).map(|(x, prismatic)| units.joint(prismatic, *x)).collect())
}

/// Tolerated overshoots of the joint limits, rad or m: one number for all joints, or a list with one per joint.
fn overshoot(v: &Value<'_>, chain: &Chain, units: Units) -> Result<Vec<f64>> {
    let values = per_joint(v, chain, Value::not_negative)?;
    let joints = values.iter().zip(prismatic(chain)).zip(chain.active_joints());
    let tolerance = |((x, prismatic), id): ((&f64, bool), &JointId)| {
        let value = units.joint(prismatic, *x);
        if value <= MAX_OVERSHOOT {
            return Ok(value);
        }
        let [is, most] = [value, MAX_OVERSHOOT].map(|x| units.show_joint(prismatic, x));
        let what = format!(
            "lets joint \"{}\" overshoot its limits by {is}: a reading in another unit would pass",
            chain.joints()[id.0].name
        );
        Err(v.error(what).hint(format!("at most {most}; a controller overshoots by less than a tenth of that")))
    };
    joints.map(tolerance).collect()
}

/// Whether each independent joint of a chain is prismatic.
fn prismatic(chain: &Chain) -> impl Iterator<Item = bool> {
    chain.active_joints().iter().map(|id| chain.joints()[id.0].kind == JointKind::Prismatic)
}

/// One number for all joints, or a list with one per joint; in the file's units.
fn per_joint<'a>(v: &Value<'a>, chain: &Chain, read: fn(&Value<'a>) -> Result<f64>) -> Result<Vec<f64>> {
    let values = if v.is_list() {
        v.list("[…]")?.iter().map(read).collect::<Result<Vec<_>>>()?
    } else {
        vec![read(v)?; chain.dof()]
    };
    if values.len() != chain.dof() {
        let what = format!("has {} values for {} joints", values.len(), chain.dof());
        return Err(v.error(what).hint("one number for all joints, or a list with one per joint"));
    }
    Ok(values)
}
