//! `[robot.NAME.tools.TOOL]`: several named tools.

use crate::common::{ARM, HEAD, parse};
use elbowroom_cell::Cell;
use elbowroom_monitor::{Part, Presence};

/// One tool per line of keys, on an arm whose forearm is a second flange.
fn cell(gripper: &str, welder: &str, more: &str) -> String {
    format!(
        "{HEAD}[robot.c]\n{ARM}\nstart = [0, 0, 0, 0, 40, 0]\n\
         [robot.c.tools.gripper]\ntcp = {{ at = [0, 0, 200] }}\nbox = {{ at = [0, 0, 100], size = [80, 80, 200] }}\n{gripper}\n\
         [robot.c.tools.welder]\ntcp = {{ at = [0, 0, 300] }}\nbox = {{ at = [0, 0, 150], size = [60, 60, 300] }}\n{welder}\n{more}\n"
    )
}

const CLOUD: &str = "[cloud.mast]\npose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }\n\
                     area = [[750, -3000], [4800, -3000], [4800, 3000]]\nfloor = 0";

#[test]
fn each_tool_has_a_link_a_tcp_and_a_volume() {
    let cell = parse(&cell("", "flange = \"link_3\"", ""));
    let robot = &cell.robots[0];
    let link = |name: &str| robot.robot.chain.link(name).unwrap();
    assert_eq!((robot.flange, robot.payload.tools[1].flange), (link("gripper"), link("link_3")));
    assert_eq!(robot.tcp_in_flange.translation.z, 0.2);
    let volumes = robot.guarded_volumes();
    let of = |name: &str| volumes.iter().find(|v| v.name == name).unwrap();
    assert_eq!((of("gripper").part, of("gripper").link), (Part::Tool, link("gripper")));
    assert_eq!((of("welder tcp").part, of("welder tcp").link), (Part::Tcp, link("welder")));
    assert!(volumes.iter().all(|v| v.presence == Presence::Always));
    // As many solids as with one tool, each once.
    assert_eq!(volumes.iter().filter(|v| v.part == Part::Arm).count(), 5);
    let active = robot.with_tool(1);
    assert_eq!((active.flange, active.tcp_in_flange.translation.z), (link("welder"), 0.3));
    assert!(active.payload.tools.iter().all(|t| t.mounted));
}

#[test]
fn a_change_mounts_one_and_takes_off_the_other() {
    let cell = parse(&cell("", "mounted = false", ""));
    let robot = &cell.robots[0];
    let presence = |name: &str| robot.guarded_volumes().into_iter().find(|v| v.name == name).unwrap().presence;
    assert_eq!([presence("gripper"), presence("welder")], [Presence::Attached, Presence::Detached]);
    let solids = |r: &elbowroom_cell::CellRobot| {
        r.payload.tools.iter().map(|t| r.robot.colliders[t.link.0].len()).collect::<Vec<_>>()
    };
    let changed = robot.with_tool(1);
    assert_eq!((solids(robot), solids(&changed), solids(&changed.with_tool(0))), (vec![1, 0], vec![0, 1], vec![1, 0]));
    assert_eq!(robot.with_all_tools().colliders.iter().map(Vec::len).sum::<usize>(), 7);
}

#[test]
fn a_robot_with_one_tool_has_no_other_links() {
    let none = format!("{HEAD}[robot.c]\n{ARM}\n");
    let one = parse(&format!("{none}[robot.c.tool]\ntcp = {{ at = [0, 0, 200] }}\n"));
    assert!(one.robots[0].payload.tools.is_empty());
    assert_eq!(one.robots[0].robot.chain.links(), parse(&none).robots[0].robot.chain.links());
}

#[test]
fn mistakes_are_named_with_their_line() {
    let welder = "[robot.c.tools.welder]";
    let steps = |step: &str| format!("[program.c]\nsteps = [\n{step},\n]");
    for (text, at, expected) in [
        (cell("", "", ""), welder, "mounted on the flange of \"gripper\""),
        (cell("", "flange = \"link_9\"", ""), "flange = \"link_9\"", "link \"link_9\""),
        (cell("mounted = false", "mounted = false", ""), "[robot.c.tools.gripper]", "no tool that is mounted"),
        (cell("colour = 5", "mounted = false", ""), "colour = 5", "no key `colour`"),
        (cell("mounted = 1", "mounted = false", ""), "mounted = 1", "mounted"),
        (
            cell("", "mounted = false", "[robot.c.tool]\ntcp = { at = [0, 0, 1] }"),
            "[robot.c.tool]",
            "one `tool`, not with `tools`",
        ),
        (
            cell("", "mounted = false", "").replace(".tools.welder", ".tools.link_2"),
            "[robot.c.tools.link_2]",
            "name of a link",
        ),
        (cell("", "mounted = false", &steps("{ tool = \"weldr\" }")), "{ tool = \"weldr\" }", "welder"),
        (cell("", "mounted = false", &steps("{ tool = \"welder\", wait = 1 }")), "{ tool =", "several steps in one"),
        (cell("", "mounted = false", &steps("{ tool = \"welder\", speed = 1 }")), "{ tool =", "speed"),
        (cell("", "mounted = false", "[avoidance.c]"), "[avoidance.c]", "does not see tools that are changed"),
        (cell("", "mounted = false", CLOUD), "[cloud.mast]", "cannot change tools"),
        (format!("{HEAD}[robot.c]\n{ARM}\n{}", steps("{ tool = \"welder\" }")), "{ tool =", "[robot.c.tools.welder]"),
    ] {
        let line = 1 + text.lines().position(|l| l.starts_with(at)).unwrap();
        let e = Cell::parse("c.toml", &text).unwrap_err();
        assert!(e.to_string().contains(expected) && e.hint.is_some(), "{e}\n{text}");
        assert_eq!(e.line, Some(line), "{e}");
    }
}

/// The only tool of a robot and its load are guarded like named tools.
#[test]
fn one_tool_and_its_load_are_guarded() {
    let cell = parse(&format!(
        "{HEAD}[robot.c]\n{ARM}\nload = {{ box = {{ at = [0, 0, 260], size = [100, 60, 120] }} }}\n\
         [robot.c.tool]\ntcp = {{ at = [0, 0, 200] }}\nbox = {{ at = [0, 0, 100], size = [80, 80, 200] }}\n"
    ));
    let robot = &cell.robots[0];
    let volumes = robot.guarded_volumes();
    for (name, part, half_z, at_z) in [("tool", Part::Tool, 0.1, 0.1), ("load", Part::Load, 0.06, 0.26)] {
        let volume = volumes.iter().find(|v| v.name == name).unwrap_or_else(|| panic!("no {name}"));
        let bounds = volume.shape.aabb(&volume.in_link);
        assert_eq!((volume.part, volume.link, volume.presence), (part, robot.flange, Presence::Always));
        assert!((bounds.extent().z * 0.5 - half_z).abs() < 1e-9, "{name}: {bounds:?}");
        assert!(((bounds.min.z + bounds.max.z) * 0.5 - at_z).abs() < 1e-9, "{name}: {bounds:?}");
    }
}
