//! The weight matrix at work in `query`: fewer pairs are tested until the first contact, and nothing is answered otherwise.

use elbowroom_cell::Cell;
use elbowroom_cell::query::{Ask, Level, Row, States, Subject, answer};
use elbowroom_scene::{Checker, Counts, Options, Scene, SceneState};

/// Two arms beside each other over a table, with posts and a shelf that the hands come to sooner than the feet.
fn cell() -> Cell {
    let arm = |name: &str, x: f64| {
        format!(
            r"
[robot.{name}]
base = {{ at = [{x}, 0, 0], rpy = [0, 0, 0] }}
foot = {{ cylinder = {{ from = [0, 0, 0], to = [0, 0, 100], radius = 90 }} }}
dh = [
  {{ d = 350, alpha = 90, min = -170, max = 170, speed = 90 }},
  {{ a = 450, min = -30, max = 170, speed = 90 }},
  {{ a = 60, alpha = 90, min = -120, max = 120, speed = 90 }},
  {{ d = 420, alpha = -90, min = -180, max = 180, speed = 90 }},
  {{ alpha = 90, min = -110, max = 110, speed = 90 }},
  {{ d = 140, min = -180, max = 180, speed = 90 }},
]
links = [
  {{ capsule = {{ from = [0, -250, 0], to = [0, 0, 0], radius = 80 }} }},
  {{ capsule = {{ from = [-450, 0, 0], to = [0, 0, 0], radius = 60 }} }},
  {{ sphere = {{ radius = 70 }} }},
  {{ capsule = {{ from = [0, 100, 0], to = [0, 280, 0], radius = 50 }} }},
  {{ sphere = {{ radius = 45 }} }},
  {{ box = {{ at = [0, 0, 40], size = [90, 160, 80] }} }},
]
"
        )
    };
    let objects = [
        ("table", "[350, 500, 100]", "[900, 400, 200]"),
        ("shelf", "[350, -650, 600]", "[900, 200, 40]"),
        ("post", "[350, 0, 400]", "[60, 60, 800]"),
        ("lamp", "[0, 0, 1250]", "[700, 60, 60]"),
    ];
    let objects = objects
        .iter()
        .map(|(name, at, size)| format!("[object.{name}]\nshape = \"box\"\nat = {at}\nsize = {size}\n"))
        .collect::<Vec<_>>()
        .concat();
    let head = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n";
    Cell::parse("c.toml", &[head, &arm("left", 0.0), &arm("right", 700.0), &objects].concat()).unwrap()
}

fn states(subject: &Subject, count: usize) -> States {
    let names = ["left", "right"].map(|r| (1..=6).map(|j| format!("{r}.joint_{j}")).collect::<Vec<_>>()).concat();
    let chain = |robot: usize| &subject.robots[robot].robot.chain;
    let bounds: Vec<(f64, f64)> = (0..2).flat_map(|r| chain(r).lower().into_iter().zip(chain(r).upper())).collect();
    let mut text = names.join(",") + "\n";
    let mut seed = 18_u64;
    for _ in 0..count {
        let q = bounds.iter().map(|(lower, upper)| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (lower + (upper - lower) * ((seed >> 11) as f64 / (1_u64 << 53) as f64)).to_string()
        });
        text += &(q.collect::<Vec<_>>().join(",") + "\n");
    }
    States::parse("q.csv".as_ref(), &text, subject).unwrap()
}

fn asked(scene: &Scene, states: &States, ask: Ask, level: Level) -> (Vec<Row>, Counts) {
    let mut all = Vec::new();
    let counts = answer(scene, states, ask, level, &mut |rows| {
        all.extend_from_slice(rows);
        true
    });
    (all, counts.unwrap())
}

/// Whether each state collides, in the order of the hierarchy: no weights.
fn in_order_of_the_hierarchy(scene: &Scene, states: &States, level: Level) -> (Vec<bool>, Counts) {
    let mut checker = Checker::new(scene, Options { level, weights: false, ..Options::default() });
    let mut state = SceneState::new(scene);
    let collides = (0..states.len()).map(|i| {
        states.of(i).for_each(|(robot, q)| state.set_q(scene, robot, q).unwrap());
        checker.collides(&state).is_some()
    });
    (collides.collect(), checker.counts())
}

#[test]
fn query_tests_likely_pairs_first_and_answers_alike() {
    let subject = Subject::of_cell(&cell());
    let states = states(&subject, 1000);
    let scene = subject.scene(false).unwrap();
    // Exact solids only: boxes dismiss most pairs before their order matters.
    let (collides, plain) = in_order_of_the_hierarchy(&scene, &states, Level::L3);
    let (exact, weighed) = asked(&scene, &states, Ask::Collision, Level::L3);
    assert_eq!(exact.iter().map(|r| r.collides).collect::<Vec<_>>(), collides);
    let colliding = collides.iter().filter(|c| **c).count();
    assert!((300..1000).contains(&colliding), "{colliding}");
    let [plain, weighed] = [plain, weighed].map(|c| c.pairs_tested.l3);
    eprintln!("{colliding} of 1000 collide; exact tests: {plain} by hierarchy, {weighed} by weight");
    assert!(10 * weighed < 9 * plain, "{weighed} by weight, {plain} by hierarchy");
    let rows = asked(&scene, &states, Ask::Collision, Level::Auto).0;
    // The pair told is one in contact, and the same one at both exact levels.
    let mut checker = Checker::new(&scene, Options::default());
    let mut state = SceneState::new(&scene);
    for (i, (row, exact)) in rows.iter().zip(&exact).enumerate() {
        assert_eq!(row.pair, exact.pair, "state {i}");
        let Some((a, b)) = row.pair else { continue };
        states.of(i).for_each(|(robot, q)| state.set_q(&scene, robot, q).unwrap());
        assert!(checker.between(a.into(), b.into()).collides(&state).is_some(), "state {i}");
    }
    // A tolerance is a yes or no, too.
    let tolerance = asked(&scene, &states, Ask::Tolerance(0.01), Level::Auto).0;
    let distance = asked(&scene, &states, Ask::Distance, Level::Auto).0;
    for (t, d) in tolerance.iter().zip(&distance) {
        assert_eq!(t.collides, d.distance_m.unwrap() <= 0.01);
    }
}
