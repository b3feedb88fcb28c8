//! Regions that follow belts and other robots, and regions that are switched.

use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{BeltSpec, BeltTravel, CellSpec, FollowSpec, ObjectSpec, PoseRow, StepSpec, Vector};

/// Lets one region of some cells move; in some cells a program switches one on.
pub fn some(spec: &mut CellSpec, random: &mut Random) {
    let Some(last) = spec.regions.len().checked_sub(1) else { return };
    let keeps_inside = spec.regions[last].is_fence || spec.regions[last].shape.contains("keep");
    if random.percent(15) && !keeps_inside {
        let direction = random.vector(1.0);
        if direction.iter().map(|v| v.abs()).sum::<f64>() > 0.1 {
            let mut belt = belt(direction, random);
            spec.regions[last].follow = Some(if random.percent(60) {
                FollowSpec::Belt(belt.name.clone())
            } else {
                // At travel 0 its frame is the world's.
                belt.wrap = None;
                let (name, shape) = ("crate".to_owned(), "shape = \"box\"\nsize = [0.1, 0.1, 0.1]\n".to_owned());
                let on_the_belt = Some(belt.name.clone());
                spec.objects.push(ObjectSpec { name, shape, belt: on_the_belt, ..ObjectSpec::default() });
                FollowSpec::Object("crate".to_owned())
            });
            spec.belts.push(belt);
        }
    } else if random.percent(10) && spec.robots.len() > 1 {
        // Its coordinates are now in the flange's frame.
        spec.regions[last].follow = Some(FollowSpec::Robot { robot: 1, frame: "flange" });
        spec.regions[last].robots = vec![0];
        spec.regions[last].is_fence = false;
        spec.regions[last].shape =
            format!("shape = \"sphere\"\ncentre = [0, 0, 0]\nradius = {}\n", random.scaled(0.05, 0.4));
    }
    if spec.regions[last].follow.is_none() && !keeps_inside && random.percent(10) {
        let in_quaternions = random.percent(50);
        spec.regions[last].follow = Some(FollowSpec::Poses { rows: poses(random), in_quaternions });
    }
    let robot = random.whole(0, spec.robots.len() - 1);
    // A recording switches nothing.
    if spec.robots[robot].program.recording.is_none() && random.percent(15) {
        spec.regions[0].temporary = true;
        let steps = &mut spec.robots[robot].program.steps;
        let at = if random.percent(60) { 0 } else { random.whole(0, steps.len()) };
        steps.insert(at, StepSpec::Switch { region: spec.regions[0].name.clone(), active: true });
    }
}

/// Makes a belt with a constant speed, or one that a file describes; some begin again at 0.
fn belt(direction: Vector, random: &mut Random) -> BeltSpec {
    let travel = if random.percent(60) {
        BeltTravel::Constant { speed: random.scaled(0.02, 0.5), start: random.one(&[0.0, 0.3]) }
    } else {
        let mut row = (0.0, random.between(-0.5, 0.5));
        let mut rows = vec![row];
        for _ in 0..random.whole(1, 4) {
            let duration_s = random.between(0.2, 3.0);
            row = (rounded(row.0 + duration_s), rounded(row.1 + random.between(-0.5, 0.5) * duration_s));
            rows.push(row);
        }
        BeltTravel::Table(rows)
    };
    let wrap = random.first_or_percent(50).then(|| random.between(0.2, 2.0));
    BeltSpec { name: "belt".into(), direction, travel, wrap }
}

/// Makes poses near that of the world: the region, whose coordinates are in this frame, stays near its place.
fn poses(random: &mut Random) -> Vec<PoseRow> {
    let (way, turn) = (random.scaled(0.02, 0.5), if random.percent(60) { random.scaled(0.05, 1.0) } else { 0.0 });
    let mut row = PoseRow { t_s: random.one(&[0.0, 0.5]), at: random.vector(0.2), rpy: random.vector(turn) };
    let mut rows = vec![row];
    for _ in 0..random.whole(1, 4) {
        let duration_s = random.between(0.5, 3.0);
        let mut near = |old: f64, most: f64| rounded(old + random.between(-most, most) * duration_s);
        let (at, rpy) = (row.at.map(|v| near(v, way)), row.rpy.map(|v| near(v, turn)));
        row = PoseRow { t_s: rounded(row.t_s + duration_s), at, rpy };
        rows.push(row);
    }
    rows
}
