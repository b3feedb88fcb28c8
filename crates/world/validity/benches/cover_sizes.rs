//! Sphere covers of a robot's links: number of spheres and time.
//!
//! `cargo bench -p elbowroom-validity --bench cover_sizes -- ROBOT.urdf [SLACK_MM]`

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]

use std::time::Instant;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_spatial::Pose;
use elbowroom_validity::{CoveredLinkId, CoveredRobot, ObstacleSet, SphereCover, ValidityChecker};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = elbowroom_testkit::bench::arguments();
    let path = arguments.next().ok_or("a URDF file is missing")?;
    let slack_m = arguments.next().map_or(Ok(5.0), |s| s.parse::<f64>())? / 1000.0;
    let robot = load(path.as_ref(), &LoadOptions::default())?.robot;
    let all = Instant::now();
    let mut total = 0;
    for link in robot.links_with_colliders() {
        let shapes: Vec<_> = robot.colliders[link.0].iter().map(|c| (&c.shape, c.in_link)).collect();
        let begin = Instant::now();
        let Some(cover) = SphereCover::new(&shapes, slack_m) else { continue };
        total += cover.outer.len();
        println!(
            "{:<28} outer {:>5}, inner {:>3}, {:>7.1} ms",
            robot.chain.links()[link.0],
            cover.outer.len(),
            cover.inner.len(),
            begin.elapsed().as_secs_f64() * 1e3
        );
    }
    println!("{total} outer spheres, {:.0} ms", all.elapsed().as_secs_f64() * 1e3);
    let begin = Instant::now();
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY)?;
    let spheres: usize = (0..covered.covered_links().len()).map(|link| covered.spheres(CoveredLinkId(link))).sum();
    let built = begin.elapsed().as_secs_f64() * 1e3;
    let begin = Instant::now();
    ValidityChecker::new(&covered, &ObstacleSet::default());
    let tables = begin.elapsed().as_secs_f64() * 1e3;
    println!("covered robot: {spheres} spheres, {built:.0} ms; tables of pairs {tables:.0} ms");
    Ok(())
}
