//! Parts that programs grip, carry and release.

use crate::common::{Answer, elbowroom, part_on_table, slide_arm, with_cell};

/// An arm with a slide at its end, a part on a table, and a post between two places.
const CELL: &str = concat!(
    "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n",
    slide_arm!(),
    "start = [0, 0, -100]\n",
    part_on_table!()
);
const POST: &str = "[object.post]\nshape = \"cylinder\"\nat = [606, 350, 310]\nradius = 30\nheight = 220\n";

fn joint(q: [f64; 3]) -> String {
    format!("{{ move = \"joint\", to = {q:?} }}")
}

/// Moves down to the part, up, to the other place, down, up; with the given steps of the hand.
fn transfer(grip: &str, carry: &str, release: &str) -> String {
    let (down, up) = (joint([0.0, 0.0, -270.0]), joint([0.0, 0.0, -100.0]));
    let (set_down, away) = (joint([60.0, 0.0, -270.0]), joint([60.0, 0.0, -100.0]));
    [&down, grip, &up, carry, &set_down, release, &away].map(String::from).join("\n")
}

const GRIP: &str = "{ grip = \"part\" },";
const RELEASE: &str = "{ release = \"part\" },";

fn run(objects: &str, steps: &str) -> (tempfile::TempDir, Answer) {
    let steps = steps.replace("}\n", "},\n");
    let dir = with_cell(&format!("{CELL}{objects}[program.arm]\nsteps = [\n{steps}\n]\n"));
    let answer = elbowroom(dir.path(), &["run", "cell.toml", "--out", "out", "--json"]);
    (dir, answer)
}

fn collisions(answer: &Answer) -> Vec<(String, String)> {
    let name = |v: &serde_json::Value| v.as_str().unwrap().to_owned();
    let json = answer.json();
    let list = json["robots"][0]["collisions"].as_array().unwrap();
    list.iter().map(|c| (name(&c["a"]), name(&c["b"]))).collect()
}

fn place(answer: &Answer, name: &str) -> [f64; 4] {
    let json = answer.json();
    let object = json["objects"].as_array().unwrap().iter().find(|o| o["name"] == name).unwrap().clone();
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let at = &object["at_m"];
    [number(&at[0]), number(&at[1]), number(&at[2]), number(&object["rpy_rad"][2])]
}

fn assert_near(found: [f64; 4], expected: [f64; 4]) {
    assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-6), "{found:?} is not {expected:?}");
}

fn put_down() -> [f64; 4] {
    let angle = 60.0_f64.to_radians();
    [0.7 * angle.cos(), 0.7 * angle.sin(), 0.25, angle]
}

#[test]
fn a_part_is_where_it_was_put() {
    let steps = transfer(GRIP, &joint([60.0, 0.0, -100.0]), RELEASE);
    let (dir, answer) = run("", &steps);
    let answer = answer.expect(0);
    assert_eq!(answer.json()["robots"][0]["outcome"], "finished");
    assert_near(place(&answer, "part"), put_down());
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    let of_part: Vec<_> = events.lines().filter(|l| l.contains(",arm,part,")).collect();
    assert!(of_part.len() == 2 && of_part[0].ends_with("grip") && of_part[1].ends_with("release"), "{events}");
    assert!(!answer.stderr.contains("warning"), "{}", answer.stderr);
    assert!(std::fs::read_to_string(dir.path().join("out/report.html")).unwrap().contains("part"));
}

#[test]
fn a_carried_part_hits_what_the_empty_hand_does_not() {
    let carry = joint([60.0, 0.0, -100.0]);
    let (_dir, with) = run(POST, &transfer(GRIP, &carry, RELEASE));
    let with = with.expect(1);
    assert_eq!(collisions(&with), [("arm/part".to_owned(), "post".to_owned())]);
    let robot = &with.json()["robots"][0];
    assert!(robot["by"] == "post" && robot["part"] == "part", "{robot}");
    let (_dir, without) = run(POST, &transfer("", &carry, ""));
    assert!(collisions(&without.expect(0)).is_empty());
}

#[test]
fn a_planned_move_leads_the_part_around_the_post() {
    let planned = "{ move = \"planned\", to = [60, 0, -100] }";
    let (_dir, answer) = run(POST, &transfer(GRIP, planned, RELEASE));
    let answer = answer.expect(0);
    assert_near(place(&answer, "part"), put_down());
}

#[test]
fn a_part_may_stand_but_not_sink() {
    let (down, up, away) = (joint([0.0, 0.0, -270.0]), joint([0.0, 0.0, -100.0]), joint([60.0, 0.0, -100.0]));
    let onto = [("arm/part".to_owned(), "table".to_owned())];
    // Pressed into the table before the first lift, and at the new place.
    let pressed = format!("{down}\n{GRIP}\n{}\n{up}", joint([0.0, 0.0, -275.0]));
    let set_down = format!("{down}\n{GRIP}\n{up}\n{away}\n{}\n{RELEASE}\n{away}", joint([60.0, 0.0, -275.0]));
    // It touches the table again although it is not released.
    let touched = format!("{down}\n{GRIP}\n{up}\n{}\n{up}", joint([0.0, 0.0, -270.5]));
    for steps in [pressed, set_down, touched] {
        let (_dir, answer) = run("", &steps);
        assert_eq!(collisions(&answer.expect(1)), onto, "{steps}");
    }
}

#[test]
fn one_robot_takes_over_what_another_put_down() {
    let second = CELL[CELL.find("[robot.arm]").unwrap()..CELL.find("[object.part]").unwrap()]
        .replace("robot.arm", "robot.other")
        .replace("at = [0, 0, 600]", "at = [1400, 0, 600], rpy = [0, 0, 180]")
        .replace("start = [0,", "start = [60,");
    let (down, up, away) = (joint([0.0, 0.0, -270.0]), joint([0.0, 0.0, -100.0]), joint([60.0, 0.0, -100.0]));
    let first = format!("{down},\n{GRIP}\n{up},\n{down},\n{RELEASE}\n{up},\n{away},\n");
    let then = |wait: f64| {
        let steps = format!("{{ wait = {wait} }},\n{up},\n{down},\n{GRIP}\n{up},\n{away},\n");
        let dir = with_cell(&format!(
            "{CELL}{second}[program.arm]\nsteps = [\n{first}]\n[program.other]\nsteps = [\n{steps}]\n"
        ));
        elbowroom(dir.path(), &["run", "cell.toml", "--json"])
    };
    let answer = then(6.0).expect(0);
    let angle = 60.0_f64.to_radians();
    let [x, y, z, _] = place(&answer, "part");
    let expected = [1.4 - 0.7 * angle.cos(), -0.7 * angle.sin(), 0.42];
    assert!([x, y, z].iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-6), "{x} {y} {z}");
    // Too early: the first robot still holds it.
    let answer = then(0.0).expect(2);
    assert!(answer.stderr.contains("which robot \"arm\" holds") && answer.stderr.contains("wait"), "{}", answer.stderr);
}

#[test]
fn wrong_steps_name_their_line_and_what_to_write() {
    let down = joint([0.0, 0.0, -270.0]);
    for (steps, line, expected) in [
        ("{ grip = \"parrt\" }".to_owned(), 2, "part"),
        (format!("{down}\n{GRIP}\n{GRIP}"), 4, "release = \"part\""),
        (format!("{down}\n{RELEASE}"), 3, "grip = \"part\""),
        ("{ grip = \"part\" }".to_owned(), 2, "180 mm"),
        ("{ grip = \"part\", speed = 50 }".to_owned(), 2, "speed"),
        ("{ grip = \"part\", wait = 1 }".to_owned(), 2, "several steps in one"),
        ("{ grip = 5 }".to_owned(), 2, "grip"),
    ] {
        let (_dir, answer) = run("", &steps);
        let answer = answer.expect(2);
        let at = CELL.lines().count() + 1 + line;
        let place = format!("cell.toml:{at}");
        assert!(
            answer.stderr.contains(expected) && answer.stderr.contains(&place),
            "{steps}: not {place}, {expected}: {}",
            answer.stderr
        );
    }
}

#[test]
fn a_program_that_repeats_grips_the_part_where_it_put_it() {
    let (down, up, away) = (joint([0.0, 0.0, -270.0]), joint([0.0, 0.0, -100.0]), joint([60.0, 0.0, -100.0]));
    let repeat = |steps: String| {
        let dir = with_cell(&format!("{CELL}[program.arm]\nrepeat = 2\nsteps = [\n{steps}\n]\n"));
        elbowroom(dir.path(), &["run", "cell.toml", "--json"])
    };
    let same_place = format!("{down},\n{GRIP}\n{up},\n{away},\n{up},\n{down},\n{RELEASE}\n{up},\n");
    assert_near(place(&repeat(same_place).expect(0), "part"), [0.7, 0.0, 0.25, 0.0]);
    let elsewhere = transfer(GRIP, &away, RELEASE).replace("}\n", "},\n");
    assert!(repeat(elsewhere).expect(2).stderr.contains("639.8 mm"));
    let kept = format!("{down},\n{GRIP}\n{up},\n");
    assert!(repeat(kept).expect(2).stderr.contains("which it has gripped already"));
}

#[test]
fn what_moves_is_gripped_at_rest_only() {
    let belt = |start: f64| {
        let motion = format!("motion = {{ via = [[700, 5, 250]], speed = 1, start = {start} }}\n");
        CELL.replace("size = [60, 60, 100]\n", &format!("size = [60, 60, 100]\n{motion}"))
    };
    let steps = format!("{},\n{GRIP}\n{},\n", joint([0.0, 0.0, -270.0]), joint([0.0, 0.0, -100.0]));
    let run = |cell: String| {
        let dir = with_cell(&format!("{cell}[program.arm]\nsteps = [\n{steps}]\n"));
        elbowroom(dir.path(), &["run", "cell.toml", "--json"])
    };
    assert!(run(belt(0.0)).expect(2).stderr.contains("grips \"part\", which moves"));
    // It begins to move only when the hand has gripped it, and then stays in the hand.
    let answer = run(belt(1.0)).expect(0);
    assert_near(place(&answer, "part"), [0.7, 0.0, 0.42, 0.0]);
}
