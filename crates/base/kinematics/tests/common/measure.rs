//! One line of the table of inverse kinematics.

use std::time::Instant;

use elbowroom_kinematics::inverse::{IkError, IkMethod, IkOptions, IkSolver};
use elbowroom_kinematics::{Chain, ChainState};
use elbowroom_spatial::Pose;

use super::{RandomGeometry, SplitMix};

pub struct Line {
    pub method: IkMethod,
    pub axes: usize,
    pub success: f64,
    /// Fraction of the solutions that needed the numeric method or another start.
    pub retried: f64,
    pub median_us: f64,
    pub p99_us: f64,
    pub worst_m: f64,
    pub worst_rad: f64,
}

impl Line {
    pub const HEAD: &str = "robot                                     axes method          found % retried % median µs   p99 µs   worst m worst rad";

    pub fn text(&self, name: &str) -> String {
        format!(
            "{name:<42}{:>3} {:<15} {:>7.2} {:>9.2} {:>9.1} {:>8.1} {:>9.1e} {:>9.1e}",
            self.axes,
            format!("{:?}", self.method),
            self.success,
            self.retried,
            self.median_us,
            self.p99_us,
            self.worst_m,
            self.worst_rad
        )
    }
}

/// Measures one chain. Targets are poses of random configurations within the limits; seeds are other random
/// configurations.
pub fn measure(chain: &Chain, targets: usize) -> Line {
    let tip = chain.tip();
    let mut solver = IkSolver::new(chain, tip, Pose::IDENTITY, IkOptions::default());
    let mut state = ChainState::new(chain);
    let mut random = SplitMix(7);
    let mut seed = vec![0.0; chain.dof()];
    let (mut found, mut retried, mut times) = (0, 0, Vec::new());
    let (mut worst_m, mut worst_rad) = (0.0_f64, 0.0_f64);
    for _ in 0..targets {
        random.state(chain, &mut state.q);
        random.state(chain, &mut seed);
        chain.forward(&mut state);
        let target = state.link_in_root(tip);
        let start = Instant::now();
        let answer = solver.solve(&target, &seed);
        times.push(start.elapsed().as_secs_f64() * 1e6);
        let solution = match answer {
            Ok(solution) => solution,
            Err(e @ (IkError::SeedLength | IkError::SeedNotFinite | IkError::TargetNotFinite)) => panic!("{e}"),
            Err(_) => continue,
        };
        found += 1;
        retried += usize::from(solution.restarts > 0);
        // The solution is checked by the chain's own forward kinematics and limits.
        state.q.copy_from_slice(&solution.q);
        chain.forward(&mut state);
        let reached = state.link_in_root(tip);
        worst_m = worst_m.max(reached.translation.distance(target.translation));
        worst_rad = worst_rad.max((reached.rotation.inverse() * target.rotation).angle());
        for (value, id) in solution.q.iter().zip(chain.active_joints()) {
            let joint = &chain.joints()[id.0];
            assert!(joint.limits.contains(*value, 0.0), "{} {value}", joint.name);
        }
    }
    times.sort_by(f64::total_cmp);
    let percent = |n: usize| 100.0 * n as f64 / targets as f64;
    Line {
        method: solver.method(),
        axes: chain.path(tip).iter().filter(|j| chain.q_index(**j).is_some()).count(),
        success: percent(found),
        retried: percent(retried),
        median_us: times[targets / 2],
        p99_us: times[targets * 99 / 100],
        worst_m,
        worst_rad,
    }
}
