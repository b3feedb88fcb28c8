//! `elbowroom run` with `[operator.NAME]`: a guided arm glides, brakes, refuses, and says so.

use std::fmt::Write;
use std::path::Path;

use crate::common::elbowroom;

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
model = "MODEL"
start = [0, 0, 0, 0, 35, 0]
[robot.arm.tool]
tcp = { at = [0, 0, 100] }
box = { at = [0, 0, 50], size = [8, 8, 100] }
[object.work]
shape = "box"
size = [400, 400, 200]
at = [1150, 0, 1200]
[operator.hand]
robot = "arm"
stream = "hand.csv"
"#;

/// Orientation of the tool at the start: it looks ahead and down.
const TURN: &str = "0.887010833178222,0,0.46174861323503386,0";

fn write(dir: &Path, cell: &str, hand: impl Fn(f64) -> [f64; 3], seconds: f64) {
    let model = elbowroom_testkit::folder::model("ns16");
    std::fs::write(dir.join("cell.toml"), cell.replace("MODEL", &model.display().to_string())).unwrap();
    let mut text = "t_s,x,y,z,qx,qy,qz,qw\n".to_owned();
    for k in 0..=(seconds * 50.0) as usize {
        let t_s = k as f64 * 0.02;
        let [x, y, z] = hand(t_s);
        writeln!(text, "{t_s},{x},{y},{z},{TURN}").unwrap();
    }
    std::fs::write(dir.join("hand.csv"), text).unwrap();
}

/// From the start into the block, along it, and up again.
fn across(t_s: f64) -> [f64; 3] {
    let y = 100.0 * (t_s - 1.0).clamp(0.0, 2.0) - 100.0 * t_s.min(1.0);
    let z = if t_s < 3.0 { 1358.8 - 100.0 * t_s.min(1.0) } else { 1258.8 + 100.0 * (t_s - 3.0) };
    [1104.2, y, z]
}

struct Row {
    z_m: f64,
    gap_m: Option<f64>,
    active: usize,
}

fn rows(dir: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(dir.join("out/operator.csv")).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let (z, gap, active) = (column("z_m"), column("gap_m"), column("active_rows"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        Row { z_m: cells[z].parse().unwrap(), gap_m: cells[gap].parse().ok(), active: cells[active].parse().unwrap() }
    };
    lines.map(row).collect()
}

#[test]
fn a_tool_pushed_into_a_block_glides_along_it_and_leaves_it() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), CELL, across, 4.0);
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0).json();
    let operator = &answer["operators"][0];
    let number = |key: &str| operator[key].as_f64().unwrap_or_else(|| panic!("{key} of {operator}"));
    assert!(number("contact_s") > 2.0 && number("free_s") > 0.5, "{operator}");
    assert!(number("least_gap_m") >= 0.25e-3 - 1e-9, "{operator}");
    assert!(number("largest_speed_change_m_s") < 0.025, "{operator}");
    let rows = rows(dir.path());
    // The block ends at a height of 1.3 m.
    assert!(rows.iter().all(|row| row.z_m > 1.3), "{}", rows.iter().map(|row| row.z_m).fold(9.0, f64::min));
    assert!(rows.iter().any(|row| row.active > 0 && row.gap_m.is_some_and(|gap| gap < 0.6e-3)));
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    let names: Vec<&str> = events.lines().skip(1).filter_map(|line| line.rsplit(',').next()).collect();
    assert_eq!(names, ["contact", "glide", "leave"], "{events}");
    let text = elbowroom(dir.path(), &["run", "cell.toml"]).expect(0).stdout;
    assert!(
        !text.contains("felt")
            && text.contains("guided by hand: ")
            && text.contains(" s at surfaces, no nearer than 0."),
        "{text}"
    );
}

/// The monitor judges how the robot brakes by where the hand leads next, not by where the tool has arrived.
#[test]
fn a_hand_that_turns_the_tool_in_every_tick_is_followed_without_a_fault() {
    let dir = tempfile::tempdir().unwrap();
    let cell = CELL.replace("[robot.arm]", "[monitor]\nstopping_distance = true\n[robot.arm]");
    let cell = cell.replace("stream = \"hand.csv\"", "stream = \"hand.csv\"\ninterpolation = \"linear\"");
    write(dir.path(), &cell, |_| [1104.2, 0.0, 1358.8], 2.0);
    let text = std::fs::read_to_string(dir.path().join("hand.csv")).unwrap();
    let row = |(k, line): (usize, &str)| {
        // Turns about the world's y axis by 0.8 rad/s, from 2·atan2(0.462, 0.887) about the axis between x and z on.
        let half = 0.5 * 0.8 * 0.02 * k.saturating_sub(1) as f64;
        let (x, z) = (0.887_010_833_178_222, 0.461_748_613_235_033_86);
        let (c, s) = (half.cos(), half.sin());
        let turn = format!("{},0,{},0", c * x + s * z, c * z - s * x);
        line.replace(TURN, &turn)
    };
    let turned: Vec<String> = text.lines().enumerate().map(row).collect();
    std::fs::write(dir.path().join("hand.csv"), turned.join("\n")).unwrap();
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0).json();
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    assert!(!events.contains("fault") && !events.contains("hold"), "{events}");
    // In the end the tool would be turned into the wrist: the arm stands, and no monitor takes it for frozen.
    assert!(events.contains("refuse"), "{events}");
    assert!(answer["operators"][0]["free_s"].as_f64().unwrap() > 1.7, "{answer}");
}

#[test]
fn a_stale_or_disabled_hand_stops_the_arm_smoothly() {
    let dir = tempfile::tempdir().unwrap();
    let up = |t_s: f64| [1104.2, 0.0, 1358.8 + 100.0 * t_s];
    write(dir.path(), CELL, up, 2.0);
    let text = std::fs::read_to_string(dir.path().join("hand.csv")).unwrap();
    // No rows between 0.5 and 1.2 s.
    let gap = |line: &&str| line.split(',').next().unwrap().parse::<f64>().is_ok_and(|t| t > 0.5 && t < 1.2);
    let kept: Vec<&str> = text.lines().filter(|line| !gap(line)).collect();
    std::fs::write(dir.path().join("hand.csv"), kept.join("\n")).unwrap();
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0).json();
    let operator = &answer["operators"][0];
    let stopped_s = operator["stopped_s"].as_f64().unwrap();
    assert!((0.5..0.8).contains(&stopped_s), "{operator}");
    assert!(operator["largest_speed_change_m_s"].as_f64().unwrap() < 0.025, "{operator}");
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    assert!(events.contains("hold") && events.contains("leave"), "{events}");
}

#[test]
fn a_region_slows_the_guided_tool_down_and_keeps_it_out() {
    let dir = tempfile::tempdir().unwrap();
    let region = "[monitor]\nstopping_distance = true\n[region.ceiling]\nshape = \"box\"\nfrom = [500, -500, 1500]\nto = [1500, 500, 2500]\nwarning = 100\nguards = [\"tcp\"]\n";
    write(dir.path(), &format!("{CELL}{region}"), |t_s| [1104.2, 0.0, 1358.8 + 150.0 * t_s], 3.0);
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0).json();
    assert_eq!(answer["regions"][0]["entered"], false, "{answer}");
    // In advance nothing is known about where a person moves a robot.
    let check = elbowroom(dir.path(), &["check", "cell.toml", "--json"]).expect(1).json();
    let reason = check["regions"][0]["reason"].as_str().unwrap();
    assert!(check["regions"][0]["excluded"] == false && reason.contains("a person guides the robot"), "{check}");
    assert!(answer["robots"][0]["min_override"].as_f64().unwrap() < 0.1, "{answer}");
    assert!(rows(dir.path()).iter().all(|row| row.z_m < 1.5));
}

#[test]
fn a_hand_that_turns_back_at_a_region_takes_the_robot_along() {
    let dir = tempfile::tempdir().unwrap();
    let region = "[monitor]\nstopping_distance = true\ndirection_aware = true\n[region.ceiling]\nshape = \"box\"\nfrom = [500, -500, 1500]\nto = [1500, 500, 2500]\nwarning = 100\nguards = [\"tcp\"]\n";
    let up_and_down = |t_s: f64| [1104.2, 0.0, 1358.8 + 150.0 * t_s.min(2.0) - 150.0 * (t_s - 2.0).max(0.0)];
    let force = "[force.soft]\nbetween = [\"arm/tool\", \"work\"]\nlaw = \"admittance\"\n";
    for (extra, head, down_to) in [("", "", 1.38), (force, "", 1.40), (force, "tick_ms = 1\n", 1.40)] {
        write(dir.path(), &format!("{head}{CELL}{region}{extra}"), up_and_down, 4.0);
        let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0).json();
        assert_eq!(answer["regions"][0]["entered"], false, "{answer}");
        let rows = rows(dir.path());
        let highest = rows.iter().map(|row| row.z_m).fold(0.0, f64::max);
        assert!(highest > 1.48 && highest < 1.5, "{highest}");
        assert!(rows[rows.len() - 1].z_m < down_to, "{extra} {head}: {}", rows[rows.len() - 1].z_m);
    }
}

#[test]
fn the_end_of_the_reach_and_a_start_in_the_work_are_told() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), CELL, |t_s| [1104.2, 1500.0 * t_s, 1358.8 + 1500.0 * t_s], 6.0);
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0).json();
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    assert!(events.contains("refuse"), "{events}");
    // Far from the work no gap is told.
    assert!(answer["operators"][0]["least_gap_m"].is_null(), "{answer}");
    write(dir.path(), &CELL.replace("at = [1150, 0, 1200]", "at = [1150, 0, 1258.7]"), across, 1.0);
    for command in ["check", "run"] {
        let message = elbowroom(dir.path(), &[command, "cell.toml"]).expect(2).stderr;
        assert!(message.contains("cell.toml:14") && message.contains("from a surface"), "{command}: {message}");
    }
}

/// The tool looks straight down on a small block.
fn above_a_block() -> String {
    let down = CELL.replace("start = [0, 0, 0, 0, 35, 0]", "start = [0, 0, 0, 0, 90, 0]");
    let work = "size = [80, 80, 60]\nat = [1016.5, 0, 1210]";
    down.replace("size = [400, 400, 200]\nat = [1150, 0, 1200]", work)
}

/// A hole in the block.
const HOLE: &str = "[fixture.hole]\nprotects = \"work\"\ntarget = { drill = { at = [1016.5, 0, 1240], axis = [0, 0, -1], depth = 20 } }\nwidth = 24\noffset = 5\ntolerance = 2\ntool = \"arm\"\n";

#[test]
fn a_fixture_opens_the_work_for_its_tool() {
    let dir = tempfile::tempdir().unwrap();
    let cell = above_a_block();
    let hand = |t_s: f64| [1016.5, 0.0, 1330.0 - 60.0 * t_s.min(2.0)];
    let lowest = |cell: &str| {
        write(dir.path(), &format!("tick_ms = 16\n{cell}"), hand, 3.0);
        let text = std::fs::read_to_string(dir.path().join("hand.csv")).unwrap().replace(TURN, "1,0,0,0");
        std::fs::write(dir.path().join("hand.csv"), text).unwrap();
        elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0);
        rows(dir.path()).iter().map(|row| row.z_m).fold(f64::INFINITY, f64::min)
    };
    let (closed, opened) = (lowest(&cell), lowest(&format!("{cell}{HOLE}")));
    assert!(closed > 1.24 && closed < 1.242, "{closed}");
    assert!(opened < 1.224 && opened > 1.218, "{opened}");
    // Only a run leaves the pair out: elsewhere a tool in the work is a collision.
    let inside = cell.replace("at = [1016.5, 0, 1210]", "at = [924, 0, 1250]");
    write(
        dir.path(),
        &format!("{inside}{HOLE}").replace("drill = { at = [1016.5, 0, 1240]", "drill = { at = [924, 0, 1280]"),
        hand,
        0.1,
    );
    elbowroom(dir.path(), &["query", "cell.toml", "--ask", "collision"]).expect(1);
}

#[test]
fn a_stream_switches_a_fixture_unless_the_tool_is_in_its_opening() {
    let dir = tempfile::tempdir().unwrap();
    let hand = |t_s: f64| [1016.5, 0.0, (1330.0 - 60.0 * t_s.min(2.0)).max(1330.0 - 60.0 * (6.0 - t_s))];
    write(dir.path(), &format!("tick_ms = 16\n{}{HOLE}", above_a_block()), hand, 6.0);
    let text = std::fs::read_to_string(dir.path().join("hand.csv")).unwrap().replace(TURN, "1,0,0,0");
    let switched = |line: &str| {
        let Ok(t_s) = line.split(',').next().unwrap().parse::<f64>() else { return format!("{line},fixture.hole\n") };
        format!("{line},{}\n", u8::from((2.0..3.6).contains(&t_s)))
    };
    let stream: String = text.lines().map(switched).collect();
    std::fs::write(dir.path().join("hand.csv"), &stream).unwrap();
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0);
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    let of_hole: Vec<(f64, &str)> = events
        .lines()
        .filter_map(|line| line.split_once(",arm,hole,"))
        .map(|(t_s, event)| (t_s.parse().unwrap(), event))
        .collect();
    assert_eq!(of_hole.iter().map(|(_, event)| *event).collect::<Vec<_>>(), ["off", "on", "refuse", "off"], "{events}");
    assert!(of_hole[0].0 == 0.0 && of_hole[1].0 == 2.0 && of_hole[2].0 == 3.6, "{of_hole:?}");
    let tick_s = 0.016;
    let rows = rows(dir.path());
    let row = |t_s: f64| &rows[(t_s / tick_s) as usize];
    assert!(rows[..(2.0 / tick_s) as usize].iter().all(|row| row.z_m > 1.24), "closed at first");
    assert!(row(3.4).z_m < 1.224, "open: {}", row(3.4).z_m);
    assert!(row(of_hole[3].0).z_m > 1.24, "closed again when the tool has left: {}", row(of_hole[3].0).z_m);
    // A fixture that is not there, and forces that would not follow.
    std::fs::write(dir.path().join("hand.csv"), stream.replace("fixture.hole", "fixture.hle")).unwrap();
    let message = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
    assert!(message.contains("fixture.hle") && message.contains("fixture.hole"), "{message}");
    std::fs::write(dir.path().join("hand.csv"), stream).unwrap();
    let force = "[force.soft]\nbetween = [\"arm/tool\", \"hole\"]\nlaw = \"repulsive\"\nrange = 9\n";
    std::fs::write(
        dir.path().join("cell.toml"),
        std::fs::read_to_string(dir.path().join("cell.toml")).unwrap() + force,
    )
    .unwrap();
    let message = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
    assert!(message.contains("switches fixtures") && message.contains("cell.toml:"), "{message}");
}

#[test]
fn fixtures_that_would_not_protect_while_they_are_off_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let cell = above_a_block() + HOLE;
    let column = |name: &str, values: [&str; 2]| {
        let rows = values.map(|v| format!("{},1016.5,0,1330,1,0,0,0,{v}\n", if v == values[0] { 0.0 } else { 0.02 }));
        format!("t_s,x,y,z,qx,qy,qz,qw,{name}\n{}", rows.concat())
    };
    let switched = column("fixture.hole", ["1", "0"]);
    let guides = "[fixture.one]\nguide = \"plane\"\nat = [0, 0, 0]\nnormal = [0, 0, 1]\ntool = \"arm\"\n[fixture.two]\nguide = \"plane\"\nat = [0, 0, 0]\nnormal = [0, 0, 1]\ntool = \"arm\"\nactive = false\n";
    let region = "[region.hole]\nshape = \"box\"\nfrom = [0, 900, 0]\nto = [100, 990, 100]\nwarning = 50\n";
    let block = "shape = \"box\"\nsize = [80, 80, 60]";
    for (cell, stream, expected) in [
        (
            cell.clone(),
            column("fixture.hole", ["1", "-1"]),
            &["hand.csv:3", "has -1 in the column `fixture.hole`", "0 or 1"][..],
        ),
        (cell.replace(block, "shape = \"sphere\"\nradius = 30"), switched.clone(), &["not a box or a closed mesh"]),
        (
            cell.replace(block, &format!("{block}\nmotion = {{ via = [[900, 0, 1210]], speed = 10 }}")),
            switched.clone(),
            &["which moves; the shield would not", "stands still"],
        ),
        (
            cell.replace("[operator.hand]", "[operator.hand]\ngap = 0.1"),
            switched.clone(),
            &["`gap` is too small", "gap = 0.5"],
        ),
        (
            cell.clone() + guides,
            column("fixture.two", ["0", "1"]),
            &["at 0.02 s the guides \"one\" and \"two\" are both on"],
        ),
        (cell + region, switched, &["has the name of a region"]),
    ] {
        write(dir.path(), &cell, |_| [0.0; 3], 0.0);
        std::fs::write(dir.path().join("hand.csv"), stream).unwrap();
        let message = elbowroom(dir.path(), &["check", "cell.toml"]).expect(2).stderr;
        for word in expected {
            assert!(message.contains(word), "{word} is not in {message}");
        }
    }
}

#[test]
fn operators_that_contradict_the_cell_are_refused_with_their_line() {
    let dir = tempfile::tempdir().unwrap();
    for (old, new, expected) in [
        ("robot = \"arm\"", "robot = \"leg\"", &["cell.toml:15", "\"leg\"", "arm"][..]),
        ("box = { at = [0, 0, 50], size = [8, 8, 100] }", "", &["has no solid"]),
        ("stream = \"hand.csv\"", "stream = \"hands.csv\"", &["cell.toml:16", "hands.csv"]),
        ("stream = \"hand.csv\"", "stream = \"hand.csv\"\nscale = 0", &["cell.toml:17", "scale"]),
        (
            "stream = \"hand.csv\"",
            "stream = \"hand.csv\"\ninterpolation = \"cubic\"",
            &["cell.toml:17", "\"cubic\"", "linear"],
        ),
        ("stream = \"hand.csv\"", "stream = \"hand.csv\"\nstale_ms = 5000", &["cell.toml:17", "at most 1000"]),
        (
            "[operator.hand]",
            "[program.arm]\nsteps = [{ wait = 1 }]\n[operator.hand]",
            &["cell.toml:17", "[program.arm]"],
        ),
        (
            "[operator.hand]",
            "[operator.other]\nrobot = \"arm\"\nstream = \"hand.csv\"\n[operator.hand]",
            &["cell.toml:17", "\"other\" already"],
        ),
    ] {
        assert!(CELL.contains(old), "{old}");
        write(dir.path(), &CELL.replacen(old, new, 1), across, 0.1);
        let message = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
        for word in expected {
            assert!(message.contains(word), "{new}: {word} is not in {message}");
        }
    }
    let carrier = "[robot.other]\ndh = [{ a = 100, speed = 90 }]\nbase = { at = [-3000, 0, 0] }\n[program.other]\nsteps = [{ grip = \"work\" }]\n[operator.hand]";
    write(dir.path(), &CELL.replace("[operator.hand]", carrier), across, 0.1);
    let message = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
    assert!(message.contains("does not see parts that are carried, as those of robot \"other\""), "{message}");
    write(dir.path(), CELL, across, 0.1);
    std::fs::write(dir.path().join("hand.csv"), "t_s,x,y,z,qx,qy,qz,qw,grip\n0,0,0,0,0,0,0,1,1\n").unwrap();
    let message = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
    assert!(message.contains("grip") && message.contains("hand.csv"), "{message}");
}

/// A column of `operator.csv`.
fn column(dir: &Path, name: &str) -> Vec<Option<f64>> {
    let text = std::fs::read_to_string(dir.join("out/operator.csv")).unwrap();
    let at = text.lines().next().unwrap().split(',').position(|h| h == name).unwrap_or_else(|| panic!("no {name}"));
    text.lines().skip(1).map(|line| line.split(',').nth(at).unwrap().parse().ok()).collect()
}

#[test]
fn forces_hold_the_tool_off_and_are_told() {
    let force = |keys: &str| format!("{CELL}[force.soft]\nbetween = [\"arm/tool\", \"work\"]\n{keys}\n");
    // In the middle of the run the hand is 41.2 mm inside the block: it ends at 1300 mm.
    for (keys, least_z, most_z, least_n, most_n) in [
        ("law = \"spring_damper\"\nrange = 30\nstiffness = 2000", 1.305, 1.32, 40.0, 46.0),
        ("law = \"khatib\"\nrange = 30\nstiffness = 2000", 1.305, 1.325, 40.0, 50.0),
        ("law = \"admittance\"\nstiffness = 1000\nmass = 1", 1.3, 1.305, 40.0, 48.0),
        ("law = \"impedance\"\nstiffness = 1000", 1.3, 1.305, 40.0, 48.0),
        ("law = \"impedance\"\nstiffness = 1000\nrange = 4", 1.3, 1.305, 43.0, 52.0),
    ] {
        let dir = tempfile::tempdir().unwrap();
        write(dir.path(), &force(keys), across, 4.0);
        let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0).json();
        let operator = &answer["operators"][0];
        let largest_n = operator["largest_force_n"].as_f64().unwrap();
        assert!((least_n..most_n).contains(&largest_n), "{keys}: {operator}");
        assert!(operator["energy_j"].as_f64().unwrap() > 0.0, "{keys}: {operator}");
        assert!(operator["largest_speed_change_m_s"].as_f64().unwrap() < 0.03, "{keys}: {operator}");
        let least = rows(dir.path()).iter().map(|row| row.z_m).fold(9.0, f64::min);
        assert!((least_z..most_z).contains(&least), "{keys}: {least} m");
        let (energy, up) = (column(dir.path(), "energy_j"), column(dir.path(), "fz_n"));
        assert!(energy.iter().all(|e| e.unwrap() >= -0.01) && up[1000].unwrap() > 30.0, "{keys}");
    }
}

#[test]
fn a_field_around_the_whole_arm_turns_it_away() {
    let wall = "[object.wall]\nshape = \"box\"\nsize = [300, 20, 900]\nat = [600, 260, 1300]\n[force.soft]\nbetween = [\"arm\", \"wall\"]\nlaw = \"repulsive\"\nrange = 150\nstiffness = 3000\n";
    let most_y = |force: bool| {
        let dir = tempfile::tempdir().unwrap();
        let wall = if force { wall.to_owned() } else { wall.split("[force").next().unwrap().to_owned() };
        // The hand draws the arm towards the wall, which the tool itself passes in front.
        write(dir.path(), &format!("{CELL}{wall}"), |t_s| [1104.2, 100.0 * t_s.min(2.0), 1400.0], 3.0);
        let text = elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0).stdout;
        assert_eq!(text.contains(", felt at most "), force, "{text}");
        column(dir.path(), "y_m").into_iter().flatten().fold(0.0, f64::max)
    };
    let (with, without) = (most_y(true), most_y(false));
    assert!(with < without - 0.005 && with > 0.05, "{with} m with a force, {without} m without");
}

#[test]
fn a_guide_keeps_the_tool_on_its_line() {
    let dir = tempfile::tempdir().unwrap();
    let guide = "[fixture.seam]\nguide = \"line\"\ntool = \"arm\"\npoints = [[1104.2, 0, 1358.8], [1104.2, -100, 1330], [1104.2, 50, 1320]]\n";
    write(dir.path(), &format!("{CELL}{guide}"), across, 4.0);
    elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "out"]).expect(0);
    let corners = [[0.0, 1.3588], [-0.1, 1.33], [0.05, 1.32]];
    let off = |y: f64, z: f64| {
        let of = |w: &[[f64; 2]]| {
            let way = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
            let share = ((y - w[0][0]) * way[0] + (z - w[0][1]) * way[1]) / (way[0] * way[0] + way[1] * way[1]);
            let share = share.clamp(0.0, 1.0);
            (y - w[0][0] - share * way[0]).hypot(z - w[0][1] - share * way[1])
        };
        corners.windows(2).map(of).fold(f64::INFINITY, f64::min)
    };
    let (y, z) = (column(dir.path(), "y_m"), column(dir.path(), "z_m"));
    let farthest = y.iter().zip(&z).map(|(y, z)| off(y.unwrap(), z.unwrap())).fold(0.0, f64::max);
    assert!(farthest < 1e-3, "{farthest} m from the line");
    assert!(y.iter().any(|y| y.unwrap() > 0.049), "the end of the line");
}

#[test]
fn forces_and_guides_that_mean_nothing_are_refused_with_the_remedy() {
    let force = |keys: &str| format!("{CELL}[force.soft]\n{keys}\n");
    let guide = |keys: &str| format!("{CELL}[fixture.seam]\ntool = \"arm\"\n{keys}\n");
    let between = "between = [\"arm/tool\", \"work\"]\n";
    for (cell, expected) in [
        (force("between = [\"arm/tool\"]\nlaw = \"repulsive\""), "has 1 names instead of two"),
        (force("between = [\"crane\", \"work\"]\nlaw = \"repulsive\""), "names \"crane\", which no operator guides"),
        (force("between = [\"arm\", \"wrok\"]\nlaw = \"repulsive\""), "write: work"),
        (force(&format!("{between}law = \"repulsive\"")), "range = 20"),
        (force(&format!("{between}law = \"repulsive\"\nrange = 9\nmass = 2")), "belongs to `law = \"admittance\"`"),
        (force(&format!("{between}law = \"impedance\"\ndevice_damping = 0.5")), "`stiffness` of at most 500"),
        (
            force(&format!("{between}law = \"impedance\"\n[force.more]\n{between}law = \"admittance\"")),
            "one `admittance` or one `impedance` per tool",
        ),
        (guide("guide = \"line\"\npoints = [[0, 0, 0]]"), "two points or more"),
        (guide("guide = \"cone\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\nhalf_angle = 95"), "not below 90°"),
        (guide("guide = \"plane\"\nat = [0, 0, 0]\nnormal = [0, 0, 0]"), "must be a direction"),
        (guide("guide = \"plane\"\nat = [0, 0, 0]\nnormal = [0, 0, 1]\nradius = 3"), "does not belong to a plane"),
    ] {
        let dir = tempfile::tempdir().unwrap();
        write(dir.path(), &cell, across, 1.0);
        let text = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
        assert!(text.contains(expected) && text.contains("cell.toml:"), "{expected}: {text}");
    }
}
