//! Random cells with regions that move and turn: on objects, on the links of other robots, and on a robot that evades.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use elbowroom_cell::Cell;
use elbowroom_spatial::Vec3;

use super::encounter::Encounter;
use super::moving_object::{local, moving_object, object_frame, text, vector};
use super::settings::{Places, settings};
use super::{any_robot, rail, region, robot};
use crate::fuzz_cells::oracle::{Arm, Frame};
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellSpec, FollowSpec, MotionSpec, ObjectSpec, RegionSpec, RobotSpec, StepSpec};

/// Number of tries to find a region that the robot's start is outside of.
const TRIES: usize = 4;

/// Makes a cell with a robot whose path regions cross.
pub fn cell(random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = CellSpec { max_s: 5.0, ..settings(random) };
    spec.robots.push(if random.percent(75) { rail::slide(random) } else { any_robot::any(random, places) });
    let what = random.whole(0, 9);
    match if random.rare(11, 12, 0).is_some() { 9 } else { what } {
        0..=5 => {
            for index in 0..if random.percent(80) { 1 } else { 2 } {
                on_an_object(&mut spec, places.cells, index, random);
            }
        }
        6..=8 => on_a_link(&mut spec, places.cells, random),
        _ => on_an_evading_robot(&mut spec, places.cells, random),
    }
    if random.percent(25)
        && let Ok(cell) = spec.parse(places.cells)
    {
        spec.regions.extend(region::on_the_path(&spec, &cell, "g", random));
    }
    if random.percent(15) {
        spec.repeat = 2;
    }
    spec
}

/// Adds an object that moves or turns, with a region that would meet the robot if it did not stop.
fn on_an_object(spec: &mut CellSpec, folder: &Path, index: usize, random: &mut Random) {
    for _ in 0..TRIES {
        let Some(Encounter { t_s, place, .. }) = Encounter::new(spec, folder, random) else { return };
        let object = moving_object(random, format!("o{index}"), place, t_s);
        let local = local(&object_frame(&object, t_s), place);
        let follow = Some(FollowSpec::Object(object.name.clone()));
        let mut with = spec.clone();
        with.objects.push(object);
        let region = region::at(&with, 0, local, &format!("m{index}"), random);
        with.regions.push(RegionSpec { follow, ..region });
        if region::starts_outside(&with, folder) {
            *spec = with;
            return;
        }
    }
}

/// Adds a robot that turns or slides, with a region on one of its links that would meet the first robot if it did not stop.
fn on_a_link(spec: &mut CellSpec, folder: &Path, random: &mut Random) {
    for _ in 0..TRIES {
        let Some(Encounter { place, .. }) = Encounter::new(spec, folder, random) else { return };
        let kinds: [fn(&mut Random) -> RobotSpec; 4] = [rail::turner, rail::turner, rail::counter_turner, robot::small];
        let mut carrier = random.one(&kinds)(random);
        carrier.at = text(place + vector(random.vector(1.0)));
        if random.percent(40) {
            carrier.rpy = [random.between(-PI, PI), random.between(-FRAC_PI_2, FRAC_PI_2), random.between(-PI, PI)];
        }
        if random.percent(50) {
            carrier.hand.tcp = Some([random.between(-0.2, 0.2), random.between(-0.2, 0.2), random.between(0.0, 0.4)]);
        }
        let mut with = spec.clone();
        with.robots.push(carrier);
        let Some(Encounter { cell, q, place, .. }) = Encounter::new(&with, folder, random) else { continue };
        let is_mechanism = random.percent(40);
        let frame = if is_mechanism { "link_1" } else { random.one(&["flange", "tcp", "tcp", "link_1"]) };
        let robot = &cell.robots[1];
        let link = if frame == "link_1" { link_named(&cell, frame) } else { Some(robot.flange.0) };
        let Some(link) = link else { continue };
        let link = Arm::new(robot).frames(&q[1])[link];
        let carried = if frame == "tcp" { link.then(&Frame::of(&robot.tcp_in_flange)) } else { link };
        let region = region::at(&with, 0, local(&carried, place), "m0", random);
        let follow = Some(FollowSpec::Robot { robot: 1, frame });
        with.regions.push(RegionSpec { follow, robots: vec![0], ..region });
        with.robots[1].is_mechanism = is_mechanism;
        if region::starts_outside(&with, folder) {
            *spec = with;
            return;
        }
    }
}

fn link_named(cell: &Cell, name: &str) -> Option<usize> {
    cell.robots[1].robot.chain.links().iter().position(|link| link == name)
}

/// Adds a robot on a rail with a region on its hand; a cart makes the robot evade towards the first robot.
fn on_an_evading_robot(spec: &mut CellSpec, folder: &Path, random: &mut Random) {
    let Ok(cell) = spec.parse(folder) else { return };
    let Some(place) = region::point_on_the_path(spec, &cell, 0, random) else { return };
    let yaw = random.between(-PI, PI);
    let ahead = Vec3::new(yaw.cos(), yaw.sin(), 0.0);
    let radius = random.between(0.05, 0.3);
    let behind = radius + random.between(0.1, 0.8);
    let mut carrier = rail::plain(random);
    carrier.rpy = [0.0, rounded(FRAC_PI_2), yaw];
    carrier.at = text(vector(place) - ahead * behind);
    carrier.evades = vec!["cart".into()];
    spec.robots.push(carrier);
    let at = text(vector(place) - ahead * (behind + random.between(0.8, 2.0)));
    let via = vec![text(vector(place) - ahead * random.between(0.0, behind))];
    let motion = MotionSpec { via, speed: random.scaled(0.2, 1.0), start: 0.0, repeat: "no", turn: [0.0; 3] };
    let shape = "shape = \"box\"\nsize = [0.3, 0.3, 0.3]\n".to_owned();
    spec.objects.push(ObjectSpec { name: "cart".into(), shape, at, rpy: [0.0; 3], motion: Some(motion), belt: None });
    let mut region = region::at(spec, 0, [0.0; 3], "m0", random);
    region.shape = format!("shape = \"sphere\"\ncentre = [0, 0, 0]\nradius = {radius}\n");
    (region.robots, region.follow) = (vec![0], Some(FollowSpec::Robot { robot: 1, frame: "flange" }));
    spec.regions.push(region);
    if random.percent(60) {
        // A robot at rest is still there when the other one comes.
        spec.robots[0].program.steps.truncate(1);
        spec.robots[0].program.steps.insert(0, StepSpec::Wait(random.between(1.0, 5.0)));
    }
}
