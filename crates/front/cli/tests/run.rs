//! `elbowroom run`: exit status, JSON, files.

use crate::common::{SWING, elbowroom, examples, keys, solid_swing, swing, with_cell};

#[test]
fn a_guarded_arm_stops_before_the_region() {
    let dir = swing();
    let answer = elbowroom(dir.path(), &["run", "cell.toml"]).expect(0);
    assert!(answer.stdout.contains("before post"), "{}", answer.stdout);
    assert!(answer.stdout.contains("TCP on link_2"), "{}", answer.stdout);
    assert!(
        answer.stdout.contains("continues when the program moves away (direction_aware = true)\n"),
        "{}",
        answer.stdout
    );
    assert!(answer.stdout.contains("Not a certified safety device."));
    assert_eq!(answer.stderr, "");
}

#[test]
fn without_the_monitor_it_enters_with_exit_status_1() {
    let dir = swing();
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--no-monitor", "--json"]).expect(1).json();
    assert_eq!(json["regions"][0]["entered"], true);
    assert_eq!(json["robots"][0]["finished"], true);
}

#[test]
fn a_free_program_finishes() {
    let dir = with_cell(&SWING.replace("[90, 0]", "[-90, 0]"));
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    assert_eq!(json["robots"][0]["finished"], true);
    assert_eq!(json["robots"][0]["min_override"], 1.0);
}

#[test]
fn a_collision_has_exit_status_1() {
    let text = SWING.replace("guards", "kind = \"monitored\"\nguards")
        + "\n[object.wall]\nshape = \"box\"\nat = [0, 650, 0]\nsize = [200, 400, 200]\n";
    let links = "links = [[], { capsule = { from = [0, 0, 0], to = [-300, 0, 0], radius = 40 } }]\n";
    let dir = with_cell(&text.replace("\n[region", &format!("{links}\n[region")));
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(1).json();
    let collision = &json["robots"][0]["collisions"][0];
    assert_eq!(keys(collision), ["a", "b", "t_s"]);
    assert_eq!((collision["a"].as_str(), collision["b"].as_str()), (Some("arm/link_2"), Some("wall")));
    assert!(collision["t_s"].as_f64().unwrap() > 0.5);
}

#[test]
fn notes_on_programs_are_called_warnings() {
    let text = SWING.split("[program.arm]").next().unwrap().replacen("\n[region", "start = [10, 0]\n\n[region", 1);
    let dir = with_cell(&(text + "[program.arm]\ntrajectory = \"t.csv\"\n"));
    std::fs::write(dir.path().join("t.csv"), "t_s,joint_1,joint_2\n0,0,0\n1,-0.1,0\n").unwrap();
    let answer = elbowroom(dir.path(), &["run", "cell.toml"]).expect(0);
    let note = answer.stderr.lines().find(|l| l.contains("does not begin at `start`")).expect(&answer.stderr);
    assert!(note.starts_with("warning: cell.toml:"), "{note}");
}

/// Makes a belt that never stops, with a region on it: far away, or across the path of the arm.
fn with_belt(base: &str, speed: f64) -> String {
    SWING.to_owned()
        + &format!(
            "\n[encoder.belt]\ndirection = [0, 0, 1]\nspeed = {speed}\n[region.part]\nshape = \"cylinder\"\n\
             base = {base}\nradius = 50\nheight = 200\nwarning = 100\nguards = [\"tcp\"]\n\
             follow = {{ encoder = \"belt\" }}\n"
        )
}

#[test]
fn a_run_ends_where_only_an_endless_belt_moves() {
    let dir = with_cell(&with_belt("[5000, 5000, 0]", 100.0));
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    let robot = &json["robots"][0];
    assert_eq!((json["end"].as_str(), robot["outcome"].as_str()), (Some("standstill"), Some("stopped")), "{json}");
    let (ended, stopped) = (json["duration_s"].as_f64().unwrap(), robot["stopped_at_s"].as_f64().unwrap());
    assert!((9.0..11.0).contains(&(ended - stopped)), "{stopped} to {ended}");
    let text = elbowroom(dir.path(), &["run", "cell.toml"]).expect(0).stdout;
    assert!(text.contains("only endless belts moved"), "{text}");
}

#[test]
fn a_robot_that_waits_for_the_belt_to_carry_its_region_away_is_waited_for() {
    // The region is on the path for about 20 s, and no other region is.
    let text = with_belt("[495, 495, -200]", 10.0).replacen("base = [495, 495, -500]", "base = [5000, 0, 0]", 1);
    let json = elbowroom(with_cell(&text).path(), &["run", "cell.toml", "--json"]).expect(0).json();
    assert_eq!(
        (json["end"].as_str(), json["robots"][0]["finished"].as_bool()),
        (Some("finished"), Some(true)),
        "{json}"
    );
    assert!(json["robots"][0]["stopped_s"].as_f64().unwrap() > 10.5, "{json}");
}

#[test]
fn json_has_the_documented_keys_and_types() {
    let dir = swing();
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    assert_eq!(
        keys(&json),
        ["cell", "checksum", "deadlocks", "duration_s", "end", "regions", "robots", "tick_ns", "ticks"]
    );
    assert_eq!(json["cell"], "cell");
    let checksum = json["checksum"].as_str().unwrap();
    assert!(checksum.len() == 64 && checksum.chars().all(|c| c.is_ascii_hexdigit()), "{checksum}");
    assert!(json["duration_s"].is_f64() && json["ticks"].is_u64());
    assert_eq!(keys(&json["tick_ns"]), ["max", "p50", "p99"]);
    assert!(json["tick_ns"]["p50"].as_u64() <= json["tick_ns"]["max"].as_u64());
    let robot = &json["robots"][0];
    let what = ["by", "collisions", "finished", "flange", "min_override", "name", "outcome", "part", "part_kind"];
    assert_eq!(keys(robot), [&what[..], &["point_m", "release", "stopped_at_s", "stopped_s", "stops"]].concat());
    assert_eq!((json["end"].as_str(), robot["flange"].as_str()), (Some("rest"), Some("link_2")));
    assert_eq!(robot["release"], "the program moves away (direction_aware = true)");
    assert_eq!((robot["name"].as_str(), robot["finished"].as_bool()), (Some("arm"), Some(false)));
    assert!(robot["stopped_s"].as_f64().unwrap() >= 1.0, "a run ends after a second of rest");
    let stops = robot["stops"].as_array().unwrap();
    assert_eq!(stops.len(), 1);
    assert_eq!(keys(&stops[0]), ["by", "distance_m", "from_s", "part", "point_m", "to_s"]);
    assert_eq!((stops[0]["by"].as_str(), stops[0]["part"].as_str()), (Some("post"), robot["part"].as_str()));
    assert_eq!(stops[0]["to_s"], json["duration_s"]);
    let stood = json["duration_s"].as_f64().unwrap() - stops[0]["from_s"].as_f64().unwrap();
    assert!((stood - robot["stopped_s"].as_f64().unwrap()).abs() < 0.02, "{stood}");
    assert!(robot["min_override"].as_f64().unwrap() < 0.01);
    assert_eq!(robot["collisions"].as_array().map(Vec::len), Some(0));
    let region = &json["regions"][0];
    assert_eq!(keys(region), ["entered", "kind", "min_distance_m", "name", "warned_s"]);
    assert_eq!((region["kind"].as_str(), region["entered"].as_bool()), (Some("forbidden"), Some(false)));
    let closest = region["min_distance_m"].as_f64().unwrap();
    assert!((0.0..=0.002).contains(&closest), "{closest}");
    assert!(region["warned_s"].as_f64().unwrap() > 1.0);
}

#[test]
fn the_checksum_that_a_run_prints_is_the_one_the_cell_file_takes() {
    let dir = swing();
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    let sum = json["checksum"].as_str().unwrap();
    let sealed = format!("checksum = \"{sum}\"\n{SWING}");
    std::fs::write(dir.path().join("cell.toml"), &sealed).unwrap();
    elbowroom(dir.path(), &["run", "cell.toml"]).expect(0);
    std::fs::write(dir.path().join("cell.toml"), sealed.replace("radius = 50", "radius = 51")).unwrap();
    let refused = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2);
    assert!(refused.stderr.contains("cell.toml:1:"), "{}", refused.stderr);
}

#[test]
fn an_error_names_file_and_line_and_a_hint() {
    let dir = with_cell(&SWING.replace("radius = 50", "radios = 50"));
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(2);
    assert_eq!(answer.stdout, "", "no half document");
    assert!(answer.stderr.contains("cell.toml:10:"), "{}", answer.stderr);
    assert!(answer.stderr.contains("radius"), "{}", answer.stderr);
}

#[test]
fn at_full_speed_the_law_of_the_paper_alone_stops_in_a_zone_that_is_thick_enough_and_not_in_a_thin_one() {
    let text = std::fs::read_to_string(examples().join("full_speed/cell.toml")).unwrap();
    assert!(!text.contains("[monitor]"));
    let text = text.replace("../models", &examples().join("models").display().to_string());
    for (warning, arguments, is_entered) in
        [(250, &[][..], false), (50, &[][..], true), (250, &["--no-monitor"][..], true)]
    {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("cell.toml"), text.replace("warning = 250", &format!("warning = {warning}")))
            .unwrap();
        let answer = elbowroom(dir.path(), &[&["run", "cell.toml", "--json", "--out", "out"][..], arguments].concat());
        let json = answer.expect(i32::from(is_entered)).json();
        assert_eq!(json["regions"][0]["entered"], is_entered, "{warning} {arguments:?}");
        let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
        // On the line from A to B, before the zone.
        let speed = |row: &str| {
            let number = |i: usize| row.split(',').nth(i).unwrap().parse::<f64>().unwrap();
            let is_before = (number(8) - 0.9).abs() < 1e-4 && number(9) < -0.147 - 1e-3 * f64::from(warning);
            if is_before { number(11) } else { 0.0 }
        };
        let fastest = trace.lines().skip(1).map(speed).fold(0.0, f64::max);
        assert!(fastest > 1.5, "as fast as the joints allow: {fastest} m/s");
    }
}

/// A door has joints and no program.
#[test]
fn what_has_no_program_has_not_finished_but_not_moved() {
    let dir = swing();
    let door = "[robot.door]\ndh = [{ a = 800, min = 0, max = 100, speed = 60 }]\nbase = { at = [0, 3000, 0] }\n\
                links = [{ box = { at = [-400, 0, 1000], size = [800, 40, 2000] } }]\n";
    let file = dir.path().join("cell.toml");
    std::fs::write(&file, std::fs::read_to_string(&file).unwrap() + door).unwrap();
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0);
    assert!(answer.stdout.contains("door   did not move\n"), "{}", answer.stdout);
    assert!(!answer.stdout.contains("door   finished") && answer.stdout.contains("arm    "), "{}", answer.stdout);
    let report = std::fs::read_to_string(dir.path().join("out/report.html")).unwrap();
    assert!(report.contains("door did not move"));
}

/// The number of the cell is that of the TCP in the same row, but for the hysteresis of 1 mm.
#[test]
fn grids_add_columns_with_the_number_of_the_occupied_cell() {
    let grids = "[grid.sector]\njoints = [\"joint_1\"]\nfrom = [-90]\nto = [90]\ncells = [9]\noutput = 20\n\
                 [grid.area]\nfrom = [0, -800, -10]\nto = [800, 800, 10]\ncells = [4, 8, 1]\noutput = 40\n";
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), format!("{}{grids}", solid_swing())).unwrap();
    let trace = |arguments: &[&str]| {
        elbowroom(dir.path(), &[&["run", "cell.toml", "--out", "out"][..], arguments].concat());
        std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap()
    };
    for arguments in [&[][..], &["--no-monitor"]] {
        let trace = trace(arguments);
        assert!(trace.lines().next().unwrap().ends_with(",point_x_m,point_y_m,point_z_m,grid.sector,grid.area"));
        let mut seen = std::collections::BTreeSet::new();
        for row in trace.lines().skip(1) {
            let row: Vec<&str> = row.split(',').collect();
            let number = |i: usize| row[i].parse::<f64>().unwrap();
            let place = |x: f64, from: f64, to: f64, count: f64| ((x - from) / (to - from) * count).floor();
            let near = |x: f64, step: f64| (x / step - (x / step).round()).abs() * step < 2e-3;
            let (q1, x, y) = (number(2), number(4), number(5));
            let half_turn = std::f64::consts::FRAC_PI_2;
            let sector = if q1.abs() > half_turn { 0.0 } else { 1.0 + place(q1, -half_turn, half_turn, 9.0) };
            if !near(q1 + half_turn, half_turn / 4.5) {
                assert_eq!(number(row.len() - 2), sector, "{row:?}");
            }
            let area = 1.0 + place(x, 0.0, 0.8, 4.0) + 4.0 * place(y, -0.8, 0.8, 8.0);
            if !near(x, 0.2) && !near(y, 0.2) {
                assert_eq!(number(row.len() - 1), if (0.0..0.8).contains(&x) { area } else { 0.0 }, "{row:?}");
            }
            seen.insert(row[row.len() - 1].to_owned());
        }
        assert!(seen.len() > 3, "{seen:?}");
    }
    let report = std::fs::read_to_string(dir.path().join("out/report.html")).unwrap();
    assert!(report.contains("Grids of the working area"));
}

#[test]
fn files_have_the_documented_columns_and_a_row_per_tick() {
    let dir = swing();
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--out", "out", "--json"]).expect(0).json();
    let read = |name: &str| std::fs::read_to_string(dir.path().join("out").join(name)).unwrap();
    let trace = read("trace.csv");
    let mut rows = trace.lines();
    let columns = "t_s,robot,q1,q2,tcp_x_m,tcp_y_m,tcp_z_m,tcp_speed_m_s,override,region,distance_m,part,object,\
                   point_x_m,point_y_m,point_z_m";
    assert_eq!(rows.next(), Some(columns));
    let rows: Vec<Vec<&str>> = rows.map(|r| r.split(',').collect()).collect();
    assert_eq!(rows.len() as u64, json["ticks"].as_u64().unwrap());
    assert!(rows.iter().all(|r| r.len() == 16 && r[1] == "arm" && r[12].is_empty()));
    let number = |text: &str| text.parse::<f64>().unwrap();
    assert_eq!(number(rows[0][0]), 0.0);
    let last = rows.last().unwrap();
    assert!((number(last[0]) - json["duration_s"].as_f64().unwrap()).abs() < 1e-9);
    // The columns are consistent: radians, metres, and the TCP at the pose that the joints give.
    for row in rows.iter().step_by(50) {
        let (q1, q2) = (number(row[2]), number(row[3]));
        let x = 0.4 * q1.cos() + 0.3 * (q1 + q2).cos();
        let y = 0.4 * q1.sin() + 0.3 * (q1 + q2).sin();
        assert!((x - number(row[4])).abs() < 1e-9 && (y - number(row[5])).abs() < 1e-9, "{row:?}");
        if row[9] == "post" {
            let to_axis = (x - 0.495).hypot(y - 0.495);
            assert!((to_axis - 0.05 - number(row[10])).abs() < 1e-9, "{row:?}");
            // The TCP is guarded: it is the governing part, and the closest point of the robot.
            assert_eq!(row[11], "tcp", "{row:?}");
            assert!((x - number(row[13])).abs() < 1e-9 && (y - number(row[14])).abs() < 1e-9, "{row:?}");
        } else {
            assert_eq!((row[9], number(row[8])), ("", 1.0), "{row:?}");
            assert!(row[11..].iter().all(|c| c.is_empty()), "{row:?}");
        }
    }
    let events = read("events.csv");
    assert_eq!(events.lines().next(), Some("t_s,robot,region,event"));
    let warned: Vec<&str> = events.lines().filter(|l| l.ends_with(",arm,post,warn_in")).collect();
    assert_eq!(warned.len(), 1, "{events}");
    assert!(!events.contains("inside_in"), "{events}");
}

#[test]
fn the_report_needs_no_network() {
    let dir = swing();
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "deep/er", "--compare"]).expect(0);
    let html = std::fs::read_to_string(dir.path().join("deep/er/report.html")).unwrap();
    assert!(html.starts_with("<!DOCTYPE html>") || html.starts_with("<!doctype html>"));
    for (tag, attribute) in [("script", "src"), ("link", "href"), ("img", "src"), ("iframe", "src")] {
        for element in html.split(&format!("<{tag} ")).skip(1) {
            let element = element.split('>').next().unwrap();
            for quote in ['"', '\''] {
                let fetch = format!("{attribute}={quote}http");
                assert!(!element.contains(&fetch), "<{tag} {element}>");
            }
        }
    }
    let second = "<option value=\"1\">monitor off</option>";
    assert!(html.contains(second), "--compare shows the other run");
    // Without --compare only the distances of the other run are shown.
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "one"]).expect(0);
    let one = std::fs::read_to_string(dir.path().join("one/report.html")).unwrap();
    assert!(!one.contains(second) && one.contains("<th scope=\"col\">without monitor</th>"));
    assert!(one.contains("arm stopped at ") && one.contains("before the forbidden region post; closest: tcp"));
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "off", "--no-monitor"]).expect(1);
    let off = std::fs::read_to_string(dir.path().join("off/report.html")).unwrap();
    assert!(
        !off.contains("<th scope=\"col\">without monitor</th>")
            && off.contains("The forbidden region post was entered: arm at ")
    );
    assert!(html.contains("not a certified safety device"));
}

#[test]
fn options_that_contradict_are_refused() {
    let dir = swing();
    for args in [
        &["run"][..],
        &["run", "cell.toml", "--compare"],
        &["run", "cell.toml", "--out", "o", "--compare", "--no-monitor"],
        &["run", "cell.toml", "--repeat", "0"],
        &["walk", "cell.toml"],
    ] {
        let answer = elbowroom(dir.path(), args).expect(2);
        assert!(answer.stderr.contains("Usage") || answer.stderr.contains("--help"), "{}", answer.stderr);
    }
}

#[test]
fn repeating_takes_that_many_times_as_long() {
    let dir = with_cell(&SWING.replace("{ move = \"joint\", to = [90, 0], speed = 50 }", "{ wait = 0.25 }"));
    let time = |n: &str| {
        let json = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--repeat", n]).expect(0).json();
        json["duration_s"].as_f64().unwrap()
    };
    let (once, thrice) = (time("1"), time("3"));
    assert!((thrice - once - 0.5).abs() < 0.05, "{once} {thrice}");
}

#[test]
fn every_example_runs_free_of_trouble() {
    for name in ["conveyor", "exchange", "figure12", "tool_box"] {
        let cell = examples().join(name).join("cell.toml");
        let answer = elbowroom(&examples(), &["run", cell.to_str().unwrap(), "--json"]).expect(0);
        let json = answer.json();
        for region in json["regions"].as_array().unwrap().iter().filter(|r| r["kind"] != "monitored") {
            assert_eq!(region["entered"], false, "{name}: {region}");
        }
        let finished = json["robots"].as_array().unwrap().iter().all(|r| r["finished"] == true);
        assert_eq!(finished, name != "figure12", "{name}: {json}");
    }
}

#[test]
fn a_robot_that_waits_is_told_who_must_leave() {
    let carriage = |name: &str, x: f64, yaw: f64, to: f64| {
        format!(
            "[robot.{name}]\nbase = {{ at = [{x}, 0, 0], rpy = [0, 90, {yaw}] }}\n\
             dh = [{{ kind = \"prismatic\", min = -2000, max = 2000, speed = 1000 }}]\n\
             links = [{{ sphere = {{ at = [0, 0, 0], radius = 50 }} }}]\n\
             [program.{name}]\nsteps = [{{ move = \"joint\", to = [{to}] }}]\n"
        )
    };
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 4\n{}{}\
         [region.shared]\nshape = \"box\"\nbase = [0, 0, -300]\nsize = [400, 400, 600]\nwarning = 100\nkind = \"exchange\"\n",
        carriage("stays", 0.0, 0.0, 10.0),
        carriage("waits", 1000.0, 180.0, 1500.0),
    );
    let dir = with_cell(&text);
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    let waits = &json["robots"][1];
    assert_eq!(waits["outcome"], "held", "{json}");
    // Its program is over, so nothing will release the region.
    let release = waits["release"].as_str().unwrap();
    let whose = "stays leaves it: the program of stays is over in the region or its warning zone";
    assert!(release.starts_with(whose) && release.contains("`warning` is made smaller"), "{release}");
    let summary = elbowroom(dir.path(), &["run", "cell.toml"]).expect(0).stdout;
    assert!(summary.contains("continues when stays leaves it"), "{summary}");
    assert!(summary.contains("closest link_1 at ("), "{summary}");
}

#[test]
fn a_region_that_a_program_switched_on_may_be_switched_off() {
    let text = SWING.replace("guards", "life = \"temporary\"\nguards");
    let text = text.replace("steps = [", "steps = [{ region = \"post\", active = true }, ");
    let dir = with_cell(&text);
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]).expect(0).json();
    let release = json["robots"][0]["release"].as_str().unwrap();
    assert!(release.starts_with("a program switches it off, or "), "{release}");
    let summary = elbowroom(dir.path(), &["run", "cell.toml"]).expect(0).stdout;
    assert!(summary.contains(" continues when a program switches it off\n"), "{summary}");
    assert!(summary.contains(" or when the program moves away (direction_aware = true)\n"), "{summary}");
}

#[test]
fn robots_that_wait_for_each_other_are_a_violation() {
    let carriage = |name: &str, x: f64, z: f64, yaw: f64| {
        format!(
            "[robot.{name}]\nbase = {{ at = [{x}, 0, {z}], rpy = [0, 90, {yaw}] }}\n\
             dh = [{{ kind = \"prismatic\", min = -2000, max = 2000, speed = 1000 }}]\n\
             links = [[{{ sphere = {{ at = [0, 0, 0], radius = 50 }} }}, {{ sphere = {{ at = [0, 0, 350], radius = 50 }} }}]]\n\
             [program.{name}]\nsteps = [{{ move = \"joint\", to = [1500] }}]\n"
        )
    };
    let region = |name: &str, x: f64| {
        format!(
            "[region.{name}]\nshape = \"box\"\nbase = [{x}, 0, -300]\nsize = [400, 400, 600]\nwarning = 100\n\
             kind = \"exchange\"\n"
        )
    };
    let text = format!(
        "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 4\n{}{}{}{}",
        carriage("a", 0.0, 0.0, 0.0),
        carriage("b", 700.0, 150.0, 180.0),
        region("A", 0.0),
        region("B", 700.0)
    );
    let dir = with_cell(&text);
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json", "--out", "o"]).expect(1).json();
    let [deadlock] = &json["deadlocks"].as_array().unwrap()[..] else { panic!("{json}") };
    assert_eq!(deadlock["robots"], serde_json::json!(["a", "b"]));
    assert_eq!(deadlock["regions"], serde_json::json!(["B", "A"]));
    assert!(deadlock["t_s"].is_f64());
    for robot in json["robots"].as_array().unwrap() {
        assert_eq!(robot["outcome"], "deadlock");
        assert!(robot["by"].is_string() && robot["part"].is_string() && robot["point_m"][2].is_f64(), "{robot}");
    }
    let text = elbowroom(dir.path(), &["run", "cell.toml"]).expect(1).stdout;
    assert!(text.contains("deadlock since"), "{text}");
    let html = std::fs::read_to_string(dir.path().join("o/report.html")).unwrap();
    assert!(html.contains("wait for each other at B, A"));
}
