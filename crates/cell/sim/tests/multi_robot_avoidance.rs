//! Robots that evade each other, and robots whose motion is known.

use crate::common::{HEAD, parse, run};
use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;

/// Two prismatic joints in the plane of world x and y that carry a ball; the first robot is stationary on the path of
/// the other.
fn cell(avoidance: &str) -> String {
    let gantry = |name: &str, start: &str| {
        format!(
            r#"
[robot.{name}]
base = {{ at = [0, 0, 0], rpy = [0, 90, 0] }}
dh = [
  {{ kind = "prismatic", alpha = 90, min = -2000, max = 2000, speed = 1000, acceleration = 4000 }},
  {{ kind = "prismatic", min = -2000, max = 2000, speed = 1000, acceleration = 4000 }},
]
links = [[], {{ sphere = {{ radius = 50 }} }}]
start = {start}
"#
        )
    };
    let programs = "
[program.waits]
steps = [{ wait = 5 }]
[program.drives]
steps = [{ move = \"joint\", to = [900, 30], speed = 40 }]
";
    let table = format!("[avoidance.waits]\n{avoidance}\n");
    [HEAD, &gantry("waits", "[0, 0]"), &gantry("drives", "[-900, 30]"), &table, programs].concat()
}

#[test]
fn another_robot_is_evaded_unless_it_is_listed_as_known() {
    let outcome = run(&cell(""));
    let robots = &outcome.recording.robots;
    assert!(robots.iter().all(|r| r.collisions.is_empty() && r.finished), "{:?}", robots[0].collisions);
    let off = robots[0].samples.iter().map(|s| s.q[0].hypot(s.q[1])).fold(0.0, f64::max);
    assert!(off > 0.05, "{off}");
    // It returns to its initial configuration.
    assert!(robots[0].samples.last().unwrap().q.iter().all(|v| v.abs() < 1e-6));

    // What is steered: the point of its ball that is nearest to the other.
    let evasion = &robots[0].avoidance.as_ref().unwrap().evasions[0];
    let event = outcome.recording.events.iter().find(|e| e.event.name() == "evade").unwrap();
    assert_eq!((event.t_s, event.robot.as_str()), (evasion.t_s, "waits"));
    assert_eq!((event.region.as_str(), evasion.obstacle.as_deref()), ("drives/link_2", Some("drives/link_2")));
    assert_eq!(
        (evasion.link.as_str(), &evasion.moved_by[..]),
        ("link_2", &["joint_1".to_owned(), "joint_2".to_owned()][..])
    );
    assert!((evasion.in_link_m.iter().map(|v| v * v).sum::<f64>().sqrt() - 0.05).abs() < 1e-9, "{evasion:?}");
    let sample = |robot: usize| robots[robot].samples.iter().find(|s| s.t_s >= evasion.t_s - 1e-9).unwrap();
    let [here, there] = [0, 1].map(|robot| &sample(robot).q);
    let gap = (here[0] - there[0]).hypot(here[1] - there[1]) - 0.1;
    assert!((gap - evasion.distance_m).abs() < 0.02, "{gap} and {}", evasion.distance_m);

    let named = run(&cell("robots = [\"drives\"]"));
    let same = named.recording.robots[0].samples.iter().zip(&robots[0].samples).all(|(a, b)| a.q == b.q);
    assert!(same && named.recording.robots[0].samples.len() == robots[0].samples.len());

    // Robots with known motion are not evaded: the programs must avoid them, and these programs do not.
    let known = run(&cell("robots = []"));
    let robot = &known.recording.robots[0];
    assert!(known.has_violation() && robot.samples.iter().all(|s| s.q == [0.0, 0.0]), "{:?}", robot.collisions);
}

#[test]
fn names_of_robots_are_checked() {
    let wrong = |list: &str, word: &str| {
        let e = Cell::parse(std::path::Path::new("cell.toml"), &cell(&format!("robots = {list}"))).unwrap_err();
        assert!(e.to_string().contains(word) && e.line.is_some() && e.hint.is_some(), "{e}");
    };
    wrong("[\"drivers\"]", "drives");
    wrong("[\"waits\"]", "itself");
    wrong("\"drives\"", "list");
    wrong("[3]", "robots");
    assert_eq!(parse(&cell("")).robots[0].avoidance.as_ref().unwrap().robots, [RobotId(1)]);
}
