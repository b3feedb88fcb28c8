//! Fills the joint map of one obstacle, beside two straightforward ways to do it, in one run:
//! `cargo run --release -p elbowroom-cspace --example joint_map`.
//!
//! - `pruned`: the middle of every cell against the exact obstacle, planes and rows out of reach skipped;
//! - `spheres`: the links as 19 overlapping spheres, the middle of every cell, nothing skipped.
//!
//! Both mark a cell by its middle; `elbowroom` marks it if any configuration in it can touch. Times are those of the
//! processor for this thread, the best of several runs.

#![allow(clippy::print_stdout, reason = "an example prints")]

#[path = "../clock/mod.rs"]
mod clock;
mod straightforward;

use std::hint::black_box;
use std::time::Duration;

use clock::best;
use elbowroom_cspace::{Axis, Changes, Filler, Grid, JointMap, Layer, Obstacle, PlanarArm, Table};
use elbowroom_spatial::{Pose, Vec3};
use straightforward::{Planar, Solid};

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

fn main() {
    for step_deg in [2.0, 1.0] {
        for (name, solid, [obstacle, moved]) in workload() {
            let grid = grid(step_deg);
            let planar = Planar::new(&ARM, &grid);
            let mut cells = vec![0u8; grid.cells()];
            let pruned = best(3, || planar.pruned(&solid, &mut cells));
            let pruned_blocked = count(&cells);
            let spheres = best(3, || planar.spheres(&solid, &mut cells));
            let spheres_blocked = count(&cells);
            let (fill, whole, blocked) = ours(&grid, &obstacle);
            let (entered, anew, moved) = updates(&grid, &obstacle, &moved);
            println!("{name}, {step_deg} degrees, {} cells", grid.cells());
            line("pruned, by middles", pruned, pruned_blocked);
            line("19 spheres, by middles", spheres, spheres_blocked);
            line("elbowroom, row intervals", fill, blocked);
            line("elbowroom, whole table", whole, blocked);
            line("elbowroom, enters an empty map", entered, blocked);
            line("elbowroom, all anew, changes told", anew, blocked);
            line("elbowroom, moves by 1 cm", moved, blocked);
            let ratio = |other: Duration| other.as_secs_f64() / whole.as_secs_f64();
            println!("  ratio: {:.1} to pruned, {:.1} to spheres", ratio(pruned), ratio(spheres));
            let share = |whole: Duration| moved.as_secs_f64() / whole.as_secs_f64() * 100.0;
            println!("  a move: {:.0} % of all anew, {:.0} % of entering\n", share(anew), share(entered));
        }
    }
}

/// Name, the solid for the straightforward ways, the obstacle and the same a centimetre on.
fn workload() -> [(&'static str, Solid, [Obstacle; 2]); 2] {
    let at = Vec3::new(1.3, 0.4, 0.9);
    let ball = |at| Obstacle::sphere(at, 0.25).expect("finite");
    let half = Vec3::new(0.25, 0.2, 0.3);
    let yaw = 30f64.to_radians();
    let crate_at = |x: f64| Obstacle::cuboid(Pose::from_xyz_rpy([x, 0.4, 0.9], [0.0, 0.0, yaw]), half).expect("finite");
    [
        ("sphere", Solid::ball(at, 0.25), [ball(at), ball(at + Vec3::X * 0.01)]),
        ("box", Solid::cuboid(at, yaw, half), [crate_at(1.3), crate_at(1.31)]),
    ]
}

fn grid(step_deg: f64) -> Grid {
    let axis = |name: &str, lo, hi| Axis::from_degrees(name, lo, hi, step_deg).expect("a fine axis");
    let axes = [axis("base", -170.0, 170.0), axis("shoulder", -90.0, 90.0), axis("elbow", -120.0, 150.0)];
    Grid::new(axes).expect("it fits")
}

/// Row intervals alone; with clearing and writing the table; blocked cells.
fn ours(grid: &Grid, obstacle: &Obstacle) -> (Duration, Duration, usize) {
    let mut filler = Filler::new(ARM, grid).expect("a sound arm");
    let (mut layer, mut table) = (Layer::new(), Table::new(grid.shape()));
    let fill = best(200, || filler.fill(obstacle, &mut layer));
    let whole = best(200, || {
        filler.fill(obstacle, &mut layer);
        table.clear();
        table.add(&layer);
    });
    (fill, whole, table.blocked())
}

/// With the changed cells told: an obstacle enters a map, the whole table made anew, an obstacle of a map moves.
fn updates(grid: &Grid, obstacle: &Obstacle, moved: &Obstacle) -> (Duration, Duration, Duration) {
    let mut map = JointMap::new(ARM, grid).expect("a sound arm");
    let mut entered = Duration::MAX;
    for _ in 0..100 {
        entered = entered.min(best(1, || _ = black_box(map.set("it", obstacle))));
        map.remove("it");
    }
    map.set("it", obstacle);
    let both = best(100, || {
        black_box(map.set("it", moved));
        black_box(map.set("it", obstacle));
    });
    (entered, anew(grid, obstacle, moved), both / 2)
}

/// What a map without layers would do when an obstacle moves.
fn anew(grid: &Grid, obstacle: &Obstacle, moved: &Obstacle) -> Duration {
    let mut filler = Filler::new(ARM, grid).expect("a sound arm");
    let (mut layer, mut old, mut new) = (Layer::new(), Table::new(grid.shape()), Table::new(grid.shape()));
    filler.fill(obstacle, &mut layer);
    old.add(&layer);
    best(100, || {
        filler.fill(moved, &mut layer);
        new.clear();
        new.add(&layer);
        black_box(Changes::between(&old, &new));
    })
}

fn line(what: &str, time: Duration, blocked: usize) {
    println!("  {what:32} {:10.4} ms {blocked:8} blocked", time.as_secs_f64() * 1e3);
}

fn count(cells: &[u8]) -> usize {
    cells.iter().map(|&c| usize::from(c)).sum()
}
