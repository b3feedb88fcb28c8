//! Growth of validity checks with the number of obstacles, and of sphere covers with their accuracy.
//!
//! `cargo bench -p elbowroom-validity --bench growth`: an RX60B (23,012 triangles) among spheres and boxes of 6 to 30 cm, ten
//! in a cube of 2 m; the hall grows with their number.

use std::error::Error;
use std::hint::black_box;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{Cuboid, Shape, Sphere};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::bench::{GrowthTable, Stopwatch, hall_places, least_s};
use elbowroom_testkit::folder::model;
use elbowroom_testkit::random::Random;
use elbowroom_validity::{CoveredRobot, ObstacleSet, SphereCover, Validity, ValidityChecker};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

/// Both ends.
type Edge = (Vec<f64>, Vec<f64>);

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Number of free states, and of free edges of one radian.
const QUESTIONS: usize = 500;

fn main() -> Result<()> {
    let urdf = model("rx60b");
    let options = LoadOptions { srdf: Some(urdf.with_extension("srdf")), ..LoadOptions::default() };
    let robot = load(&urdf, &options)?.robot;
    obstacles(&robot)?;
    covers(&robot);
    Ok(())
}

fn obstacles(robot: &Robot) -> Result<()> {
    let columns = ["obstacles", "set-up ms", "state ns", "edge of 1 rad ns", "B/obstacle", "allocations of all checks"];
    let table = GrowthTable::start("obstacles of validity checks", &columns);
    let covered = CoveredRobot::new(robot, Pose::IDENTITY)?;
    // The first checker makes the tables of the robot's own pairs.
    ValidityChecker::new(&covered, &ObstacleSet::default());
    for count in [10, 30, 100, 300, 1_000, 3_000, 10_000, 30_000, 100_000] {
        let (watch, counter) = (Stopwatch::start(), AllocationCounter::start());
        let obstacles = hall(count);
        let mut checker = ValidityChecker::new(&covered, &obstacles);
        let (set_up_ms, bytes) = (watch.seconds() * 1e3, counter.held_bytes() as f64);
        let (states, edges) = questions(robot, &mut checker)?;
        let state_s = least_s(9, || check_states(&mut checker, &states));
        let edge_s = least_s(9, || check_edges(&mut checker, &edges));
        let counter = AllocationCounter::start();
        check_states(&mut checker, &states);
        check_edges(&mut checker, &edges);
        let allocations = counter.allocations();
        let each_ns = |all_s: f64| all_s * 1e9 / QUESTIONS as f64;
        let times = [set_up_ms, each_ns(state_s), each_ns(edge_s)];
        table.row(&[&[count as f64][..], &times, &[bytes / count as f64, allocations as f64]].concat());
    }
    Ok(())
}

fn check_states(checker: &mut ValidityChecker<'_>, states: &[Vec<f64>]) {
    for q in states {
        _ = black_box(checker.state(q));
    }
}

fn check_edges(checker: &mut ValidityChecker<'_>, edges: &[Edge]) {
    for (from, to) in edges {
        _ = black_box(checker.edge_is_free(from, to));
    }
}

fn hall(count: usize) -> ObstacleSet {
    let mut random = Random(7);
    let mut obstacles = ObstacleSet::default();
    for (i, at) in hall_places(count).into_iter().enumerate() {
        let size = random.between(0.03, 0.15);
        let cuboid = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(size) });
        let shape = if i % 2 == 0 { Shape::Sphere(Sphere { radius: size }) } else { cuboid };
        obstacles.add_shape(&shape, &Pose::from_translation(at.into()), 0.0);
    }
    obstacles
}

/// Random states that are proven free, and edges of one radian.
fn questions(robot: &Robot, checker: &mut ValidityChecker<'_>) -> Result<(Vec<Vec<f64>>, Vec<Edge>)> {
    let mut random = Random(5);
    let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
    let mut q = || -> Vec<f64> { lower.iter().zip(&upper).map(|(&l, &u)| random.between(l, u)).collect() };
    let (mut states, mut edges) = (Vec::new(), Vec::new());
    while states.len() < QUESTIONS || edges.len() < QUESTIONS {
        let (a, b) = (q(), q());
        let length = a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
        let to: Vec<f64> = a.iter().zip(&b).map(|(x, y)| x + (y - x) / length).collect();
        if edges.len() < QUESTIONS && checker.edge_is_free(&a, &to)? {
            edges.push((a.clone(), to));
        }
        if states.len() < QUESTIONS && checker.state(&a)? == Validity::Free {
            states.push(a);
        }
    }
    Ok((states, edges))
}

/// Covers of all links, ever closer to the meshes.
fn covers(robot: &Robot) {
    let table = GrowthTable::start("spheres of a cover", &["spheres", "protrusion mm", "cover ms", "B/sphere"]);
    for protrusion_mm in [20.0, 10.0, 5.0, 2.0, 1.0] {
        let (watch, counter) = (Stopwatch::start(), AllocationCounter::start());
        let covers: Vec<SphereCover> = robot
            .links_with_colliders()
            .filter_map(|link| {
                let shapes: Vec<_> = robot.colliders[link.0].iter().map(|c| (&c.shape, c.in_link)).collect();
                SphereCover::new(&shapes, protrusion_mm / 1e3)
            })
            .collect();
        let (ms, bytes) = (watch.seconds() * 1e3, counter.held_bytes() as f64);
        let spheres = covers.iter().map(|c| c.outer.len() + c.inner.len()).sum::<usize>() as f64;
        table.row(&[spheres, protrusion_mm, ms, bytes / spheres]);
    }
}
