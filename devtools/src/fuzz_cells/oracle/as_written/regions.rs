//! Places and sizes of regions.

use elbowroom_cell::{Cell, CellRegion};
use elbowroom_spatial::Vec3;
use toml::{Table, Value};

use super::compare::{Off, ROUNDING, compare};
use super::written::Written;
use crate::fuzz_cells::oracle::frame::Frame;

pub fn check(file: &Written, cell: &Cell, off: &mut Off) {
    for (name, t) in file.tables("region") {
        let Some(read) = cell.regions.iter().find(|r| r.region.name == *name) else {
            off.push((format!("region.{name}"), f64::INFINITY));
            continue;
        };
        let what = format!("region.{name}");
        let word = t.get("shape").and_then(Value::as_str).unwrap_or_default();
        let place = Frame::of(&read.region.anchor).then(&Frame::of(&read.region.shape_in_anchor));
        if word == "plane" {
            plane(&what, file, t, &place, off);
            continue;
        }
        compare(what.clone(), &expected(file, word, t), word != "sphere", &place, off);
        if is_outside(t) {
            file.compare_size(&what, word, t, &read.region.shape, off);
        }
        warning(&what, file, t, read, off);
    }
}

fn is_outside(t: &Table) -> bool {
    t.get("keep").and_then(Value::as_str) != Some("inside")
}

/// The frame of the middle of a solid; of meshes that of their file.
fn expected(file: &Written, word: &str, t: &Table) -> Frame {
    let above =
        |base: Vec3, height: f64| Frame::shift(base).then(&file.turn(t)).then(&Frame::shift(Vec3::Z * (0.5 * height)));
    match word {
        "sphere" => Frame::shift(file.point(t, if t.contains_key("center") { "center" } else { "centre" })),
        "cylinder" => above(file.point(t, "base"), file.length(t, "height")),
        "box" if t.contains_key("base") => above(file.point(t, "base"), file.point(t, "size").z),
        "box" => {
            let (from, to) = (file.point(t, "from"), file.point(t, "to"));
            let mut bottom = (from + to) * 0.5;
            bottom.z = from.z.min(to.z);
            above(bottom, (to.z - from.z).abs())
        }
        _ => file.pose(t),
    }
}

/// A plane is right if its side and one point of it are.
fn plane(what: &str, file: &Written, t: &Table, read: &Frame, off: &mut Off) {
    let [origin, x, y] = ["origin", "x", "y"].map(|key| file.point(t, key));
    let up = file.turn(t).vector((x - origin).cross(y - origin).try_normalize().unwrap_or(Vec3::Z));
    let up = if is_outside(t) { up } else { -up };
    let by = (read.vector(Vec3::Z) - up).length().max((read.at - origin).dot(up).abs());
    if !(by <= ROUNDING) {
        off.push((what.to_owned(), by));
    }
}

fn warning(what: &str, file: &Written, t: &Table, read: &CellRegion, off: &mut Off) {
    let by = (file.length(t, "warning") - read.region.warning_m).abs();
    if !(by <= ROUNDING) {
        off.push((format!("{what}: warning"), by));
    }
}
