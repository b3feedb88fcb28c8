//! Keys of the whole file, and the tables that set the monitor, maps and avoidance.

use super::key::{Key, key};

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const TOP: &[Key] = &[
    key("version", "1", "required", "version of this format"),
    key("name", "text", "the file's name; the report calls `cell.toml` by its folder", "shown in reports; processes of one cell find each other by it"),
    key("units", "table", "required: a guessed unit is a wrong unit", "units of all numbers below: `{ length = \"mm\", angle = \"deg\" }`"),
    key("tick_ms", "0.01 to 1000 ms", "2: a common cycle of robot controllers", "period of the control tick"),
    key("max_s", "seconds", "600: so that no run is endless", "longest simulated time of a run"),
    key("checksum", "text", "none", "hex SHA-256 of the approved configuration; any other is refused"),
    key("robot", "tables", "none", "the robots: [`[robot.NAME]`](#robotname)"),
    key("object", "tables", "none", "solid objects: [`[object.NAME]`](#objectname)"),
    key("scene", "tables", "none", "objects of planning scenes: [`[scene.NAME]`](#scenename)"),
    key("region", "tables", "none", "regions: [`[region.NAME]`](#regionname)"),
    key("fence", "tables", "none", "fences, which are regions: [`[fence.NAME]`](#fencename)"),
    key("grid", "tables", "none", "grids of the working area: [`[grid.NAME]`](#gridname)"),
    key("encoder", "tables", "none", "conveyors: [`[encoder.NAME]`](#encodername)"),
    key("fixture", "tables", "none", "virtual fixtures: [`[fixture.NAME]`](#fixturename)"),
    key("force", "tables", "none", "forces between guided tools and their surroundings: [`[force.NAME]`](#forcename)"),
    key("virtual_robot", "tables", "none", "robots that act as one: [`[virtual_robot.NAME]`](#virtual_robotname)"),
    key("operator", "tables", "none", "robots that a person guides: [`[operator.NAME]`](#operatorname)"),
    key("camera", "tables", "none", "cameras: [`[camera.NAME]`](#cameraname)"),
    key("cloud", "tables", "none", "sensors of points: [`[cloud.NAME]`](#cloudname)"),
    key("monitor", "table", "the defaults", "the laws: [`[monitor]`](#monitor)"),
    key("map", "tables", "none", "joint-space maps: [`[map.ROBOT]`](#maprobot)"),
    key("pairs", "path", "none", "[the file of pairs](query.md#the-file-of-pairs): pairs that may touch, such as a gripped part and its table, and weights"),
    key("avoidance", "tables", "none", "robots that evade: [`[avoidance.ROBOT]`](#avoidancerobot)"),
    key("program", "tables", "none", "programs: [`[program.ROBOT]`](#programrobot)"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const UNITS: &[Key] = &[
    key("length", "`\"mm\"` `\"m\"`", "required", "unit of lengths; speeds are per second"),
    key("angle", "`\"deg\"` `\"rad\"`", "required", "unit of angles; turning speeds are per second"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const MONITOR: &[Key] = &[
    key("direction_aware", "true, false", "false: the paper's law alone, which needs no intent of the program", "motion away from a region is not held back"),
    key("recovery", "percent", "10: slow enough to be watched", "largest override while a direction-aware robot leaves a static region from inside"),
    key("stopping_distance", "true, false", "false: it needs measured decelerations", "never faster than a stop before the border allows"),
    key("reaction_ms", "ms", "one tick: the delay of the simulation", "reaction time in the stopping-distance law"),
    key("override_rate", "per second", "0: unlimited, as a limit delays slowing down, too", "largest change of the override per second"),
    key("stale_ms", "ms, at most 1000; above 100 with a warning", "20: ten ticks of 2 ms", "input older than this gives override 0"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const MAP: &[Key] = &[
    key("joints", "names", "the first three", "axes of the map"),
    key("step", "number or one per joint", "2 deg, 20 mm", "width of a cell"),
    key("others", "`\"any\"` `\"start\"`", "`\"any\"`: the safe one", "the remaining joints are anywhere, or held at `start`"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const AVOIDANCE: &[Key] = &[
    key("rules", "path", "the built-in rules", "fuzzy rules; `elbowroom rules --write FILE` writes a copy to change"),
    key("objects", "names", "the objects that move", "objects to evade; other moving objects are avoided, not evaded"),
    key("robots", "names", "all others", "robots to evade; other robots of the cell are avoided, not evaded"),
    key("speed", "length per second", "1 m/s", "speed of an evasion of size 1; 0.01 to 20 m/s"),
    key("clearance", "length", "50 mm", "distance kept from evaded obstacles; 0.1 mm to 5 m, and less than the range of the rules"),
    key("return_speed", "percent, from 1", "50, or the speed of the program if it is slower", "percent of the joints' speeds on detours and on the return path"),
    key("stall_timeout", "seconds", "0.6", "time without progress before another path is planned; 0.01 to 60"),
    key("replan", "true, false", "true", "false: no paths are planned"),
    key("horizon", "seconds, 0 to 10", "3", "time for which the motion of obstacles is predicted; 0: no prediction, no escapes"),
    key("noise", "length, up to 500 mm", "0", "standard deviation of each coordinate of an observed position"),
    key("delay_ms", "milliseconds, up to 2000", "0", "age of an observation when it arrives"),
    key("plan_ms", "milliseconds, up to 10000", "70", "simulated time from the beginning of a plan until its path is followed"),
];
