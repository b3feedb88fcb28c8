//! Time per configuration: on proven edges, and one at a time.
//!
//! `cargo run --release -p elbowroom-validity --example state_times -- ROBOT.urdf ROBOT.srdf [OBSTACLES]`

use std::time::Instant;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{Cuboid, Shape, Sphere};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::{linear_congruential, unit};
use elbowroom_validity::{CoveredRobot, ObstacleSet, Validity, ValidityChecker};

/// States per radian of an edge, as planners sample them.
const STATES_PER_RADIAN: f64 = 32.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("a URDF file is missing")?;
    let srdf = arguments.next().map(Into::into);
    let robot = load(path.as_ref(), &LoadOptions { srdf, ..LoadOptions::default() })?.robot;
    let counts: Vec<usize> = arguments.next().map_or(Ok(vec![10, 100, 1000]), |n| n.parse().map(|n| vec![n]))?;
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY)?;
    for count in counts {
        let mut seed = 7;
        let mut random = |low: f64, high: f64| low + (high - low) * unit(linear_congruential(&mut seed));
        let mut obstacles = ObstacleSet::default();
        for i in 0..count {
            let size = if count > 100 { 0.02 } else { 0.05 };
            let (angle, radius, height) = (random(-3.1, 3.1), random(0.45, 1.0), random(0.0, 1.1));
            let at = Vec3::new(radius * f64::cos(angle), radius * f64::sin(angle), height);
            let shape = if i % 2 == 0 {
                Shape::Sphere(Sphere { radius: size })
            } else {
                Shape::Cuboid(Cuboid { half_extents: Vec3::splat(size) })
            };
            obstacles.add_shape(&shape, &Pose::from_translation(at), 0.0);
        }
        let mut checker = ValidityChecker::new(&covered, &obstacles);
        let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
        let mut q = || -> Vec<f64> { lower.iter().zip(&upper).map(|(&l, &u)| random(l, u)).collect() };
        let mut edges = Vec::new();
        let mut states = Vec::new();
        let mut tried = 0;
        while edges.len() < 2000 && tried < 400_000 {
            tried += 1;
            let (a, b) = (q(), q());
            let length = a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
            let to: Vec<f64> = a.iter().zip(&b).map(|(x, y)| x + (y - x) / length).collect();
            if checker.edge_is_free(&a, &to)? {
                edges.push((a.clone(), to));
            }
            if checker.state(&a)? == Validity::Free && states.len() < 2000 {
                states.push(a);
            }
        }
        let blocks = checker.blocks();
        let mut per_edge = f64::INFINITY;
        let mut per_state = f64::INFINITY;
        for _ in 0..60 {
            let begin = Instant::now();
            let mut free = 0;
            for (a, b) in &edges {
                free += usize::from(checker.edge_is_free(a, b)?);
            }
            per_edge = per_edge.min(begin.elapsed().as_secs_f64() / free as f64);
            let begin = Instant::now();
            for a in &states {
                std::hint::black_box(checker.state(a)?);
            }
            per_state = per_state.min(begin.elapsed().as_secs_f64() / states.len() as f64);
        }
        let per_round = (checker.blocks() - blocks - 60 * states.len() as u64) as f64 / 60.0 / edges.len() as f64;
        println!(
            "{count:>5} obstacles: {:.1} ns per state on an edge ({per_round:.2} blocks per edge, {} edges of {tried}), {:.0} ns alone",
            per_edge / STATES_PER_RADIAN * 1e9,
            edges.len(),
            per_state * 1e9
        );
    }
    Ok(())
}
