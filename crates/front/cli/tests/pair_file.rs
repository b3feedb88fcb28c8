//! File of pairs: `pairs` in a cell, `query --pairs`, `inspect --pairs`.

use crate::common::{Answer, elbowroom, part_on_table, slide_arm, with_cell};

/// An arm with a slide at its end, and a part on a table.
const CELL: &str = concat!(
    "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\npairs = \"pairs.toml\"\n",
    slide_arm!(),
    "start = [0, 0, -270]\n",
    part_on_table!(),
    r#"[map.arm]
joints = ["joint_1", "joint_3"]
step = [10, 20]
others = "start"
"#
);

const STANDS: &str = "{ a = \"part\", b = \"table\", reason = \"it stands there\" }";

/// Makes a folder with the cell and its file of pairs.
fn folder(cell: &str, rows: &str) -> tempfile::TempDir {
    let dir = with_cell(cell);
    std::fs::write(dir.path().join("pairs.toml"), format!("version = 1\npairs = [\n{rows}\n]\n")).unwrap();
    dir
}

fn run(steps: &str, rows: &str) -> Answer {
    let dir = folder(&format!("{CELL}[program.arm]\nsteps = [\n{steps}\n]\n"), rows);
    elbowroom(dir.path(), &["run", "cell.toml", "--json"])
}

#[test]
fn a_gripped_part_may_stand_on_its_table() {
    let (grip, lift) = ("{ grip = \"part\" },", "{ move = \"planned\", to = [60, 0, -100] },");
    let refused = run(&[grip, lift].concat(), "").expect(2);
    assert!(refused.stderr.contains("`part` and `table`"), "{}", refused.stderr);
    assert!(refused.stderr.contains("{ a = \"part\", b = \"table\", reason = \"…\" }"), "{}", refused.stderr);
    for rows in [STANDS, "{ a = \"*\", b = \"part\", reason = \"any contact\" }"] {
        let lifted = run(&[grip, lift].concat(), rows).expect(0);
        assert_eq!(lifted.json()["robots"][0]["outcome"], "finished");
    }
    // Pressed into the table: a collision, unless the two may touch.
    let press = "{ move = \"joint\", to = [0, 0, -275] },";
    assert_eq!(run(&[grip, press].concat(), "").expect(1).json()["robots"][0]["collisions"][0]["b"], "table");
    let pressed = run(&[grip, press].concat(), STANDS).expect(0);
    assert_eq!(pressed.json()["robots"][0]["collisions"].as_array().map(Vec::len), Some(0));
    // The arm itself may still not touch the table.
    let down = "{ move = \"joint\", to = [0, 0, -390] },";
    assert_eq!(run(down, STANDS).expect(1).json()["robots"][0]["collisions"][0]["b"], "part");
}

#[test]
fn a_later_row_overrides_an_earlier_one() {
    let rows =
        "{ a = \"part\", b = \"*\", reason = \"any contact\" },\n{ a = \"part\", b = \"arm\", state = \"tested\" }";
    for (rows, status) in [("", 1), ("{ a = \"part\", b = \"*\", reason = \"any contact\" }", 0), (rows, 1)] {
        let dir = folder(CELL, rows);
        std::fs::write(dir.path().join("q.csv"), "joint_1,joint_2,joint_3\n0,0,-0.3\n").unwrap();
        let args = ["query", "cell.toml", "--ask", "collision", "--states", "q.csv"];
        elbowroom(dir.path(), &args).expect(status);
    }
}

#[test]
fn query_and_map_leave_out_what_may_touch() {
    let blocked = |rows: &str| {
        let dir = folder(CELL, rows);
        elbowroom(dir.path(), &["map", "cell.toml", "--json"]).expect(0).json()["blocked"].as_u64().unwrap()
    };
    let all = blocked("");
    let without_part = blocked("{ a = \"arm\", b = \"part\", reason = \"it is soft\" }");
    let hand_only = blocked("{ a = \"arm/link_3\", b = \"*\", reason = \"it is soft\" }");
    assert!(0 < without_part && without_part < all && hand_only < without_part, "{all} {without_part} {hand_only}");
    let dir = folder(CELL, "{ a = \"arm\", b = \"part\", reason = \"it is soft\" }");
    let args = ["query", "cell.toml", "--ask", "distance"];
    assert!(elbowroom(dir.path(), &args).expect(0).stdout.contains("arm/link_3,table,"));
    // Another file, beside the cell's own.
    std::fs::write(
        dir.path().join("more.toml"),
        "version = 1\npairs = [{ a = \"arm/link_3\", b = \"table\", reason = \"-\" }]",
    )
    .unwrap();
    let more = elbowroom(dir.path(), &[&args[..], &["--pairs", "more.toml"]].concat()).expect(0);
    assert!(more.stdout.contains("arm/link_2,table,"), "{}", more.stdout);
    // Two objects that may touch are not a pair, even if both are named.
    let between = ["--between", "part,table"];
    assert!(elbowroom(dir.path(), &[&args[..], &between].concat()).expect(0).stdout.contains("part,table,"));
    let dir = folder(CELL, STANDS);
    assert!(!elbowroom(dir.path(), &[&args[..], &between].concat()).expect(0).stdout.contains("part,table,"));
}

#[test]
fn wrong_rows_are_errors_with_their_lines() {
    for (rows, expected) in [
        ("{ a = \"part\", b = \"tabel\", reason = \"-\" }", "table"),
        ("{ a = \"arm/link_9\", b = \"table\", reason = \"-\" }", "arm/link_"),
        ("{ a = \"part\", b = \"part\", reason = \"-\" }", "named twice"),
        ("{ a = \"part\", b = \"table\" }", "without a reason"),
        ("{ a = \"part\", b = \"table\", reason = \" \" }", "empty `reason`"),
        ("{ a = \"*\", b = \"*\", reason = \"-\" }", "everything touch everything"),
        ("{ a = \"part\", reason = \"-\" }", "needs the key `b`"),
        ("{ a = \"part\", b = \"table\", weight = 2, reason = \"-\" }", "orders tested pairs"),
        ("{ a = \"part\", b = \"arm\", state = \"tested\", weight = -1 }", "0 or more"),
        ("{ a = \"part\", b = \"table\", state = \"ignored\", reason = \"-\" }", "skipped"),
        ("{ a = \"part\", b = \"table\", why = \"-\" }", "no key `why`"),
        ("{ a = \"arm/link_2\", b = \"arm/link_3\", state = \"tested\", reason = \"-\" }", "adjacent"),
        ("[\"part\", \"table\"]", "must be a table"),
    ] {
        let dir = folder(CELL, rows);
        let answer = elbowroom(dir.path(), &["query", "cell.toml", "--ask", "collision"]).expect(2);
        assert!(
            answer.stderr.contains(expected) && answer.stderr.contains("pairs.toml:3"),
            "{rows}: {}",
            answer.stderr
        );
    }
    let dir = folder(CELL, "");
    for (text, expected) in [
        ("pairs = []", "needs the key `version`"),
        ("version = 2\npairs = []", "is not 1"),
        ("version = 1\npair = []", "no key `pair`"),
        ("version = 1", "needs the key `pairs`"),
        ("version = 1\npairs = 3", "must be a list"),
        ("version = ", "not TOML"),
    ] {
        std::fs::write(dir.path().join("pairs.toml"), text).unwrap();
        let answer = elbowroom(dir.path(), &["query", "cell.toml", "--ask", "collision"]).expect(2);
        assert!(answer.stderr.contains(expected) && answer.stderr.contains("pairs.toml:"), "{text}: {}", answer.stderr);
    }
    std::fs::remove_file(dir.path().join("pairs.toml")).unwrap();
    let missing = elbowroom(dir.path(), &["query", "cell.toml", "--ask", "collision"]).expect(2);
    assert!(missing.stderr.contains("cell.toml:3") && missing.stderr.contains("does not exist"), "{}", missing.stderr);
}

/// A ball wrist: three joints, two links without solids, the hand always inside the forearm; and a tool that is never
/// near it.
const BALL_WRIST: &str = r#"<robot name="ball">
<link name="forearm"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="roll"/><link name="pitch"/>
<link name="hand"><collision><geometry><sphere radius="0.04"/></geometry></collision></link>
<link name="tool"><collision><origin xyz="0 0 0.3"/><geometry><sphere radius="0.04"/></geometry></collision></link>
<joint name="j1" type="revolute"><parent link="forearm"/><child link="roll"/><axis xyz="1 0 0"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="j2" type="revolute"><parent link="roll"/><child link="pitch"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
<joint name="j3" type="revolute"><parent link="pitch"/><child link="hand"/><origin xyz="0 0 0.01"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="j4" type="revolute"><parent link="hand"/><child link="tool"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
</robot>"#;

#[test]
fn inspect_writes_what_it_finds_and_accepts_what_always_touches() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("ball.urdf"), BALL_WRIST).unwrap();
    let query = || elbowroom(dir.path(), &["query", "--urdf", "ball.urdf", "--ask", "collision", "--pairs", "p.toml"]);
    let inspect = |more: &[&str]| {
        let answer = elbowroom(dir.path(), &[&["inspect", "ball.urdf", "--pairs", "p.toml"], more].concat()).expect(0);
        assert!(answer.stderr.contains("wrote p.toml: "), "{}", answer.stderr);
        std::fs::read_to_string(dir.path().join("p.toml")).unwrap()
    };
    let found = "found = \"always in contact, in 10000 samples\"";
    let text = inspect(&[]);
    let row = |state: &str| format!("{{ a = \"forearm\", b = \"hand\", state = \"{state}\", {found} }}");
    assert!(text.contains(&row("tested")), "{text}");
    query().expect(1);
    let text = inspect(&["--accept"]);
    assert!(text.contains(&row("skipped")) && text.contains("found = \"adjacent\""), "{text}");
    assert!(!query().expect(0).stderr.contains("touch"));
    // A row with a reason stays, and takes precedence.
    let by_hand = "{ a = \"forearm\", b = \"hand\", state = \"tested\", reason = \"I want to know\" }";
    std::fs::write(dir.path().join("p.toml"), format!("version = 1\npairs = [{by_hand}]\n")).unwrap();
    let text = inspect(&["--accept"]);
    assert!(text.contains(by_hand), "{text}");
    query().expect(1);
    let refused = elbowroom(dir.path(), &["inspect", "ball.urdf", "--accept"]).expect(2);
    assert!(refused.stderr.contains("--pairs"), "{}", refused.stderr);
}

#[test]
fn inspect_writes_the_pairs_of_a_cell() {
    let dir = folder(CELL, STANDS);
    let answer = elbowroom(dir.path(), &["inspect", "cell.toml", "--pairs", "pairs.toml", "--accept"]).expect(0);
    assert!(answer.stderr.contains("wrote pairs.toml: "), "{}", answer.stderr);
    let text = std::fs::read_to_string(dir.path().join("pairs.toml")).unwrap();
    assert!(
        text.contains("{ a = \"part\", b = \"table\", state = \"skipped\", reason = \"it stands there\" }"),
        "{text}"
    );
    assert!(text.contains("found = \"adjacent\""), "{text}");
    elbowroom(dir.path(), &["query", "cell.toml", "--ask", "collision"]).expect(0);
    // The same result, although the cell already names the file.
    elbowroom(dir.path(), &["inspect", "cell.toml", "--pairs", "pairs.toml", "--accept"]).expect(0);
    assert_eq!(std::fs::read_to_string(dir.path().join("pairs.toml")).unwrap(), text);
    elbowroom(dir.path(), &["inspect", "cell.toml", "--pairs", "nowhere/p.toml"]).expect(2);
}

/// A forearm, a wrist and a hand whose hub reaches into the forearm.
const WRIST: &str = r#"<robot name="wrist">
<link name="forearm"><collision><origin xyz="0.25 0 0"/><geometry><box size="0.4 0.1 0.1"/></geometry></collision></link>
<link name="wrist"><collision><geometry><sphere radius="0.04"/></geometry></collision></link>
<link name="hand"><collision><geometry><sphere radius="0.05"/></geometry></collision>BAR</link>
<joint name="bend" type="revolute"><parent link="forearm"/><child link="wrist"/><origin xyz="0.45 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="turn" type="revolute"><parent link="wrist"/><child link="hand"/><origin xyz="0.02 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
</robot>"#;

#[test]
fn links_that_always_touch_at_their_joint_stop_no_run_and_no_plan() {
    let bar = r#"<collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.02 0.02"/></geometry></collision>"#;
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    write("wrist.urdf", &WRIST.replace("BAR", ""));
    write(
        "tested.toml",
        "version = 1\npairs = [{ a = \"r/forearm\", b = \"r/hand\", state = \"tested\", reason = \"-\" }]",
    );
    let cell = |top: &str, key: &str| {
        let text = format!(
            "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n{top}[robot.r]\nmodel = \"wrist.urdf\"\n{key}\
             [program.r]\nsteps = [{{ move = \"joint\", to = [0.5, 0.5], speed = 100 }}]\n"
        );
        write("cell.toml", &text);
    };
    let call = |args: &[&str]| elbowroom(dir.path(), args);
    let (run, plan) = (["run", "cell.toml", "--json"], ["plan", "cell.toml", "--to", "0.5,0.5", "--json"]);
    let query = ["query", "cell.toml", "--ask", "collision"];
    let said =
        "robot \"r\": links `forearm` and `hand` touch in all 1000 states sampled in the joint space, and only at `";
    cell("", "");
    let ran = call(&run).expect(0);
    assert!(ran.stderr.contains(said) && ran.stderr.contains("ignore = [[\"forearm\", \"hand\"]]"), "{}", ran.stderr);
    assert_eq!(ran.json()["robots"][0]["collisions"].as_array().map(Vec::len), Some(0));
    assert!(call(&plan).expect(0).stderr.contains(said));
    // One rule for all commands on a cell; a model alone has only its SRDF.
    assert!(call(&query).expect(0).stderr.contains(said));
    let distance = call(&["query", "cell.toml", "--ask", "distance"]).expect(0).stdout;
    assert!(distance.contains("index,collides") && !distance.contains("r/hand"), "{distance}");
    let single = call(&["query", "--urdf", "wrist.urdf", "--ask", "collision"]).expect(1);
    assert!(single.stderr.contains("links `forearm` and `hand` touch in all 1000 states"), "{}", single.stderr);
    cell("", "ignore = [[\"forearm\", \"hand\"]]\n");
    assert!(!call(&query).expect(0).stderr.contains("touch"));
    // A tool that reaches back to the forearm is part of the hand: the pair stays.
    cell(
        "",
        "flange = \"hand\"\ntool = { tcp = { at = [0.1, 0, 0] }, box = { at = [0.1, 0, 0], size = [0.2, 0.02, 0.02] } }\n",
    );
    assert!(!call(&run).expect(1).stderr.contains(said));
    cell("pairs = \"tested.toml\"\n", "");
    call(&query).expect(1);
    assert_eq!(call(&run).expect(1).json()["robots"][0]["collisions"][0]["b"], "r/hand");
    // A hand with a bar that folds back onto the forearm touches it elsewhere too: the pair stays.
    write("wrist.urdf", &WRIST.replace("BAR", bar));
    cell("", "");
    assert!(!call(&run).expect(1).stderr.contains(said));
    let key = "if they always touch: ignore = [[\"forearm\", \"hand\"]] in [robot.r]";
    let ran = call(&run[..2]).expect(1);
    assert!(ran.stdout.contains(key), "{}", ran.stdout);
    let refused = call(&plan).expect(2);
    assert!(refused.stderr.contains("ignore = [[\"forearm\", \"hand\"]]"), "{}", refused.stderr);
}
