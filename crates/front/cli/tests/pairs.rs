//! Links without a collider between them are a tested pair; contacts at rest cause a warning.

use crate::common::elbowroom;

/// A wrist, a palm without solids, and two fingers that slide towards each other: they touch from 0.04 m on.
const GRIP: &str = r#"<robot name="grip">
<link name="wrist"><collision><geometry><box size="0.1 0.1 0.05"/></geometry></collision></link>
<link name="palm"/>
<joint name="turn" type="revolute"><parent link="wrist"/><child link="palm"/><origin xyz="0 0 0.05"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<link name="f1"><collision><geometry><box size="0.02 0.02 0.1"/></geometry></collision></link>
<link name="f2"><collision><geometry><box size="0.02 0.02 0.1"/></geometry></collision></link>
<joint name="a" type="prismatic"><parent link="palm"/><child link="f1"/><origin xyz="0.05 0 0.09"/><axis xyz="1 0 0"/>
  <limit lower="-0.1" upper="0.05" velocity="1" effort="1"/></joint>
<joint name="b" type="prismatic"><parent link="palm"/><child link="f2"/><origin xyz="-0.05 0 0.09"/><axis xyz="-1 0 0"/>
  <limit lower="-0.1" upper="0.05" velocity="1" effort="1"/></joint>
</robot>"#;

const SRDF: &str = r#"<robot name="grip"><disable_collisions link1="f1" link2="f2" reason="Default"/></robot>"#;

/// A ball wrist: three joints, two links without solids, the hand always inside the forearm.
const BALL_WRIST: &str = r#"<robot name="ball">
<link name="forearm"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="roll"/><link name="pitch"/>
<link name="hand"><collision><geometry><sphere radius="0.04"/></geometry></collision></link>
<joint name="j1" type="revolute"><parent link="forearm"/><child link="roll"/><axis xyz="1 0 0"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="j2" type="revolute"><parent link="roll"/><child link="pitch"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
<joint name="j3" type="revolute"><parent link="pitch"/><child link="hand"/><origin xyz="0 0 0.01"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
</robot>"#;

fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in [("grip.urdf", GRIP), ("grip.srdf", SRDF), ("ball.urdf", BALL_WRIST)] {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    std::fs::write(dir.path().join("q.csv"), "turn,a,b\n0,0,0\n0,-0.05,-0.05\n0,-0.1,0\n").unwrap();
    dir
}

#[test]
fn fingers_on_a_palm_without_solids_are_a_pair() {
    let dir = folder();
    let args = ["query", "--urdf", "grip.urdf", "--ask", "distance", "--states", "q.csv"];
    let answer = elbowroom(dir.path(), &args).expect(0);
    let rows: Vec<Vec<&str>> = answer.stdout.lines().skip(1).map(|l| l.split(',').collect()).collect();
    let contact: Vec<(&str, &str)> = rows.iter().map(|r| (r[1], r[2])).collect();
    // At 0 the fingers are 80 mm apart, and 15 mm above the wrist, across two joints.
    assert_eq!(contact[0].0, "0");
    assert!((contact[0].1.parse::<f64>().unwrap() - 0.065).abs() < 1e-9, "{}", answer.stdout);
    assert_eq!(contact[1..], [("1", "0.0"), ("1", "0.0")], "{}", answer.stdout);
    assert_eq!(rows[1][3..5], ["f1", "f2"]);
    // No contact at rest, no warning.
    assert_eq!(answer.stderr, "");
    let with_srdf = [&args[..3], &["--srdf", "grip.srdf"], &args[3..]].concat();
    let answer = elbowroom(dir.path(), &with_srdf).expect(0);
    assert!(answer.stdout.lines().skip(1).all(|l| l.split(',').nth(1) == Some("0")), "{}", answer.stdout);
}

#[test]
fn contacts_at_rest_are_named_with_a_hint() {
    let dir = folder();
    let line = "<disable_collisions link1=\"forearm\" link2=\"hand\" reason=\"Default\"/>";
    let query = elbowroom(dir.path(), &["query", "--urdf", "ball.urdf", "--ask", "collision"]).expect(1);
    assert!(query.stdout.contains("0,1,0.0,forearm,hand,"), "{}", query.stdout);
    assert!(
        query.stderr.contains("links `forearm` and `hand` touch at rest, and in all 200 states"),
        "{}",
        query.stderr
    );
    assert!(query.stderr.contains(line), "{}", query.stderr);
    let inspect = elbowroom(dir.path(), &["inspect", "ball.urdf", "--json"]).expect(0).json();
    assert_eq!(inspect["pairs"][0]["suggestion"], "always in contact, in 1000 samples");
    assert!(inspect["warnings"].to_string().contains("link1=\\\"forearm\\\""), "{}", inspect["warnings"]);
    // The fingers are closed at rest, and open elsewhere.
    let closed = GRIP.replace("0.05 0 0.09", "0.005 0 0.09");
    std::fs::write(dir.path().join("closed.urdf"), closed).unwrap();
    let inspect = elbowroom(dir.path(), &["inspect", "closed.urdf", "--json"]).expect(0).json();
    let fingers = inspect["pairs"].as_array().unwrap().iter().find(|p| p["a"] == "f1" && p["b"] == "f2").unwrap();
    let suggestion = fingers["suggestion"].as_str().unwrap();
    assert!(fingers["tested"] == true && suggestion.starts_with("in contact at rest, and in "), "{fingers}");
    assert!(inspect["warnings"].to_string().contains("a query at rest answers collision"), "{}", inspect["warnings"]);
}

/// Makes a cell in which the hand turns.
fn cell(model: &str, more: &str, to: &str) -> String {
    format!(
        "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n[robot.r]\nmodel = \"{model}\"\n{more}[program.r]\n\
         steps = [{{ move = \"joint\", to = {to}, speed = 100 }}]\n"
    )
}

#[test]
fn a_run_warns_of_contacts_at_the_start_and_reports_new_contacts() {
    let dir = folder();
    let run = |text: String| {
        std::fs::write(dir.path().join("cell.toml"), text).unwrap();
        elbowroom(dir.path(), &["run", "cell.toml", "--json"])
    };
    let wrist = run(cell("ball.urdf", "", "[1, 1, 1]")).expect(0);
    assert!(wrist.stderr.contains("robot \"r\": links `forearm` and `hand` touch at its `start`"), "{}", wrist.stderr);
    assert!(wrist.stderr.contains("ignore = [[\"forearm\", \"hand\"]]"), "{}", wrist.stderr);
    assert_eq!(wrist.json()["robots"][0]["collisions"].as_array().map(Vec::len), Some(0));
    let fingers = run(cell("grip.urdf", "", "[0, -0.05, -0.05]")).expect(1);
    let collisions = &fingers.json()["robots"][0]["collisions"];
    assert_eq!((&collisions[0]["a"], &collisions[0]["b"]), (&"r/f1".into(), &"r/f2".into()), "{collisions}");
    let disabled = run(cell("grip.urdf", "srdf = \"grip.srdf\"\n", "[0, -0.05, -0.05]")).expect(0);
    assert!(!disabled.stderr.contains("touch"), "{}", disabled.stderr);
}

#[test]
fn the_tcp_is_on_no_finger() {
    let dir = folder();
    let check = |text: String| {
        std::fs::write(dir.path().join("cell.toml"), text).unwrap();
        elbowroom(dir.path(), &["run", "cell.toml", "--json"])
    };
    let grip = check(cell("grip.urdf", "srdf = \"grip.srdf\"\n", "[0.1, 0, 0]")).expect(0);
    assert!(grip.stderr.contains("its TCP is on `palm`, which carries f1 and f2"), "{}", grip.stderr);
    assert!(grip.stderr.contains("flange = \"palm\""), "{}", grip.stderr);
    let named = check(cell("grip.urdf", "srdf = \"grip.srdf\"\nflange = \"f1\"\n", "[0.1, 0, 0]")).expect(0);
    assert!(!named.stderr.contains("TCP"), "{}", named.stderr);
    let tool0 = GRIP.replace("\"palm\"", "\"tool0\"");
    std::fs::write(dir.path().join("tool0.urdf"), tool0).unwrap();
    let tool0 = check(cell("tool0.urdf", "srdf = \"grip.srdf\"\n", "[0.1, 0, 0]")).expect(0);
    assert!(!tool0.stderr.contains("TCP"), "{}", tool0.stderr);
    // A single leaf is not a finger.
    assert!(!check(cell("ball.urdf", "", "[0.1, 0, 0]")).expect(0).stderr.contains("TCP"));
}

#[test]
fn an_srdf_is_written_and_silences_what_always_touches() {
    let dir = folder();
    let written = elbowroom(dir.path(), &["inspect", "ball.urdf", "--write-srdf", "new.srdf"]).expect(0);
    assert!(written.stderr.contains("wrote new.srdf"), "{}", written.stderr);
    let text = std::fs::read_to_string(dir.path().join("new.srdf")).unwrap();
    let line = "<disable_collisions link1=\"forearm\" link2=\"hand\" reason=\"Default\"/>";
    assert!(text.contains(line), "{text}");
    let kr125 = elbowroom_testkit::folder::model("kr125");
    elbowroom(dir.path(), &["inspect", kr125.to_str().unwrap(), "--write-srdf", "kr125.srdf"]).expect(0);
    let kr125 = std::fs::read_to_string(dir.path().join("kr125.srdf")).unwrap();
    assert!(kr125.contains("reason=\"Adjacent\""), "{kr125}");
    let query = ["query", "--urdf", "ball.urdf", "--srdf", "new.srdf", "--ask", "collision"];
    assert!(!elbowroom(dir.path(), &query).expect(0).stderr.contains("touch"));
    // The content of the present SRDF stays.
    let again = ["inspect", "grip.urdf", "--srdf", "grip.srdf", "--write-srdf", "again.srdf"];
    elbowroom(dir.path(), &again).expect(0);
    let text = std::fs::read_to_string(dir.path().join("again.srdf")).unwrap();
    assert!(text.contains("link1=\"f1\" link2=\"f2\" reason=\"User\""), "{text}");
    // An existing file stays: a person may have written pairs and groups into it.
    let before = std::fs::read_to_string(dir.path().join("grip.srdf")).unwrap();
    let over = elbowroom(dir.path(), &["inspect", "grip.urdf", "--write-srdf", "grip.srdf"]).expect(2).stderr;
    assert!(over.contains("grip.srdf: is there already") && over.contains("the name of a new file"), "{over}");
    assert_eq!(std::fs::read_to_string(dir.path().join("grip.srdf")).unwrap(), before);
    std::fs::write(dir.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(dir.path().join("bare.urdf"), "<robot name=\"bare\"><link name=\"a\"/></robot>").unwrap();
    let cases: &[(&[&str], &str, &str)] = &[
        (&["ball.urdf", "--brief", "--write-srdf", "x.srdf"], "cannot be used with", "--brief"),
        (&["ball.urdf", "--states", "q.csv", "--write-srdf", "x.srdf"], "cannot be used with", "--states"),
        (&["a.obj", "--write-srdf", "x.srdf"], "a.obj: has no pairs of links", "a robot with collision geometry"),
        (
            &["bare.urdf", "--write-srdf", "x.srdf"],
            "bare.urdf: has no pairs of links",
            "a robot with collision geometry",
        ),
        (&["ball.urdf", "--write-srdf", "nowhere/x.srdf"], "nowhere/x.srdf", "write: a folder that is there"),
        (&["ball.urdf", "--write-srdf", "/dev/full"], "/dev/full: is there already", "the name of a new file"),
        (&["ball.urdf", "--pairs", "/dev/full"], "/dev/full", "write: "),
    ];
    for (args, what, hint) in cases {
        let refused = elbowroom(dir.path(), &[&["inspect"], *args].concat()).expect(2).stderr;
        assert!(refused.contains(what) && refused.contains(hint), "{args:?}: {refused}");
        assert!(!dir.path().join("x.srdf").exists());
    }
}

#[test]
fn pairs_that_the_cell_file_ignores_are_never_tested() {
    let dir = folder();
    let run = |more: &str| {
        std::fs::write(dir.path().join("cell.toml"), cell("grip.urdf", more, "[0, -0.05, -0.05]")).unwrap();
        elbowroom(dir.path(), &["run", "cell.toml", "--json"])
    };
    run("").expect(1);
    let ignored = run("ignore = [[\"f2\", \"f1\"]]\n").expect(0);
    assert_eq!(ignored.json()["robots"][0]["collisions"].as_array().map(Vec::len), Some(0));
    for (key, expected) in [
        ("ignore = [[\"f1\"]]\n", "names 1 links, not two"),
        ("ignore = [[\"f1\", \"f3\"]]\n", "names the link \"f3\""),
        ("ignore = [[\"f1\", \"f1\"]]\n", "one link twice"),
        ("ignore = [\"f1\", \"f2\"]\n", "must be a list"),
    ] {
        let answer = run(key).expect(2);
        assert!(answer.stderr.contains(expected) && answer.stderr.contains("cell.toml:5"), "{key}: {}", answer.stderr);
    }
}

#[test]
fn a_robot_of_rows_takes_an_srdf_too() {
    let dir = tempfile::tempdir().unwrap();
    let row = "{ alpha = 1.5, min = -3, max = 3, speed = 1 }";
    let ball = "{ sphere = { radius = 0.1 } }";
    let text = |more: &str| {
        format!(
            "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n[robot.r]\ndh = [{row}, {row}, {row}, {row}]\n\
             links = [{ball}, [], [], {ball}]\n{more}"
        )
    };
    let srdf = r#"<robot name="r"><disable_collisions link1="link_1" link2="link_4" reason="Default"/></robot>"#;
    std::fs::write(dir.path().join("r.srdf"), srdf).unwrap();
    for (more, status) in [("", 1), ("srdf = \"r.srdf\"\n", 0)] {
        std::fs::write(dir.path().join("cell.toml"), text(more)).unwrap();
        let answer = elbowroom(dir.path(), &["query", "cell.toml", "--ask", "collision"]).expect(status);
        assert_eq!(answer.stderr.contains("`link_1` and `link_4` touch"), status == 1, "{}", answer.stderr);
    }
}
