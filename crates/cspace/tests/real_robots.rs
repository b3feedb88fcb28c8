//! Maps of real robots: a million configurations each, no collision in a free cell; and the share of cells that are blocked
//! needlessly.
//!
//! `cargo test --release -p elbowroom-cspace --test real_robots -- --ignored --nocapture` (minutes; the data is not part of
//! the repository).
#![allow(clippy::print_stdout, reason = "a table is what it is for")]

#[path = "common/robots.rs"]
mod robots;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use elbowroom_cspace::ObstacleModel;
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{Cylinder, Shape, Sphere};
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;
use robots::{Case, box_mesh, cuboid};

fn data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("ELBOWROOM_DATA").map_or(beside, PathBuf::from);
    folder.join("urdf").is_dir().then_some(folder)
}

/// Length from base to tip along the links, metres.
fn reach(robot: &Robot) -> f64 {
    let chain = &robot.chain;
    chain.path(chain.tip()).iter().map(|j| chain.joints()[j.0].origin.translation.length()).sum()
}

/// A table, a column, a sphere, an obstacle over the base axis, and a small rotated mesh.
fn obstacles(reach: f64) -> Vec<(Shape, Pose)> {
    let at = |x: f64, y: f64, z: f64| [x * reach, y * reach, z * reach];
    let place = |x, y, z, rpy| Pose::from_xyz_rpy(at(x, y, z), rpy);
    vec![
        cuboid(at(0.5, 0.0, 0.1), [0.0, 0.0, 0.3], at(0.2, 0.4, 0.2)),
        (
            Shape::Cylinder(Cylinder { half_length: 0.4 * reach, radius: 0.05 * reach }),
            place(0.2, -0.45, 0.4, [0.1, 0.0, 0.0]),
        ),
        (Shape::Sphere(Sphere { radius: 0.08 * reach }), place(-0.35, 0.3, 0.5, [0.0; 3])),
        (Shape::Mesh(Arc::new(box_mesh(0.1 * reach))), place(0.02, 0.01, 0.95, [0.5, 0.3, 0.2])),
        (Shape::Mesh(Arc::new(box_mesh(0.12 * reach))), place(-0.5, -0.2, 0.25, [0.5, 0.3, 0.2])),
    ]
}

#[test]
#[ignore = "minutes; cargo test --release -p elbowroom-cspace --test real_robots -- --ignored --nocapture"]
fn no_collision_lies_in_a_free_cell() {
    let Some(data) = data() else {
        println!("skipped: no data at ../shared/data or $ELBOWROOM_DATA");
        return;
    };
    let names = ["kuka_kr150_2", "staubli_tx60", "ur5e", "abb_irb2400"];
    println!(
        "{:<14} {:>4} {:<10} {:>9} {:>9} {:>8} {:>9}",
        "robot", "step", "model", "ms", "blocked", "missed", "needless"
    );
    for name in names {
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
            // Checked against the obstacles themselves, not their models.
            case.compare(&tree, samples);
            case.obstacles = solids;
            let needless = case.needless_share(&tree, 1000);
            let blocked = tree.blocked();
            println!("{name:<14} {step:>4} {word:<10} {ms:>9.0} {blocked:>9} {:>8} {:>7.2} %", 0, 100.0 * needless);
            assert!(needless <= 0.01, "{name} {step} {word}: {needless}");
        }
    }
}
