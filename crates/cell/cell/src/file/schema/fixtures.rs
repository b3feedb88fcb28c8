//! Keys of virtual fixtures.

use super::key::{Key, key};

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FIXTURE: &[Key] = &[
    key("protects", "name", "required", "the object that the shield protects; not a plane"),
    key("target", "table", "required", "what the tool is to reach: one of the keys below"),
    key("width", "length", "required", "width of the opening at its ground"),
    key("offset", "length", "2 mm", "distance of the shield from the surface"),
    key("depth", "length", "0", "how far the opening reaches into the object; of `drill`: its own depth"),
    key("flare", "angle", "0: parallel walls", "angle between the wall of the opening and its axis, at most 80°"),
    key("tolerance", "length", "2 mm", "largest error of the shield, and distance of the target from the surface; a fine one takes longer"),
    key("tool", "`\"ROBOT/TOOL\"`", "none: whether a tool passes is not examined", "the tool that works in the opening; `\"ROBOT\"` or `\"ROBOT/tool\"` for the only one"),
    key("active", "true, false", "true", "whether it is on at the start"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const OPERATOR: &[Key] = &[
    key("robot", "name", "required", "the guided robot; it has no program and no avoidance"),
    key("tool", "name", "the only one, or the one that is mounted", "the tool whose point is guided; it needs a solid"),
    key("stream", "path", "required", "CSV of desired poses of the tool point in the world: `t_s,x,y,z,qx,qy,qz,qw`, and `enable`, `clutch` (0 or 1) if wanted; a row holds until the next"),
    key("scale", "0.001 to 100", "1", "motions of the hand count so many times, from the first row on and from where the clutch closes"),
    key("gap", "length", "0.5 mm", "distance at which the tool glides along surfaces; half of it is never undercut"),
    key("speed", "length per second", "250 mm/s", "largest speed of the tool point"),
    key("acceleration", "length per second squared", "5 m/s²", "acceleration with which the tool follows"),
    key("stale_ms", "ms, at most 1000", "100", "the robot stands if the last row is older"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FIXTURE_TARGET: &[Key] = &[
    key("line", "list of points", "none", "a line on the surface, through two points or more in the world"),
    key("area", "list of points", "none", "the part of the surface inside a closed line through three points or more"),
    key("drill", "table", "none", "a hole: `at`, `axis`, `depth`"),
    key("faces_within", "table", "none", "the part of the surface within `radius` of `at`"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FIXTURE_DRILL: &[Key] = &[
    key("at", "point", "required", "a point of the surface"),
    key("axis", "vector", "required", "direction into the object"),
    key("depth", "length", "required", "depth of the hole below the surface"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FIXTURE_FACES: &[Key] = &[
    key("at", "point", "required", "a point of the surface"),
    key("radius", "length", "required", "distance from it"),
];
