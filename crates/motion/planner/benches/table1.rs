//! Table 1 of the joint-space paper, remade: `cargo bench -p elbowroom-planner --bench table1`.
//!
//! Times to transform an upright cube by each model, to move it by 1 cm, and to plan on the result; blocked cells; lengths of
//! the paths, and the share that is found. In addition the number of collisions in free cells (sampled anywhere, behind the
//! base, and in free neighbours of blocked cells) and the fraction of blocked cells that are free in their whole box. The last
//! table moves the cube towards the base.
#![allow(clippy::print_stdout, reason = "a bench prints")]
#![allow(clippy::unwrap_used, reason = "the numbers are constants")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../../cspace/tests/common/planar_samples.rs"]
mod samples;

use std::time::{Duration, Instant};

use common::table1::{MODELS, Setting, Table, lengths, pairs, settings};
use elbowroom_cspace::{JointMap, Layer, ObstacleModel};
use elbowroom_spatial::Vec3;
use samples::{SampleCounts, Xorshift, missed_contacts, needless_share};

/// Milliseconds and blocked elements of the paper, for the first four models.
const PAPER: [&str; 7] = ["18.7 ms, 2425", "94.2 ms, 2335", "126.2 ms, 1982", "15.2 ms, 2488", "", "", ""];

fn main() {
    for setting in settings() {
        reproduce(&setting);
    }
    nearer();
}

/// Returns the shortest time of several rounds, ms.
fn best(rounds: usize, mut run: impl FnMut()) -> f64 {
    let once = |_| {
        let begin = Instant::now();
        run();
        begin.elapsed()
    };
    (0..rounds).map(once).min().unwrap_or(Duration::ZERO).as_secs_f64() * 1e3
}

fn reproduce(setting: &Setting) {
    let Setting { name, arm, grid, edge_m, centre } = setting;
    println!("{name}, {} cells, a cube of {} mm at {:?} m\n", grid.cells(), 1e3 * edge_m, centre.to_array());
    println!(
        "| model | ms | moved by 1 cm: ms | a plan: µs | found | path: rad | blocked | missed | needlessly | the paper |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let table = Table::of(setting);
    let exact = setting.blocked(ObstacleModel::Exact);
    let ends = pairs(setting, &exact);
    for (i, model) in MODELS.into_iter().enumerate() {
        let (mut builder, mut layer) = (setting.builder(), Layer::new());
        let here = setting.cube(Vec3::ZERO);
        let transform = best(100, || model.build_layer(&mut builder, &here, &mut layer));
        let mut map = JointMap::new(*arm, grid).unwrap();
        let mut moved = 0;
        let shift = best(100, || {
            moved += 1;
            let mut layer = Layer::new();
            model.build_layer(&mut builder, &setting.cube(Vec3::Y * 0.01 * f64::from(moved % 2)), &mut layer);
            map.set_layer("cube", layer);
        });
        let occupancy = setting.blocked(model);
        let plan = 1e3 * best(3, || drop(lengths(setting, &occupancy, &ends))) / ends.len() as f64;
        let mut random = Xorshift(0x9e37_79b9_7f4a_7c15);
        let counts = SampleCounts { uniform: 200_000, beside: 200_000 };
        let missed = missed_contacts(arm, grid, &occupancy, &here, counts, &mut random);
        let needless = 100.0 * needless_share(arm, grid, &occupancy, &here, 2000, &mut random);
        let Table { blocked, found, length_rad } = &table;
        println!(
            "| {model} | {transform:.4} | {shift:.4} | {plan:.0} | {:.1} % | {:.3} | {} | {missed} | {needless:.1} % | {} |",
            100.0 * found[i],
            length_rad[i],
            blocked[i],
            PAPER[i]
        );
    }
    println!();
}

/// An object that comes near the base may touch both links: more cells, and a longer time (the paper, section VI.B).
fn nearer() {
    let [_, setting, _] = settings();
    println!(
        "The paper's arm, 2°, the cube nearer to the base\n\n| centre, x: m | model | ms | blocked |\n| --- | --- | --- | --- |"
    );
    for x in [0.34, 0.28, 0.22, 0.18] {
        let setting = Setting { centre: Vec3::new(x, 0.0, 0.05), grid: setting.grid.clone(), ..setting };
        for model in [ObstacleModel::Sphere, ObstacleModel::Slices, ObstacleModel::Exact] {
            let (mut builder, mut layer, cube) = (setting.builder(), Layer::new(), setting.cube(Vec3::ZERO));
            let ms = best(100, || model.build_layer(&mut builder, &cube, &mut layer));
            println!("| {x} | {model} | {ms:.4} | {} |", setting.blocked(model).blocked());
        }
    }
}
