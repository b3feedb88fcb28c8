//! Depths of the box trees on real robots, if the data is available: answers never get worse with the depth, and never
//! exceed the exact ones.

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_query::{Level, QueryKind, QueryRow, QueryStates, evaluate};
use elbowroom_testkit::folder;

use crate::inspected_robots::states;

const ROBOTS: [&str; 4] = ["fanuc_m20ia", "kuka_kr16_2", "panda", "staubli_tx60"];

fn rows(model: &QueryModel, states: &QueryStates, kind: QueryKind, level: Level) -> Vec<QueryRow> {
    let scene = model.scene(OutOfReachProofs::Omit).unwrap();
    let mut all: Vec<QueryRow> = Vec::new();
    evaluate(&scene, states, kind, level, &mut |rows| {
        all.extend_from_slice(rows);
        true
    })
    .unwrap();
    all
}

#[test]
fn deeper_boxes_of_real_robots_are_never_worse_and_never_beyond_the_exact_answer() {
    let Some(data) = folder::data_part("urdf") else { return };
    let mut better = 0;
    for name in ROBOTS {
        let urdf = data.join(name).join(name).with_extension("urdf");
        let loaded = robot::load(&urdf, &LoadOptions::default()).unwrap();
        let model = QueryModel::of_robot(&urdf, loaded.robot);
        let states = states(&model);
        let answers = |level| {
            let collisions = rows(&model, &states, QueryKind::Collision, level);
            let distances = rows(&model, &states, QueryKind::Distance, level);
            collisions.into_iter().zip(distances).map(|(c, d)| (c.collides, d.distance_m.unwrap())).collect::<Vec<_>>()
        };
        let exact = answers(Level::L3);
        let mut last = answers(Level::L2);
        for depth in [1, 2, 4] {
            let next = answers(Level::boxes(depth));
            for (state, ((above, below), truth)) in last.iter().zip(&next).zip(&exact).enumerate() {
                let what = format!("{name} depth {depth} state {state}: {above:?} {below:?} {truth:?}");
                assert!(below.1 >= above.1 && below.1 <= truth.1 + 1e-12, "{what}");
                assert!((above.0 || !below.0) && (below.0 || !truth.0), "{what}");
                better += usize::from(above.0 && !below.0);
            }
            last = next;
        }
    }
    assert!(better > 10, "deeper boxes decided only {better} states");
}
