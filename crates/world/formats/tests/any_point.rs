//! Inverse kinematics of random points on the surfaces of real robots.
//!
//! Few points by default, 10⁵ per robot with `ELBOWROOM_LONG=1`. The bench with the same name prints the table.
#![allow(clippy::print_stdout)]

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_kinematics::LinkId;

use crate::problem::{IkProblem, SolverResults, measure};
use crate::surface::{SplitMix, Surface};

#[test]
fn reachable_surface_points_are_reached() {
    let Some(data) = elbowroom_testkit::folder::data() else { return };
    let points_per_link = elbowroom_testkit::extent::amount(200, 16_667);
    for name in ["kuka_kr150_2", "staubli_tx60", "ur5e", "abb_irb2400"] {
        let path = data.join(format!("urdf/{name}/{name}.urdf"));
        let robot = robot::load(&path, &LoadOptions::default()).unwrap().robot;
        let mut random = SplitMix(7);
        for with_normal in [false, true] {
            let mut whole = SolverResults::default();
            for link in (0..robot.chain.links().len()).map(LinkId) {
                let moves = robot.chain.path(link).iter().any(|j| robot.chain.joints()[j.0].kind.moves());
                if !moves || robot.colliders[link.0].is_empty() {
                    continue;
                }
                let surface = Surface::of(&robot.colliders[link.0]);
                let draw = |_| IkProblem::draw(&robot.chain, link, &surface, with_normal, &mut random);
                let problems: Vec<IkProblem> = (0..points_per_link).filter_map(draw).collect();
                whole.add(measure(&robot.chain, &problems));
            }
            println!("{}", whole.text(name, "all", with_normal));
            assert!(whole.asked() > points_per_link * 5);
            assert!(whole.reached() * 1000 >= whole.asked() * 995, "{name}: {} of {}", whole.reached(), whole.asked());
            assert!(whole.outside() <= 0.0, "{name}: an answer is {} beyond a limit", whole.outside());
        }
    }
}
