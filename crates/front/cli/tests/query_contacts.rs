//! `query --ask contacts` and `--ask point`.

use crate::common::{Answer, elbowroom, with_cell};

/// A slide that pushes a cube along z, through a plate and into a shell; and a sphere beside them.
const CELL: &str = r#"version = 1
units = { length = "mm", angle = "deg" }
[robot.push]
dh = [{ kind = "prismatic", min = 0, max = 3000, speed = 500 }]
links = [{ box = { at = [0, 0, 0], size = [100, 100, 100] } }]
[object.plate]
shape = "box"
at = [0, 0, 500]
size = [400, 400, 20]
[object.ball]
shape = "sphere"
at = [0, 100, 1000]
radius = 60
[object.block]
shape = "box"
at = [0, 0, 2000]
size = [400, 400, 400]
"#;

const STATES: &str = "joint_1\n0\n0.45\n1.0\n2.0\n2.5\n";

fn ask(args: &[&str]) -> Answer {
    let dir = with_cell(CELL);
    std::fs::write(dir.path().join("q.csv"), STATES).unwrap();
    elbowroom(dir.path(), &[&["query", "cell.toml", "--states", "q.csv"], args].concat())
}

fn rows(answer: &Answer) -> Vec<Vec<String>> {
    answer.stdout.lines().skip(1).map(|l| l.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn every_two_triangles_that_touch_are_a_row() {
    let answer = ask(&["--ask", "contacts"]).expect(0);
    let header = "index,a,b,collider_a,collider_b,triangle_a,triangle_b,px,py,pz,qx,qy,qz";
    assert_eq!(answer.stdout.lines().next(), Some(header));
    let rows = rows(&answer);
    let of = |index: &str| rows.iter().filter(|r| r[0] == index).collect::<Vec<_>>();
    assert!(of("0").is_empty() && of("4").is_empty());
    // The cube's four sides cross the plate's lower face, at z = 0.49 m.
    let plate = of("1");
    assert!(plate.len() >= 4 && plate.iter().all(|r| r[1] == "push/link_1" && r[2] == "plate"), "{plate:?}");
    for r in &plate {
        let number = |i: usize| r[i].parse::<f64>().unwrap();
        assert!((number(9) - 0.49).abs() < 1e-9 && (number(12) - 0.49).abs() < 1e-9, "{r:?}");
        assert!(number(7).abs().max(number(8).abs()) < 0.05 + 1e-9 && number(5) < 12.0 && number(6) < 12.0, "{r:?}");
    }
    // One side of the cube is in the sphere, whose triangles are inside its surface.
    let ball = of("2");
    assert!(ball.len() > 4, "{ball:?}");
    for r in &ball {
        let p: Vec<f64> = (7..10).map(|i| r[i].parse().unwrap()).collect();
        let radius = p[0].hypot(p[1] - 0.1).hypot(p[2] - 1.0);
        assert!((0.0598..=0.06 + 1e-9).contains(&radius), "{radius} {r:?}");
    }
    // Inside the block: in contact, without triangles.
    let inside = of("3");
    assert!(inside.len() == 1 && inside[0][5].is_empty() && inside[0][6].is_empty(), "{inside:?}");
    let json = ask(&["--ask", "contacts", "--json"]).expect(0).json();
    assert_eq!((json["ask"].as_str(), json["colliding"].as_u64()), (Some("contacts"), Some(3)));
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(rows.len()));
    assert_eq!(json["rows"][0]["triangle_a"].as_u64().map(|t| t.to_string()), Some(rows[0][5].clone()));
    // The requested pairs.
    assert!(
        ask(&["--ask", "contacts", "--between", "push,ball"])
            .expect(0)
            .stdout
            .lines()
            .skip(1)
            .all(|l| l.starts_with("2,"))
    );
}

#[test]
fn the_collision_point_lies_on_both_surfaces() {
    let answer = ask(&["--ask", "point"]).expect(0);
    let rows = rows(&answer);
    assert_eq!(rows.len(), 5);
    assert!(answer.stdout.starts_with("index,collides,distance_m,a,b,ax,"), "{}", answer.stdout);
    assert_eq!(rows.iter().map(|r| &r[1][..]).collect::<Vec<_>>(), ["0", "1", "1", "1", "0"]);
    let [plate, ball] = [1, 2].map(|i: usize| {
        let r = &rows[i];
        assert_eq!(r[3], "push/link_1");
        (r[4].clone(), (5..11).map(|k| r[k].parse().unwrap()).collect::<Vec<f64>>())
    });
    assert!(plate.0 == "plate" && (0.40..=0.51).contains(&plate.1[2]), "{plate:?}");
    let on_ball = distance(&ball.1[3..], [0.0, 0.1, 1.0]);
    assert!(ball.0 == "ball" && (on_ball - 0.06).abs() < 1e-6, "{ball:?}");
    assert!(rows[0][3].is_empty() && rows[0][5].is_empty());
}

fn distance(p: &[f64], q: [f64; 3]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2])
}

#[test]
fn wrong_calls_say_what_to_write() {
    for (args, expected) in [
        (&["--ask", "contacts", "--level", "L2"][..], "--level auto"),
        (&["--ask", "point", "--level", "hull"][..], "--level auto"),
        (&["--ask", "contact"][..], "contacts"),
        (&["--ask", "contacts", "--all-pairs", "0.1"][..], "--ask distance"),
    ] {
        let answer = ask(args).expect(2);
        assert!(answer.stderr.contains(expected) && answer.stdout.is_empty(), "{args:?}: {}", answer.stderr);
    }
}
