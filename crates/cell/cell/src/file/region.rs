//! `[region.NAME]`, `[fence.NAME]` and `[encoder.NAME]`.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_monitor::{Guards, Life, Region, RegionKind, SlotId, SourceLimits};
use elbowroom_proximity::surroundings::surroundings;
use elbowroom_proximity::{ConvexHull, Shape};
use elbowroom_robot::RobotId;
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::definitions::{Definitions, robot_id};
use super::mechanism::{self, NOT_GUARDED};
use super::schema::{ENCODER, FENCE, REGION, REGION_SHAPES, names};
use super::{fence, follow, models};
use crate::cell::guarded;
use crate::{Cell, CellRegion, Encoder, Follow, MeasuredSource, RegionSolid, Travel, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Largest warning zone and hysteresis, m.
const MAX_M: f64 = 10_000.0;
/// Thickness above which a warning zone causes a warning, m.
const LARGE_WARNING_M: f64 = 10.0;
/// The thinnest warning zone of an exchange region, m.
const MIN_EXCHANGE_WARNING_M: f64 = 1e-3;
/// Hysteresis above which a warning is issued, m.
const LARGE_HYSTERESIS_M: f64 = 1.0;
/// Thickness of the wall around a solid that robots must not leave, m: no robot gets through it.
pub(super) const SURROUNDINGS_M: f64 = 50.0;
/// By how much the inside of a curved region is smaller than the region, at most, m.
const CHORD_ERROR_M: f64 = 1e-3;
/// Keys of a region that a fence does not have: it is a solid of its own in the world.
const NOT_OF_A_FENCE: [&str; 5] = ["shape", "rpy", "quaternion", "keep", "follow"];

/// A table that describes a region.
pub(super) struct RegionTable<'t> {
    name: &'t str,
    pub table: Table<'t>,
    is_fence: bool,
}

/// The tables of all regions, in the order of the cell's: `[region.NAME]`, then `[fence.NAME]`.
pub(super) fn tables<'t>(root: &Table<'t>) -> Result<Vec<RegionTable<'t>>> {
    let mut tables: Vec<RegionTable<'t>> = Vec::new();
    for (word, is_fence) in [("region", false), ("fence", true)] {
        for (name, table) in root.named(word)? {
            if let Some(first) = tables.iter().find(|first| first.name == name) {
                let line = first.table.line;
                let what = format!("a fence is a region, and \"{name}\" is the name of the one in line {line}");
                return Err(table.error(what).hint("another name for one of them"));
            }
            tables.push(RegionTable { name, table, is_fence });
        }
    }
    Ok(tables)
}

impl RegionTable<'_> {
    pub fn read(
        &self,
        units: Units,
        known: &mut Definitions<'_>,
        warnings: &mut Vec<Diagnostic>,
    ) -> Result<CellRegion> {
        let (region, solid) = if self.is_fence {
            walls(self.name, &self.table, units)?
        } else {
            (solid(self.name, &self.table, units)?, RegionSolid::Shape)
        };
        read(region, solid, &self.table, units, known, warnings)
    }
}

/// Reads what a table says of its region beside the solid.
fn read(
    mut region: Region,
    mut solid: RegionSolid,
    t: &Table<'_>,
    units: Units,
    known: &mut Definitions<'_>,
    warnings: &mut Vec<Diagnostic>,
) -> Result<CellRegion> {
    region.kind = kind(t)?;
    region.life = t
        .get("life")
        .map_or(Ok(Life::Permanent), |v| v.word(&[("permanent", Life::Permanent), ("temporary", Life::Temporary)]))?;
    region.warning_m = t.get("warning").map_or(Ok(0.0), |v| thickness(&v, units, LARGE_WARNING_M, warnings))?;
    region.guards = t.get("guards").map_or(Ok(Guards::ARM), |v| guards(&v))?;
    if let Some(v) = t.get("hysteresis") {
        region.hysteresis_m = thickness(&v, units, LARGE_HYSTERESIS_M, warnings)?;
    }
    let channel = |key: &str| t.get(key).map(|v| v.whole(0, 63).map(|c| c as u8)).transpose();
    region.output = channel("output")?;
    region.warning_output = channel("warning_output")?;
    check_warning(t, &region, warnings)?;
    let followed = t.get("follow").map(|v| follow::read(&v, units, known, warnings)).transpose()?;
    if let Some(v) = t.get("keep").filter(|_| is_inside(t)) {
        if let Some(kept_in) = kept_inside(&mut region, &v)? {
            solid = RegionSolid::AllBut(kept_in);
        }
        let moves = t.get("follow").filter(|_| matches!(region.shape, Shape::Mesh(_)));
        if let Some(follow) = moves {
            let what = "moves a region that keeps robots inside of it";
            return Err(follow.error(what).hint("keep = \"outside\", or a region that does not move"));
        }
    }
    let (follow, source_limits) = followed.map_or((None, SourceLimits::default()), |(f, l)| (Some(f), l));
    let robots = robots(t, known, follow)?;
    Ok(CellRegion { region, line: t.line, robots, follow, source_limits, solid })
}

/// A thickness or a hysteresis: beyond `plausible` metres it causes a warning, beyond [`MAX_M`] an error.
fn thickness(v: &Value<'_>, units: Units, plausible: f64, warnings: &mut Vec<Diagnostic>) -> Result<f64> {
    let metres = units.not_negative_length(v)?;
    let shown = units.show_length(metres);
    if metres > MAX_M {
        let what = format!("is {shown}: no cell is that large");
        return Err(v.error(what).hint(format!("a length up to {}", units.show_length(plausible))));
    }
    if metres > plausible {
        let meant = if units.length == LengthUnit::Metre && metres < MAX_M {
            format!("; in mm it would be {} m", metres / 1000.0)
        } else {
            String::new()
        };
        let what = format!("`{}` is {shown}, more than any robot needs{meant}", v.name);
        let hint = format!("units = {{ length = \"mm\", … }}, or a length up to {}", units.show_length(plausible));
        warnings.push(Diagnostic::new(v.file, v.line, what).hint(hint));
    }
    Ok(metres)
}

fn check_warning(t: &Table<'_>, region: &Region, warnings: &mut Vec<Diagnostic>) -> Result<()> {
    let name = &region.name;
    match region.kind {
        // A robot without the grant stops half a millimetre before the border, and must have requested the grant by
        // then.
        RegionKind::Exchange { .. } if region.warning_m < MIN_EXCHANGE_WARNING_M => Err(t
            .error(format!(
                "region \"{name}\" is an exchange region: robots request it in its warning zone, so it needs one of 1 mm \
                 or more"
            ))
            .hint("warning = 250")),
        RegionKind::Forbidden if region.warning_m <= 0.0 => {
            let what = format!("region \"{name}\" has no warning zone: robots stop only when they touch it");
            warnings.push(Diagnostic::new(t.file, t.line, what).hint("warning = 250"));
            Ok(())
        }
        _ => Ok(()),
    }
}

fn is_inside(t: &Table<'_>) -> bool {
    t.get("keep").is_some_and(|v| v.text().is_ok_and(|word| word == "inside"))
}

/// Turns a region around: what was inside is free, and everything else is the region. Returns the solid that is free;
/// `None` for a plane, which is still one.
fn kept_inside(region: &mut Region, v: &Value<'_>) -> Result<Option<Shape>> {
    if matches!(region.kind, RegionKind::Exchange { .. }) {
        return Err(v
            .error("does not suit an exchange region, into which robots go one by one")
            .hint("keep = \"outside\""));
    }
    if matches!(region.shape, Shape::HalfSpace(_)) {
        let turned_over = Pose::new(Rotation::from_rpy(std::f64::consts::PI, 0.0, 0.0), Vec3::ZERO);
        region.shape_in_anchor = region.shape_in_anchor * turned_over;
        return Ok(None);
    }
    let wall = surroundings(&region.shape, CHORD_ERROR_M, SURROUNDINGS_M).map_err(|e| {
        v.error(format!("\"inside\" of the region: {e}")).hint("a closed mesh, or shape = \"convex\" for its hull")
    })?;
    Ok(Some(std::mem::replace(&mut region.shape, Shape::Mesh(wall.into()))))
}

fn walls(name: &str, t: &Table<'_>, units: Units) -> Result<(Region, RegionSolid)> {
    let common = REGION.iter().filter(|key| !NOT_OF_A_FENCE.contains(&key.name)).map(|key| key.name);
    t.only(&common.chain(names(&[FENCE])).collect::<Vec<_>>())?;
    fence::solid(name, t, units)
}

fn solid(name: &str, t: &Table<'_>, units: Units) -> Result<Region> {
    let shape = t.need("shape", "shape = \"cylinder\"   (or sphere, plane, box, capsule, mesh, convex)")?;
    let words: Vec<_> = REGION_SHAPES.iter().map(|s| (s.word, s)).collect();
    let own = shape.word(&words)?;
    t.only(&names(&[REGION, own.keys]))?;
    t.get("keep").map_or(Ok(()), |v| v.word(&[("outside", ()), ("inside", ())]))?;
    let rotation = units.rotation(t)?;
    let point = |key: &str| units.point(&t.need(key, &format!("{key} = [900, 0, 0]"))?);
    let radius = || units.positive_length(&t.need("radius", "radius = 150")?);
    let height = || units.positive_length(&t.need("height", "height = 1200")?);
    match own.word {
        "sphere" => {
            let centre = if t.get("center").is_some() { "center" } else { "centre" };
            Ok(Region::sphere(name, point(centre)?, radius()?))
        }
        "cylinder" => Ok(Region::cylinder(name, point("base")?, radius()?, height()?, rotation)),
        "plane" => {
            let mut plane = Region::plane(name, point("origin")?, point("x")?, point("y")?).map_err(|e| {
                t.error(format!("`{}`: {e}", t.name)).hint("origin, x and y: three points that are not on one line")
            })?;
            plane.anchor.rotation = rotation * plane.anchor.rotation;
            Ok(plane)
        }
        "box" => cuboid(name, t, units),
        "capsule" => {
            let (half_length, radius) = (height()? / 2.0, radius()?);
            let shape = Shape::Capsule(elbowroom_proximity::Capsule { half_length, radius });
            Ok(Region::solid(name, shape, units.place(t)?))
        }
        _ => {
            let (solid, pose) = units.mesh(t, "mesh")?;
            let solid = if own.word == "convex" { hull(t, &solid)? } else { solid };
            Ok(Region::solid(name, solid, pose))
        }
    }
}

fn hull(t: &Table<'_>, solid: &Shape) -> Result<Shape> {
    let Shape::Mesh(mesh) = solid else { return Ok(solid.clone()) };
    ConvexHull::from_points(mesh.vertices())
        .map(|h| Shape::Hull(h.into()))
        .map_err(|e| t.error(format!("`{}`: the mesh has no convex hull: {e}", t.name)))
}

fn cuboid(name: &str, t: &Table<'_>, units: Units) -> Result<Region> {
    let rotation = units.rotation(t)?;
    if t.get("base").is_some() || t.get("size").is_some() {
        if let Some(v) = t.get("from").or_else(|| t.get("to")) {
            return Err(v.error("contradicts `base` and `size`").hint("either from and to, or base and size"));
        }
        let base = units.point(&t.need("base", "base = [900, 0, 0]")?)?;
        return Ok(Region::cuboid(name, base, units.size(&t.need("size", "size = [600, 400, 700]")?)?, rotation));
    }
    let from = units.point(&t.need("from", "from = [500, -200, 0]   (or: base and size)")?)?;
    let to = t.need("to", "to = [1100, 200, 700]")?;
    let mut region = Region::cuboid_from_corners(name, from, units.point(&to)?);
    let extent = (units.point(&to)? - from).abs();
    if extent.min_element() <= 0.0 {
        return Err(to
            .error("lies on a face with `from`: the box has no volume")
            .hint("two corners that differ in x, y and z"));
    }
    region.anchor.rotation = rotation;
    Ok(region)
}

fn kind(t: &Table<'_>) -> Result<RegionKind> {
    let exchange = RegionKind::Exchange { slot: SlotId(0) };
    let monitored = RegionKind::Monitored { slow_to: None };
    let kind = t.get("kind").map_or(Ok(RegionKind::Forbidden), |v| {
        v.word(&[("forbidden", RegionKind::Forbidden), ("monitored", monitored), ("exchange", exchange)])
    })?;
    let Some(slow_to) = t.get("slow_to") else { return Ok(kind) };
    match kind {
        RegionKind::Monitored { .. } => Ok(RegionKind::Monitored { slow_to: Some(slow_to.percent()?) }),
        _ => Err(slow_to.error("requires a monitored region; this one is not").hint("kind = \"monitored\"")),
    }
}

fn guards(v: &Value<'_>) -> Result<Guards> {
    const EXAMPLE: &str = "guards = [\"arm\"]   (any of \"tcp\", \"tool\", \"arm\")";
    let list = v.list(EXAMPLE)?;
    if list.is_empty() {
        return Err(v.error("is empty: the region would guard nothing").hint(EXAMPLE));
    }
    let mut guards = Guards { tcp: false, tool: false, arm: false };
    for item in &list {
        match item.word(&[("tcp", 0), ("tool", 1), ("arm", 2)])? {
            0 => guards.tcp = true,
            1 => guards.tool = true,
            _ => guards.arm = true,
        }
    }
    Ok(guards)
}

fn robots(t: &Table<'_>, known: &Definitions<'_>, follow: Option<Follow>) -> Result<Vec<RobotId>> {
    let followed = match follow {
        Some(Follow::Robot { robot, .. }) => Some(robot),
        _ => None,
    };
    let Some(v) = t.get("robots") else {
        return Ok(guarded(known.robots).filter(|r| Some(*r) != followed).collect());
    };
    let list = v.list("robots = [\"r1\"]")?;
    if list.is_empty() {
        return Err(v.error("is empty: the region would apply to no robot").hint("leave it out for all robots"));
    }
    let mut robots = Vec::new();
    for item in &list {
        let robot = robot_id(item, known.robots)?;
        mechanism::refuse(item, &known.robots[robot.0], NOT_GUARDED)?;
        if Some(robot) == followed {
            let what = "names the robot that the region follows: it would stop itself";
            return Err(item.error(what).hint("the other robots only, or leave `robots` out"));
        }
        if robots.contains(&robot) {
            return Err(item.error("is named twice").hint("each robot once"));
        }
        robots.push(robot);
    }
    Ok(robots)
}

pub(super) fn read_encoders(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    let sources = &mut cell.frame_sources;
    for (index, (name, t)) in root.named("encoder")?.into_iter().enumerate() {
        sources.encoders.push(encoder(name, &t, cell.units)?);
        if t.flag_or("measured", false)? {
            sources.measured.push(MeasuredSource::Encoder(index));
        }
    }
    Ok(())
}

fn encoder(name: &str, t: &Table<'_>, units: Units) -> Result<Encoder> {
    t.only(&names(&[ENCODER]))?;
    let direction = t.get("direction").map_or(Ok(Vec3::X), |v| {
        v.three()?.try_normalize().ok_or_else(|| v.error("has no length").hint("direction = [1, 0, 0]"))
    })?;
    let wrap_m = t.get("wrap").map(|v| units.positive_length(&v)).transpose()?;
    let travel = match (t.get("file"), t.get("speed")) {
        (Some(_), Some(speed)) => {
            return Err(speed.error("contradicts `file`").hint("one of the two: speed or file"));
        }
        (Some(file), None) => {
            if let Some(v) = ["at", "start", "end"].iter().find_map(|k| t.get(k)) {
                return Err(v.error("belongs to `speed`; the file gives times and travel").hint("leave it out"));
            }
            Travel::Table(models::travel(&file)?)
        }
        (None, speed) => {
            let speed = speed.map_or_else(
                || t.need("speed", "speed = 200   (length units per second; or: file = \"belt.csv\")"),
                Ok,
            )?;
            let start = t.get("start");
            let start_s = start.map_or(Ok(0.0), |v| v.not_negative())?;
            let end_s = t.get("end").map_or(Ok(f64::INFINITY), |v| v.not_negative())?;
            if end_s < start_s {
                return Err(t.error(format!("`{}` ends before it starts", t.name)).hint("start = 0, end = 10"));
            }
            let at_m = t.get("at").map_or(Ok(0.0), |v| units.length_of(&v))?;
            Travel::Constant { at_m, speed: units.length_of(&speed)?, start_s, end_s }
        }
    };
    Ok(Encoder { name: name.to_owned(), direction, travel, wrap_m })
}
