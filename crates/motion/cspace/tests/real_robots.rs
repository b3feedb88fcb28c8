//! Maps of real robots: a million configurations each, all collisions in blocked cells; and the fraction of cells that
//! are blocked needlessly.
//!
//! `cargo test --release -p elbowroom-cspace --test main real_robots:: -- --ignored --nocapture` (minutes; the data is not part of
//! the repository).
#![allow(clippy::print_stdout, reason = "a table is what it is for")]

use std::time::Instant;

use crate::common::real::{ROBOTS, obstacles, reach};
use crate::common::robots::Case;
use elbowroom_cspace::ObstacleModel;
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_testkit::folder;

#[test]
#[ignore = "minutes; cargo test --release -p elbowroom-cspace --test main real_robots:: -- --ignored --nocapture"]
fn no_collision_lies_in_a_free_cell() {
    let Some(data) = folder::data() else { return };
    println!(
        "{:<14} {:>4} {:<10} {:>9} {:>9} {:>8} {:>9}",
        "robot", "step", "model", "ms", "blocked", "missed", "needless"
    );
    for name in ROBOTS {
        let file = data.join("urdf").join(name).join(format!("{name}.urdf"));
        let robot = load(&file, &LoadOptions::default()).unwrap().robot;
        let reach = reach(&robot);
        for (step, word, samples) in [
            (2.0, "exact", 1_000_000),
            (5.0, "exact", 1_000_000),
            (4.0, "sphere", 250_000),
            (4.0, "spheres=8", 250_000),
            (4.0, "box", 250_000),
            (4.0, "slices", 250_000),
        ] {
            let mut case = Case::new(obstacles(reach));
            case.fixed = Some(vec![0.1; robot.chain.dof()]);
            case.robot = robot.clone();
            case.step = step;
            let base = case.builder().base_in_world();
            let model: ObstacleModel = word.parse().unwrap();
            let solids: Vec<_> = case.obstacles.iter().flat_map(|(s, at)| model.solids(s, at, &base)).collect();
            let begin = Instant::now();
            let tree = case.builder().build(&solids).unwrap();
            let ms = begin.elapsed().as_secs_f64() * 1e3;
            // Compared with the obstacles themselves instead of their models.
            case.compare(&tree, samples);
            case.obstacles = solids;
            let needless = case.needless_share(&tree, 1000);
            let blocked = tree.blocked();
            println!("{name:<14} {step:>4} {word:<10} {ms:>9.0} {blocked:>9} {:>8} {:>7.2} %", 0, 100.0 * needless);
            assert!(needless <= 0.01, "{name} {step} {word}: {needless}");
        }
    }
}
