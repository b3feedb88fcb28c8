//! `[fixture.NAME]` with `guide`: where a hand is kept, or where the shaft of a tool enters.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_shared_control::Guide;
use elbowroom_spatial::Vec3;

use super::fixture_tool::{TOOL, tool};
use super::schema::{GUIDE, names};
use crate::fixture::CellGuide;
use crate::{Cell, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const DEPTH: &str = "depth = [10, 80]   (least and most length of the shaft beyond the point)";
const POINTS: &str = "points = [[1000, 0, 1240], [1030, 60, 1240]]   (in the world)";

/// The words of `guide`, each with the keys of its geometry.
const SHAPES: &[(&str, &[&str])] = &[
    ("line", &["points", "tolerance"]),
    ("tube", &["points", "radius", "tolerance"]),
    ("plane", &["at", "normal"]),
    ("cone", &["at", "axis", "half_angle"]),
    ("entry", &["at", "axis", "radius", "depth"]),
];

pub(super) fn read(name: &str, t: &Table<'_>, cell: &Cell) -> Result<CellGuide> {
    t.only(&names(&[GUIDE]))?;
    let word = t.need("guide", "guide = \"line\"")?;
    let words: Vec<(&str, usize)> = SHAPES.iter().enumerate().map(|(i, (word, _))| (*word, i)).collect();
    let (shape, keys) = SHAPES[word.word(&words)?];
    let article = if shape == "entry" { "an" } else { "a" };
    let all = SHAPES.iter().flat_map(|(_, keys)| *keys);
    if let Some(v) = all.filter(|key| !keys.contains(key)).find_map(|key| t.get(key)) {
        return Err(v
            .error(format!("does not belong to {article} {shape}"))
            .hint(format!("{article} {shape} has {}", keys.join(", "))));
    }
    let tool_value = t.need("tool", TOOL)?;
    let tool = tool(&tool_value, cell)?;
    let active = t.flag_or("active", true)?;
    let others = &cell.guidance.guides;
    if let Some(other) = others.iter().find(|g| active && g.active && g.tool == tool) {
        let what = format!("is kept by the guide \"{}\" already", other.name);
        return Err(tool_value.error(what).hint("one guide that is `active` per tool"));
    }
    let guide = guide(shape, t, cell)?.map_err(|e| word.error(e.to_string()))?;
    Ok(CellGuide { name: name.to_owned(), line: t.line, guide, tool, active })
}

/// The guide, or why its numbers do not make one.
fn guide(
    shape: &str,
    t: &Table<'_>,
    cell: &Cell,
) -> Result<std::result::Result<Guide, elbowroom_shared_control::NavigatorError>> {
    let units = cell.units;
    let at = || units.point(&t.need("at", "at = [1000, 0, 1240]   (in the world)")?);
    Ok(match shape {
        "plane" => Guide::plane(at()?, t.need("normal", "normal = [0, 0, 1]")?.three()?),
        "cone" => {
            let half_angle = t.need("half_angle", "half_angle = 20")?;
            let half_angle_rad = units.angle.to_radians(half_angle.not_negative()?);
            if half_angle_rad.to_degrees() >= 90.0 {
                return Err(half_angle.error("is not below 90°").hint("half_angle = 20   (degrees)"));
            }
            Guide::cone(at()?, t.need("axis", "axis = [0, 0, -1]")?.three()?, half_angle_rad)
        }
        "entry" => {
            let axis = t.get("axis").map_or(Ok(Vec3::Z), |v| v.three())?;
            let radius_m = t.get("radius").map_or(Ok(0.0), |v| units.not_negative_length(&v))?;
            let depth_m = t.get("depth").map_or(Ok((f64::NEG_INFINITY, f64::INFINITY)), |v| depth(&v, units))?;
            Guide::entry(at()?, axis, radius_m, depth_m)
        }
        _ => {
            let points = t.need("points", POINTS)?.list(POINTS)?;
            let points = points.iter().map(|v| units.point(v)).collect::<Result<Vec<Vec3>>>()?;
            let radius_m = match shape {
                "tube" => units.positive_length(&t.need("radius", "radius = 5")?)?,
                _ => 0.0,
            };
            let tolerance_m = t.get("tolerance").map_or(Ok(0.5e-3), |v| units.positive_length(&v))?;
            Guide::path(points, radius_m, tolerance_m)
        }
    })
}

/// Least and most length of a shaft beyond its point of entry, metres.
fn depth(v: &Value<'_>, units: Units) -> Result<(f64, f64)> {
    let list = v.list(DEPTH)?;
    let [least, most] = &list[..] else {
        return Err(v.error(format!("has {} lengths", list.len())).hint(DEPTH));
    };
    let (least_m, most_m) = (units.length_of(least)?, units.length_of(most)?);
    if least_m >= most_m {
        return Err(v.error("is not from a smaller to a larger length").hint(DEPTH));
    }
    Ok((least_m, most_m))
}
