//! The walls of `[fence.NAME]`.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_monitor::Region;
use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;
use elbowroom_vision::Point2;

use super::schema::{GATE, names};
use super::sensor::two;
use crate::fence::{Fence, FenceError, Gate, mesh_of_walls};
use crate::{RegionSolid, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const CORNERS: &str = "corners = [[-1500, -1500], [1500, -1500], [1500, 1500], [-1500, 1500]]";
const GATES: &str = "gates = [{ from = [1500, -400], to = [1500, 400], top = 900 }]";
/// Corners of a fence, at most: each wall is compared with all others.
const MOST_CORNERS: usize = 500;
/// Thickness of the walls, m, if the file does not state it.
const THICKNESS_M: f64 = 0.05;

/// The region of a fence: the solid of its walls.
pub(super) fn solid(name: &str, t: &Table<'_>, units: Units) -> Result<(Region, RegionSolid)> {
    let corners = t.need("corners", CORNERS)?;
    let listed = corners.list(CORNERS)?;
    if !(3..=MOST_CORNERS).contains(&listed.len()) {
        let what = format!("has {} corners, not 3 to {MOST_CORNERS}", listed.len());
        return Err(corners.error(what).hint(CORNERS));
    }
    let floor_m = t.get("floor").map_or(Ok(0.0), |v| units.length_of(&v))?;
    let height_m = units.positive_length(&t.need("height", "height = 2000")?)?;
    let gates = match t.get("gates") {
        None => Vec::new(),
        Some(v) => {
            v.list(GATES)?.iter().map(|v| gate(v, units, [floor_m, floor_m + height_m])).collect::<Result<_>>()?
        }
    };
    let fence = Fence {
        corners: listed.iter().map(|v| point(v, CORNERS, units)).collect::<Result<_>>()?,
        floor_m,
        height_m,
        thickness_m: t.get("thickness").map_or(Ok(THICKNESS_M), |v| units.positive_length(&v))?,
        gates,
    };
    let refused = |e: FenceError| refused(t, &corners, &e, units);
    let walls = fence.boxes().map_err(refused)?;
    let mesh = mesh_of_walls(&walls).map_err(|e| refused(e.into()))?;
    Ok((Region::solid(name, Shape::Mesh(mesh.into()), Pose::IDENTITY), RegionSolid::Walls(walls)))
}

fn gate(v: &Value<'_>, units: Units, [bottom_m, top_m]: [f64; 2]) -> Result<Gate> {
    let t = v.table(GATES)?;
    t.only(&names(&[GATE]))?;
    let end = |key: &str| point(&t.need(key, &format!("{key} = [1500, -400]"))?, GATES, units);
    let height = |key: &str, default: f64| t.get(key).map_or(Ok(default), |v| units.length_of(&v));
    Ok(Gate { ends: [end("from")?, end("to")?], heights_m: [height("bottom", bottom_m)?, height("top", top_m)?] })
}

fn point(v: &Value<'_>, example: &str, units: Units) -> Result<Point2> {
    two(v, example).map(|[x, y]| Point2::new(units.length.to_metres(x), units.length.to_metres(y)))
}

fn refused(t: &Table<'_>, corners: &Value<'_>, e: &FenceError, units: Units) -> Diagnostic {
    let hint = match e {
        FenceError::Thick(_) => "thickness = 10   (thinner walls)",
        FenceError::Narrow(_) => "corners that leave out the notch, or regions of shape \"box\" for its walls",
        FenceError::GateOffLine { .. } | FenceError::GateWithoutSize(_) | FenceError::GatesOverlap(..) => {
            "two places on the line of one wall, and `bottom` below `top`"
        }
        FenceError::Short(_) | FenceError::Crossing(..) => "the corners in order, each once",
        FenceError::Mesh(_) => "lengths of a cell, and walls that gates leave a part of",
    };
    let what = match e {
        FenceError::GateOffLine { gate, off_m } => {
            format!("gate {gate} is on no wall: an end is {} away from the nearest", units.show_length(*off_m))
        }
        e => e.to_string(),
    };
    match e {
        FenceError::GateOffLine { .. } | FenceError::GateWithoutSize(_) | FenceError::GatesOverlap(..) => {
            t.get("gates").unwrap_or_else(|| corners.clone()).error(format!("does not fit: {what}")).hint(hint)
        }
        _ => corners.error(format!("makes no fence: {what}")).hint(hint),
    }
}
