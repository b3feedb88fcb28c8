//! A fence from taught corners, as text of a cell file.

use std::fmt::Write as _;

use elbowroom::cell::Units;
use elbowroom::spatial::Vec3;

use crate::region_keys::{length_text, shown};

/// Fewest corners of a fence.
pub(crate) const FEWEST_CORNERS: usize = 3;

/// The corners of a fence on the floor, in the order in which they were taught.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TaughtFence {
    /// In the world, m.
    corners: Vec<Vec3>,
    /// Height of the walls, m.
    height_m: f64,
}

impl TaughtFence {
    /// The walls stand at the height of the lowest corner. Points and the height of the walls in metres.
    pub(crate) fn new(points: &[Vec3], height_m: f64) -> Self {
        Self { corners: points.to_vec(), height_m }
    }

    fn floor_m(&self) -> f64 {
        self.corners.iter().map(|p| p.z).fold(f64::INFINITY, f64::min)
    }

    /// The keys of `[fence.NAME]` for its place.
    pub(crate) fn keys(&self, units: Units) -> String {
        let corners: Vec<String> = self.corners.iter().map(|p| corner_text(*p, units)).collect();
        let [floor, height] = [self.floor_m(), self.height_m].map(|metres| length_text(metres, units));
        format!("corners = [{}]\nfloor = {floor}\nheight = {height}\n", corners.join(", "))
    }

    /// The keys without the wall that leads from the last corner to the first one.
    pub(crate) fn keys_without_last_wall(&self, units: Units) -> String {
        let mut text = self.keys(units);
        if let (Some(first), Some(last)) = (self.corners.first(), self.corners.last()) {
            let [from, to] = [last, first].map(|p| corner_text(*p, units));
            let _ = writeln!(text, "gates = [{{ from = {from}, to = {to} }}]");
        }
        text
    }

    /// In words, how the fence was built.
    pub(crate) fn built(&self, units: Units) -> Vec<String> {
        let unit = units.length.symbol();
        let number = |metres: f64| shown(metres / units.length.to_metres(1.0));
        let next = self.corners.iter().cycle().skip(1);
        let twice_m2: f64 = self.corners.iter().zip(next).map(|(a, b)| a.x * b.y - b.x * a.y).sum();
        let (walls, floor_m) = (self.corners.len(), self.floor_m());
        let [height, floor, top] = [self.height_m, floor_m, floor_m + self.height_m].map(number);
        let area = shown(0.5 * twice_m2.abs());
        vec![
            format!("built {walls} walls, {height} {unit} high, z from {floor} to {top} {unit}, around {area} m2"),
            "what is within the corners is free; gates are added in the cell file (docs/cell-file.md)".to_owned(),
        ]
    }
}

fn corner_text(p: Vec3, units: Units) -> String {
    format!("[{}, {}]", length_text(p.x, units), length_text(p.y, units))
}
