//! Where in a cell file the keys of each list are, and which of them no random cell has.

/// The tables that each list of keys is for. A name that the writer of the file chooses is `*`; rows of a list are its table.
pub const PLACES: &[(&str, &[&str])] = &[
    ("keys of the file", &[""]),
    ("keys of `units`", &["units"]),
    ("keys of a pose", &["robot.*.base", "robot.*.tool.tcp", "robot.*.tools.*.tcp", "program.*.steps.to"]),
    ("keys of [robot.NAME]", &["robot.*"]),
    ("keys of a row of `dh`", &["robot.*.dh"]),
    ("keys of [robot.NAME.tool]", &["robot.*.tool", "robot.*.tools.*"]),
    ("keys of [robot.NAME.tools.TOOL]", &["robot.*.tools.*"]),
    ("keys of [object.NAME]", &["object.*"]),
    ("keys of `follow` of an object", &["object.*.follow"]),
    ("keys of `motion`", &["object.*.motion"]),
    ("keys of [scene.NAME]", &["scene.*"]),
    ("keys of [region.NAME]", &["region.*"]),
    ("keys of [fence.NAME]", &["fence.*"]),
    ("keys of a gate", &["fence.*.gates"]),
    ("keys of [grid.NAME]", &["grid.*"]),
    ("keys of [encoder.NAME]", &["encoder.*"]),
    ("keys of [fixture.NAME]", &["fixture.*"]),
    ("keys of a guide", &["fixture.*"]),
    ("keys of [operator.NAME]", &["operator.*"]),
    ("keys of [virtual_robot.NAME]", &["virtual_robot.*"]),
    ("keys of a grasp", &["virtual_robot.*.grasps.*"]),
    ("keys of [force.NAME]", &["force.*"]),
    ("keys of `target`", &["fixture.*.target"]),
    ("keys of `drill`", &["fixture.*.target.drill"]),
    ("keys of `faces_within`", &["fixture.*.target.faces_within"]),
    ("keys of a sensor", &["camera.*", "cloud.*"]),
    ("keys of a lens", &["camera.*.lens", "camera.*"]),
    ("keys of [camera.NAME]", &["camera.*"]),
    ("keys of a template", &["camera.*.templates"]),
    ("keys of [cloud.NAME]", &["cloud.*"]),
    ("keys of `depth`", &["cloud.*.depth"]),
    ("keys of [monitor]", &["monitor"]),
    ("keys of [program.ROBOT]", &["program.*"]),
    ("keys of `keep`", &["program.*.steps.keep"]),
    ("keys of `trajectory`", &["program.*.trajectory"]),
    ("keys of a goal", &["program.*.steps.to"]),
    ("keys of [map.ROBOT]", &["map.*"]),
    ("keys of [avoidance.ROBOT]", &["avoidance.*"]),
    ("keys of a step", &["program.*.steps"]),
    ("keys of `follow` of a region", &["region.*.follow"]),
    ("solids", &["robot.*.links", "robot.*.tool", "robot.*.tools.*", "robot.*.load"]),
    ("shapes of objects", &["object.*.shape"]),
    ("shapes of regions", &["region.*.shape"]),
];

/// The cells of long runs have it, the few of the suite do not.
const RARE: &str = "rare: `fuzz cells --count 150 --keys` has it";
/// What random pictures and clouds show is judged by the tests of `perceived_run`.
const SENSOR: &str = "the oracle sees nothing: runs with cameras and clouds have their own tests";
/// It changes which pairs are tested, and no motion.
const PAIRS: &str = "it concerns queries and contacts, which the oracle does not judge";
/// It has no influence on a run.
const NO_MOTION: &str = "it concerns no run";
/// The oracle takes the turns that were read.
const TURN: &str = "the oracle takes poses from the cell as read; tests of the reader judge both forms";
/// What is to come.
const YET: &str = "not generated yet";

/// Keys that no random cell of the suite has: list, reason, names. The list may only become shorter.
pub const UNTRIED: &[(&str, &str, &[&str])] = &[
    ("keys of [avoidance.ROBOT]", YET, &["rules"]),
    (
        "keys of [camera.NAME]",
        SENSOR,
        &["frames", "learning_frames", "mask_margin", "max_speed", "shadows", "templates", "uncertainty"],
    ),
    (
        "keys of [cloud.NAME]",
        SENSOR,
        &[
            "ceiling",
            "clouds",
            "depth",
            "floor_thickness",
            "learning_clouds",
            "mask_margin",
            "max_speed",
            "min_points",
            "min_voxels",
            "to_floor",
            "uncertainty",
            "voxel",
        ],
    ),
    ("keys of [fixture.NAME]", RARE, &["active", "depth"]),
    ("keys of [fixture.NAME]", YET, &["mesh", "mesh_unit"]),
    (
        "keys of [force.NAME]",
        RARE,
        &["damping", "deceleration", "device_damping", "largest_force", "mass", "reaction_ms", "tank"],
    ),
    ("keys of [grid.NAME]", TURN, &["quaternion"]),
    ("keys of [map.ROBOT]", NO_MOTION, &["joints", "others", "step"]),
    ("keys of [object.NAME]", TURN, &["quaternion"]),
    ("keys of [operator.NAME]", YET, &["tool"]),
    ("keys of [region.NAME]", TURN, &["quaternion"]),
    ("keys of [robot.NAME.tool]", YET, &["at", "mesh", "mesh_unit", "rpy"]),
    ("keys of [robot.NAME.tool]", TURN, &["quaternion"]),
    ("keys of [robot.NAME.tools.TOOL]", YET, &["flange"]),
    ("keys of [robot.NAME]", YET, &["base_link", "flange", "ignore", "joints", "speed", "states", "unit"]),
    ("keys of [scene.NAME]", PAIRS, &["allowed_collisions", "at", "file", "frame", "quaternion", "rpy"]),
    ("keys of `depth`", SENSOR, &["step"]),
    ("keys of `faces_within`", YET, &["at", "radius"]),
    ("keys of `follow` of a region", YET, &["max_speed", "max_turn"]),
    ("keys of `target`", YET, &["area", "faces_within", "line"]),
    ("keys of a goal", YET, &["configuration", "near"]),
    ("keys of a grasp", TURN, &["quaternion"]),
    ("keys of a guide", RARE, &["active", "at", "axis", "depth", "guide", "half_angle", "normal", "points", "radius"]),
    ("keys of a lens", RARE, &["distortion"]),
    ("keys of a lens", SENSOR, &["center_px", "centre_px"]),
    ("keys of a pose", TURN, &["quaternion"]),
    ("keys of a row of `dh`", YET, &["name"]),
    (
        "keys of a sensor",
        SENSOR,
        &["area", "floor", "joints", "latency_ms", "prediction", "robot", "robots", "search_ms", "stale_ms"],
    ),
    ("keys of a template", SENSOR, &["diameter", "height", "height_tolerance", "name", "size", "tolerance"]),
    ("keys of the file", NO_MOTION, &["checksum", "map", "name"]),
    ("keys of the file", SENSOR, &["cloud"]),
    ("keys of the file", PAIRS, &["pairs", "scene"]),
    ("solids", YET, &["mesh"]),
];
