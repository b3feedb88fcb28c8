//! The weight matrix in `query`: fewer pairs are tested until the first contact, with the same results.

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_query::{Level, QueryKind, QueryRow, QueryStates, evaluate};
use elbowroom_scene::{Checker, CheckerOptions, CheckerStats, Scene, SceneState};
use elbowroom_testkit::random::Random;

/// Two arms beside each other over a table, with posts and a shelf that the hands reach sooner than the bases.
fn cell() -> Cell {
    let arm = |name: &str, x: f64| {
        format!(
            r"
[robot.{name}]
base = {{ at = [{x}, 0, 0], rpy = [0, 0, 0] }}
base_link = {{ cylinder = {{ from = [0, 0, 0], to = [0, 0, 100], radius = 90 }} }}
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

fn states(model: &QueryModel, count: usize) -> QueryStates {
    let names = ["left", "right"].map(|r| (1..=6).map(|j| format!("{r}.joint_{j}")).collect::<Vec<_>>()).concat();
    let chain = |robot: usize| &model.robots[robot].robot.chain;
    let bounds: Vec<(f64, f64)> = (0..2).flat_map(|r| chain(r).lower().into_iter().zip(chain(r).upper())).collect();
    let mut text = names.join(",") + "\n";
    let mut random = Random(18);
    for _ in 0..count {
        let q = bounds.iter().map(|(lower, upper)| random.between(*lower, *upper).to_string());
        text += &(q.collect::<Vec<_>>().join(",") + "\n");
    }
    QueryStates::parse("q.csv".as_ref(), &text, model).unwrap()
}

fn evaluate_all(scene: &Scene, states: &QueryStates, kind: QueryKind, level: Level) -> (Vec<QueryRow>, CheckerStats) {
    let mut all = Vec::new();
    let counts = evaluate(scene, states, kind, level, &mut |rows| {
        all.extend_from_slice(rows);
        true
    });
    (all, counts.unwrap())
}

/// Whether each state collides, with pairs tested in the order of the hierarchy, without weights.
fn in_order_of_the_hierarchy(scene: &Scene, states: &QueryStates, level: Level) -> (Vec<bool>, CheckerStats) {
    let mut checker = Checker::new(scene, CheckerOptions { level, weights: false, ..CheckerOptions::default() });
    let mut state = SceneState::new(scene);
    let collides = (0..states.len()).map(|i| {
        states.of(i).for_each(|(robot, q)| state.set_q(scene, robot, q).unwrap());
        checker.collides(&state).is_some()
    });
    (collides.collect(), checker.stats())
}

#[test]
fn testing_likely_pairs_first_does_not_change_the_results() {
    let model = QueryModel::of_cell(&cell());
    let states = states(&model, 1000);
    let scene = model.scene(OutOfReachProofs::Omit).unwrap();
    // Exact solids only: boxes dismiss most pairs before their order matters.
    let (collides, plain) = in_order_of_the_hierarchy(&scene, &states, Level::L3);
    let (exact, weighed) = evaluate_all(&scene, &states, QueryKind::Collision, Level::L3);
    assert_eq!(exact.iter().map(|r| r.collides).collect::<Vec<_>>(), collides);
    let colliding = collides.iter().filter(|c| **c).count();
    assert!((300..1000).contains(&colliding), "{colliding}");
    let [plain, weighed] = [plain, weighed].map(|c| c.pairs_tested.l3);
    eprintln!("{colliding} of 1000 collide; exact tests: {plain} by hierarchy, {weighed} by weight");
    assert!(10 * weighed < 9 * plain, "{weighed} by weight, {plain} by hierarchy");
    let rows = evaluate_all(&scene, &states, QueryKind::Collision, Level::Auto).0;
    // The reported pair is in contact, and the same at both exact levels.
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut state = SceneState::new(&scene);
    for (i, (row, exact)) in rows.iter().zip(&exact).enumerate() {
        assert_eq!(row.pair, exact.pair, "state {i}");
        let Some((a, b)) = row.pair else { continue };
        states.of(i).for_each(|(robot, q)| state.set_q(&scene, robot, q).unwrap());
        assert!(checker.between(a.into(), b.into()).collides(&state).is_some(), "state {i}");
    }
    // A tolerance query is a boolean query, too.
    let tolerance = evaluate_all(&scene, &states, QueryKind::Tolerance(0.01), Level::Auto).0;
    let distance = evaluate_all(&scene, &states, QueryKind::Distance, Level::Auto).0;
    for (t, d) in tolerance.iter().zip(&distance) {
        assert_eq!(t.collides, d.distance_m.unwrap() <= 0.01);
    }
}
