//! Check of guided robots: the tool keeps its least gap from objects and stays out of shields, the arm touches nothing,
//! and forces make no energy.

use elbowroom_cell::shared_control::{ShieldSettings, ShieldTarget};
use elbowroom_cell::{Cell, CellFixture, CellOperator, ForceResponse, ShieldSource};
use elbowroom_proximity::Shape;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_sim::{EventRow, Recording, RunEvent};
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::findings::{Finding, Findings, TOLERANCE_M};
use super::frame::Frame;
use super::guarded::Guarded;
use super::solid::OracleSolid;

/// Distances beyond this are not computed, m.
const FAR_M: f64 = 0.5;
/// Points along an edge of a tool's box that are tried against a shield.
const POINTS: i32 = 8;
/// Tank of `impedance` by default, J.
const TANK_J: f64 = 0.01;
/// Rounding of an energy, J.
const ROUNDING_J: f64 = 1e-6;

/// Objects as the oracle sees them.
fn objects(cell: &Cell) -> Vec<(OracleSolid, Frame)> {
    cell.objects.iter().map(|o| (OracleSolid::eroded(&o.shape, 0.0), Frame::of(&o.in_world))).collect()
}

/// Whether no part of any robot is nearer to an object than this (m) at the start.
pub fn is_clear(cell: &Cell, least_m: f64) -> bool {
    let objects = objects(cell);
    cell.robots.iter().all(|robot| {
        let frames = Arm::new(robot).frames(&robot.start);
        Guarded::all(robot)
            .iter()
            .all(|part| objects.iter().all(|(solid, at)| part.distance(&frames, solid, at, FAR_M).upper > least_m))
    })
}

pub fn check(cell: &Cell, recording: &Recording, arms: &[Arm], findings: &mut Findings) {
    let objects = objects(cell);
    for operator in &cell.guidance.operators {
        let robot = operator.robot.0;
        distances(cell, operator, recording, &arms[robot], &objects, findings);
        energy(cell, robot, recording, findings);
    }
}

fn distances(
    cell: &Cell,
    operator: &CellOperator,
    recording: &Recording,
    arm: &Arm,
    objects: &[(OracleSolid, Frame)],
    findings: &mut Findings,
) {
    let robot = operator.robot.0;
    let parts = Guarded::all(&cell.robots[robot]);
    let fixtures = &cell.guidance.fixtures;
    let shield_of = |object: usize, t_s: f64| {
        let is_of = |f: &&CellFixture| f.tool == Some(operator.tool) && f.protects == ObjectId(object);
        fixtures.iter().find(|f| is_of(f) && is_on(f, recording, t_s))
    };
    let tool_link = cell.robots[robot].flange.0;
    let pairs: Vec<(&Guarded, usize, f64)> = parts
        .iter()
        .flat_map(|part| (0..objects.len()).map(move |object| (part, object)))
        .map(|(part, object)| (part, object, if part.is_tool() { operator.settings.least_gap_m } else { 0.0 }))
        .collect();
    // How much nearer each pair may have come than at its last measurement, m.
    let mut slack_m = vec![0.0; pairs.len()];
    let lever_arms: Vec<Vec<f64>> = pairs.iter().map(|(part, ..)| arm.lever_arms(part.link, part.radius_m)).collect();
    let samples = &recording.robots[robot].samples;
    for (k, sample) in samples.iter().enumerate() {
        let frames = arm.frames(&sample.q);
        let before = &samples[k.saturating_sub(1)].q;
        let t_s = sample.t_s;
        for (i, &(part, object, least_m)) in pairs.iter().enumerate() {
            if part.link == tool_link && shield_of(object, t_s).is_some() {
                // Nothing is known of what happens meanwhile.
                slack_m[i] = 0.0;
                continue;
            }
            let motion = sample.q.iter().zip(before).zip(&lever_arms[i]);
            slack_m[i] -= motion.map(|((now, before), lever)| (now - before).abs() * lever).sum::<f64>();
            if slack_m[i] > 0.0 {
                continue;
            }
            let (solid, at) = &objects[object];
            let distance = part.distance(&frames, solid, at, FAR_M);
            if distance.upper < least_m - TOLERANCE_M || distance.upper <= 0.0 {
                let distance_m = distance.upper;
                findings.list.push(Finding::TooNear { robot, object, t_s, distance_m, least_m });
                return;
            }
            slack_m[i] = distance.lower - least_m;
        }
        for (object, (_, at)) in objects.iter().enumerate() {
            if let Some(inside_m) = shield_of(object, t_s).and_then(|f| inside_shield(cell, f, &frames, at)) {
                let (distance_m, least_m) = (-inside_m, 0.0);
                findings.list.push(Finding::TooNear { robot, object, t_s, distance_m, least_m });
                return;
            }
        }
    }
}

/// Whether a fixture was on at a time, by the events of the run.
fn is_on(fixture: &CellFixture, recording: &Recording, t_s: f64) -> bool {
    let mut switched = recording.events.iter().rev().filter(|e| e.region == fixture.name && e.t_s < t_s);
    let state = |e: &EventRow| match e.event {
        RunEvent::On => Some(true),
        RunEvent::Off => Some(false),
        _ => None,
    };
    switched.find_map(state).unwrap_or(fixture.active)
}

/// How far a point of the tool's box is inside the shield of a drill in a box, beyond its tolerance; `None` if none is.
fn inside_shield(cell: &Cell, fixture: &CellFixture, frames: &[Frame], object_at: &Frame) -> Option<f64> {
    let robot = &cell.robots[fixture.tool.map_or(RobotId(0), |t| t.robot).0];
    let ShieldSource::Generated { target: ShieldTarget::Drill { at, axis }, settings } = &fixture.shield else {
        return None;
    };
    let (Shape::Cuboid(object), tool) = (&cell.objects[fixture.protects.0].shape, robot.payload.tool.as_ref()?) else {
        return None;
    };
    let Shape::Cuboid(tool_box) = &tool.shape else { return None };
    let tool_in_world = frames[robot.flange.0].then(&Frame::of(&tool.in_link));
    let depth_m = |p: Vec3| {
        let p = object_at.vector_back(tool_in_world.point(p) - object_at.at);
        let outside = p.abs() - object.half_extents;
        let distance_m =
            if outside.max_element() <= 0.0 { outside.max_element() } else { outside.max(Vec3::ZERO).length() };
        let below_offset = settings.offset_m - distance_m;
        below_offset.min(outside_opening(p, *at, *axis, settings)) - settings.tolerance_m
    };
    let deepest = surface_points(tool_box.half_extents).map(depth_m).fold(f64::NEG_INFINITY, f64::max);
    (deepest > TOLERANCE_M).then_some(deepest)
}

/// Distance of a point of the object's frame from the opening, or less, m; negative inside.
fn outside_opening(p: Vec3, at: Vec3, axis: Vec3, s: &ShieldSettings) -> f64 {
    let out = axis.try_normalize().map_or(Vec3::Z, |a| -a);
    let height = out.dot(p - at);
    let aside = (p - at - out * height).length();
    let wall = (aside - 0.5 * s.width_m) * s.flare_rad.cos() - (height + s.depth_m) * s.flare_rad.sin();
    wall.max(-(height + s.depth_m))
}

/// Points all over the surface of a box.
fn surface_points(half: Vec3) -> impl Iterator<Item = Vec3> {
    let share = |i: i32| 2.0 * f64::from(i) / f64::from(POINTS) - 1.0;
    let side = move |(axis, sign): (usize, f64)| {
        (0..=POINTS).flat_map(move |i| {
            (0..=POINTS).map(move |j| {
                let mut p = [sign, share(i), share(j)];
                p.rotate_right(axis);
                Vec3::new(p[0] * half.x, p[1] * half.y, p[2] * half.z)
            })
        })
    };
    (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]).flat_map(side)
}

/// The hand gets no more energy than it put in, and a tank. A virtual mass gives nothing back at all.
fn energy(cell: &Cell, robot: usize, recording: &Recording, findings: &mut Findings) {
    let Some(track) = &recording.robots[robot].guidance else { return };
    let forces = || cell.guidance.forces.iter().filter(|f| f.tool.robot == RobotId(robot));
    let has_port = forces().any(|f| matches!(f.response, ForceResponse::Impedance(_)));
    let mut before_j = 0.0;
    for sample in &track.samples {
        let Some(force) = sample.force else { continue };
        let least_j = if has_port { -TANK_J } else { before_j };
        if !(force.energy_j >= least_j - ROUNDING_J) || !force.on_hand_n.is_finite() {
            findings.list.push(Finding::EnergyMade { robot, t_s: sample.t_s, energy_j: force.energy_j - least_j });
            return;
        }
        before_j = force.energy_j;
    }
}
