//! Random cells of two to six robots that share exchange regions, some of which move.

use std::f64::consts::TAU;

use super::moving_object::{local, moving_object, object_frame, vector};
use super::settings::{settings, stop_time};
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{
    CellSpec, DhRow, FollowSpec, HandSpec, Model, ProgramSpec, RegionSpec, RobotSpec, SolidSpec, StepSpec, Vector,
};

/// Makes a cell of carriages that pass one to four crossings, each with solids that reach some of them.
pub fn cell(random: &mut Random) -> CellSpec {
    let mut spec = CellSpec { tick_ms: random.one(&[2.0, 4.0, 8.0]), max_s: 120.0, ..settings(random) };
    let crossings = random.whole(1, 4);
    let apart = random.between(0.3, 3.0);
    let centers: Vec<Vector> = (0..crossings)
        .map(|i| [0.0, rounded(i as f64 * apart), if random.percent(80) { 0.0 } else { random.between(-0.5, 0.5) }])
        .collect();
    let carried = random.percent(30);
    for (i, center) in centers.iter().enumerate() {
        if carried && i == 0 {
            on_an_object(&mut spec, *center, random);
        } else {
            spec.regions.push(region(random, i, *center));
        }
    }
    for _ in 0..random.whole(2, 6) {
        spec.robots.push(carriage(random, &centers));
    }
    spec
}

/// Adds a region on an object that moves or turns, which comes to the crossing at some time.
fn on_an_object(spec: &mut CellSpec, center: Vector, random: &mut Random) {
    let meets_s = random.between(0.5, 8.0);
    let object = moving_object(random, "carrier".to_owned(), vector(center), meets_s);
    let there = local(&object_frame(&object, meets_s), vector(center));
    let follow = Some(FollowSpec::Object(object.name.clone()));
    spec.regions.push(RegionSpec { follow, ..region(random, 0, there) });
    spec.objects.push(object);
}

fn region(random: &mut Random, index: usize, center: Vector) -> RegionSpec {
    let size = random.between(0.1, 0.5);
    let shape = match random.whole(0, 2) {
        0 => format!("shape = \"sphere\"\ncentre = {center:?}\nradius = {}\n", rounded(size / 2.0)),
        1 => {
            let base = [center[0], center[1], rounded(center[2] - 0.5)];
            format!("shape = \"cylinder\"\nbase = {base:?}\nradius = {}\nheight = 1\n", rounded(size / 2.0))
        }
        _ => {
            let base = [center[0], center[1], rounded(center[2] - 0.5)];
            format!("shape = \"box\"\nbase = {base:?}\nsize = [{size}, {size}, 1]\n")
        }
    };
    let warning = if random.percent(30) { random.between(0.01, 0.05) } else { random.between(0.05, 0.6) };
    RegionSpec {
        name: format!("x{index}"),
        shape,
        kind: "exchange",
        warning,
        guards: vec!["arm"],
        robots: Vec::new(),
        temporary: false,
        is_fence: false,
        follow: None,
        limits: None,
    }
}

/// Makes a carriage that passes one or more crossings, with spheres that move through them.
fn carriage(random: &mut Random, centers: &[Vector]) -> RobotSpec {
    let speed = random.scaled(0.3, 2.0);
    let half = 2.5;
    // Its rail is along the frame's z; spheres can be beside it along the frame's x and y.
    let any = random.between(0.0, TAU);
    let along = random.one(&[0.0, TAU / 2.0, TAU / 4.0, any]);
    let first = random.whole(0, centers.len() - 1);
    let at = centers[first];
    let (sin, cos) = along.sin_cos();
    let mut balls = vec![SolidSpec::Sphere { at: [0.0; 3], radius: random.between(0.02, 0.1) }];
    for (i, center) in centers.iter().enumerate() {
        if i == first || random.percent(60) {
            continue;
        }
        // The offset in the carriage's frame: z along the rail, y across it, x down.
        let d: Vector = std::array::from_fn(|k| center[k] - at[k]);
        let (z, y) = (d[0] * cos + d[1] * sin, -d[0] * sin + d[1] * cos);
        balls.push(SolidSpec::Sphere { at: [-d[2], y, z + random.between(-0.5, 0.5)].map(rounded), radius: 0.05 });
    }
    let row = DhRow {
        slides: true,
        a: 0.0,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        min: -5.0,
        max: 5.0,
        speed,
        acceleration: rounded(speed / random.scaled(0.05, 0.6)),
    };
    let from = if random.percent(5) { 0.0 } else { -half };
    let to = if random.percent(8) { 0.0 } else { half };
    let mut steps = Vec::new();
    if random.percent(50) {
        steps.push(StepSpec::Wait(random.between(0.0, 1.0)));
    }
    if random.percent(20) {
        steps.push(StepSpec::Joint { to: vec![random.between(-0.6, 0.6)], percent: 100.0 });
    }
    steps.push(StepSpec::Joint { to: vec![to], percent: if random.percent(70) { 100.0 } else { 50.0 } });
    if random.percent(30) {
        steps.push(StepSpec::Joint { to: vec![-half], percent: 100.0 });
    }
    RobotSpec {
        model: Model::Dh { rows: vec![row], links: vec![balls], has_names: false },
        at,
        rpy: [0.0, rounded(TAU / 4.0), rounded(along)],
        start: vec![from],
        hand: HandSpec::default(),
        volumes: "auto",
        stop_time: stop_time(random),
        acceleration: None,
        overshoot: None,
        program: ProgramSpec::of_steps(100.0, steps),
        evades: Vec::new(),
        is_mechanism: false,
        keys: Vec::new(),
        starts_at_home: false,
    }
}
