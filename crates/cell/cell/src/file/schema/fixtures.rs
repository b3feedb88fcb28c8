//! Keys of virtual fixtures.

use super::key::{Key, key};

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FIXTURE: &[Key] = &[
    key("protects", "name", "required", "the object that the shield protects; not a plane"),
    key("target", "table", "required without `mesh`", "what the tool is to reach: one of the keys below"),
    key("mesh", "path", "none", "instead of `target` and its dimensions: a closed shield in the world, as `elbowroom fixture --out` writes it"),
    key("mesh_unit", "`\"m\"` `\"mm\"` `\"cm\"` `\"in\"`", "`\"m\"`", "unit of the mesh"),
    key("width", "length", "required with `target`", "width of the opening at its ground"),
    key("offset", "length", "2 mm", "distance of the shield from the surface"),
    key("depth", "length", "0", "how far the opening reaches into the object; of `drill`: its own depth"),
    key("flare", "angle", "0: parallel walls", "angle between the wall of the opening and its axis, at most 80°"),
    key("tolerance", "length", "2 mm", "largest error of the shield, and distance of the target from the surface; a fine one takes longer"),
    key("tool", "`\"ROBOT/TOOL\"`", "none: whether a tool passes is not examined", "the tool that works in the opening; `\"ROBOT\"` or `\"ROBOT/tool\"` for the only one"),
    key("active", "true, false", "true", "whether it is on at the start"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const GUIDE: &[Key] = &[
    key("guide", "`\"line\"` `\"tube\"` `\"plane\"` `\"cone\"` `\"entry\"`", "required", "where the hand is kept, instead of a shield; `entry`: the fixed point through which the shaft of the tool passes"),
    key("tool", "`\"ROBOT/TOOL\"`", "required", "the guided tool; `\"ROBOT\"` or `\"ROBOT/tool\"` for the only one"),
    key("points", "list of points", "required by `line` and `tube`", "the line, which may bend, or the axis of the tube; in the world"),
    key("radius", "length", "required by `tube`; 0 for `entry`", "radius of the tube; of `entry`: how far from the point the shaft may pass"),
    key("tolerance", "length", "0.5 mm", "of `line` and `tube`: distance from the line in bends, at sharp corners up to twice as much; a small one makes the tool slow there"),
    key("at", "point", "required by `plane`, `cone` and `entry`", "a point of the plane, the apex of the cone, or the point of entry; in the world"),
    key("normal", "vector", "required by `plane`", "normal of the plane"),
    key("axis", "vector", "required by `cone`; [0, 0, 1] for `entry`", "from the apex into the cone, in the world; of `entry`: direction of the shaft towards the tip, in the frame of the tool point"),
    key("half_angle", "angle", "required by `cone`", "angle between the axis and the side of the cone, below 90°"),
    key("depth", "two lengths", "no limit", "of `entry`: least and most length of the shaft beyond the point; negative before it. A tip that is once within stays within"),
    key("active", "true, false", "true", "whether it is on at the start"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const FORCE: &[Key] = &[
    key("between", "`[\"ROBOT/TOOL\", \"OBJECT\"]`", "required", "a guided tool, or `\"ROBOT\"` for its whole arm, and an object or a fixture with a shield that is on for the tool"),
    key("law", "`\"repulsive\"` `\"khatib\"` `\"spring_damper\"` `\"admittance\"` `\"impedance\"`", "required", "the force: [force laws](fixtures.md#forces)"),
    key("range", "length", "required, 0 for `admittance` and `impedance`", "distance at which the two begin to repel each other"),
    key("stiffness", "N/m", "1000, 800 for `admittance`", "of the repulsion; of `admittance` and `impedance`: of the spring between hand and tool too"),
    key("damping", "N·s/m", "0, 50 for `spring_damper`, critical for `admittance`", "of the approach by the tool; of `admittance`: of every motion; of `impedance`: between hand and tool"),
    key("reaction_ms", "ms", "0", "the range grows by the way of the approach in this time"),
    key("deceleration", "length per second squared", "none", "the range grows by the way of braking with it"),
    key("mass", "kg", "2", "of `admittance`: mass of the tool as the hand feels it"),
    key("jerk", "length per second cubed", "500 m/s³", "of `admittance`: largest jerk of the mass; it slows down as fast as forces demand"),
    key("largest_force", "N", "150", "of `admittance` and `impedance`: largest force of the spring between hand and tool"),
    key("tank", "J", "0.01", "of `impedance`: energy that the hand may get before it has put any in"),
    key("device_damping", "N·s/m", "none: not examined", "of `impedance`: damping of the hand controller, which limits the stiffness"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const OPERATOR: &[Key] = &[
    key("robot", "name", "required", "the guided robot; it has no program and no avoidance"),
    key("tool", "name", "the only one, or the one that is mounted", "the tool whose point is guided; it needs a solid"),
    key("stream", "path", "required", "CSV of desired poses of the tool point in the world: `t_s,x,y,z,qx,qy,qz,qw`, and `enable`, `clutch`, `fixture.NAME` (0 or 1) if wanted"),
    key("interpolation", "`\"hold\"` `\"linear\"`", "`\"hold\"`", "between two rows the hand stays at the first, or moves evenly to the second"),
    key("scale", "0.001 to 100", "1", "motions of the hand count so many times, from the first row on and from where the clutch closes"),
    key("gap", "length", "0.5 mm", "distance at which the tool glides along surfaces; half of it is never undercut"),
    key("speed", "length per second", "250 mm/s", "largest speed of the tool point"),
    key("acceleration", "length per second squared", "5 m/s²", "acceleration with which the tool follows"),
    key("stale_ms", "ms, at most 1000", "100", "the robot stands if the last row is older"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const VIRTUAL_ROBOT: &[Key] = &[
    key("robots", "list of names", "required", "two to eight robots, each without program, avoidance and operator"),
    key("work_piece", "name", "required", "the object that they carry; no program grips it, and it does not move by itself"),
    key("holder", "name", "required", "the robot that holds it at the start"),
    key("grasps", "table of lists", "required", "per robot its grasps: `grasps = { left = [{ at = [0, 0, 80], rpy = [180, 0, 0], approach = 60 }] }`"),
    key("stream", "path", "required", "CSV of desired poses of the work-piece in the world: `t_s,x,y,z,qx,qy,qz,qw`, and `enable`, `clutch` (0 or 1) if wanted"),
    key("speed", "length per second", "250 mm/s", "largest speed of the origin of the work-piece"),
    key("turn_speed", "angle per second", "57.3°/s", "largest angular speed of the work-piece"),
    key("gap", "length", "10 mm", "distance from everything that a free robot aims to keep; below it, it turns away"),
    key("approach_speed", "length per second", "100 mm/s", "speed of a hand on its approach to the grasp and away from it, at least 1 mm/s"),
    key("settle_ms", "ms, at most 60000", "300", "time that a hand takes to close or to open"),
    key("horizon_s", "s, at most 60", "5", "time that the motion is foreseen"),
    key("seen_by", "name", "none", "the [camera](#cameraname) that looks at the work-piece: a robot that will hide it hands it over before; a lens and a pose are enough"),
    key("hidden", "percent", "30, with `seen_by`", "a robot hides the work-piece from more than this on: percent of its surface in view"),
    key("stale_ms", "ms, at most 1000", "500", "the work-piece stands if the last row is older"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const GRASP: &[Key] = &[
    key("at", "point", "[0, 0, 0]", "the tool centre point in the frame of the work-piece"),
    key("rpy", "angles", "[0, 0, 0]", "its orientation there; or `quaternion`"),
    key("quaternion", "four numbers", "none", "qx, qy, qz, qw in place of `rpy`"),
    key("approach", "length, or vector", "50 mm", "way from the pre-grasp to the grasp: along the z axis of the tool, or a motion in the frame of the work-piece"),
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
