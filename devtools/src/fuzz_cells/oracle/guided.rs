//! Check of guided robots: the tool keeps its least gap from objects and stays out of shields, the arm touches nothing,
//! and forces make no energy.

use elbowroom_cell::{Cell, CellFixture, CellOperator, ForceResponse, ShieldSource};
use elbowroom_proximity::Shape;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_sim::{EventRow, Recording, RunEvent};

use super::arm::Arm;
use super::findings::{Finding, Findings, TOLERANCE_M};
use super::frame::Frame;
use super::guarded::Guarded;
use super::shield::inside_shield;
use super::solid::OracleSolid;

/// Distances beyond this are not computed, m.
const FAR_M: f64 = 0.5;
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
        fixtures.iter().enumerate().find(|(_, f)| is_of(f) && is_on(f, recording, t_s))
    };
    let from_files = shields_from_files(fixtures);
    let tool_link = cell.robots[robot].flange.0;
    let pairs = pairs(&parts, objects.len(), operator.settings.least_gap_m);
    // How much nearer each pair may have come than at its last measurement, m.
    let mut slack_m = vec![0.0; pairs.len()];
    let lever_arms: Vec<Vec<f64>> = pairs.iter().map(|(part, ..)| arm.lever_arms(part.link, part.radius_m)).collect();
    let samples = &recording.robots[robot].samples;
    for (k, sample) in samples.iter().enumerate() {
        let frames = arm.frames(&sample.q);
        let before = &samples[k.saturating_sub(1)].q;
        let t_s = sample.t_s;
        for (i, &(part, object, least_m)) in pairs.iter().enumerate() {
            let (own_solid, at) = &objects[object];
            let shield = shield_of(object, t_s).filter(|_| part.link == tool_link);
            // A shield that is on takes the place of its object; a generated one is judged below.
            let solid = match &shield {
                Some((shield, _)) => from_files[*shield].as_ref(),
                None => Some(own_solid),
            };
            let motion = sample.q.iter().zip(before).zip(&lever_arms[i]);
            slack_m[i] -= motion.map(|((now, before), lever)| (now - before).abs() * lever).sum::<f64>();
            if shield.is_some() {
                slack_m[i] = 0.0;
            }
            let Some(solid) = solid.filter(|_| slack_m[i] <= 0.0) else { continue };
            let distance = part.distance(&frames, solid, at, FAR_M);
            if distance.upper < least_m - TOLERANCE_M || distance.upper <= 0.0 {
                let distance_m = distance.upper;
                findings.list.push(Finding::TooNear { robot, object, t_s, distance_m, least_m });
                return;
            }
            slack_m[i] = if shield.is_some() { 0.0 } else { distance.lower - least_m };
        }
        for (object, (_, at)) in objects.iter().enumerate() {
            if let Some(inside_m) = shield_of(object, t_s).and_then(|(_, f)| inside_shield(cell, f, &frames, at)) {
                let (distance_m, least_m) = (-inside_m, 0.0);
                findings.list.push(Finding::TooNear { robot, object, t_s, distance_m, least_m });
                return;
            }
        }
    }
}

/// The pairs of parts and objects, with the distance that they keep, m.
fn pairs(parts: &[Guarded], objects: usize, least_gap_m: f64) -> Vec<(&Guarded, usize, f64)> {
    let all = parts.iter().flat_map(|part| (0..objects).map(move |object| (part, object)));
    all.map(|(part, object)| (part, object, if part.is_tool() { least_gap_m } else { 0.0 })).collect()
}

/// The shields that files have, in the frames of their objects.
fn shields_from_files(fixtures: &[CellFixture]) -> Vec<Option<OracleSolid>> {
    let from_file = |f: &CellFixture| match &f.shield {
        ShieldSource::Mesh(mesh) => Some(OracleSolid::eroded(&Shape::Mesh(mesh.clone()), 0.0)),
        ShieldSource::Generated { .. } => None,
    };
    fixtures.iter().map(from_file).collect()
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

/// The hand gets no more energy than it put in, and a tank. A virtual mass gives nothing back at all.
fn energy(cell: &Cell, robot: usize, recording: &Recording, findings: &mut Findings) {
    let Some(track) = &recording.robots[robot].guidance else { return };
    let forces = cell.guidance.forces.iter().filter(|f| f.tool.robot == RobotId(robot));
    let tank = |response: &ForceResponse| match response {
        ForceResponse::Impedance(port) => Some(port.tank_j),
        _ => None,
    };
    let tank_j = forces.filter_map(|f| tank(&f.response)).reduce(f64::max);
    let mut before_j = 0.0;
    for sample in &track.samples {
        let Some(force) = sample.force else { continue };
        let least_j = tank_j.map_or(before_j, |tank_j| -tank_j);
        if !(force.energy_j >= least_j - ROUNDING_J) || !force.on_hand_n.is_finite() {
            findings.list.push(Finding::EnergyMade { robot, t_s: sample.t_s, energy_j: force.energy_j - least_j });
            return;
        }
        before_j = force.energy_j;
    }
}
