//! `elbowroom run` with two operators: guided arms do not bring each other into contact.

use std::fmt::Write;

use crate::common::elbowroom;

/// Two arms on one table, their tools 200 mm apart and facing each other.
fn two_arms() -> String {
    let model = elbowroom_testkit::folder::model("rx60b");
    let arm = |name: &str, base: &str| {
        format!(
            "[robot.{name}]\nmodel = \"{}\"\nsrdf = \"{}\"\nbase = {base}\nstart = [0, 0, 90, 0, 30, 0]\n\
             [robot.{name}.tool]\ntcp = {{ at = [0, 0, 60] }}\nbox = {{ at = [0, 0, 30], size = [30, 30, 60] }}\n\
             [operator.{name}]\nrobot = \"{name}\"\nstream = \"{name}.csv\"\ninterpolation = \"linear\"\n",
            model.display(),
            model.with_extension("srdf").display()
        )
    };
    let arms = [
        arm("left", "{ at = [-500, 0, 0], rpy = [0, 0, 0] }"),
        arm("right", "{ at = [500, 0, 0], rpy = [0, 0, 180] }"),
    ];
    format!("version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = 4\n{}", arms.concat())
}

#[test]
fn two_hands_that_push_their_arms_together_do_not_bring_them_into_contact() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), two_arms()).unwrap();
    // 300 mm towards the other arm in 2 s, and back.
    let x = |t_s: f64| -100.0 + 150.0 * t_s.min(4.0 - t_s);
    for (name, side, turn) in [("left", 1.0, "0,0.8660254,0,0.5"), ("right", -1.0, "-0.8660254,0,0.5,0")] {
        let mut text = "t_s,x,y,z,qx,qy,qz,qw\n".to_owned();
        for k in 0..=80 {
            let t_s = 0.05 * f64::from(k);
            writeln!(text, "{t_s},{},0,500,{turn}", side * x(t_s)).unwrap();
        }
        std::fs::write(dir.path().join(format!("{name}.csv")), text).unwrap();
    }
    elbowroom(dir.path(), &["run", "cell.toml", "--out", "out"]).expect(0);
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    assert!(events.contains(",refuse"), "{events}");
    // Both came free again.
    let trace = std::fs::read_to_string(dir.path().join("out/operator.csv")).unwrap();
    let column = |name: &str| trace.lines().next().unwrap().split(',').position(|head| head == name).unwrap();
    let last = |robot: &str| trace.lines().rfind(|line| line.contains(robot)).unwrap().split(',').collect::<Vec<_>>();
    for (name, at_m) in [("left", -0.1), ("right", 0.1)] {
        let x_m: f64 = last(name)[column("x_m")].parse().unwrap();
        assert!((x_m - at_m).abs() < 2e-3, "{name} at {x_m} m");
    }
}
