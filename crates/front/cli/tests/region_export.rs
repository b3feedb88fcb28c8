//! `elbowroom region export`: a robot's regions for its controller, its exit status, its messages and its files.

use crate::common::{elbowroom, examples, keys, with_cell};

/// A six-axis arm of its own, beside a second robot; its base is turned by a quarter and 500 mm high.
const PRESS: &str = r#"version = 1
name = "press"
units = { length = "mm", angle = "deg" }

[robot.loader]
base = { at = [2000, 1000, 500], rpy = [0, 0, 90] }
dh = [
  { a = 160, alpha = 90, d = 450, min = -170, max = 170, speed = 120 },
  { a = 590, theta = 90, min = -60, max = 130, speed = 120 },
  { a = 130, alpha = 90, min = -80, max = 150, speed = 120 },
  { alpha = -90, d = 650, min = -180, max = 180, speed = 250 },
  { alpha = 90, min = -115, max = 115, speed = 250 },
  { d = 95, min = -350, max = 350, speed = 400 },
]
[robot.loader.tool]
tcp = { at = [0, 0, 180] }

[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 500, speed = 500 }]

[region.press]
shape = "box"
from = [1500, 2000, 0]
to = [2500, 3200, 1800]
warning = 200
guards = ["tcp"]
robots = ["loader"]

[region.lamp]
shape = "sphere"
centre = [2000, 1500, 2200]
radius = 120
kind = "monitored"
output = 9
guards = ["tcp"]
robots = ["loader"]

[region.of_the_rail]
shape = "box"
from = [0, 0, 400]
to = [10, 10, 410]
warning = 5
guards = ["tcp"]
robots = ["rail"]
"#;

#[test]
fn regions_are_in_the_frame_of_a_turned_base() {
    let dir = with_cell(PRESS);
    let call = ["region", "export", "cell.toml", "--robot", "loader", "--to", "rapid"];
    let answer = elbowroom(dir.path(), &call).expect(0);
    // World x is y of the base, reversed; world y is x of the base.
    for line in [
        "        WZBoxDef \\Inside, shape, [999.996,-500.004,-500.004], [2200.004,500.004,1300.004];\n",
        "        WZLimSup \\Stat, wz1_press, shape;\n",
        "        WZSphDef \\Inside, shape, [500.000,0.000,1700.000], 120.005;\n",
        "        WZDOSet \\Stat, wz2_lamp \\Inside, shape, doElbowroom9, 1;\n",
        "    ! Zones of robot \"loader\", from the regions of the cell \"press\".\n",
        "    ! Millimetres and degrees in the frame of the link \"base\": it has to be the world frame of the controller.\n",
    ] {
        assert!(answer.stdout.contains(line), "{line}\n{}", answer.stdout);
    }
    assert!(!answer.stdout.contains("of_the_rail"));
    let world = elbowroom(dir.path(), &[&call[..], &["--frame", "world"]].concat()).expect(0);
    assert!(world.stdout.contains("[1499.996,1999.996,-0.004], [2500.004,3200.004,1800.004];"), "{}", world.stdout);
    let krl = elbowroom(dir.path(), &["region", "export", "cell.toml", "--robot", "loader", "--to", "krl"]).expect(1);
    assert!(
        krl.stdout.contains("$WORKSPACE[1]={X 1600.000,Y 0.000,Z 400.000,A -90.000000,B 0.000000,"),
        "{}",
        krl.stdout
    );
    let message =
        "not expressed: cell.toml:29: region \"lamp\": a workspace is a box, and this is a sphere\n  write: a box";
    assert!(krl.stderr.contains(message), "{}", krl.stderr);
}

#[test]
fn the_document_has_the_text_and_what_is_missing() {
    let dir = with_cell(PRESS);
    let call = ["region", "export", "cell.toml", "--robot", "loader", "--to", "krl", "--out", "zones.dat", "--json"];
    let answer = elbowroom(dir.path(), &call).expect(1);
    let json = answer.json();
    assert_eq!(keys(&json), ["cell", "frame", "language", "regions", "robot", "text"]);
    assert_eq!((json["robot"].as_str(), json["language"].as_str()), (Some("loader"), Some("krl")));
    assert_eq!(json["text"].as_str().unwrap(), std::fs::read_to_string(dir.path().join("zones.dat")).unwrap());
    let regions = json["regions"].as_array().unwrap();
    assert_eq!(keys(&regions[0]), ["kind", "missing", "name", "zones"]);
    assert_eq!(
        (&regions[0]["zones"][0], regions[0]["missing"].as_array().unwrap().len()),
        (&"$WORKSPACE[1]".into(), 0)
    );
    assert_eq!((&regions[1]["name"], regions[1]["zones"].as_array().unwrap().len()), (&"lamp".into(), 0));
    assert!(regions[1]["missing"][0]["reason"].as_str().unwrap().contains("sphere"));
    assert!(answer.stderr.contains("wrote zones.dat: zones for 1 of 2 regions"), "{}", answer.stderr);
    let quiet = elbowroom(dir.path(), &call[..call.len() - 1]).expect(1);
    assert!(quiet.stdout.is_empty());
}

#[test]
fn wrong_calls_say_what_to_write() {
    let dir = with_cell(PRESS);
    let wrong = |more: &[&str]| {
        let call = [&["region", "export", "cell.toml"], more].concat();
        elbowroom(dir.path(), &call).expect(2).stderr
    };
    assert!(wrong(&["--to", "rapid"]).contains("cell.toml: has 2 robots: name one"));
    assert!(wrong(&["--to", "rapid", "--robot", "loader2"]).contains("has no robot \"loader2\""));
    let frame = wrong(&["--to", "rapid", "--robot", "loader", "--frame", "link_3"]);
    assert!(
        frame.contains("cell.toml:5: joints move the link \"link_3\"") && frame.contains("write: base, or world"),
        "{frame}"
    );
    assert!(wrong(&["--to", "pdl2", "--robot", "loader"]).contains("[possible values: rapid, krl]"));
    let unwritable = wrong(&["--to", "rapid", "--robot", "loader", "--out", "no/folder/zones.mod"]);
    assert!(unwritable.contains("cannot be written"), "{unwritable}");
    assert!(
        elbowroom(dir.path(), &["region", "export", "none.toml", "--to", "krl"]).expect(2).stderr.contains("none.toml")
    );
}

#[test]
fn every_example_is_exported_or_says_what_is_missing() {
    let (mut zones, mut missing) = (0, 0);
    for folder in std::fs::read_dir(examples()).unwrap().map(|entry| entry.unwrap().path()) {
        let cell = folder.join("cell.toml");
        let Ok(text) = std::fs::read_to_string(&cell) else { continue };
        let names = text.lines().filter_map(|line| line.strip_prefix("[robot.")?.strip_suffix(']'));
        for robot in names.filter(|name| !name.contains('.')) {
            for language in ["rapid", "krl"] {
                let call = ["region", "export", cell.to_str().unwrap(), "--robot", robot, "--to", language, "--json"];
                let answer = elbowroom(&folder, &call);
                let regions = answer.json()["regions"].as_array().unwrap().clone();
                let gaps: usize = regions.iter().map(|r| r["missing"].as_array().unwrap().len()).sum();
                assert_eq!(answer.status, i32::from(gaps > 0), "{robot}: {}", answer.stderr);
                let silent = |r: &&serde_json::Value| {
                    r["zones"] == serde_json::json!([]) && r["missing"] == serde_json::json!([])
                };
                assert!(!regions.iter().any(|r| silent(&r)), "{robot}: {regions:?}");
                zones += regions.iter().map(|r| r["zones"].as_array().unwrap().len()).sum::<usize>();
                missing += gaps;
            }
        }
    }
    assert!(zones > 10 && missing > 10, "{zones} {missing}");
}
