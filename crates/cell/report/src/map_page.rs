//! A map as one page with a slider over its slices.

use std::io::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use elbowroom_cell::Units;
use elbowroom_cspace::GridAxis;
use elbowroom_query::LinkCells;
use elbowroom_query::map::CellMap;
use serde_json::{Value, json};

use crate::palette;
use crate::tables::escape;

const PAGE: &str = include_str!("../assets/map/page.html");

/// Largest number of cells of a page: a browser holds one byte per cell.
const MAX_PAGE_CELLS: usize = 1 << 26;
/// Largest number of objects of a page: each has its own index, and index 0 is a free cell.
const MAX_OBJECTS: usize = 255;

/// Writes one page that opens offline: slices across any of three joints, chosen by a slider, with axes in the units of
/// the cell.
///
/// A path (joint values of the map's axes, rad or m, straight between its rows) is drawn over the slices, strongly where it
/// passes through the cells of the slice.
///
/// With `links`, the cell under the pointer also tells which links block it.
///
/// With more than three joints, the page shows the first and the last two; the others are at the middle of their
/// ranges.
///
/// # Errors
/// More than 2²⁶ cells on the three axes, more than 255 objects, and errors of `out`.
pub fn write(
    mut out: impl Write,
    map: &CellMap,
    links: &[LinkCells],
    path: &[Vec<f64>],
    units: Units,
) -> io::Result<()> {
    let shown = shown_axes(map.axes.len());
    let counts = shown.map(|axis| axis.map_or(1, |axis| map.axes[axis].count()));
    if counts.iter().product::<usize>() > MAX_PAGE_CELLS || map.obstacles.len() > MAX_OBJECTS {
        let what = format!(
            "{} cells and {} objects are too many for a page",
            counts.iter().product::<usize>(),
            map.obstacles.len()
        );
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    let data = json!({
        "joints": map.axes.len(),
        "axes": shown.map(|axis| axis.map_or_else(no_axis, |axis| axis_data(&map.axes[axis], map.is_angle[axis], units))),
        "objects": map.obstacles.iter().enumerate().map(|(i, o)| json!({
            "name": o.name,
            "colour": palette::of_index(i),
            "share": (1e4 * o.blocks.blocked() as f64 / map.cells().max(1) as f64).round() / 100.0,
        })).collect::<Vec<_>>(),
        "links": links.iter().map(|l| json!({
            "name": l.link,
            "cells": STANDARD.encode(packed_cells(&l.map, shown, counts)),
        })).collect::<Vec<_>>(),
        "path": path_in_cells(path, map, shown),
        "cells": STANDARD.encode(packed_cells(map, shown, counts)),
    });
    let title = format!("Joint-space map of {}", escape(&map.robot));
    // `</script>` within a name would end the script.
    let data = data.to_string().replace('<', "\\u003c");
    let page = PAGE.replace("TITLE", &title).replace("SUMMARY", &summary(map, shown)).replace("/*DATA*/null", &data);
    out.write_all(page.as_bytes())?;
    out.flush()
}

/// The first axis and the last two, if there are that many.
fn shown_axes(count: usize) -> [Option<usize>; 3] {
    match count {
        0 => [None; 3],
        1 => [None, None, Some(0)],
        2 => [None, Some(0), Some(1)],
        _ => [Some(0), Some(count - 2), Some(count - 1)],
    }
}

fn no_axis() -> Value {
    json!({ "joint": "", "unit": "", "min": 0, "step": 1, "count": 1 })
}

/// An axis in the units of the cell.
fn axis_data(axis: &GridAxis, is_angle: bool, units: Units) -> Value {
    let (scale, unit) = if is_angle {
        (1.0 / units.angle.to_radians(1.0), units.angle.symbol())
    } else {
        (1.0 / units.length.to_metres(1.0), units.length.symbol())
    };
    json!({
        "joint": axis.joint(),
        "unit": unit,
        "min": axis.min() * scale,
        "step": axis.step() * scale,
        "count": axis.count(),
    })
}

/// A path in cells of the shown axes, to a hundredth; points on one line are left out.
fn path_in_cells(path: &[Vec<f64>], map: &CellMap, shown: [Option<usize>; 3]) -> Vec<[f64; 3]> {
    let place = |q: &Vec<f64>| {
        shown.map(|axis| {
            let cells = axis.map_or(0.5, |k| (q[k] - map.axes[k].min()) / map.axes[k].step());
            (cells * 100.0).round() / 100.0
        })
    };
    let mut kept: Vec<[f64; 3]> = Vec::new();
    for at in path.iter().filter(|q| q.len() == map.axes.len()).map(place) {
        if kept.last() == Some(&at) {
            continue;
        }
        if let [.., before, last] = kept[..]
            && is_straight(before, last, at)
        {
            kept.pop();
        }
        kept.push(at);
    }
    kept
}

/// Whether the second point is within a hundredth of a cell of the straight way between the others.
fn is_straight(from: [f64; 3], at: [f64; 3], to: [f64; 3]) -> bool {
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (way, offset) = (minus(to, from), minus(at, from));
    let share = dot(way, offset) / dot(way, way).max(f64::MIN_POSITIVE);
    let off = minus(offset, way.map(|v| v * share));
    (0.0..=1.0).contains(&share) && dot(off, off) <= 1e-4
}

fn summary(map: &CellMap, shown: [Option<usize>; 3]) -> String {
    let share = 100.0 * map.blocked as f64 / map.cells().max(1) as f64;
    let held =
        (0..map.axes.len()).filter(|axis| !shown.contains(&Some(*axis))).map(|axis| escape(map.axes[axis].joint()));
    let held: Vec<String> = held.collect();
    let held =
        if held.is_empty() { String::new() } else { format!("; {} at the middle of the range", held.join(", ")) };
    format!("{} cells, {share:.2} % of them blocked: in these the robot can touch an object{held}.", map.cells())
}

/// Run-length code of the number of the first object that blocks each cell, 0 for none.
///
/// Each run is the number object + (objects + 1) · length, in groups of seven bits, lowest first.
fn packed_cells(map: &CellMap, shown: [Option<usize>; 3], counts: [usize; 3]) -> Vec<u8> {
    let mut cell: Vec<u16> = map.axes.iter().map(|a| (a.count() / 2) as u16).collect();
    let kinds = map.obstacles.len() as u64 + 1;
    let mut packed = Vec::new();
    let (mut kind, mut length) = (0, 0);
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            for k in 0..counts[2] {
                for (axis, value) in shown.into_iter().zip([i, j, k]) {
                    if let Some(axis) = axis {
                        cell[axis] = value as u16;
                    }
                }
                let first = map.obstacles.iter().position(|o| o.blocks.is_blocked_cell(&cell));
                let next = first.map_or(0, |first| first as u64 + 1);
                if next != kind {
                    push_number(&mut packed, kind + kinds * length);
                    (kind, length) = (next, 0);
                }
                length += 1;
            }
        }
    }
    push_number(&mut packed, kind + kinds * length);
    packed
}

fn push_number(packed: &mut Vec<u8>, mut number: u64) {
    while number >= 128 {
        packed.push((number & 127) as u8 | 128);
        number >>= 7;
    }
    packed.push(number as u8);
}

#[cfg(test)]
mod tests {
    use base64::Engine as _;
    use elbowroom_cell::Cell;
    use elbowroom_query::blocked_by_link;
    use elbowroom_query::map::{MapRequest, map};
    use serde_json::Value;

    use super::{STANDARD, is_straight, push_number, write};

    const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ alpha = 90, min = -90, max = 90, speed = 90 }, { a = 400, min = -60, max = 90, speed = 90 }, { a = 300, min = 0, max = 90, speed = 90 }]
links = [[], { capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }, { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
[object.near]
shape = "box"
at = [250, 0, 0]
size = [100, 100, 100]
[object.far]
shape = "sphere"
at = [600, 0, 200]
radius = 80
[map.arm]
step = 5
"#;

    /// The table of a page, as its script reads it.
    fn unpacked(text: &Value, kinds: u64) -> Vec<u64> {
        let (mut cells, mut number, mut shift) = (Vec::new(), 0, 0);
        for byte in STANDARD.decode(text.as_str().unwrap()).unwrap() {
            number |= u64::from(byte & 127) << shift;
            shift += 7;
            if byte & 128 == 0 {
                cells.extend(std::iter::repeat_n(number % kinds, (number / kinds) as usize));
                (number, shift) = (0, 0);
            }
        }
        cells
    }

    #[test]
    fn a_cell_is_blocked_by_the_links_that_block_it() {
        let cell = Cell::parse("c.toml", CELL).unwrap();
        let request = MapRequest::default();
        let (whole, links) = (map(&cell, &request).unwrap(), blocked_by_link(&cell, &request).unwrap());
        let mut page = Vec::new();
        write(&mut page, &whole, &links, &[], cell.units).unwrap();
        let page = String::from_utf8(page).unwrap();
        let data = page.split("const map = ").nth(1).unwrap().split(";\n").next().unwrap();
        let data: Value = serde_json::from_str(data).unwrap();
        let cells = unpacked(&data["cells"], 3);
        let links: Vec<Vec<u64>> =
            data["links"].as_array().unwrap().iter().map(|link| unpacked(&link["cells"], 3)).collect();
        assert!(links.len() == 2 && cells.len() as u64 == whole.cells());
        // At a border a map may block a cell that is free in fact, and another map of the same solids not.
        let differ =
            cells.iter().enumerate().filter(|(i, kind)| (**kind > 0) != links.iter().any(|l| l[*i] > 0)).count();
        assert!(20 * differ < cells.iter().filter(|kind| **kind > 0).count(), "{differ}");
        assert_ne!(links[0], links[1]);
    }

    #[test]
    fn points_on_a_straight_way_are_left_out() {
        assert!(is_straight([0.0; 3], [1.0, 1.0, 0.0], [3.0, 3.0, 0.0]));
        assert!(!is_straight([0.0; 3], [1.0, 1.1, 0.0], [3.0, 3.0, 0.0]));
        // Back again is a corner.
        assert!(!is_straight([0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0]) && !is_straight([0.0; 3], [1.0; 3], [0.0; 3]));
    }

    #[test]
    fn numbers_are_read_back() {
        for number in [0, 1, 127, 128, 300, 16_383, 16_384, u64::from(u32::MAX) * 3] {
            let mut packed = Vec::new();
            push_number(&mut packed, number);
            let read = packed.iter().rev().fold(0, |sum, byte| sum << 7 | u64::from(byte & 127));
            assert!(read == number && packed.iter().rev().skip(1).all(|byte| byte & 128 != 0), "{number}");
        }
    }
}
