//! `elbowroom teach`: its output is valid in a cell file.

use crate::common;
use crate::common::{SWING, elbowroom, solid_swing, with_cell};

/// States (radians) at which the TCP of the swinging arm is at (0.7, 0), (0, 0.7) and so on.
const HEADER: &str = "joint_1,joint_2\n";

fn teach(cell: &str, shape: &str, states: &str, more: &[&str]) -> (tempfile::TempDir, common::Answer) {
    let dir = with_cell(cell);
    std::fs::write(dir.path().join("taught.csv"), format!("{HEADER}{states}")).unwrap();
    let mut args = vec!["teach", "cell.toml", "--shape", shape, "--name", "taught", "--states", "taught.csv"];
    args.extend(more);
    let answer = elbowroom(dir.path(), &args);
    (dir, answer)
}

#[test]
fn a_taught_sphere_loads_in_the_cell_and_is_where_it_was_taught() {
    // Centre at (0.4, 0.3), with (0.7, 0) on the surface.
    let states = "0,1.5707963267948966\n0,0\n";
    let (dir, answer) = teach(SWING, "sphere", states, &["--warning", "150"]);
    let answer = answer.expect(0);
    let expected = "\n[region.taught]\nshape = \"sphere\"\ncentre = [400, 300, 0]\nradius = 424.2641\n\
                    kind = \"forbidden\"\nwarning = 150\n";
    assert_eq!(answer.stdout, expected);
    let file = dir.path().join("cell.toml");
    std::fs::write(&file, format!("{}{}", solid_swing(), answer.stdout)).unwrap();
    let json = elbowroom(dir.path(), &["run", "cell.toml", "--json"]);
    let json = json.json();
    assert_eq!(json["regions"][1]["name"], "taught");
    let again = elbowroom(
        dir.path(),
        &["teach", "cell.toml", "--shape", "sphere", "--name", "taught", "--states", "taught.csv"],
    );
    assert!(again.expect(2).stderr.contains("already"));
}

#[test]
fn metres_keep_a_tenth_of_a_micrometre() {
    let cell = "version = 1\nunits = { length = \"m\", angle = \"rad\" }\n[robot.arm]\n\
                dh = [{ a = 0.4, min = -3, max = 3, speed = 1 }, { a = 0.3, min = -3, max = 3, speed = 1 }]\n";
    let (_dir, answer) = teach(cell, "sphere", "0,1.5707963267948966\n0,0\n", &[]);
    assert!(answer.expect(0).stdout.contains("radius = 0.4242641\n"));
}

#[test]
fn every_shape_that_the_plane_can_teach_loads() {
    let quarter = "1.5707963267948966";
    let plane = format!("0,0\n{quarter},0\n0,-{quarter}\n");
    for (shape, states, more) in [
        ("plane", plane.as_str(), &[][..]),
        ("box3", plane.as_str(), &["--height", "250"]),
        ("box3", plane.as_str(), &["--height", "-250"]),
    ] {
        let (dir, answer) = teach(SWING, shape, states, more);
        let answer = answer.expect(0);
        std::fs::write(dir.path().join("cell.toml"), format!("{}{}", solid_swing(), answer.stdout)).unwrap();
        let ran = elbowroom(dir.path(), &["run", "cell.toml", "--json"]);
        assert!(ran.status < 2, "{shape}: {}{}", answer.stdout, ran.stderr);
    }
}

/// Three slides: the position of the TCP equals its joint values, in metres, along the world's axes.
const GANTRY: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.g]
base = { at = [0, 0, 0], rpy = [0, 90, 0] }
dh = [
  { kind = "prismatic", min = -3000, max = 3000, speed = 1000, alpha = -90, theta = 0 },
  { kind = "prismatic", min = -3000, max = 3000, speed = 1000, alpha = 90, theta = -90 },
  { kind = "prismatic", min = -3000, max = 3000, speed = 1000 },
]
links = [[], [], { sphere = { radius = 30 } }]
"#;

/// Teaches a box by corners (joint values) on the gantry: returns its centre in the world, m, and the answer.
fn gantry_box(corners: &str, height: &str) -> (elbowroom::spatial::Vec3, common::Answer) {
    let dir = with_cell(GANTRY);
    std::fs::write(dir.path().join("taught.csv"), format!("joint_1,joint_2,joint_3\n{corners}")).unwrap();
    let args = ["teach", "cell.toml", "--shape", "box3", "--name", "t", "--states", "taught.csv", "--height", height];
    let answer = elbowroom(dir.path(), &args).expect(0);
    let cell = elbowroom::cell::Cell::parse("t.toml", &format!("{GANTRY}{}", answer.stdout)).unwrap();
    let region = &cell.regions[0].region;
    ((region.anchor * region.shape_in_anchor).translation, answer)
}

#[test]
fn a_positive_height_goes_up_whatever_the_order_of_corners() {
    // In the world: (0, 0, 200), 500 mm along one horizontal axis, 1000 mm along the other.
    for corners in ["0,0,0.2\n0,0.5,0.2\n1,0,0.2\n", "0,0,0.2\n1,0,0.2\n0,0.5,0.2\n"] {
        for (height, z, word) in [("400", 0.4, "upwards (against gravity)"), ("-400", 0.0, "downwards (with gravity)")]
        {
            let (centre, answer) = gantry_box(corners, height);
            assert!((centre.z - z).abs() < 1e-9, "{corners} {height}: {}", answer.stdout);
            for text in [&answer.stdout, &answer.stderr] {
                assert!(text.contains(&format!("built {word}, 400 mm high")), "{text}");
                assert!(text.contains(", 400] mm (first edge, second edge, height)"), "{text}");
                assert!(text.contains(&format!("z from {} to {} mm", z * 1e3 - 200.0, z * 1e3 + 200.0)), "{text}");
            }
        }
    }
}

#[test]
fn the_side_of_an_upright_base_is_reported_and_can_be_chosen() {
    let corners = "0,0,0.2\n1,0,0.2\n0,0,0.8\n";
    let (one, answer) = gantry_box(corners, "400");
    assert!(answer.stderr.contains("to the side, towards ["), "{}", answer.stderr);
    assert!(answer.stderr.contains("--height with the other sign"), "{}", answer.stderr);
    let (other, _) = gantry_box(corners, "-400");
    assert!((one.distance(other) - 0.4).abs() < 1e-9 && (one.z - 0.5).abs() < 1e-9, "{one:?} {other:?}");
}

/// Teaches a fence by corners (joint values) on the gantry.
fn gantry_fence(corners: &str, more: &[&str]) -> common::Answer {
    let dir = with_cell(GANTRY);
    std::fs::write(dir.path().join("taught.csv"), format!("joint_1,joint_2,joint_3\n{corners}")).unwrap();
    let args = ["teach", "cell.toml", "--shape", "fence", "--name", "yard", "--states", "taught.csv"];
    elbowroom(dir.path(), &[&args[..], more].concat())
}

#[test]
fn a_taught_fence_has_walls_around_its_corners_in_either_direction() {
    for corners in ["0,0,0.02\n2,0,0\n2,1.5,0.01\n0,1.5,0\n", "0,1.5,0\n2,1.5,0.01\n2,0,0\n0,0,0.02\n"] {
        let answer = gantry_fence(corners, &["--height", "1800", "--warning", "150"]).expect(0);
        let expected = "height = 1800\nkind = \"forbidden\"\nwarning = 150\n";
        assert!(
            answer.stdout.contains("[fence.yard]\ncorners = [[") && answer.stdout.ends_with(expected),
            "{}",
            answer.stdout
        );
        for text in [&answer.stdout, &answer.stderr] {
            assert!(text.contains("built 4 walls, 1800 mm high, z from 0 to 1800 mm, around 3 m2"), "{text}");
        }
        let cell = elbowroom::cell::Cell::parse("t.toml", &format!("{GANTRY}{}", answer.stdout)).unwrap();
        let elbowroom::cell::RegionSolid::Walls(walls) = &cell.regions[0].solid else { panic!("{}", answer.stdout) };
        // The inner side of each wall is where the corners are: 2 m and 1.5 m around the middle.
        let middle = elbowroom::spatial::Vec3::new(1.0, 0.0, 0.9);
        let mut distances: Vec<f64> = walls
            .iter()
            .map(|wall| (wall.in_world.translation - middle).dot(wall.outwards) - wall.solid.half_extents.y)
            .collect();
        distances.sort_by(f64::total_cmp);
        let sum: f64 = distances.iter().sum();
        assert!((sum - 3.5).abs() < 1e-6 && walls.len() == 4, "{distances:?}");
        assert!(walls.iter().all(|wall| (wall.in_world.translation.z - 0.9).abs() < 1e-9));
    }
}

#[test]
fn corners_that_make_no_fence_are_refused() {
    let square = "0,0,0\n1,0,0\n1,1,0\n0,1,0\n";
    for (corners, more, words) in [
        (
            "0,0,0\n1,0,0\n",
            &["--height", "500"][..],
            "2 states; --shape fence needs 3 or more states and --height above 0",
        ),
        ("0,0,0\n1,0,0\n2,0,0\n", &["--height", "500"], "makes no fence: "),
        ("0,0,0\n1,1,0\n1,0,0\n0,1,0\n", &["--height", "500"], "makes no fence: walls 1 and 3 cross each other"),
        ("0,0,0\n1,0,0\n1,0,0\n0,1,0\n", &["--height", "500"], "makes no fence: wall 2 is shorter than 1 mm"),
        (square, &[], "--shape fence needs --height above 0"),
        (square, &["--height", "nan"], "--shape fence needs --height above 0"),
        (square, &["--height=-500"], "--shape fence needs --height above 0"),
        (square, &["--height", "500", "--inside"], "--shape fence has no --inside"),
    ] {
        let answer = gantry_fence(corners, more).expect(2);
        assert_eq!(answer.stdout, "", "{corners} {more:?}");
        assert!(answer.stderr.contains(words), "{corners} {more:?}: {}", answer.stderr);
    }
}

#[test]
fn points_that_determine_nothing_are_refused() {
    let straight = "0,0\n0,0\n0,0\n";
    for (shape, states, more) in [
        ("sphere", "0,0\n0,0\n", &[][..]),
        ("plane", straight, &[]),
        ("cylinder", straight, &[]),
        ("box", "0,0\n1,0\n", &[]),
        ("sphere4", "0,0\n1,0\n2,0\n0.5,0\n", &[]),
        ("box3", straight, &["--height", "100"]),
        ("box3", "0,0\n1,0\n0,1\n", &["--height", "nan"]),
        ("box3", "0,0\n1,0\n0,1\n", &[]),
        ("sphere", "0,0\n", &[]),
        ("sphere", "0,1\n0,0\n", &["--height", "3"]),
        ("sphere", "0,1\n0,0\n", &["--warning=-3"]),
        ("sphere", "0,1\n0,0\n", &["--warning", "inf"]),
        ("sphere", "0,1\n0,0\n", &["--robot", "leg"]),
        ("triangle", "0,1\n0,0\n", &[]),
    ] {
        let (_dir, answer) = teach(SWING, shape, states, more);
        let answer = answer.expect(2);
        assert_eq!(answer.stdout, "", "{shape} {states} {more:?}");
        assert!(answer.stderr.len() > 20);
    }
}

/// A teach pendant shows degrees; states are radians.
#[test]
fn states_beyond_the_limits_of_the_joints_are_refused() {
    let (_dir, answer) = teach(SWING, "sphere", "0,90\n0,0\n", &[]);
    let refused = answer.expect(2);
    assert_eq!(refused.stdout, "");
    for words in ["taught.csv:2: `joint_2` is 90, beyond its limits", "are these degrees?", "write: states in radians"]
    {
        assert!(refused.stderr.contains(words), "{words}: {}", refused.stderr);
    }
}

#[test]
fn a_name_that_no_cell_file_takes_is_refused() {
    let dir = with_cell(SWING);
    std::fs::write(dir.path().join("taught.csv"), format!("{HEADER}0,1\n0,0\n")).unwrap();
    for name in ["a/b", "a,b", "", "a\nb", "\"quoted\""] {
        let args = ["teach", "cell.toml", "--shape", "sphere", "--states", "taught.csv", "--name", name];
        let answer = elbowroom(dir.path(), &args).expect(2);
        assert_eq!(answer.stdout, "", "{name:?}");
    }
    let args = ["teach", "cell.toml", "--shape", "sphere", "--states", "taught.csv", "--name", "Tisch 1 (groß)"];
    let answer = elbowroom(dir.path(), &args).expect(0);
    assert!(answer.stdout.contains("[region.\"Tisch 1 (groß)\"]"), "{}", answer.stdout);
}
