//! Duration of a tick: `cargo bench -p elbowroom-monitor --bench tick_time -- [PART]`.
//!
//! A six-axis arm with eight volumes moves among regions; each line is one set of regions. With PART, only the sets with
//! PART in their names.

#![allow(clippy::print_stdout, reason = "a bench prints")]

mod workload;

use elbowroom_monitor::{Laws, Region, RegionId, Snapshot, StoppingSettings};
use elbowroom_testkit::bench::{arguments, quantile};
use workload::{SLOW_S, TICK_S, joints, monitor, regions, tick_times};

const TICKS: u32 = 50_000;

/// The regions that the arm never touches while it moves.
fn untouched(regions: Vec<Region>, count: usize) -> Vec<Region> {
    let mut m = monitor(regions.clone(), Laws::default());
    let mut touched = vec![false; regions.len()];
    for i in 0..TICKS / 50 {
        let t = 0.1 * f64::from(i);
        m.tick(&Snapshot::stationary(t, &joints(t)));
        let mut inside = |r: usize| touched[r] |= m.is_inside(RegionId(r));
        (0..regions.len()).for_each(&mut inside);
    }
    let free = regions.into_iter().zip(touched).filter(|(_, touched)| !touched).map(|(r, _)| r);
    free.take(count).collect()
}

/// Prints one row if its name contains the command's argument. The arm moves by `step_s` of its motion in each tick.
fn measure(name: &str, regions: Vec<Region>, laws: Laws, step_s: f64) {
    if arguments().next().is_some_and(|part| !name.contains(&part)) {
        return;
    }
    // The stopping-distance law would report that the robot does not brake.
    let is_stationary = laws.stopping_distance.is_some();
    let (mut times, pairs) = tick_times(&mut monitor(regions, laws), TICKS, step_s, is_stationary);
    let mut at = |fraction: f64| quantile(&mut times, fraction);
    println!("{name:46} {:8.2} {:8.2} {:8.2} {:8.2} {pairs:9.1}", at(0.5), at(0.99), at(0.999), at(1.0));
}

fn main() {
    println!("{:46} {:>8} {:>8} {:>8} {:>8} {:>9}", "regions (µs per tick)", "median", "p99", "p99.9", "max", "pairs");
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: 0.002,
        joint_deceleration: vec![30.0; 6],
        // The motion below needs at most 1.2 rad/s².
        joint_acceleration: vec![2.0; 6],
    };
    let all = Laws { direction_aware: true, stopping_distance: Some(stopping), ..Laws::default() };
    // A fifth of the speed of the motion, and all of it.
    let (slow, fast) = (SLOW_S, TICK_S);
    measure("none", vec![], Laws::default(), slow);
    let free = untouched(regions(4000, |r| r.between(0.3, 1.8), 1.0), 1000);
    measure("100 around the arm, never touched", free[..100].to_vec(), Laws::default(), slow);
    measure("1,000 around the arm, never touched", free.clone(), Laws::default(), slow);
    measure("1,000 around the arm, never touched, all laws", free, all.clone(), slow);
    let touched = regions(1000, |r| r.between(0.3, 1.6), 1.0);
    measure("1,000 around the arm, often touched", touched.clone(), Laws::default(), slow);
    measure("1,000 around the arm, often touched, all laws", touched.clone(), all.clone(), slow);
    measure("1,000 often touched, fast", touched.clone(), Laws::default(), fast);
    measure("1,000 often touched, fast, direction-aware", touched, Laws { stopping_distance: None, ..all }, fast);
    measure("10,000 far (3 to 30 m)", regions(10_000, |r| r.between(3.0, 30.0), 1.0), Laws::default(), slow);
}
