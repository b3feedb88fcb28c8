//! `elbowroom run` with `guide = "entry"`: the shaft stays at the point while the hand pushes aside, twists and pulls out.

use std::fmt::Write;
use std::path::Path;

use crate::common::elbowroom;

/// The tool looks straight down; the point of entry is 60 mm above its tip.
const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
model = "MODEL"
start = [0, 0, 0, 0, 90, 0]
[robot.arm.tool]
tcp = { at = [0, 0, 200] }
box = { at = [0, 0, 100], size = [8, 8, 200] }
[fixture.port]
guide = "entry"
tool = "arm"
at = [924, 0, 1225]
depth = [20, 90]
[operator.hand]
robot = "arm"
stream = "hand.csv"
interpolation = "linear"
"#;

/// A hand that holds the tool downwards, turned about its shaft by an angle (rad).
fn write(dir: &Path, cell: &str, hand: impl Fn(f64) -> ([f64; 3], f64), seconds: f64) {
    let model = elbowroom_testkit::folder::model("ns16");
    std::fs::write(dir.join("cell.toml"), cell.replace("MODEL", &model.display().to_string())).unwrap();
    let mut text = "t_s,x,y,z,qx,qy,qz,qw\n".to_owned();
    for k in 0..=(seconds * 50.0) as usize {
        let t_s = k as f64 * 0.02;
        let ([x, y, z], twist) = hand(t_s);
        writeln!(text, "{t_s},{x},{y},{z},{},{},0,0", (0.5 * twist).cos(), (0.5 * twist).sin()).unwrap();
    }
    std::fs::write(dir.join("hand.csv"), text).unwrap();
}

/// Aside, then twisted, then back and out of the port.
fn aside_and_out(t_s: f64) -> ([f64; 3], f64) {
    let aside = 60.0 * ((t_s - 0.5).clamp(0.0, 1.0) - (t_s - 2.5).clamp(0.0, 1.0));
    let out = 100.0 * (t_s - 3.5).clamp(0.0, 2.0);
    ([924.0, aside, 1165.0 + out], (t_s - 1.5).clamp(0.0, 1.0))
}

/// Per tick the distance of the shaft from the point and the depth, m, and the y coordinate of the tip.
fn shafts(dir: &Path, at: [f64; 3]) -> Vec<[f64; 3]> {
    let text = std::fs::read_to_string(dir.join("out/operator.csv")).unwrap();
    let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let columns = ["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"].map(|n| head.iter().position(|h| *h == n).unwrap());
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [x, y, z, qx, qy, qz, qw] = columns.map(|c| cells[c].parse::<f64>().unwrap());
        let axis = [2.0 * (qx * qz + qw * qy), 2.0 * (qy * qz - qw * qx), 1.0 - 2.0 * (qx * qx + qy * qy)];
        let out = [x - at[0], y - at[1], z - at[2]];
        let depth: f64 = axis.iter().zip(out).map(|(a, o)| a * o).sum();
        let beside = axis.iter().zip(out).map(|(a, o)| (o - a * depth).powi(2)).sum::<f64>().sqrt();
        [beside, depth, y]
    };
    text.lines().skip(1).map(row).collect()
}

fn events(dir: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(dir.join("out/events.csv")).unwrap();
    text.lines().skip(1).map(|line| line.split(',').skip(2).collect::<Vec<_>>().join(" ")).collect()
}

#[test]
fn the_shaft_stays_at_the_point_while_the_hand_pushes_aside_twists_and_pulls_out() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), CELL, aside_and_out, 6.0);
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0);
    let shafts = shafts(dir.path(), [0.924, 0.0, 1.225]);
    let most = |column: usize| shafts.iter().map(|row| row[column]).fold(f64::NEG_INFINITY, f64::max);
    let least_depth = shafts.iter().map(|row| row[1]).fold(f64::INFINITY, f64::min);
    assert!(most(0) < 2e-6, "{} m from the point", most(0));
    assert!(most(2) > 0.059, "the tip follows the hand aside: {} m", most(2));
    assert!(most(1) > 0.08 && least_depth > 0.02 - 2e-6 && least_depth < 0.0201, "{} to {least_depth} m", most(1));
}

#[test]
fn a_tool_that_starts_beside_the_point_turns_there_first_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let cell = CELL.replace("at = [924, 0, 1225]", "at = [924, 10, 1225]");
    write(dir.path(), &cell, aside_and_out, 2.0);
    let output = elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0);
    assert!(output.stderr.contains("the shaft starts 10 mm from the point of \"port\""), "{}", output.stderr);
    assert!(output.stderr.contains("cell.toml:10"), "{}", output.stderr);
    let first: Vec<String> = events(dir.path()).into_iter().take(2).collect();
    assert_eq!(first, [" entry", " leave"]);
    let shafts = shafts(dir.path(), [0.924, 0.01, 1.225]);
    assert!(shafts[0][0] > 0.009 && shafts[shafts.len() - 1][0] < 2e-6, "{:?}", shafts[0]);
    assert!(shafts.windows(2).all(|w| w[1][0] <= w[0][0] + 2e-6), "it only comes nearer");
}

#[test]
fn an_obstacle_or_a_joint_stops_the_tool_at_the_point_and_is_named() {
    let dir = tempfile::tempdir().unwrap();
    // An open surface, which the tool cannot glide along, beside the shaft above the point.
    let wall = "[object.wall]\nshape = \"mesh\"\nmesh = \"wall.obj\"\nat = [924, -40, 1250]\n";
    std::fs::write(
        dir.path().join("wall.obj"),
        "v -0.03 0 0\nv 0.03 0 0\nv 0.03 0 0.1\nv -0.03 0 0.1\nf 1 2 3\nf 1 3 4\n",
    )
    .unwrap();
    let hand = |t_s: f64| ([924.0, 200.0 * t_s.min(1.0), 1165.0], 0.0);
    write(dir.path(), &format!("{CELL}{wall}"), hand, 3.0);
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0);
    let events = events(dir.path());
    assert!(events.iter().any(|e| e == "wall refuse"), "{events:?}");
    let shafts = shafts(dir.path(), [0.924, 0.0, 1.225]);
    assert!(shafts.iter().all(|row| row[0] < 2e-6));
    assert!(shafts.iter().any(|row| row[2] > 0.01) && shafts.iter().all(|row| row[2] < 0.06), "it stops at the wall");
}

#[test]
fn points_of_entry_that_mean_nothing_are_refused_with_the_remedy() {
    let entry = |keys: &str| CELL.replace("at = [924, 0, 1225]\ndepth = [20, 90]", keys);
    for (cell, expected) in [
        (entry("depth = [20, 90]"), "at = "),
        (entry("at = [924, 0, 1225]\ndepth = [90, 20]"), "is not from a smaller to a larger length"),
        (entry("at = [924, 0, 1225]\ndepth = [20]"), "depth = [10, 80]"),
        (entry("at = [924, 0, 1225]\naxis = [0, 0, 0]"), "must be a direction"),
        (entry("at = [924, 0, 1225]\nradius = -1"), "radius"),
        (entry("at = [924, 0, 1225]\nhalf_angle = 20"), "does not belong to an entry"),
    ] {
        let dir = tempfile::tempdir().unwrap();
        write(dir.path(), &cell, aside_and_out, 1.0);
        let text = elbowroom(dir.path(), &["run", "cell.toml"]).expect(2).stderr;
        assert!(text.contains(expected) && text.contains("cell.toml:"), "{expected}: {text}");
    }
}
