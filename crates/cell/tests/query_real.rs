//! Every real robot, where the data is there: it loads, raises no doubt about units, and exact and automatic levels
//! answer alike.

use std::path::{Path, PathBuf};

use elbowroom_cell::inspect::{InspectOptions, Inspection};
use elbowroom_cell::query::{Ask, Level, Row, States, Subject, answer};
use elbowroom_formats::robot::{self, LoadOptions};

fn robots() -> Vec<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("ELBOWROOM_DATA").map_or_else(beside, PathBuf::from);
    if !data.is_dir() {
        eprintln!("skipped: no data at {}", data.display());
        return Vec::new();
    }
    let mut robots = Vec::new();
    for group in ["urdf", "cell"] {
        for entry in std::fs::read_dir(data.join(group)).unwrap() {
            let folder = entry.unwrap().path();
            let urdf = folder.join(format!("{}.urdf", folder.file_name().unwrap().to_str().unwrap()));
            robots.extend(urdf.is_file().then_some(urdf));
        }
    }
    assert!(robots.len() > 30, "only {}", robots.len());
    robots.sort();
    robots
}

/// Fifty states spread over the limits, as a file would hold them.
fn states(subject: &Subject) -> States {
    let chain = &subject.robots[0].robot.chain;
    let names: Vec<&str> = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect();
    let mut text = names.join(",") + "\n";
    let bounds: Vec<(f64, f64)> =
        chain.lower().into_iter().zip(chain.upper()).map(|(l, u)| (l.max(-3.1), u.min(3.1))).collect();
    let mut seed = 1_u64;
    for _ in 0..50 {
        let q = bounds.iter().map(|(lower, upper)| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (lower + (upper - lower) * ((seed >> 11) as f64 / (1_u64 << 53) as f64)).to_string()
        });
        text += &(q.collect::<Vec<_>>().join(",") + "\n");
    }
    States::parse("q.csv".as_ref(), &text, subject).unwrap()
}

#[test]
fn real_robots_answer_and_the_levels_agree() {
    for urdf in robots() {
        let srdf = Some(urdf.with_extension("srdf")).filter(|p| p.is_file());
        let loaded = robot::load(&urdf, &LoadOptions { srdf, ..LoadOptions::default() }).unwrap();
        let subject = Subject::of_robot(&urdf, loaded.robot);
        let states = states(&subject);
        let scene = subject.scene(false).unwrap();
        for ask in [Ask::Collision, Ask::Distance, Ask::Tolerance(0.05)] {
            let rows = |level| {
                let mut all: Vec<Row> = Vec::new();
                answer(&scene, &states, ask, level, &mut |rows| {
                    all.extend_from_slice(rows);
                    true
                })
                .unwrap();
                all
            };
            let (auto, exact) = (rows(Level::Auto), rows(Level::L3));
            assert_eq!((auto.len(), exact.len()), (50, 50));
            for (x, y) in auto.iter().zip(&exact) {
                let said = |r: &Row| (r.collides, r.distance_m, r.pair.filter(|_| ask == Ask::Collision));
                assert_eq!(said(x), said(y), "{} {ask:?} state {}", urdf.display(), x.index);
            }
        }
    }
}

#[test]
fn no_robot_that_its_makers_publish_is_in_doubt() {
    let options = InspectOptions { brief: true, ..InspectOptions::default() };
    for urdf in robots() {
        let inspection = Inspection::of(&urdf, &options).unwrap();
        assert_eq!(inspection.unit_doubts, [], "{}", urdf.display());
    }
}
