//! Inverse kinematics on every real robot: a table, and what it must show.
#![allow(clippy::print_stdout)]

mod common;

use std::time::Instant;

use common::{Random, robots};
use elbowroom_kinematics::inverse::{Method, Options, Solver};
use elbowroom_kinematics::{Chain, ChainState};
use elbowroom_spatial::Pose;

struct Line {
    method: Method,
    joints: usize,
    success: f64,
    median_us: f64,
    worst_m: f64,
    worst_rad: f64,
}

fn measure(chain: &Chain, targets: usize) -> Line {
    let tip = chain.tip();
    let mut solver = Solver::new(chain, tip, Pose::IDENTITY, Options::default());
    let mut state = ChainState::new(chain);
    let mut random = Random(7);
    let mut seed = vec![0.0; chain.dof()];
    let (mut found, mut times, mut worst_m, mut worst_rad) = (0, Vec::new(), 0.0_f64, 0.0_f64);
    for _ in 0..targets {
        random.state(chain, &mut state.q);
        random.state(chain, &mut seed);
        chain.forward(&mut state);
        let target = state.link_in_root(tip);
        let start = Instant::now();
        let answer = solver.solve(&target, &seed);
        times.push(start.elapsed().as_secs_f64() * 1e6);
        let Ok(solution) = answer else { continue };
        found += 1;
        // Judged by the chain's own forward kinematics and limits, not by what the solver says.
        state.q.copy_from_slice(&solution.q);
        chain.forward(&mut state);
        let reached = state.link_in_root(tip);
        let turn = (reached.rotation.inverse() * target.rotation).angle();
        worst_m = worst_m.max(reached.translation.distance(target.translation));
        worst_rad = worst_rad.max(turn);
        for (value, id) in solution.q.iter().zip(chain.active_joints()) {
            assert!(chain.joints()[id.0].limits.contains(*value, 0.0), "{} {value}", chain.joints()[id.0].name);
        }
    }
    times.sort_by(f64::total_cmp);
    let joints = chain.path(tip).iter().filter(|j| chain.q_index(**j).is_some()).count();
    Line {
        method: solver.method(),
        joints,
        success: 100.0 * f64::from(found) / targets as f64,
        median_us: times[targets / 2],
        worst_m,
        worst_rad,
    }
}

#[test]
fn every_robot_reaches_what_it_can_reach() {
    println!(
        "{:<42} {:>4} {:<15} {:>8} {:>10} {:>9} {:>9}",
        "robot", "axes", "method", "found %", "median µs", "m", "rad"
    );
    for (name, path) in robots() {
        let chain = common::load(&path);
        let targets = if cfg!(debug_assertions) { 300 } else { 2000 };
        let line = measure(&chain, targets);
        println!(
            "{name:<42} {:>4} {:<15} {:>8.2} {:>10.1} {:>9.1e} {:>9.1e}",
            line.joints,
            format!("{:?}", line.method),
            line.success,
            line.median_us,
            line.worst_m,
            line.worst_rad
        );
        assert!(line.worst_m <= 1e-9 && line.worst_rad <= 2e-9, "{name}");
        let wanted = if line.method == Method::SphericalWrist { 100.0 } else { 99.0 };
        if line.joints >= 6 {
            assert!(line.success >= wanted, "{name}: {}", line.success);
        }
    }
}
