//! All published robots, if the data is available: they load, have no suspect units, and exact and automatic levels
//! agree.

use std::path::PathBuf;

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_inspect::{InspectOptions, Inspection};
use elbowroom_query::{Level, QueryKind, QueryRow, QueryStates, evaluate};
use elbowroom_testkit::folder;
use elbowroom_testkit::random::Random;

fn robots() -> Vec<PathBuf> {
    let robots = folder::robots(&["urdf", "cell"]);
    assert!(robots.is_empty() || robots.len() > 30, "only {}", robots.len());
    robots
}

/// Fifty states spread over the limits, as CSV.
pub fn states(model: &QueryModel) -> QueryStates {
    let chain = &model.robots[0].robot.chain;
    let names: Vec<&str> = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect();
    let mut text = names.join(",") + "\n";
    let bounds: Vec<(f64, f64)> =
        chain.lower().into_iter().zip(chain.upper()).map(|(l, u)| (l.max(-3.1), u.min(3.1))).collect();
    let mut random = Random(1);
    for _ in 0..50 {
        let q = bounds.iter().map(|(lower, upper)| random.between(*lower, *upper).to_string());
        text += &(q.collect::<Vec<_>>().join(",") + "\n");
    }
    QueryStates::parse("q.csv".as_ref(), &text, model).unwrap()
}

#[test]
fn the_levels_agree_on_real_robots() {
    for urdf in robots() {
        let srdf = Some(urdf.with_extension("srdf")).filter(|p| p.is_file());
        let loaded = robot::load(&urdf, &LoadOptions { srdf, ..LoadOptions::default() }).unwrap();
        let model = QueryModel::of_robot(&urdf, loaded.robot);
        let states = states(&model);
        let scene = model.scene(OutOfReachProofs::Omit).unwrap();
        for kind in [QueryKind::Collision, QueryKind::Distance, QueryKind::Tolerance(0.05)] {
            let rows = |level| {
                let mut all: Vec<QueryRow> = Vec::new();
                evaluate(&scene, &states, kind, level, &mut |rows| {
                    all.extend_from_slice(rows);
                    true
                })
                .unwrap();
                all
            };
            let (auto, exact) = (rows(Level::Auto), rows(Level::L3));
            assert_eq!((auto.len(), exact.len()), (50, 50));
            for (x, y) in auto.iter().zip(&exact) {
                let result = |r: &QueryRow| (r.collides, r.distance_m, r.pair.filter(|_| kind == QueryKind::Collision));
                assert_eq!(result(x), result(y), "{} {kind:?} state {}", urdf.display(), x.index);
            }
        }
    }
}

#[test]
fn published_robot_models_cause_no_unit_warning() {
    let options = InspectOptions { brief: true, ..InspectOptions::default() };
    for urdf in robots() {
        let inspection = Inspection::of(&urdf, &options).unwrap();
        assert_eq!(inspection.suspect_units, [], "{}", urdf.display());
    }
}
