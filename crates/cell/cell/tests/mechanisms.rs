//! Mechanisms: what their tables may say, what concerns only robots, and what a file without `robots` means.

use crate::common::{HEAD, rail};
use elbowroom_cell::{Cell, Follow};
use elbowroom_robot::RobotId;

/// A carriage, and a sliding door beside its path. `keys` are lines of the door's table, `more` is added to the file.
fn cell(keys: &str, more: &str) -> String {
    format!(
        "{HEAD}{}[robot.door]\nkind = \"mechanism\"\nbase = {{ at = [0, -1500, 0], rpy = [-90, 0, 0] }}\n\
         dh = [{{ kind = \"prismatic\", min = 0, max = 1500, speed = 500 }}]\nlinks = [{{ sphere = {{ radius = 300 }} }}]\n\
         {keys}\n[object.box]\nshape = \"box\"\nat = [0, 900, 0]\nsize = [100, 100, 100]\n{more}\n",
        rail("a", 0.0)
    )
}

fn parse(keys: &str, more: &str) -> Result<Cell, elbowroom_formats::Diagnostic> {
    Cell::parse("cell.toml", &cell(keys, more))
}

const BALL: &str = "[region.ball]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 200\n";
const CAMERA: &str = "[camera.top]\nsize = [640, 480]\nfocal_px = 500\npose = { at = [1700, 0, 6500], rpy = [180, 0, 0] }\n\
                      area = [[750, -3000], [4800, -3000], [4800, 3000]]\n";

#[test]
fn a_mechanism_is_moved_and_followed_but_nothing_guards_it() {
    let more = format!(
        "{BALL}[region.leaf]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 200\n\
         follow = {{ robot = \"door\", frame = \"link_1\" }}\n{CAMERA}\
         [grid.place]\nfrom = [-2000, -100, -100]\nto = [2000, 100, 100]\ncells = [4, 1, 1]\noutput = 8\n\
         [avoidance.a]\n[program.door]\nsteps = [{{ wait = 1 }}, {{ move = \"joint\", to = [1500], speed = 50 }}]\n"
    );
    let cell = parse("start = [100]\nspeed = 400\nacceleration = 800\njerk = 9000\nstates = { open = [1500] }", &more);
    let cell = cell.unwrap_or_else(|e| panic!("{e}"));
    let [a, door] = [RobotId(0), RobotId(1)];
    assert!(cell.robots[1].is_mechanism() && !cell.robots[0].is_mechanism());
    assert_eq!(cell.guarded_robots().collect::<Vec<_>>(), [a]);
    assert!(cell.robots[1].guarded_volumes().is_empty() && !cell.robots[0].guarded_volumes().is_empty());
    assert!(cell.regions.iter().all(|r| r.robots == [a]), "regions concern robots alone");
    assert!(matches!(cell.regions[1].follow, Some(Follow::Robot { robot, .. }) if robot == door));
    assert_eq!(cell.sensors[0].robots, [a]);
    assert_eq!(cell.monitoring.grids.iter().map(|g| g.robot).collect::<Vec<_>>(), [a]);
    // A robot that avoids obstacles avoids mechanisms too.
    assert_eq!(cell.robots[0].avoidance.as_ref().unwrap().robots, [door]);
    assert!(cell.robots[1].program.is_some());
    // A robot of the same table is guarded by the same regions.
    let robot =
        Cell::parse("cell.toml", &self::cell("", BALL).replace("kind = \"mechanism\"", "kind = \"robot\"")).unwrap();
    assert_eq!(robot.regions[0].robots, [a, door]);
    assert_ne!(robot.approval.checksum, parse("", BALL).unwrap().approval.checksum);
}

/// A cell of mechanisms alone has regions that guard nothing yet.
#[test]
fn regions_of_a_cell_without_robots_are_no_error() {
    let text = cell("", BALL).replace(&rail("a", 0.0), "");
    assert!(Cell::parse("cell.toml", &text).unwrap().regions[0].robots.is_empty());
}

/// Lines of the door's table or of the file, words of the message, words of the hint.
const REFUSED: &[(&str, &str, &str, &str)] = &[
    ("kind = \"door\"", "", "cannot be \"door\"", "mechanism"),
    ("tool = { tcp = { at = [0, 0, 100] } }", "", "carries no tool", "kind = \"robot\""),
    ("tools.hook = { tcp = { at = [0, 0, 100] } }", "", "carries no tool", "kind = \"robot\""),
    ("load = { sphere = { radius = 50 } }", "", "carries no load", "leave it out"),
    ("flange = \"link_1\"", "", "carries no tool", "leave it out"),
    ("volumes = \"box\"", "", "is not guarded", "leave it out"),
    ("overshoot = 1", "", "has no monitor", "leave it out"),
    ("stop_time = 0.2", "", "follows no override", "leave it out"),
    ("", "robots = [\"door\"]", "\"door\", which is a mechanism: it has no monitor", "a robot"),
    ("", "follow = { robot = \"door\" }", "which part of the mechanism \"door\"", "frame = \"link_1\""),
    ("", "follow = { robot = \"door\", frame = \"tcp\" }", "link \"tcp\", which robot", "link_1"),
    (
        "",
        "[avoidance.door]",
        "`avoidance.door` names \"door\", which is a mechanism: it avoids nothing",
        "[robot.door]",
    ),
    ("", "[map.door]", "`map.door` names \"door\", which is a mechanism", "[robot.door]"),
    ("", "[virtual_robot.both]\nrobots = [\"a\", \"door\"]", "mechanism: it carries nothing", "a robot"),
    ("", "[operator.o]\nrobot = \"door\"", "no tool that a person could guide", "a robot"),
    ("", "[grid.g]\ncells = [1]\noutput = 1\nrobots = [\"door\"]", "it has no monitor", "a robot"),
    (
        "",
        "[program.door]\nsteps = [{ grip = \"box\" }]",
        "the mechanism \"door\", which has no hand",
        "move = \"joint\"",
    ),
    (
        "",
        "[program.door]\nsteps = [{ move = \"linear\", to = { at = [0, 0, 0] } }]",
        "which has no tool centre point that could move straight",
        "move = \"joint\"",
    ),
];

#[test]
fn what_only_robots_have_is_refused_with_what_to_write() {
    let mut wrong = Vec::new();
    for (keys, more, what, hint) in REFUSED {
        let own_kind = keys.starts_with("kind");
        let text = cell(if own_kind { "" } else { keys }, &format!("{BALL}{more}"));
        let text = if own_kind { text.replace("kind = \"mechanism\"", keys) } else { text };
        match Cell::parse("cell.toml", &text) {
            Ok(_) => wrong.push(format!("{keys}{more}: accepted")),
            Err(e) => {
                let hinted = e.hint.as_deref().is_some_and(|h| h.contains(hint));
                let line = e.line.and_then(|line| text.lines().nth(line - 1)).unwrap_or("");
                let is_there = keys.contains(line) || more.contains(line) || line == "[robot.door]";
                if !e.message.contains(what) || !hinted || !is_there {
                    wrong.push(format!("{keys}{more}: {e} ({line})"));
                }
            }
        }
    }
    let camera = |line: &str| parse("", &format!("{CAMERA}{line}\n")).unwrap_err().to_string();
    assert!(camera("robots = [\"door\"]").contains("it avoids nothing"));
    assert!(camera("robot = \"door\"").contains("plans no paths"));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
