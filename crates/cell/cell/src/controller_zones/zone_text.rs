//! What the texts of all languages say in comments.

use elbowroom_robot::RobotId;
use elbowroom_spatial::Vec3;

use super::region_zones::RegionZones;
use super::zone::Zone;
use super::zone_frame::ZoneFrame;
use crate::{Cell, RegionSolid};

/// Printable ASCII, one line: names of a cell may have any character, and comments of a controller may not.
pub(super) fn ascii(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect()
}

/// What a fence is for a controller.
const NOTE_OF_FENCES: [&str; 2] = [
    "The zones of a fence are its walls: each stops the robot in the wall, and both sides of it are free. A robot that is",
    "outside already is not stopped: start on the side that the comment of each wall names, in this frame.",
];

/// The first comments: whose zones these are, in which frame, and what no zone does.
pub(super) fn head(cell: &Cell, robot: RobotId, frame: &ZoneFrame) -> Vec<String> {
    let is_fence = |r: &crate::CellRegion| matches!(r.solid, RegionSolid::Walls(_)) && r.robots.contains(&robot);
    let has_fence = cell.regions.iter().any(is_fence);
    let robot = &cell.robots[robot.0];
    let frame = frame.title();
    let of_fences = NOTE_OF_FENCES.iter().filter(|_| has_fence).map(|line| (*line).to_owned());
    [
        format!("Zones of robot \"{}\", from the regions of the cell \"{}\".", robot.name, cell.name),
        format!("Written by elbowroom {}.", env!("CARGO_PKG_VERSION")),
        format!("Millimetres and degrees in {frame}: it has to be the world frame of the controller."),
        "A zone watches the active tool centre point: it guards neither the arm nor the tool.".to_owned(),
        "It acts at its border; the slow-down before it, and the stopping distance, are the monitor's alone."
            .to_owned(),
        "Move the robot slowly to the border of each zone before you rely on it. Not a certified safety function."
            .to_owned(),
    ]
    .into_iter()
    .chain(of_fences)
    .map(|line| ascii(&line))
    .collect()
}

/// The last comments: everything that the text does not express.
pub(super) fn missing(regions: &[RegionZones<'_>]) -> Vec<String> {
    let missing: Vec<_> = regions.iter().flat_map(|r| &r.missing).map(|m| ascii(&format!("- {}", m.message))).collect();
    if missing.is_empty() {
        return vec!["All regions of the robot are expressed.".to_owned()];
    }
    [vec!["NOT EXPRESSED:".to_owned()], missing].concat()
}

/// A comment that names the region, the part, and what the zone does.
pub(super) fn title(zones: &RegionZones<'_>, zone: &Zone) -> String {
    let part = if zone.part.is_empty() { String::new() } else { format!(", {}", zone.part) };
    let inwards = zone.inwards.map(|v| format!(" (the inside of the fence is towards {})", direction(v)));
    let part = part + &inwards.unwrap_or_default();
    let life = if zones.is_temporary() { ", temporary" } else { "" };
    let kind = zones.region.region.kind.name();
    ascii(&format!("region \"{}\"{part}: {kind}{life}", zones.name()))
}

/// A direction as an axis, or as its coordinates.
fn direction(v: Vec3) -> String {
    let is_axis = |i: &usize| v.to_array()[*i].abs() > 1.0 - 1e-9;
    if let Some(i) = (0..3).find(is_axis) {
        return format!("{}{}", if v.to_array()[i] > 0.0 { '+' } else { '-' }, ["X", "Y", "Z"][i]);
    }
    let [x, y, z] = v.to_array().map(|c| format!("{:.3}", (c * 1e3).round() * 1e-3 + 0.0));
    format!("[{x},{y},{z}]")
}
