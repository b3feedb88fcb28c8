//! Random cells with robots that grip parts, carry them past regions and put them down.

use elbowroom_cell::Cell;
use elbowroom_spatial::Vec3;

use super::moving_object::{object_frame, text, vector};
use super::settings::{Places, laws, settings};
use super::{any_robot, exchange, planned, region};
use crate::fuzz_cells::oracle::{Arm, Frame, Guarded};
use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{CellSpec, ObjectSpec, RegionSpec, StepSpec, Vector};

/// Number of tries to find a place of a region that the robot's start is outside of.
const TRIES: usize = 4;

/// A part that a robot carries: on which of its program's ways, and where on the flange.
struct Carried {
    robot: usize,
    /// Joint values at which it is gripped, those at the ends of the moves with it, and those where it is put down.
    ends: Vec<Vec<f64>>,
    part_in_flange: Frame,
    half: Vec3,
}

/// Makes a cell with forbidden regions, or with exchange regions of several robots.
pub fn cell(random: &mut Random, places: &Places<'_>) -> CellSpec {
    if random.percent(30) {
        let mut spec = CellSpec { max_s: 60.0, ..exchange::cell(random) };
        spec.robots.truncate(3);
        for robot in 0..spec.robots.len() {
            if robot == 0 || random.percent(40) {
                carry(&mut spec, robot, places, random);
            }
        }
        return spec;
    }
    let mut spec = settings(random);
    laws(&mut spec, random);
    spec.robots.push(any_robot::any(random, places));
    if random.percent(10) {
        planned::plan(&mut spec, random);
    }
    let carried = carry(&mut spec, 0, places, random);
    let Ok(cell) = spec.parse(places.cells) else { return spec };
    for i in 0..random.whole(1, 3) {
        let name = format!("g{i}");
        let region = match &carried {
            Some(carried) if random.percent(70) => beside_the_part(&spec, &cell, carried, &name, places, random),
            _ => region::on_the_path(&spec, &cell, &name, random),
        };
        spec.regions.extend(region);
    }
    spec
}

/// Puts a part where the hand comes, and lets the program grip it there; most parts are put down again later.
fn carry(spec: &mut CellSpec, robot: usize, places: &Places<'_>, random: &mut Random) -> Option<Carried> {
    let cell = spec.parse(places.cells).ok()?;
    let program = &spec.robots[robot].program;
    if program.steps.iter().any(|step| matches!(step, StepSpec::Grip(_) | StepSpec::Tool(_))) {
        return None;
    }
    // Where the program rests: the number of steps before, and the joint values.
    let ends = program.steps.iter().enumerate().filter_map(|(i, step)| Some((i + 1, step.target()?.clone())));
    let rests: Vec<(usize, Vec<f64>)> = std::iter::once((0, spec.robots[robot].start.clone())).chain(ends).collect();
    let last = rests.len() - 1;
    let first = random.whole(0, last.saturating_sub(1));
    let end = if random.percent(70) { random.whole((first + 1).min(last), last) } else { last };
    let (at, q) = rests[first].clone();

    let name = format!("part{}", spec.objects.len());
    let (part, half) = part_at(hand(&cell, robot, &q, random), name.clone(), random);
    let part_in_flange = object_frame(&part, 0.0).seen_from(&flange(&cell, robot, &q));
    let steps = &mut spec.robots[robot].program.steps;
    let mut ends: Vec<Vec<f64>> = rests[first..=end].iter().map(|(_, q)| q.clone()).collect();
    match random.whole(0, 9) {
        // It is put down where it was, so that the program can be repeated.
        0..=2 => {
            ends.extend(rests[end + 1..].iter().map(|(_, q)| q.clone()).chain([q.clone()]));
            steps.extend([StepSpec::Joint { to: q, percent: 100.0 }, StepSpec::Release(name.clone())]);
            spec.robots[robot].program.repeat = random.one(&[1, 2, 2]);
        }
        3..=7 => steps.insert(rests[end].0, StepSpec::Release(name.clone())),
        _ => ends.extend(rests[end + 1..].iter().map(|(_, q)| q.clone())),
    }
    spec.robots[robot].program.steps.insert(at, StepSpec::Grip(name));
    spec.objects.push(part);
    Some(Carried { robot, ends, part_in_flange, half })
}

/// The tool centre point of a robot, or a point beside it within reach of the hand.
fn hand(cell: &Cell, robot: usize, q: &[f64], random: &mut Random) -> Vec3 {
    let frames = Arm::new(&cell.robots[robot]).frames(q);
    let tcp = Guarded::all(&cell.robots[robot])[0].center(&frames);
    tcp + if random.percent(30) { vector(random.vector(0.02)) } else { Vec3::ZERO }
}

fn flange(cell: &Cell, robot: usize, q: &[f64]) -> Frame {
    Arm::new(&cell.robots[robot]).frames(q)[cell.robots[robot].flange.0]
}

/// Makes a part that contains a point, and half of its extents; some are long.
fn part_at(point: Vec3, name: String, random: &mut Random) -> (ObjectSpec, Vec3) {
    let long = if random.percent(50) { random.between(0.3, 1.0) } else { random.between(0.05, 0.3) };
    let thin = random.between(0.02, 0.2);
    let (shape, half): (String, Vector) = match random.whole(0, 9) {
        0 => (format!("shape = \"sphere\"\nradius = {thin}\n"), [thin; 3]),
        1 | 2 => (format!("shape = \"cylinder\"\nradius = {thin}\nheight = {long}\n"), [thin, thin, long / 2.0]),
        3 | 4 => {
            let half = [thin, thin, long / 2.0 + thin];
            (format!("shape = \"capsule\"\nradius = {thin}\nheight = {long}\n"), half)
        }
        // A corner of plates is hollow: only its origin is surely solid.
        5 => ("shape = \"mesh\"\nmesh = \"corner.obj\"\n".to_owned(), [0.0; 3]),
        _ => {
            let size = [thin, random.between(0.02, 0.3), long];
            (format!("shape = \"box\"\nsize = {size:?}\n"), size.map(|s| s / 2.0))
        }
    };
    let mut within = |half: f64| random.between(-0.6, 0.6) * half;
    let inside = Vec3::new(within(half[0]), within(half[1]), within(half[2]));
    let rpy = random.vector(3.0);
    let turned = object_frame(&ObjectSpec { rpy, ..ObjectSpec::default() }, 0.0);
    let at = text(point - turned.vector(inside));
    (ObjectSpec { name, shape, at, rpy, ..ObjectSpec::default() }, vector(half))
}

/// Makes a forbidden region near the part, somewhere on its way; `None` if none was found that the start is outside of.
fn beside_the_part(
    spec: &CellSpec,
    cell: &Cell,
    carried: &Carried,
    name: &str,
    places: &Places<'_>,
    random: &mut Random,
) -> Option<RegionSpec> {
    let Carried { robot, ends, part_in_flange, half } = carried;
    let last = ends.len().checked_sub(2)?;
    for _ in 0..TRIES {
        let (leg, share) = (random.whole(0, last), random.between(0.2, 1.1));
        let q: Vec<f64> = ends[leg].iter().zip(&ends[leg + 1]).map(|(a, b)| a + (b - a) * share).collect();
        let mut end = |half: f64| if random.percent(50) { half } else { -half };
        let far = Vec3::new(end(half.x), end(half.y), end(half.z));
        let point = flange(cell, *robot, &q).then(part_in_flange).point(far) + vector(random.vector(0.1));
        let region = region::at(spec, *robot, text(point), name, random);
        let with = CellSpec { regions: vec![region.clone()], ..spec.clone() };
        if region::starts_outside(&with, places.cells) {
            return Some(region);
        }
    }
    None
}
