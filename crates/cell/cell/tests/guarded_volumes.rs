//! A region must guard a volume of every robot that it applies to, and a TCP counts as one.

use crate::common::{HEAD, parse, rail};
use elbowroom_cell::Cell;

const PROGRAM: &str = "[program.a]\nsteps = [{ move = \"joint\", to = [1000] }]\n";

fn region(more: &str) -> String {
    format!("[region.z]\nshape = \"sphere\"\ncentre = [0, 0, 0]\nradius = 300\nwarning = 300\n{more}")
}

/// A carriage without solids; `more` is below its table.
fn robot_with(more: &str) -> String {
    format!("{}start = [-1000]\n{more}", rail("a", 0.0).replace("links = [{ sphere = { radius = 50 } }]\n", ""))
}

fn ball(more: &str) -> String {
    format!("{}start = [-1000]\n{more}", rail("a", 0.0))
}

/// Checks the line of the error and its words.
#[track_caller]
fn refused(text: &str, line: &str, words: &[&str]) {
    let e = Cell::parse("test.toml", text).err().unwrap_or_else(|| panic!("accepted:\n{text}"));
    let at = text.lines().position(|l| l == line).unwrap() + 1;
    assert_eq!(e.line, Some(at), "{e}");
    for word in words {
        assert!(e.to_string().contains(word), "`{word}` is missing in: {e}");
    }
}

#[test]
fn a_region_that_guards_nothing_is_refused() {
    let tool = "guards = [\"tool\"]\n";
    refused(
        &format!("{HEAD}{}{}{PROGRAM}", ball(""), region(tool)),
        "guards = [\"tool\"]",
        &["region \"z\" guards nothing of robot \"a\"", "no tool", "guards = [\"arm\"]"],
    );
    refused(
        &format!("{HEAD}{}{}{PROGRAM}", robot_with(""), region("")),
        "[region.z]",
        &["guards nothing of robot \"a\"", "has a solid", "guards = [\"tcp\"]", "links = "],
    );
    // A fixed solid cannot approach a region.
    refused(
        &format!("{HEAD}{}{}{PROGRAM}", robot_with("base_link = { sphere = { radius = 50 } }\n"), region("")),
        "[region.z]",
        &["guards nothing"],
    );
    let exchange = region("kind = \"exchange\"\nguards = [\"tool\"]\n");
    refused(&format!("{HEAD}{}{exchange}{PROGRAM}", ball("")), "guards = [\"tool\"]", &["guards nothing"]);
    let slow = region("kind = \"monitored\"\nslow_to = 10\nguards = [\"tool\"]\n");
    refused(&format!("{HEAD}{}{slow}{PROGRAM}", ball("")), "guards = [\"tool\"]", &["guards nothing"]);
}

#[test]
fn one_robot_among_several_counts() {
    let two =
        format!("{HEAD}{}{}", ball(""), rail("b", 1000.0).replace("links = [{ sphere = { radius = 50 } }]\n", ""));
    refused(&format!("{two}{}", region("")), "[region.z]", &["robot \"b\"", "`robots` without \"b\""]);
    parse(&format!("{two}{}", region("robots = [\"a\"]\n")));
    parse(&format!("{two}{}", region("guards = [\"tcp\"]\n")));
}

#[test]
fn an_output_that_never_rises_causes_a_warning() {
    let text =
        format!("{HEAD}{}{}{PROGRAM}", ball(""), region("kind = \"monitored\"\noutput = 1\nguards = [\"tool\"]\n"));
    let warnings = parse(&text).warnings;
    assert!(warnings.iter().any(|w| w.message.contains("guards nothing")), "{warnings:?}");
    let tool_only = robot_with("tool.box = { at = [0, 0, 100], size = [50, 50, 200] }\n");
    let warnings = parse(&format!("{HEAD}{tool_only}{}{PROGRAM}", region(""))).warnings;
    assert!(warnings.iter().any(|w| w.message.contains("guards only tool and load")), "{warnings:?}");
}

#[test]
fn a_tcp_within_a_solid_adds_no_guarded_volume() {
    use elbowroom_monitor::Part;
    let part = |more: &str| parse(&format!("{HEAD}{}", ball(more))).robots[0].guarded_volumes()[0].part;
    assert_eq!(part(""), Part::Tcp);
    assert_eq!(part("tool.tcp = { at = [0, 0, 50] }\n"), Part::Tcp, "on the surface");
    assert_eq!(part("tool.tcp = { at = [0, 0, 51] }\n"), Part::TcpOutside);
    let enclosed = "tool.tcp = { at = [0, 0, 51] }\nload = { sphere = { at = [0, 0, 60], radius = 20 } }\n";
    assert_eq!(part(enclosed), Part::Tcp);
}

#[test]
fn a_region_attached_to_the_only_robot_guards_no_robot() {
    let follow = "follow = { robot = \"a\" }";
    let words = ["region \"z\" concerns no robot", "another source to follow"];
    refused(&format!("{HEAD}{}{}{PROGRAM}", ball(""), region(&format!("{follow}\n"))), follow, &words);
}

#[test]
fn an_exchange_region_without_a_warning_zone_is_refused() {
    let exchange = region("kind = \"exchange\"\n").replace("warning = 300", "warning = 0.5");
    refused(&format!("{HEAD}{}{exchange}{PROGRAM}", ball("")), "[region.z]", &["1 mm or more", "warning = 250"]);
}
