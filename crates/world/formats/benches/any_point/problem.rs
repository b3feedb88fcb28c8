//! Inverse kinematics problems, and counts of the solved ones.

use std::time::Instant;

use elbowroom_kinematics::surface_ik::{OrientedPoint, PointChain, SurfaceIkOptions};
use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::Vec3;

use crate::surface::{SplitMix, Surface};

/// Tolerance of a solution, m and rad.
const TOLERANCE: f64 = 1e-6;

/// A point of a link, its target and the start of the search.
pub struct IkProblem {
    pub link: LinkId,
    pub point_in_link: Vec3,
    pub normal_in_link: Vec3,
    pub start: Vec<f64>,
    pub target: OrientedPoint,
}

impl IkProblem {
    pub fn draw(
        chain: &Chain,
        link: LinkId,
        surface: &Surface,
        with_normal: bool,
        random: &mut SplitMix,
    ) -> Option<Self> {
        let (point_in_link, normal_in_link) = surface.draw(random)?;
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(&random_state(chain, random));
        chain.forward(&mut state);
        let link_in_root = state.link_in_root(link);
        let target = OrientedPoint {
            point_in_root: link_in_root.transform_point(point_in_link),
            normal_in_root: with_normal.then(|| link_in_root.transform_vector(normal_in_link)),
        };
        Some(Self { link, point_in_link, normal_in_link, start: random_state(chain, random), target })
    }
}

fn random_state(chain: &Chain, random: &mut SplitMix) -> Vec<f64> {
    chain.lower().iter().zip(chain.upper()).map(|(l, u)| random.between(l.max(-10.0), u.min(10.0))).collect()
}

/// Results of one solver.
#[derive(Default)]
pub struct SolverResults {
    asked: usize,
    reached: usize,
    restarted: usize,
    times_us: Vec<f64>,
    worst_m: f64,
    worst_rad: f64,
    outside: f64,
}

impl SolverResults {
    pub fn text(&self, robot: &str, link: &str, with_normal: bool) -> String {
        let mut times = self.times_us.clone();
        times.sort_by(f64::total_cmp);
        let at = |part: usize| times.get(times.len() * part / 1000).or(times.last()).copied().unwrap_or(f64::NAN);
        let mean = times.iter().sum::<f64>() / times.len().max(1) as f64;
        let percent = |n: usize| 100.0 * n as f64 / self.asked.max(1) as f64;
        format!(
            "{robot:<14} {link:<20} {:<9} {:>8} {:>10.3} {:>12.2} {:>10.2} {:>7.1} {:>8.2} {:>8.1e} {:>10.1e} {:>14.1e}",
            if with_normal { "+ normal" } else { "position" },
            self.asked,
            percent(self.reached),
            percent(self.restarted),
            at(500),
            at(990),
            mean,
            self.worst_m,
            self.worst_rad,
            self.outside,
        )
    }

    pub fn asked(&self) -> usize {
        self.asked
    }

    pub fn reached(&self) -> usize {
        self.reached
    }

    /// Largest excess over a joint limit in any solution and any nearest state, rad or m; negative within the limits.
    pub fn outside(&self) -> f64 {
        self.outside
    }

    pub fn add(&mut self, other: Self) {
        self.asked += other.asked;
        self.reached += other.reached;
        self.restarted += other.restarted;
        self.times_us.extend(other.times_us);
        self.worst_m = self.worst_m.max(other.worst_m);
        self.worst_rad = self.worst_rad.max(other.worst_rad);
        self.outside = self.outside.max(other.outside);
    }
}

pub fn measure(chain: &Chain, problems: &[IkProblem]) -> SolverResults {
    let mut line = SolverResults::default();
    let mut state = ChainState::new(chain);
    let mut q = vec![0.0; chain.dof()];
    let (lower, upper) = (chain.lower(), chain.upper());
    let Some(first) = problems.first() else { return line };
    let normal = Some(first.normal_in_link);
    let Ok(mut end) = PointChain::new(chain, first.link, first.point_in_link, normal, SurfaceIkOptions::default())
    else {
        return line;
    };
    for problem in problems {
        q.copy_from_slice(&problem.start);
        let clock = Instant::now();
        let answer = end
            .set_point(problem.point_in_link, Some(problem.normal_in_link))
            .and_then(|()| end.solve(&problem.target, &mut q));
        line.times_us.push(clock.elapsed().as_secs_f64() * 1e6);
        line.asked += 1;
        for ((v, l), u) in q.iter().zip(&lower).zip(&upper) {
            line.outside = line.outside.max(l - v).max(v - u);
        }
        let Ok(reached) = answer else { continue };
        state.q.copy_from_slice(&q);
        chain.forward(&mut state);
        let link_in_root = state.link_in_root(problem.link);
        let distance = link_in_root.transform_point(problem.point_in_link).distance(problem.target.point_in_root);
        let angle = problem.target.normal_in_root.map_or(0.0, |wanted| {
            let normal = link_in_root.transform_vector(problem.normal_in_link);
            normal.cross(wanted).length().atan2(normal.dot(wanted))
        });
        line.worst_m = line.worst_m.max(distance);
        line.worst_rad = line.worst_rad.max(angle);
        line.reached += usize::from(distance <= TOLERANCE && angle <= TOLERANCE);
        line.restarted += usize::from(reached.restarts > 0);
    }
    line
}
