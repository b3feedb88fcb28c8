//! Maps of real robots on covers: time, a million configurations each, and the fraction of cells that are blocked
//! needlessly.
//!
//! `cargo test --release -p elbowroom-cspace --test main real_covers:: -- --ignored --nocapture` (minutes; the data is not part of
//! the repository). `SAMPLES` is the number of configurations.
#![allow(clippy::print_stdout, reason = "a table is what it is for")]

use std::time::Instant;

use crate::common::occupancy::{compare, needless_share, occupancy};
use crate::common::real::{ROBOTS, obstacles, reach};
use crate::common::robots::{Case, axes};
use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, CoverObstacle, Grid, Layer, RemainingJoints};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::folder;

/// Number of repetitions, of which the fastest counts.
const REPETITIONS: usize = 5;

#[test]
#[ignore = "minutes; cargo test --release -p elbowroom-cspace --test main real_covers:: -- --ignored --nocapture"]
fn maps_on_covers_miss_nothing() {
    let Some(data) = folder::data() else { return };
    let samples: usize = std::env::var("SAMPLES").map_or(1_000_000, |s| s.parse().unwrap());
    let only = std::env::var("ROBOT").ok();
    println!(
        "{:<14} {:<7} {:>8} {:>8} {:>8} {:>9} {:>8} {:>9} {:>9}",
        "robot", "others", "built ms", "all ms", "(cores)", "one moved", "(cores)", "blocked", "needless"
    );
    for name in ROBOTS.into_iter().filter(|name| only.as_ref().is_none_or(|o| o == name)) {
        let file = data.join("urdf").join(name).join(format!("{name}.urdf"));
        let robot = load(&file, &LoadOptions::default()).unwrap().robot;
        for others in ["start", "any"] {
            if std::env::var("MODE").is_ok_and(|m| m != others) {
                continue;
            }
            let mut case = Case::new(obstacles(reach(&robot)));
            case.fixed = (others == "start").then(|| vec![0.1; robot.chain.dof()]);
            case.robot = robot.clone();
            case.step = 2.0;
            measure(name, others, &case, samples);
        }
    }
}

fn measure(name: &str, others: &str, case: &Case, samples: usize) {
    let grid = Grid::new(axes(&case.robot, &case.joints, case.step).try_into().unwrap()).unwrap();
    let remaining = case.fixed.as_deref().map_or(RemainingJoints::Swept, RemainingJoints::Fixed);
    let slack_m = std::env::var("SLACK").ok().map(|s| s.parse().unwrap());
    let settings = CoverMapSettings { slack_m, ..CoverMapSettings::default() };
    let begin = Instant::now();
    let builder = CoverMapBuilder::new(&case.robot, case.base, &grid, [0, 1, 2], remaining, settings).unwrap();
    let build_ms = begin.elapsed().as_secs_f64() * 1e3;
    let prepared: Vec<CoverObstacle> = case.obstacles.iter().map(|(s, _)| builder.obstacle(s).unwrap()).collect();
    let placed: Vec<(&CoverObstacle, Pose)> =
        prepared.iter().zip(&case.obstacles).map(|(o, (_, at))| (o, *at)).collect();
    let repetitions = std::env::var("REPS").map_or(REPETITIONS, |s| s.parse().unwrap());
    // The least elapsed time, and the least processor time of all threads, ms.
    let shortest = |places: &[(&CoverObstacle, Pose)]| {
        let mut shortest = [f64::INFINITY; 2];
        for _ in 0..repetitions {
            let (begin, processor) = (Instant::now(), processor_ms());
            for (obstacle, at) in places {
                std::hint::black_box(builder.layer(obstacle, at).unwrap());
            }
            let took = [begin.elapsed().as_secs_f64() * 1e3, processor_ms() - processor];
            shortest = [0, 1].map(|k| took[k].min(shortest[k]));
        }
        shortest
    };
    let all = shortest(&placed);
    let moved = |at: &Pose| Pose::from_translation(Vec3::X * 0.01) * *at;
    let each = placed.iter().map(|(o, at)| shortest(&[(*o, moved(at))]));
    let one = each.fold([0.0; 2], |most: [f64; 2], took| [0, 1].map(|k| most[k].max(took[k])));
    let layers: Vec<Layer> = placed.iter().map(|(o, at)| builder.layer(o, at).unwrap()).collect();
    let map = occupancy(&grid, &layers);
    let hits = if samples == 0 { 1 } else { compare(case, &grid, &map, samples) };
    assert!(hits > 0, "no sample is in collision: the test is void");
    let needless =
        if others == "any" || samples == 0 { f64::NAN } else { 100.0 * needless_share(case, &grid, &map, 1000) };
    println!(
        "{name:<14} {others:<7} {build_ms:>8.0} {:>8.2} {:>8.2} {:>9.2} {:>8.2} {:>9} {needless:>7.2} %",
        all[0],
        all[1] / all[0],
        one[0],
        one[1] / one[0],
        map.blocked()
    );
}

/// Processor time of all threads, ms.
fn processor_ms() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}
