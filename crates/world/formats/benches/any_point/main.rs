//! Inverse kinematics of random points on the surfaces of real robots: `cargo bench -p elbowroom-formats --bench
//! any_point -- [POINTS] [PINOCCHIO]`.
//!
//! Each robot gets POINTS points (default 100,000), equally many on every moving link, sampled by area on its collision
//! geometry. A target is the position of the point (and its normal) at a random state within the limits; the search
//! starts from another random state. Forward kinematics checks the solutions.
//!
//! The first PINOCCHIO problems (default 0) of each link are also solved by damped least squares with Pinocchio:
//! `pin_dls.py`, with the Python of `ELBOWROOM_PYTHON` (which needs `pin` and `numpy`). The data are those of the tests,
//! `ELBOWROOM_DATA`.
#![allow(clippy::print_stdout)]

mod pinocchio;
#[allow(dead_code)]
mod problem;
mod surface;

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_kinematics::LinkId;

use problem::{IkProblem, SolverResults, measure};
use surface::{SplitMix, Surface};

const ROBOTS: [&str; 4] = ["kuka_kr150_2", "staubli_tx60", "ur5e", "abb_irb2400"];

/// Header line of the table.
const HEAD: &str = "robot          link                 task             n  reached %  restarted %  median µs  p99 µs  mean µs  worst m  worst rad  beyond limits";

fn main() {
    let mut arguments = elbowroom_testkit::bench::arguments();
    let mut number = || arguments.next().and_then(|n| n.parse::<usize>().ok());
    let (points, beside) = (number().unwrap_or(100_000), number().unwrap_or(0));
    let Some(data) = elbowroom_testkit::folder::data() else { return };
    println!("{HEAD}");
    for name in ROBOTS {
        let path = data.join(format!("urdf/{name}/{name}.urdf"));
        let loaded = match robot::load(&path, &LoadOptions::default()) {
            Ok(loaded) => loaded.robot,
            Err(e) => {
                println!("{e}");
                continue;
            }
        };
        let chain = &loaded.chain;
        let moved = |l: &LinkId| chain.path(*l).iter().any(|j| chain.joints()[j.0].kind.moves());
        let links: Vec<LinkId> = (0..chain.links().len()).map(LinkId).filter(moved).collect();
        let links: Vec<LinkId> = links.into_iter().filter(|l| !loaded.colliders[l.0].is_empty()).collect();
        let mut random = SplitMix(2026);
        for with_normal in [false, true] {
            let mut whole = SolverResults::default();
            for &link in &links {
                let surface = Surface::of(&loaded.colliders[link.0]);
                let problems: Vec<IkProblem> = (0..points.div_ceil(links.len()))
                    .filter_map(|_| IkProblem::draw(chain, link, &surface, with_normal, &mut random))
                    .collect();
                let line = measure(chain, &problems);
                println!("{}", line.text(name, &chain.links()[link.0], with_normal));
                let few = &problems[..beside.min(problems.len())];
                if !few.is_empty() {
                    println!("{}", measure(chain, few).text("  the first of them", "", with_normal));
                    pinocchio::run(&path, chain, few);
                }
                whole.add(line);
            }
            println!("{}", whole.text(name, "all", with_normal));
        }
    }
}
