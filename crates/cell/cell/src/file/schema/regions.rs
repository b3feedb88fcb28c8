//! Keys of regions and encoders.

use super::key::{Key, Variant, key, variant};
use super::model::{HEIGHT, MESH, MESH_UNIT, RADIUS};

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const REGION: &[Key] = &[
    key("shape", "a shape of the table below", "required", "which keys give its place and size"),
    key("rpy", "vector of angles", "zero", "turns the region, about the point that the table below names"),
    key("quaternion", "`[x, y, z, w]`", "none", "instead of `rpy`"),
    key("keep", "`\"outside\"` `\"inside\"`", "`\"outside\"`", "which side is free: with `\"inside\"` everything but the solid is the region"),
    key("kind", "`\"forbidden\"` `\"monitored\"` `\"exchange\"`", "`\"forbidden\"`: the safe one", "override 0 at the surface · outputs only · open to one robot at a time"),
    key("life", "`\"permanent\"` `\"temporary\"`", "`\"permanent\"`: the safe one", "a temporary region starts inactive, in `live` [as it was](live.md#how-a-robot-is-guarded); programs switch it"),
    key("warning", "length, at most 10 km; above 10 m with a warning", "0, with a warning if forbidden; exchange: required, at least 1 mm", "thickness δ of the warning zone"),
    key("slow_to", "percent", "none", "a monitored region becomes a speed zone: at most this override inside, ramped through the warning zone"),
    key("guards", "any of `\"tcp\"` `\"tool\"` `\"arm\"`", "`[\"arm\"]`: everything that moves", "guarded: the TCP, the tool's solid (with the load), the links with tool and load"),
    key("robots", "names", "all except the one that carries it", "robots that it concerns"),
    key("follow", "table", "none: it is static", "the source that moves it"),
    key("hysteresis", "length, at most 10 km; above 1 m with a warning", "1 mm: above encoder noise, below relevant distances", "distance outside a border at which the robot's output falls"),
    key("output", "0 to 63", "none", "digital output raised while a guarded part is inside"),
    key("warning_output", "0 to 63", "none", "digital output raised while a guarded part is inside or in the warning zone"),
];

const AT: Key = key("at", "point", "", "");
const BASE: Key = key("base", "point", "", "centre of the bottom");

#[rustfmt::skip] // a row per shape, as in the document
pub(in crate::file) const REGION_SHAPES: &[Variant] = &[
    variant("sphere", &[key("centre", "point", "", ""), key("center", "", "", "the same"), RADIUS], "turned about `centre`"),
    variant("cylinder", &[BASE, RADIUS, HEIGHT], "turned about `base`"),
    variant("plane", &[key("origin", "point", "", ""), key("x", "point", "", "on X"), key("y", "point", "", "in the XY plane")], "everything below (against Z); turned about `origin`"),
    variant("box", &[key("from", "point", "", ""), key("to", "point", "", ""), BASE, key("size", "three lengths", "", "")], "two opposite corners, or `base` and `size`; turned about the centre of the bottom"),
    variant("capsule", &[AT, RADIUS, HEIGHT], "`height` is without the caps; turned about `at`"),
    variant("mesh", &[AT, MESH, MESH_UNIT], "a closed mesh; turned about `at`"),
    variant("convex", &[AT, MESH, MESH_UNIT], "the convex hull of the mesh; turned about `at`"),
];

/// Walls of a fence, beside the keys of a region.
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FENCE: &[Key] = &[
    key("corners", "list of `[x, y]`", "required, 3 to 500", "the polygon around what is free, in the world; the walls are outside of it"),
    key("height", "length", "required", "of the walls"),
    key("floor", "length", "0", "height of their lower edge in the world"),
    key("thickness", "length", "50 mm", "of the walls"),
    key("gates", "list of tables", "none", "openings"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const GATE: &[Key] = &[
    key("from", "`[x, y]`", "required", "an end of the opening, on the line of a wall (within 10 mm)"),
    key("to", "`[x, y]`", "required", "the other end, on the same wall"),
    key("bottom", "length", "that of the walls", "height of its lower edge in the world"),
    key("top", "length", "that of the walls", "height of its upper edge in the world"),
];

/// Sources of a region that moves.
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FOLLOW_SOURCES: &[Key] = &[
    key("robot", "name", "none; exactly one of `robot`, `encoder`, `object`, `poses` is required", "coordinates in the `frame` of this robot, which is not guarded against the region"),
    key("encoder", "name", "none", "coordinates in the world at travel 0; the region moves as the encoder does"),
    key("object", "name", "none", "coordinates in the object's frame (its centre, or its mesh's origin), turning with it; a static object holds it still"),
    key("poses", "path", "none", "coordinates in the frame whose poses in the world the file lists: straight and by the shortest turn between them, static before and after"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FOLLOW: &[Key] = &[
    key("frame", "`\"flange\"` `\"tool\"` `\"tcp\"` or a link", "`\"flange\"`", "frame of the robot; `\"tool\"` and `\"tcp\"` are both that of the tool centre point"),
    key("max_speed", "length per second", "10 m/s; with `robot` at least 1.5 × its joints' speeds", "a faster source is a fault (it has jumped), and the robot stops ([watchdog](laws.md#9-watchdog))"),
    key("max_turn", "angle per second", "20 rad/s", "limit for turning, likewise"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const ENCODER: &[Key] = &[
    key("direction", "vector", "`[1, 0, 0]`", "direction of positive travel in the world; its length does not matter"),
    key("speed", "length per second", "`speed` or `file` required", "constant speed"),
    key("at", "length", "0", "travel before it starts"),
    key("start", "seconds", "0", "time at which it starts"),
    key("end", "seconds", "never", "time at which it stops"),
    key("wrap", "length", "none", "travel after which it begins again at 0"),
    key("file", "path", "`speed` or `file` required", "CSV with the columns `t_s,travel_m` (seconds, metres), linear between rows"),
    key("measured", "boolean", "false", "`live`: the travel arrives [over the network](live.md#measured-encoders-and-objects)"),
];
