//! `elbowroom check`, and the warnings of `run` before it begins.

use crate::common::{Answer, elbowroom, examples, keys};
use std::path::Path;

/// A carriage at 2 m/s that stops in 0.25 s, and a wall with a thin warning zone: it runs 202 mm into it by the bare law.
const OVERRUN: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
tick_ms = 2

[robot.cart]
base = { at = [0, 0, 0], rpy = [0, 90, 0] }
dh = [{ kind = "prismatic", min = -3000, max = 3000, speed = 2000, acceleration = 8000 }]
links = [{ sphere = { radius = 50 } }]
stop_time = 0.25
start = [-2500]

[region.wall]
shape = "box"
base = [1000, 0, -500]
size = [1000, 1000, 1000]
warning = 50

[program.cart]
steps = [{ move = "joint", to = [2500] }]
"#;

const STOPPING: &str = "[monitor]\nstopping_distance = true\n";

fn cell(text: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), text).unwrap();
    dir
}

fn check(text: &str) -> Answer {
    elbowroom(cell(text).path(), &["check", "cell.toml", "--json"])
}

fn run(text: &str) -> Answer {
    elbowroom(cell(text).path(), &["run", "cell.toml", "--json"])
}

/// The thickness is the sum, a supplement for the reaction time of the law
/// (docs/laws.md, section 2: (v·t)²/4 over the braking distance), and 0.3 % for sampling.
fn assert_close(needed: f64, sum: f64, late: f64) {
    assert!(needed >= sum && needed <= (sum + late) * 1.003, "{needed} m, the sum is {sum} m");
}

#[test]
fn an_overrun_is_said_before_the_run() {
    let answer = run(OVERRUN).expect(1);
    for words in ["cell.toml:12: ", "region \"wall\"", "robot \"cart\"", "2000 mm/s", "255 mm", "50 mm"] {
        assert!(answer.stderr.contains(words), "{words}: {}", answer.stderr);
    }
    assert!(answer.stderr.contains("write: stopping_distance = true in [monitor], or warning = 255 in [region.wall]"));
    // Both named remedies work, without further warnings.
    for cured in [format!("{OVERRUN}{STOPPING}"), OVERRUN.replace("warning = 50", "warning = 255")] {
        let answer = run(&cured).expect(0);
        assert!(!answer.stderr.contains("overrun"), "{}", answer.stderr);
    }
    // No warning of overruns without the monitor.
    let free = elbowroom(cell(OVERRUN).path(), &["run", "cell.toml", "--no-monitor"]).expect(1);
    assert!(!free.stderr.contains("overrun"), "{}", free.stderr);
}

/// A fence is a region with a table of its own.
#[test]
fn the_remedy_for_a_fence_names_its_table() {
    let corners = "corners = [[-3000, -2000], [600, -2000], [600, 2000], [-3000, 2000]]\nheight = 3000\nfloor = -1500";
    let fence = OVERRUN.split("[region.wall]\n").next().unwrap();
    let rest = OVERRUN.split("[region.wall]\n").nth(1).unwrap();
    let after = rest.find("\n[").map_or("", |at| &rest[at..]);
    let cell = cell(&format!("{fence}[fence.wall]\n{corners}\nwarning = 50\n{after}"));
    let answer = elbowroom(cell.path(), &["check", "cell.toml"]).expect(1);
    assert!(answer.stdout.contains("in [fence.wall]") && !answer.stdout.contains("region.wall"), "{}", answer.stdout);
}

#[test]
fn check_says_whether_entry_is_excluded_and_why() {
    let answer = check(OVERRUN).expect(1).json();
    let row = &answer["regions"][0];
    assert_eq!(keys(row), ["excluded", "kind", "name", "needed_warning_m", "reason", "robot", "warning_m", "write"]);
    assert_eq!((row["name"].as_str(), row["robot"].as_str()), (Some("wall"), Some("cart")));
    assert_eq!(row["excluded"], false);
    // 2²/(2·8) + 2·0.002; then 20 µm because the robot acts on late answers when it reaches the law's curve, and 0.2 %.
    assert_close(row["needed_warning_m"].as_f64().unwrap(), 0.254, 0.02e-3);
    assert!(row["reason"].as_str().unwrap().contains("`stopping_distance` is off"), "{row}");
    assert!(row["write"].as_str().unwrap().contains("stopping_distance = true"), "{row}");

    let row = &check(&format!("{OVERRUN}{STOPPING}")).expect(0).json()["regions"][0];
    assert_eq!(row["excluded"], true);
    assert!(row["reason"].as_str().unwrap().contains("provided that its joints brake as `stop_time` states"), "{row}");
    let row = &check(&OVERRUN.replace("warning = 50", "warning = 255")).expect(0).json()["regions"][0];
    assert!(row["reason"].as_str().unwrap().contains("thick enough"), "{row}");
    assert_eq!(
        check(&OVERRUN.replace("warning = 50", "warning = 253")).expect(1).json()["regions"][0]["excluded"],
        false
    );
}

#[test]
fn the_reaction_time_and_the_programmed_override_count() {
    let needed = |text: &str| check(text).json()["regions"][0]["needed_warning_m"].as_f64().unwrap();
    let slow = format!("{OVERRUN}[monitor]\nreaction_ms = 30\n");
    // One tick until the speed is seen, 30 ms until the override is obeyed.
    assert_close(needed(&slow), 0.314, 0.064 * 0.064 / (4.0 * 0.25));
    let half = OVERRUN.replace("[program.cart]\n", "[program.cart]\noverride = 50\n");
    assert_close(needed(&half), 0.0625 + 0.002, 0.02e-3);
    // The override falls more slowly than the robot brakes: 2/s instead of 4/s.
    let rate = format!("{OVERRUN}[monitor]\noverride_rate = 2\n");
    assert_close(needed(&rate), 0.504, 0.02e-3);
    // It does not delay the stopping distance.
    check(&format!("{OVERRUN}{STOPPING}override_rate = 2\n")).expect(0);
}

#[test]
fn a_robot_that_is_released_near_the_border_is_not_kept_out_by_any_thickness() {
    let thick = OVERRUN.replace("warning = 50", "warning = 2000");
    check(&thick).expect(0);
    let aware = format!("{thick}[monitor]\ndirection_aware = true\n");
    // A single straight move never comes back.
    check(&aware).expect(0);
    // It moves to the border, a little away from it, at full speed, and in.
    let turns =
        aware.replace("to = [2500]", "to = [500] }, { move = \"joint\", to = [400] }, { move = \"joint\", to = [2500]");
    let row = &check(&turns).expect(1).json()["regions"][0];
    assert_eq!(row["excluded"], false);
    assert!(row["reason"].as_str().unwrap().contains("no thickness is enough"), "{row}");
    assert!(row["write"].as_str().unwrap().starts_with("stopping_distance = true"), "{row}");
    check(&turns.replace("direction_aware = true", "stopping_distance = true\ndirection_aware = true")).expect(0);
}

#[test]
fn what_no_law_excludes_is_said() {
    let stopping = format!("{OVERRUN}{STOPPING}");
    let reason = |text: &str, words: &str| {
        let answer = check(text).expect(1).json();
        let reason = answer["regions"][0]["reason"].as_str().unwrap().to_owned();
        assert!(reason.contains(words), "{reason}");
    };
    reason(&stopping.replace("start = [-2500]", "start = [1500]"), "starts inside");
    reason(&stopping.replace("warning = 50", "warning = 50\nlife = \"temporary\""), "temporary");
    let belt = "[encoder.belt]\nspeed = 100\n";
    let moving = stopping.replace("warning = 50", "warning = 50\nfollow = { encoder = \"belt\" }");
    reason(&format!("{moving}{belt}"), "the region moves");
    // A stopped belt moves nothing.
    check(&format!("{moving}{}", belt.replace("100", "0"))).expect(0);
}

#[test]
fn a_monitored_region_is_listed_and_no_trouble() {
    let answer = check(&OVERRUN.replace("warning = 50", "kind = \"monitored\"")).expect(0).json();
    assert_eq!(answer["regions"][0]["excluded"], false);
    assert!(answer["regions"][0]["reason"].as_str().unwrap().starts_with("monitored"));
}

#[test]
fn two_that_start_in_one_exchange_region_are_told_apart_from_one() {
    let shared = OVERRUN
        .replace("warning = 50", "warning = 300\nkind = \"exchange\"")
        .replace("start = [-2500]", "start = [1500]");
    check(&shared).expect(0);
    let second = "[robot.other]\nbase = { at = [0, 400, 0], rpy = [0, 90, 0] }\n\
                  dh = [{ kind = \"prismatic\", min = -3000, max = 3000, speed = 2000 }]\n\
                  links = [{ sphere = { radius = 50 } }]\nstart = [1500]\n";
    let answer = check(&format!("{shared}{second}")).expect(1).json();
    assert!(answer["regions"][0]["reason"].as_str().unwrap().contains("another robot"), "{answer}");
}

#[test]
fn the_table_fits_a_hundred_columns() {
    let long = OVERRUN.replace("wall", "a_wall_with_a_name_that_is_longer_than_any_column_of_a_table");
    let answer = elbowroom(cell(&long).path(), &["check", "cell.toml"]).expect(1);
    assert!(answer.stdout.lines().all(|l| l.chars().count() <= 100), "{}", answer.stdout);
    assert!(answer.stdout.contains("POSSIBLE") && answer.stdout.contains("write: "), "{}", answer.stdout);
}

#[test]
fn the_examples_stop_in_time() {
    for cell in ["figure12", "exchange", "conveyor", "tool_box", "pallet"] {
        let file = examples().join(cell).join("cell.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("stopping_distance = true") && text.contains("direction_aware = true"), "{cell}");
        let answer = elbowroom(Path::new("."), &["check", file.to_str().unwrap(), "--json"]);
        assert!(answer.status < 2 && answer.stderr.is_empty(), "{cell}: {}", answer.stderr);
        for row in answer.json()["regions"].as_array().unwrap() {
            let (reason, kind) = (row["reason"].as_str().unwrap(), row["kind"].as_str().unwrap());
            assert!(
                row["excluded"] == true || kind == "monitored" || reason.contains("the region moves"),
                "{cell}: {row}"
            );
        }
    }
}

#[test]
fn a_region_that_guards_nothing_is_no_cell() {
    let text = OVERRUN.replace("warning = 50", "warning = 50\nguards = [\"tool\"]");
    for answer in [run(&text), check(&text)] {
        let answer = answer.expect(2);
        assert!(answer.stderr.contains("cell.toml:17: region \"wall\" guards nothing"), "{}", answer.stderr);
        assert!(answer.stderr.contains("write: guards = [\"arm\"]"), "{}", answer.stderr);
    }
}

/// One region that cannot be kept is enough, first or last; a cell without regions has none.
#[test]
fn one_bad_region_among_good_ones_fails_the_check() {
    let good = |name: &str| {
        format!("[region.{name}]\nshape = \"sphere\"\ncentre = [0, 9000, 0]\nradius = 100\nwarning = 300\n")
    };
    for more in [good("aaa"), good("zzz"), good("aaa") + &good("zzz")] {
        let rows = check(&format!("{OVERRUN}{more}")).expect(1).json()["regions"].clone();
        let excluded = rows.as_array().unwrap().iter().filter(|row| row["excluded"] == true).count();
        assert_eq!(excluded + 1, rows.as_array().unwrap().len(), "{rows}");
    }
    let (robot, rest) = OVERRUN.split_once("[region.wall]").unwrap();
    let program = &rest[rest.find("[program").unwrap()..];
    check(&format!("{robot}{program}")).expect(0);
}
