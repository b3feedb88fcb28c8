//! Fraction of random configurations that covers leave uncertain, and the pairs of links that cause most of them.
//!
//! `cargo bench -p elbowroom-validity --bench uncertain_share -- [STATES] ROBOT.urdf …` prints a row of a table for each
//! robot, among five obstacles and without obstacles. It uses the SRDF beside the robot, if it exists.

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]

use std::collections::BTreeMap;
use std::path::Path;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::{linear_congruential, unit};
use elbowroom_validity::{CoveredRobot, NotCertain, ObstacleSet, Validity, ValidityChecker};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Per pair of links: number of uncertain configurations in which the pair is near.
type PairCounts = BTreeMap<(usize, usize), usize>;

fn main() -> Result<()> {
    let words: Vec<String> = elbowroom_testkit::bench::arguments().collect();
    let states = words.first().and_then(|word| word.parse().ok());
    println!("| robot | free | hit | not certain | without obstacles | worst pair of links | of all |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    words.iter().skip(usize::from(states.is_some())).try_for_each(|path| row(path.as_ref(), states.unwrap_or(10_000)))
}

fn row(path: &Path, states: usize) -> Result<()> {
    let srdf = Some(path.with_extension("srdf")).filter(|p| p.is_file());
    let robot = load(path, &LoadOptions { srdf, ..LoadOptions::default() })?.robot;
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY)?;
    let q = configurations(&robot, states);
    let obstacles = five_obstacles(reach_m(&robot));
    let (among, _) = ask(&covered, &obstacles, &q)?;
    let (alone, pairs) = ask(&covered, &ObstacleSet::default(), &q)?;
    let share = |n: usize| format!("{:.1} %", 100.0 * n as f64 / states as f64);
    let links: Vec<_> = covered.covered_links().map(|link| robot.chain.links()[link.0].clone()).collect();
    let worst = pairs.iter().max_by_key(|(_, n)| **n);
    let (pair, of_all) =
        worst.map_or_else(Default::default, |((a, b), n)| (format!("{} and {}", links[*a], links[*b]), share(*n)));
    println!(
        "| {} | {} | {} | {} | {} | {pair} | {of_all} |",
        path.file_stem().unwrap_or_default().to_string_lossy(),
        share(among[0]),
        share(among[1]),
        share(among[2]),
        share(alone[2]),
    );
    Ok(())
}

/// Numbers of configurations that are free, hit and uncertain; per pair of links, the number of uncertain ones in which
/// it is near.
fn ask(robot: &CoveredRobot, set: &ObstacleSet, q: &[f64]) -> Result<([usize; 3], PairCounts)> {
    let mut checker = ValidityChecker::new(robot, set);
    let (mut answers, mut near) = (Vec::new(), Vec::new());
    checker.states(q, &mut answers)?;
    let (mut counts, mut pairs) = ([0; 3], PairCounts::new());
    for (q, &answer) in q.chunks(robot.dof()).zip(&answers) {
        counts[answer as usize] += 1;
        if answer == Validity::Uncertain {
            checker.uncertain_pairs(q, q, &mut near)?;
            for pair in &near {
                if let NotCertain::Links(a, b) = pair {
                    *pairs.entry((a.0, b.0)).or_default() += 1;
                }
            }
        }
    }
    Ok((counts, pairs))
}

fn configurations(robot: &Robot, states: usize) -> Vec<f64> {
    let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
    let mut seed = 3;
    let mut value = |i: usize| {
        let (low, high) = if lower[i].is_finite() && upper[i].is_finite() { (lower[i], upper[i]) } else { (-3.1, 3.1) };
        low + (high - low) * unit(linear_congruential(&mut seed))
    };
    (0..states).flat_map(|_| (0..lower.len()).map(&mut value).collect::<Vec<_>>()).collect()
}

/// Sum of the distances between joints, m.
fn reach_m(robot: &Robot) -> f64 {
    robot.chain.joints().iter().map(|joint| joint.origin.translation.length()).sum()
}

/// A table, a post, a shelf, a ball and a pipe, at fractions of the robot's reach.
fn five_obstacles(reach_m: f64) -> ObstacleSet {
    let at = |x: f64, y: f64, z: f64| Pose::from_translation(Vec3::new(x, y, z) * reach_m);
    let mut set = ObstacleSet::default();
    let half = |x: f64, y: f64, z: f64| Vec3::new(x, y, z) * reach_m;
    set.add_shape(&Shape::Cuboid(Cuboid { half_extents: half(0.2, 0.3, 0.02) }), &at(0.6, 0.0, 0.1), 0.0);
    set.add_shape(
        &Shape::Cylinder(Cylinder { half_length: 0.5 * reach_m, radius: 0.04 * reach_m }),
        &at(-0.4, 0.5, 0.5),
        0.0,
    );
    set.add_shape(&Shape::Cuboid(Cuboid { half_extents: half(0.02, 0.3, 0.2) }), &at(0.3, -0.6, 0.5), 0.0);
    set.add_shape(&Shape::Sphere(Sphere { radius: 0.1 * reach_m }), &at(-0.6, -0.3, 0.4), 0.0);
    set.add_shape(
        &Shape::Capsule(Capsule { half_length: 0.3 * reach_m, radius: 0.03 * reach_m }),
        &at(0.1, 0.6, 0.3),
        0.0,
    );
    set
}
