//! Regions that follow belts and other robots, and regions that are switched.

use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{BeltSpec, CellSpec, FollowSpec, StepSpec};

/// Lets one region of some cells move; in some cells a program switches one on.
pub fn some(spec: &mut CellSpec, random: &mut Random) {
    let Some(last) = spec.regions.len().checked_sub(1) else { return };
    let keeps_inside = spec.regions[last].is_fence || spec.regions[last].shape.contains("keep");
    if random.percent(15) && !keeps_inside {
        let direction = random.vector(1.0);
        if direction.iter().map(|v| v.abs()).sum::<f64>() > 0.1 {
            let start = random.one(&[0.0, 0.3]);
            spec.belts.push(BeltSpec { name: "belt".into(), direction, speed: random.scaled(0.02, 0.5), start });
            spec.regions[last].follow = Some(FollowSpec::Belt("belt".into()));
        }
    } else if random.percent(10) && spec.robots.len() > 1 {
        // Its coordinates are now in the flange's frame.
        spec.regions[last].follow = Some(FollowSpec::Robot { robot: 1, frame: "flange" });
        spec.regions[last].robots = vec![0];
        spec.regions[last].is_fence = false;
        spec.regions[last].shape =
            format!("shape = \"sphere\"\ncentre = [0, 0, 0]\nradius = {}\n", random.scaled(0.05, 0.4));
    }
    if random.percent(15) {
        spec.regions[0].temporary = true;
        let robot = random.whole(0, spec.robots.len() - 1);
        let steps = &mut spec.robots[robot].program.steps;
        let at = if random.percent(60) { 0 } else { random.whole(0, steps.len()) };
        steps.insert(at, StepSpec::Switch { region: spec.regions[0].name.clone(), active: true });
    }
}
