//! Keys of programs: steps, goals, recordings.

use super::key::{Key, Variant, key, variant};

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const PROGRAM: &[Key] = &[
    key("override", "percent", "100", "the programmed override; the monitor only lowers it"),
    key("repeat", "whole number", "1", "number of runs of the program"),
    key("steps", "list of tables", "`steps` or `trajectory` required", "the steps, below"),
    key("trajectory", "path or table", "`steps` or `trajectory` required", "a recording: CSV with `t_s` and one column per joint name in any order; seconds, radians, metres. Other formats: a table, below"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const KEPT_AXIS: &[Key] = &[
    key("axis", "`\"x\"` `\"y\"` `\"z\"` or a vector", "required", "the axis, in the frame of the tool centre point"),
    key("within", "angle, below half a turn", "required", "largest angle from its direction at the start of the move"),
];

/// The kinds of steps: the word is the first key of each.
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const STEPS: &[Variant] = &[
    variant("move", &[
        key("move", "`\"joint\"` `\"linear\"` `\"planned\"`", "required in a move", "straight in joint space · TCP on a straight line, shortest turn · along a collision-free path, [planned](plan.md) before the run"),
        key("to", "joint values, pose or state", "required in a move", "the goal"),
        key("speed", "percent; linear: length per second", "100; linear: 250 mm/s", "percent of each joint's speed; of a linear move the speed of the TCP"),
        key("planner", "`\"rrt-connect\"` `\"grid\"`", "`\"rrt-connect\"`", "of a planned move; `\"grid\"`: through free cells of the robot's [map](plan.md#on-the-map)"),
        key("keep", "table", "none", "of a planned move: an axis of the tool that [keeps its direction](#keeping-an-axis)"),
    ], ""),
    variant("region", &[
        key("region", "name", "", "switches a temporary region from the next tick on"),
        key("active", "true, false", "required with `region`", "whether the region is on or off"),
    ], ""),
    variant("wait", &[key("wait", "seconds", "", "waits")], ""),
    variant("override", &[key("override", "percent", "", "changes the programmed override")], ""),
    variant("grip", &[key("grip", "name of an object", "", "attaches it to the flange at its present place: [below](#gripping)")], ""),
    variant("release", &[key("release", "name of an object", "", "detaches it: it stays where it is")], ""),
    variant("tool", &[key("tool", "name", "", "activates one of the robot's [`tools`](#robotnametoolstool)")], ""),
];

/// What a pose in `to` has besides a pose elsewhere.
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const GOAL: &[Key] = &[
    key("configuration", "list of words", "any", "`\"front\"` or `\"back\"`, `\"up\"` or `\"down\"`, `\"no_flip\"` or `\"flip\"`; an omitted choice may be either"),
    key("near", "joint values, or the name of a state", "none", "takes only the found solution nearest to them: for any arm, and for whole turns"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const RECORDING: &[Key] = &[
    key("file", "path", "required", "the recording"),
    key("angle", "`\"rad\"` `\"deg\"`", "radians", "unit of its angles"),
    key("length", "`\"m\"` `\"mm\"` `\"cm\"` `\"in\"`", "metres", "unit of its lengths"),
    key("time", "column", "`t_s`", "the column with the time"),
    key("time_unit", "`\"s\"` `\"ms\"` `\"us\"`", "seconds", "unit of this column"),
    key("period_ms", "ms", "none", "time from row to row, if the file has no column with the time"),
    key("columns", "table", "names of the joints", "`{ joint_1 = \"A1\" }`: joints whose columns have other names"),
    key("offset", "seconds", "0", "time for which the robot rests at the first row"),
];
