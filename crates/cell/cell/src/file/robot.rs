//! `[robot.NAME]`.

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_kinematics::dh::ClassicalRow;
use elbowroom_kinematics::{Chain, JointKind, Limits};
use elbowroom_proximity::Shape;
use elbowroom_robot::{Collider, Robot, RobotId};
use elbowroom_spatial::Pose;

use super::models::{self, RobotModels};
use super::schema::{self, names};
use super::{flange, joint_limits, mechanism, tools};
use crate::{CellRobot, Payload, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

pub(super) fn read(
    name: &str,
    t: &Table<'_>,
    units: Units,
    models: &mut RobotModels,
    warnings: &mut Vec<Diagnostic>,
) -> Result<CellRobot> {
    t.only(&names(&[schema::ROBOT]))?;
    let volumes = mechanism::volumes(name, t)?;
    let mut robot = model(t, units, models, warnings)?;
    if let Some(v) = t.get("ignore") {
        ignore(&v, &mut robot)?;
    }
    let mut flange = if volumes.is_some() { flange::read(name, t, &robot.chain, warnings)? } else { robot.chain.tip() };
    let base_in_world = t.get("base").map_or(Ok(Pose::IDENTITY), |v| units.pose(&v))?;
    let (mut tcp_in_flange, tool) =
        t.get("tool").map_or(Ok((Pose::IDENTITY, None)), |v| tool(&v.table(TOOL)?, units))?;
    let load = t.get("load").map(|v| solid(&v, units, "load")).transpose()?;
    robot.colliders[flange.0].extend(tool.iter().chain(&load).cloned());
    let tools = tools::read(t, &mut robot, flange, units, self::tool)?;
    if let Some(active) = tools.iter().find(|t| t.mounted) {
        (flange, tcp_in_flange) = (active.link, active.tcp_in_link);
    }
    let start = start(name, t, &robot.chain, units, warnings)?;
    let limits = joint_limits::read(name, t, &robot.chain, units, warnings)?;
    let states = states(t, &robot.chain, &start, units)?;
    joint_limits::set_plausible(t, &mut robot.chain, &limits, units)?;
    Ok(CellRobot {
        name: name.to_owned(),
        line: t.line,
        base_in_world,
        flange,
        tcp_in_flange,
        payload: Payload { tool, load, tools },
        start,
        start_given: t.get("start").is_some(),
        states,
        volumes,
        limits,
        program: None,
        avoidance: None,
        map: None,
        robot,
    })
}

/// Adds pairs of links that are never tested.
fn ignore(v: &Value<'_>, robot: &mut Robot) -> Result<()> {
    const EXAMPLE: &str = "ignore = [[\"link_4\", \"link_6\"]]";
    for pair in v.list(EXAMPLE)? {
        let names = pair.list(EXAMPLE)?;
        let [a, b] = &names[..] else {
            return Err(pair.error(format!("names {} links, not two", names.len())).hint(EXAMPLE));
        };
        let link = |v: &Value<'_>| {
            let name = v.text()?;
            robot.chain.link(name).ok_or_else(|| {
                v.error(format!("names the link \"{name}\", which the robot does not have"))
                    .hint(suggest::hint(name, robot.chain.links().iter().map(String::as_str)))
            })
        };
        let (one, other) = (link(a)?, link(b)?);
        if one == other {
            return Err(pair.error("names one link twice").hint(EXAMPLE));
        }
        robot.disabled_pairs.push((one, other, "ignored in the cell file".into()));
    }
    Ok(())
}

fn model(t: &Table<'_>, units: Units, models: &mut RobotModels, warnings: &mut Vec<Diagnostic>) -> Result<Robot> {
    let example =
        "model = \"arm.urdf\"   (or: dh = [{ a = 300, alpha = 90, d = 600, theta = 0, min = -180, max = 180 }, …])";
    match (t.get("model"), t.get("dh")) {
        (Some(model), Some(_)) => Err(model.error("contradicts `dh`").hint("one of the two: model or dh")),
        (Some(file), None) => {
            if let Some(v) = t.get("links").or_else(|| t.get("base_link")) {
                return Err(v.error("belongs to `dh`; a model has its own solids").hint("leave it out"));
            }
            models.robot(&file, t, warnings)
        }
        (None, Some(dh)) => {
            if let Some(v) = ["joints", "unit"].iter().find_map(|key| t.get(key)) {
                return Err(v.error("belongs to `model`, not to `dh`").hint("leave it out"));
            }
            let mut robot = dh_robot(t, &dh, units)?;
            if let Some(srdf) = t.get("srdf") {
                models::srdf(&srdf, &mut robot, warnings)?;
            }
            Ok(robot)
        }
        (None, None) => Err(t.need("model", example).err().unwrap_or_else(|| t.error("no model"))),
    }
}

fn dh_robot(t: &Table<'_>, dh: &Value<'_>, units: Units) -> Result<Robot> {
    let rows = dh.list("dh = [{ a = 300, alpha = 90, d = 600, theta = 0, min = -180, max = 180 }]")?;
    if rows.is_empty() || rows.len() > 64 {
        return Err(dh.error(format!("has {} rows", rows.len())).hint("1 to 64 rows, one per joint"));
    }
    let rows = rows.iter().enumerate().map(|(i, v)| dh_row(i, v, units)).collect::<Result<Vec<_>>>()?;
    let chain = Chain::from_dh(t.name.rsplit('.').next().unwrap_or("robot"), &rows)
        .map_err(|e| dh.error(format!("is not a valid chain: {e}")))?;
    let mut robot = Robot::new(chain);
    if let Some(base) = t.get("base_link") {
        robot.colliders[robot.chain.root().0] = solids(&base, units, "base_link")?;
    }
    let Some(links) = t.get("links") else { return Ok(robot) };
    let entries = links.list("links = [{ capsule = { from = [0, 0, 0], to = [0, 0, 400], radius = 60 } }, …]")?;
    if entries.len() != rows.len() {
        let what = format!("has {} entries for {} rows of `dh`", entries.len(), rows.len());
        return Err(links.error(what).hint("one entry per row, [] for a row without solids"));
    }
    for (i, entry) in entries.iter().enumerate() {
        let name = format!("link_{}", i + 1);
        let Some(link) = robot.chain.link(&name) else { continue };
        robot.colliders[link.0] = solids(entry, units, &name)?;
    }
    Ok(robot)
}

fn dh_row(index: usize, v: &Value<'_>, units: Units) -> Result<ClassicalRow> {
    let t = v.table("{ a = 300, alpha = 90, d = 600, theta = 0, min = -180, max = 180, speed = 170 }")?;
    t.only(&names(&[schema::DH_ROW]))?;
    let prismatic = t.get("kind").map_or(Ok(false), |k| k.word(&[("revolute", false), ("prismatic", true)]))?;
    let length = |key: &str| t.get(key).map_or(Ok(0.0), |v| units.length_of(&v));
    let angle = |key: &str| t.get(key).map_or(Ok(0.0), |v| v.number().map(|x| units.joint(false, x)));
    let bound = |key: &str| t.get(key).map(|v| v.number().map(|x| units.joint(prismatic, x))).transpose();
    let rate = |key: &str| t.get(key).map(|v| v.positive().map(|x| units.joint(prismatic, x))).transpose();
    let (kind, lower, upper) = match (prismatic, bound("min")?, bound("max")?) {
        (_, Some(min), Some(max)) if min >= max => {
            return Err(t.error(format!("`{}`: min is not below max", t.name)).hint("min = -180, max = 180"));
        }
        (true, Some(min), Some(max)) => (JointKind::Prismatic, min, max),
        (false, Some(min), Some(max)) => (JointKind::Revolute, min, max),
        (false, None, None) => (JointKind::Continuous, f64::NEG_INFINITY, f64::INFINITY),
        (true, ..) => {
            return Err(t
                .error(format!("`{}` is prismatic: it needs min and max", t.name))
                .hint("min = 0, max = 1000"));
        }
        _ => {
            return Err(t
                .error(format!("`{}` has one bound", t.name))
                .hint("both min and max, or neither for a continuous joint"));
        }
    };
    let joint = match t.get("name") {
        Some(v) => v.text()?.to_owned(),
        None => format!("joint_{}", index + 1),
    };
    let limits =
        Limits { velocity: rate("speed")?, acceleration: rate("acceleration")?, ..Limits::range(lower, upper) };
    Ok(ClassicalRow {
        joint,
        kind,
        a: length("a")?,
        alpha: angle("alpha")?,
        d: length("d")?,
        theta: angle("theta")?,
        limits,
    })
}

fn solids(v: &Value<'_>, units: Units, name: &str) -> Result<Vec<Collider>> {
    if v.is_list() {
        return v.list("[]")?.iter().map(|s| solid(s, units, name)).collect();
    }
    let empty = v.table("{ capsule = { … } }")?.entries.is_empty();
    if empty { Ok(Vec::new()) } else { solid(v, units, name).map(|b| vec![b]) }
}

/// `{ capsule = { … } }`, or box, sphere, cylinder, mesh.
fn solid(v: &Value<'_>, units: Units, name: &str) -> Result<Collider> {
    const EXAMPLE: &str = "{ capsule = { from = [0, 0, 0], to = [0, 0, 400], radius = 60 } }";
    let t = v.table(EXAMPLE)?;
    t.only(&schema::SOLIDS.iter().map(|s| s.word).collect::<Vec<_>>())?;
    let mut kinds = t.each();
    let (Some((kind, inner)), None) = (kinds.next(), kinds.next()) else {
        return Err(v.error("must be exactly one of box, sphere, cylinder, capsule, mesh").hint(EXAMPLE));
    };
    let (shape, in_link) = named_solid(kind, &inner, &t, units)?;
    Ok(Collider { name: name.to_owned(), shape, in_link })
}

fn named_solid(kind: &str, inner: &Value<'_>, outer: &Table<'_>, units: Units) -> Result<(Shape, Pose)> {
    if kind == "mesh" && !inner.is_table() {
        return units.mesh(outer, "mesh");
    }
    let t = inner.table("{ at = [0, 0, 0], … }")?;
    let own = schema::SOLIDS.iter().filter(|solid| solid.word == kind).flat_map(|solid| names(&[solid.keys]));
    t.only(&names(&[schema::POSE]).into_iter().chain(own).collect::<Vec<_>>())?;
    match kind {
        "box" => units.cuboid(&t),
        "sphere" => units.sphere(&t),
        "cylinder" => units.cylinder(&t),
        "capsule" => units.capsule(&t),
        _ => units.mesh(&t, "file"),
    }
}

const TOOL: &str = "tcp = { at = [0, 0, 250], rpy = [0, 0, 0] }";

fn tool(t: &Table<'_>, units: Units) -> Result<(Pose, Option<Collider>)> {
    t.only(&names(&[schema::TOOL]))?;
    if let (None, Some(v)) = (t.get("mesh"), ["at", "rpy", "quaternion", "mesh_unit"].iter().find_map(|k| t.get(k))) {
        return Err(v
            .error("places the tool's mesh, but there is none")
            .hint("box = { at = [0, 0, 125], size = [80, 80, 250] }"));
    }
    let tcp = t.get("tcp").map_or(Ok(Pose::IDENTITY), |v| units.pose(&v))?;
    let collider = |(shape, in_link)| Some(Collider { name: "tool".into(), shape, in_link });
    match (t.get("box"), t.get("mesh")) {
        (Some(_), Some(mesh)) => Err(mesh.error("contradicts `box`").hint("one of the two: box or mesh")),
        (Some(cuboid), None) => Ok((tcp, collider(named_solid("box", &cuboid, t, units)?))),
        (None, Some(mesh)) => Ok((tcp, collider(named_solid("mesh", &mesh, t, units)?))),
        (None, None) => Ok((tcp, None)),
    }
}

/// Named configurations: `home = [0, -20, 90, 0, 40, 0]`, and states of the SRDF with other names.
fn states(t: &Table<'_>, chain: &Chain, start: &[f64], units: Units) -> Result<Vec<(String, Vec<f64>)>> {
    let mut states: Vec<(String, Vec<f64>)> = Vec::new();
    if let Some(v) = t.get("states") {
        let named = v.table("states = { home = [0, -20, 90, 0, 40, 0] }")?;
        for (name, v) in named.each() {
            states.push((name.to_owned(), joint_values(&v, chain, units)?));
        }
    }
    if let Some(v) = t.get("srdf") {
        for (name, q) in models::srdf_states(&v, chain, start)? {
            if !states.iter().any(|(known, _)| *known == name) {
                states.push((name, q));
            }
        }
    }
    Ok(states)
}

/// Joint values in the file's units, checked against the number of joints and their limits.
pub(super) fn joint_values(v: &Value<'_>, chain: &Chain, units: Units) -> Result<Vec<f64>> {
    let zeros = vec!["0"; chain.dof()].join(", ");
    let raw = v.numbers(&format!("[{zeros}]"))?;
    let names =
        || chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect::<Vec<_>>().join(", ");
    if raw.len() != chain.dof() {
        let what = format!("has {} values for the {} joints of \"{}\"", raw.len(), chain.dof(), chain.name());
        return Err(v.error(what).hint(format!("one value per joint, in this order: {}", names())));
    }
    let mut q = Vec::with_capacity(raw.len());
    for (raw, id) in raw.iter().zip(chain.active_joints()) {
        let joint = &chain.joints()[id.0];
        let prismatic = joint.kind == JointKind::Prismatic;
        let value = units.joint(prismatic, *raw);
        if !joint.limits.contains(value, 1e-9) {
            let [is, low, high] =
                [value, joint.limits.lower, joint.limits.upper].map(|x| units.show_joint(prismatic, x));
            let what = format!("brings joint \"{}\" to {is}, outside its limits", joint.name);
            return Err(v.error(what).hint(format!("a value from {low} to {high}")));
        }
        q.push(value.max(joint.limits.lower).min(joint.limits.upper));
    }
    Ok(q)
}

fn start(name: &str, t: &Table<'_>, chain: &Chain, units: Units, warnings: &mut Vec<Diagnostic>) -> Result<Vec<f64>> {
    let clamped: Vec<f64> = chain.lower().iter().zip(chain.upper()).map(|(lo, hi)| 0.0_f64.max(*lo).min(hi)).collect();
    if let Some(v) = t.get("start") {
        return match v.text() {
            Ok(state) => start_state(name, &v, state, &states(t, chain, &clamped, units)?),
            Err(_) => joint_values(&v, chain, units),
        };
    }
    if clamped.iter().any(|v| *v != 0.0) {
        let what =
            format!("robot \"{name}\" has no `start`, and 0 lies outside its limits: it starts at the nearest limit");
        warnings.push(
            Diagnostic::new(t.file, t.line, what).hint(format!("start = [{}]", vec!["…"; clamped.len()].join(", "))),
        );
    }
    Ok(clamped)
}

/// The named state in which a robot starts.
fn start_state(robot: &str, v: &Value<'_>, state: &str, states: &[(String, Vec<f64>)]) -> Result<Vec<f64>> {
    states.iter().find(|(name, _)| name == state).map(|(_, q)| q.clone()).ok_or_else(|| {
        let known = states.iter().map(|(name, _)| name.as_str());
        v.error(format!("names the state \"{state}\", which robot \"{robot}\" does not have"))
            .hint(suggest::hint(state, known))
    })
}

/// The robot that a table `[map.NAME]` or `[program.NAME]` refers to.
pub(super) fn robot_of<'a>(name: &str, t: &Table<'_>, robots: &'a [CellRobot]) -> Result<(RobotId, &'a CellRobot)> {
    let mut all = robots.iter().enumerate().map(|(i, r)| (RobotId(i), r));
    all.find(|(_, r)| r.name == name).ok_or_else(|| {
        t.error(format!("`{}` refers to the robot \"{name}\", which is not in this cell", t.name))
            .hint(suggest::hint(name, robots.iter().map(|r| r.name.as_str())))
    })
}
