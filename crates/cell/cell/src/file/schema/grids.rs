//! Keys of grids.

use super::key::{Key, key};

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const GRID: &[Key] = &[
    key("cells", "list of whole numbers", "required", "cells along each axis, at most 65,535 in all"),
    key("output", "0 to 63", "required", "digital output with the lowest bit of the number; no region has one of its outputs"),
    key("from", "point; with `joints` a list", "required; with `joints` their low ends", "a corner of the divided box, or low ends of the joint values"),
    key("to", "point; with `joints` a list", "required; with `joints` their high ends", "the opposite corner, or high ends of the joint values"),
    key("rpy", "vector of angles", "zero", "turns the box about the centre of its bottom"),
    key("quaternion", "`[x, y, z, w]`", "none", "instead of `rpy`"),
    key("joints", "names", "none: the place of the TCP counts", "the joints whose values are divided, instead of a box"),
    key("robots", "names", "all", "robots that have the grid"),
    key("hysteresis", "length or angle, as the axes", "1 mm, 0.1°", "how far beyond its border a cell is left; at most half of a cell"),
];
