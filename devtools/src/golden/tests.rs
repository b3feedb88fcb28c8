//! Tests: equal answers have equal hashes, and different answers have different hashes.

use elbowroom_cell::QueryModel;

use super::overrides::{self, KINDS};
use super::queries;
use crate::cross_validation::world::{self, Files};

#[test]
fn hashes_of_queries_repeat_and_depend_on_each_state() {
    let model = xtask::call::workspace_root().unwrap().join("examples/models/rx60b/rx60b");
    let (urdf, srdf) = (model.with_extension("urdf"), Some(model.with_extension("srdf")));
    let robot = world::load(&Files { name: "rx60b".into(), urdf: urdf.clone(), srdf }, true).unwrap();
    let mut states = world::states(&robot, 300);
    let model = QueryModel::of_robot(&urdf, robot);
    let hash = |states: &[Vec<f64>]| queries::digest(&model, states).unwrap().hex();
    let before = hash(&states);
    assert_eq!(hash(&states), before);
    states[299][1] += 1e-9;
    assert_ne!(hash(&states), before);
}

#[test]
fn hashes_of_overrides_do_not_depend_on_the_number_of_threads() {
    let root = xtask::call::workspace_root().unwrap();
    let groups = |cells, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| overrides::groups(&root, None, cells).unwrap())
    };
    // One of each kind.
    let kinds = KINDS.len();
    let once = groups(kinds, 1);
    assert_eq!(groups(kinds, 2), once);
    assert!(once.iter().all(|group| group.count == 1));
    assert_ne!(groups(2 * kinds, 2), once);
}
