//! Builds the joint map of one obstacle, and by two straightforward methods for comparison, in one run:
//! `cargo bench -p elbowroom-cspace --bench joint_map`.
//!
//! - `pruned`: tests the centre of every cell against the exact obstacle; skips planes and rows out of reach;
//! - `spheres`: the links are 19 overlapping spheres; tests the centre of every cell and skips none.
//!
//! The two methods mark a cell by its centre; `elbowroom` marks a cell if any configuration in it is in collision.
//! Times are processor times of this thread, the best of several runs.

#![allow(clippy::print_stdout, reason = "a bench prints")]

#[path = "../clock/mod.rs"]
mod clock;
mod straightforward;

use std::hint::black_box;
use std::time::Duration;

use clock::best;
use elbowroom_cspace::{
    CellChanges, ConvexObstacle, Grid, GridAxis, JointMap, Layer, OccupancyBitmap, PlanarArm, PlanarMapBuilder,
};
use elbowroom_spatial::{Pose, Vec3};
use straightforward::{Planar, RoundedBox};

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
            let (fill, whole, blocked) = building(&grid, &obstacle);
            let (added, rebuilt, moved) = updates(&grid, &obstacle, &moved);
            println!("{name}, {step_deg} degrees, {} cells", grid.cells());
            line("pruned, by centres", pruned, pruned_blocked);
            line("19 spheres, by centres", spheres, spheres_blocked);
            line("elbowroom, row intervals", fill, blocked);
            line("elbowroom, whole bitmap", whole, blocked);
            line("elbowroom, added to empty map", added, blocked);
            line("elbowroom, rebuilt, with changes", rebuilt, blocked);
            line("elbowroom, moved by 1 cm", moved, blocked);
            let ratio = |other: Duration| other.as_secs_f64() / whole.as_secs_f64();
            println!("  ratio: {:.1} to pruned, {:.1} to spheres", ratio(pruned), ratio(spheres));
            let share = |whole: Duration| moved.as_secs_f64() / whole.as_secs_f64() * 100.0;
            println!("  a move: {:.0} % of rebuilding, {:.0} % of adding\n", share(rebuilt), share(added));
        }
    }
}

/// Name, the solid for the straightforward methods, the obstacle, and the obstacle moved by a centimetre.
fn workload() -> [(&'static str, RoundedBox, [ConvexObstacle; 2]); 2] {
    let at = Vec3::new(1.3, 0.4, 0.9);
    let ball = |at| ConvexObstacle::sphere(at, 0.25).expect("finite");
    let half = Vec3::new(0.25, 0.2, 0.3);
    let yaw = 30f64.to_radians();
    let crate_at =
        |x: f64| ConvexObstacle::cuboid(Pose::from_xyz_rpy([x, 0.4, 0.9], [0.0, 0.0, yaw]), half).expect("finite");
    [
        ("sphere", RoundedBox::ball(at, 0.25), [ball(at), ball(at + Vec3::X * 0.01)]),
        ("box", RoundedBox::cuboid(at, yaw, half), [crate_at(1.3), crate_at(1.31)]),
    ]
}

fn grid(step_deg: f64) -> Grid {
    let axis = |name: &str, lo, hi| GridAxis::from_degrees(name, lo, hi, step_deg).expect("a fine axis");
    let axes = [axis("base", -170.0, 170.0), axis("shoulder", -90.0, 90.0), axis("elbow", -120.0, 150.0)];
    Grid::new(axes).expect("it fits")
}

/// Times of computing the row intervals alone, and with clearing and writing the bitmap; and the number of blocked
/// cells.
fn building(grid: &Grid, obstacle: &ConvexObstacle) -> (Duration, Duration, usize) {
    let mut builder = PlanarMapBuilder::new(ARM, grid).expect("a sound arm");
    let (mut layer, mut occupancy) = (Layer::new(), OccupancyBitmap::new(grid.shape()));
    let fill = best(200, || builder.build_layer(obstacle, &mut layer));
    let whole = best(200, || {
        builder.build_layer(obstacle, &mut layer);
        occupancy.clear();
        occupancy.add(&layer);
    });
    (fill, whole, occupancy.blocked())
}

/// Times with changed cells: adding an obstacle, rebuilding the whole map, moving an obstacle.
fn updates(grid: &Grid, obstacle: &ConvexObstacle, moved: &ConvexObstacle) -> (Duration, Duration, Duration) {
    let mut map = JointMap::new(ARM, grid).expect("a sound arm");
    let mut added = Duration::MAX;
    for _ in 0..100 {
        added = added.min(best(1, || _ = black_box(map.set_obstacle("it", obstacle))));
        map.remove_obstacle("it");
    }
    map.set_obstacle("it", obstacle);
    let both = best(100, || {
        black_box(map.set_obstacle("it", moved));
        black_box(map.set_obstacle("it", obstacle));
    });
    (added, rebuilding(grid, obstacle, moved), both / 2)
}

/// The cost of a moved obstacle without layers.
fn rebuilding(grid: &Grid, obstacle: &ConvexObstacle, moved: &ConvexObstacle) -> Duration {
    let mut builder = PlanarMapBuilder::new(ARM, grid).expect("a sound arm");
    let (mut layer, mut old, mut new) =
        (Layer::new(), OccupancyBitmap::new(grid.shape()), OccupancyBitmap::new(grid.shape()));
    builder.build_layer(obstacle, &mut layer);
    old.add(&layer);
    best(100, || {
        builder.build_layer(moved, &mut layer);
        new.clear();
        new.add(&layer);
        black_box(CellChanges::between(&old, &new));
    })
}

fn line(what: &str, time: Duration, blocked: usize) {
    println!("  {what:32} {:10.4} ms {blocked:8} blocked", time.as_secs_f64() * 1e3);
}

fn count(cells: &[u8]) -> usize {
    cells.iter().map(|&c| usize::from(c)).sum()
}
