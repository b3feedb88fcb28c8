//! Default weights, from size and reach alone, on real robots, if the data is available.
//!
//! Fewer pairs are tested until the first contact than in the order of the file, with the same answers. Weights of a
//! file of pairs override the default weights.

use elbowroom_cell::{Cell, OutOfReachProofs, PairFile, QueryModel};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Level, PairContact, PairEdit, Scene, SceneState};
use elbowroom_testkit::folder;
use elbowroom_testkit::random::Random;

/// Two arms of six axes side by side at a table, with a post and a beam.
fn cell() -> Option<Cell> {
    let data = folder::data_part("urdf")?;
    let robot = |name: &str, model: &str, y: f64| {
        let urdf = data.join(model).join(format!("{model}.urdf"));
        let urdf = urdf.to_str().unwrap();
        format!("[robot.{name}]\nmodel = {urdf:?}\nbase = {{ at = [0, {y}, 0] }}\n")
    };
    let cuboid =
        |name: &str, at: &str, size: &str| format!("[object.{name}]\nshape = \"box\"\nat = {at}\nsize = {size}\n");
    let text = [
        "version = 1\nunits = { length = \"m\", angle = \"rad\" }\n".to_owned(),
        robot("left", "kuka_kr16_2", 0.0),
        robot("right", "abb_irb1600_6_12", 1.4),
        cuboid("table", "[1.1, 0.7, 0.3]", "[0.8, 2.4, 0.6]"),
        cuboid("post", "[0.6, 0.7, 0.8]", "[0.1, 0.1, 1.6]"),
        cuboid("beam", "[0.4, 0.7, 2.0]", "[0.2, 3.0, 0.2]"),
    ];
    Some(Cell::parse(data.join("cell.toml"), &text.concat()).unwrap())
}

/// The first contact of a state, and the number of pairs that were tested exactly until then, without learned weights.
fn first_contact(scene: &Scene, state: &SceneState) -> (Option<PairContact>, u64) {
    let options = CheckerOptions { level: Level::L3, ..CheckerOptions::default() };
    let mut checker = Checker::new(scene, options);
    let contact = checker.collides(state);
    (contact, checker.stats().pairs_tested.l3)
}

fn random_state(scene: &Scene, random: &mut Random) -> SceneState {
    let mut state = SceneState::new(scene);
    for (i, r) in scene.robots().iter().enumerate() {
        let chain = &r.robot.chain;
        let q: Vec<f64> =
            chain.lower().iter().zip(chain.upper()).map(|(l, u)| random.between(l.max(-3.1), u.min(3.1))).collect();
        state.set_q(scene, RobotId(i), &q).unwrap();
    }
    state
}

#[test]
fn weights_by_size_and_reach_find_the_first_contact_with_fewer_tests() {
    let Some(cell) = cell() else { return };
    let model = QueryModel::of_cell(&cell);
    let by_weight = model.scene(OutOfReachProofs::Compute).unwrap();
    let mut in_file_order = by_weight.allowed_collision_matrix().clone();
    let pairs: Vec<_> = in_file_order.entries().iter().map(|e| (e.a, e.b)).collect();
    for (i, (a, b)) in pairs.iter().enumerate() {
        in_file_order.edit(&by_weight, *a, *b, PairEdit::Weight((pairs.len() - i) as f64)).unwrap();
    }
    let in_file_order = by_weight.clone().with_allowed_collision_matrix(in_file_order).unwrap();
    let mut random = Random(22);
    let (mut colliding, mut tests) = (0_u64, [0_u64; 2]);
    for _ in 0..600 {
        let state = random_state(&by_weight, &mut random);
        let (weighted, ordered) = (first_contact(&by_weight, &state), first_contact(&in_file_order, &state));
        assert_eq!(weighted.0.is_some(), ordered.0.is_some());
        if weighted.0.is_some() {
            colliding += 1;
            tests[0] += weighted.1;
            tests[1] += ordered.1;
        }
    }
    let mean = tests.map(|n| n as f64 / colliding as f64);
    println!(
        "{colliding} of 600 collide; exact tests until the first contact: {:.2} by size and reach, {:.2} in file order",
        mean[0], mean[1]
    );
    assert!((100..600).contains(&colliding) && mean[0] < 0.9 * mean[1], "{colliding} {mean:?}");
}

#[test]
fn weights_of_a_file_decide_which_contact_is_found_first() {
    let Some(cell) = cell() else { return };
    let mut state = None;
    for weight in [0.0, 1e6] {
        let mut model = QueryModel::of_cell(&cell);
        let row = format!(
            "version = 1\npairs = [{{ a = \"left\", b = \"post\", state = \"tested\", weight = {weight:?} }}]\n"
        );
        let rules = PairFile::parse("pairs.toml", &row).unwrap().rules(&model).unwrap();
        model.add_rules(rules);
        let scene = model.scene(OutOfReachProofs::Omit).unwrap();
        // A state in which the left arm is in the post, and something else collides too.
        let state = state.get_or_insert_with(|| {
            let mut random = Random(23);
            let mut states = std::iter::repeat_with(|| random_state(&scene, &mut random)).take(5000);
            let is_both = |state: &SceneState| {
                let mut pairs = Vec::new();
                Checker::new(&scene, CheckerOptions::default()).contacts(state, |c| pairs.push(is_post(&scene, &c)));
                pairs.contains(&true) && pairs.contains(&false)
            };
            states.find(is_both).expect("a state with two contacts")
        });
        let contact = first_contact(&scene, state).0.unwrap();
        assert_eq!(is_post(&scene, &contact), weight > 0.0, "{} {}", scene.name(contact.a), scene.name(contact.b));
    }
}

fn is_post(scene: &Scene, contact: &PairContact) -> bool {
    scene.name(contact.a).starts_with("left/") && scene.name(contact.b) == "post"
}
