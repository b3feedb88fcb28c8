//! Keys of poses and solids, robots, tools, objects and planning scenes.

use super::key::{Key, Variant, key, variant};

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const POSE: &[Key] = &[
    key("at", "vector", "zero", "position of the origin"),
    key("rpy", "vector of angles", "zero", "roll, pitch, yaw as in URDF: `Rz(yaw) · Ry(pitch) · Rx(roll)`"),
    key("quaternion", "`[x, y, z, w]`", "none", "instead of `rpy`: a unit quaternion"),
];

const SIZE: Key = key("size", "three lengths", "", "");
pub(super) const RADIUS: Key = key("radius", "length", "", "");
pub(super) const HEIGHT: Key = key("height", "length", "", "");
pub(super) const MESH: Key = key("mesh", "path", "", "");
pub(super) const MESH_UNIT: Key =
    key("mesh_unit", "`\"m\"` `\"mm\"` `\"cm\"` `\"in\"`", "", "for formats that state no unit; default metres");
const BAR: &[Key] = &[RADIUS, HEIGHT, key("from", "point", "", ""), key("to", "point", "", "")];
const BAR_NOTE: &str = "along z about `at`; or `from` and `to`, instead of `at`, `rpy` and `height`";
const CAPSULE_NOTE: &str = "likewise; `height` is without the caps";

/// Solids of links and loads. Each also has the keys of a pose.
#[rustfmt::skip] // a row per shape, as in the document
pub(in crate::file) const SOLIDS: &[Variant] = &[
    variant("box", &[SIZE], "about `at`"),
    variant("sphere", &[RADIUS], "about `at`"),
    variant("cylinder", BAR, BAR_NOTE),
    variant("capsule", BAR, CAPSULE_NOTE),
    variant("mesh", &[key("file", "path", "", ""), MESH_UNIT], "`{ mesh = \"link.stl\" }` for a mesh in metres, without a pose"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const ROBOT: &[Key] = &[
    key("model", "path", "`model` or `dh` required", "a URDF, or a 3DS, GLB, glTF or VRML model: [models](models.md)"),
    key("kind", "`\"robot\"` `\"mechanism\"`", "`\"robot\"`", "a [mechanism](#mechanisms) moves and is an obstacle; no monitor guards it"),
    key("srdf", "path", "none", "a file whose disabled pairs are never tested for collision; with `dh` the links are `link_1`, `link_2`, …"),
    key("ignore", "pairs of links", "none", "pairs never tested for collision: `[[\"link_4\", \"link_6\"]]`, for links that always touch"),
    key("joints", "path", "`MODEL.joints.toml` beside it, if it exists", "which nodes of a 3DS, glTF or VRML model move"),
    key("unit", "`\"m\"` `\"cm\"` `\"mm\"` `\"in\"`", "metres", "unit of a 3DS model, and of a URDF's meshes that state none"),
    key("dh", "list of rows", "`model` or `dh` required", "classical Denavit-Hartenberg table, see below"),
    key("links", "list", "none", "solids of the `dh` rows: one entry (or a list) per row, in the frame after the row; `[]` for none"),
    key("base_link", "solid or list", "none", "solids of the root link of a `dh` robot"),
    key("base", "pose", "world origin", "pose of the root link"),
    key("flange", "link name", "`tool0`, else `flange`, else the leaf with the most joints above it (or the link that carries this leaf as a finger)", "carries the tool; of `dh`: `base`, `link_1`, …"),
    key("start", "joint values, or the name of a state", "zero, moved into the limits with a warning", "joint values at the start"),
    key("states", "table", "the group states of the SRDF", "named joint values: `{ home = [0, -20, 90, 0, 40, 0] }`, for `to` in programs and `plan --to`"),
    key("tool", "table", "none", "[the tool](#robotnametool)"),
    key("tools", "tables", "none", "several named tools instead: [below](#robotnametoolstool)"),
    key("load", "solid", "none", "solid that the tool holds, in the flange frame; counts as tool"),
    key("volumes", "`\"auto\"` `\"capsule\"` `\"box\"` `\"hull\"` `\"mesh\"`", "`\"auto\"`: the smaller of capsule and box", "how link meshes are guarded against regions"),
    key("speed", "number or one per joint", "the model's; else 180 deg/s, 1 m/s, with a warning", "highest joint speed"),
    key("acceleration", "number or one per joint", "the model's; else full speed in 0.25 s, typical of industrial arms", "of programmed moves"),
    key("jerk", "number or one per joint", "full acceleration in 0.1 s", "of programmed moves"),
    key("overshoot", "number or one per joint", "0.05 rad, 0.05 m", "how far a reading may be beyond the joint limits before the [monitor](laws.md#9-watchdog) stops the robot; 0 for not at all"),
    key("stop_time", "seconds", "0.1: a hard but category-1 stop", "time from full speed to rest when the override falls"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const DH_ROW: &[Key] = &[
    key("name", "text", "`joint_1`, `joint_2`, …", "name of the joint"),
    key("kind", "`\"revolute\"` `\"prismatic\"`", "`\"revolute\"`", "what the joint does: θ or d follows its value"),
    key("a", "length", "0", "distance along x"),
    key("alpha", "angle", "0", "α, about x"),
    key("d", "length", "0", "distance along z"),
    key("theta", "angle", "0", "θ, about z"),
    key("min", "joint value", "continuous; required for prismatic joints", "lower limit"),
    key("max", "joint value", "continuous; required for prismatic joints", "upper limit"),
    key("speed", "joint value per second", "as for the robot", "highest speed of this joint"),
    key("acceleration", "joint value per second²", "as for the robot", "highest acceleration of this joint"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const TOOL: &[Key] = &[
    key("tcp", "pose", "the flange", "tool centre point in the flange frame"),
    key("box", "solid: pose and `size`", "none", "the tool's oriented box in the flange frame"),
    key("mesh", "path", "none", "instead of `box`: a mesh in the flange frame"),
    key("mesh_unit", "`\"m\"` `\"mm\"` `\"cm\"` `\"in\"`", "metres", "unit of a mesh whose format states none"),
    key("at", "vector", "zero", "position of the mesh"),
    key("rpy", "vector of angles", "zero", "orientation of the mesh"),
    key("quaternion", "`[x, y, z, w]`", "none", "instead of `rpy`"),
];

/// What a tool of `tools` has besides [`TOOL`].
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const NAMED_TOOL: &[Key] = &[
    key("flange", "link name", "the robot's `flange`", "the link that carries it"),
    key("mounted", "true, false", "true", "whether it is on its flange at the start; at most one tool per flange"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const OBJECT: &[Key] = &[
    key("shape", "a shape of the table below", "required", "which keys give its size"),
    key("at", "vector", "zero", "the shape's centre, a point of the plane, or the mesh file's origin; with `follow`: its place at travel 0"),
    key("rpy", "vector of angles", "zero", "its orientation"),
    key("quaternion", "`[x, y, z, w]`", "none", "instead of `rpy`"),
    key("follow", "table", "none", "`{ encoder = \"belt\" }`: the object moves with this encoder"),
    key("motion", "table", "none", "it moves by itself, starting at `at`; either `follow` or `motion`"),
    key("measured", "boolean", "false", "`live`: its pose arrives [over the network](live.md#measured-encoders-and-objects)"),
];

#[rustfmt::skip] // a row per shape, as in the document
pub(in crate::file) const OBJECT_SHAPES: &[Variant] = &[
    variant("box", &[SIZE], ""),
    variant("sphere", &[RADIUS], ""),
    variant("cylinder", BAR, "along z; or `from` and `to`, instead of `at`, `rpy` and `height`"),
    variant("capsule", BAR, CAPSULE_NOTE),
    variant("plane", &[], "everything below the x-y plane of its frame, such as a floor; it does not move"),
    variant("mesh", &[MESH, MESH_UNIT], ""),
];

pub(in crate::file) const OBJECT_FOLLOW: &[Key] = &[key("encoder", "name", "required", "the encoder")];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const OBJECT_MOTION: &[Key] = &[
    key("via", "list of points", "`via` or `turn` required", "positions of its origin, straight from point to point, beginning at `at`"),
    key("speed", "length per second", "required with `via`", "constant; at the corners the velocity changes at once, without rounding"),
    key("start", "seconds", "0", "time at which it leaves `at`"),
    key("repeat", "`\"no\"` `\"loop\"` `\"ping-pong\"`", "`\"no\"`: it stops at the last point", "`\"loop\"`: from the last point straight to `at` and again; `\"ping-pong\"`: back along the points and again"),
    key("turn", "vector, angle per second", "`[0, 0, 0]`", "rotation about world axes through its origin while it moves; without `via`, for ever"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const SCENE: &[Key] = &[
    key("file", "path", "required", "the scene, in metres"),
    key("frame", "frame name", "`\"world\"`: also the frame of objects that name none", "frame of the scene that is placed"),
    key("at", "vector", "zero", "position of the placed frame in the world"),
    key("rpy", "vector of angles", "zero", "its orientation"),
    key("quaternion", "`[x, y, z, w]`", "none", "instead of `rpy`"),
    key("allowed_collisions", "true, false", "true", "whether pairs that the scene's `allowed_collision_matrix` lets touch are left out"),
];
