//! Check of robots that only move along planned paths: they touch no fixed object.

use std::collections::BTreeSet;

use elbowroom_cell::{Cell, ProgramBody, StepAction};
use elbowroom_robot::ObjectId;
use elbowroom_sim::Recording;

use super::arm::Arm;
use super::findings::{Finding, Findings, TOLERANCE_M};
use super::frame::Frame;
use super::guarded::Guarded;
use super::solid::OracleSolid;

/// Distances beyond this are not computed, m.
const FAR_M: f64 = 0.3;

pub fn check(cell: &Cell, recording: &Recording, arms: &[Arm], findings: &mut Findings) {
    let moving: BTreeSet<ObjectId> = cell.moving_objects.iter().map(|m| m.object).collect();
    let fixed = cell.objects.iter().enumerate().filter(|(index, _)| !moving.contains(&ObjectId(*index)));
    // A floor far below is in a file of pairs as one that may be touched.
    let objects: Vec<(OracleSolid, Frame)> = fixed
        .filter(|(_, object)| object.name != "floor")
        .map(|(_, object)| (OracleSolid::eroded(&object.shape, TOLERANCE_M), Frame::of(&object.in_world)))
        .collect();
    for (robot, arm) in arms.iter().enumerate() {
        if only_planned(cell, robot) && !objects.is_empty() {
            let found = first_touch(cell, recording, (robot, arm), &objects);
            findings.list.extend(found.map(|t_s| Finding::Touched { robot, t_s }));
        }
    }
}

/// Whether all motions of a robot are planned moves, with what it has in its hand at the start.
fn only_planned(cell: &Cell, robot: usize) -> bool {
    let r = &cell.robots[robot];
    let Some(ProgramBody::Steps(steps)) = r.program.as_ref().map(|p| &p.body) else { return false };
    let is_planned = |action: &StepAction| {
        !matches!(
            action,
            StepAction::Joint { .. } | StepAction::Linear { .. } | StepAction::Grip(_) | StepAction::Tool(_)
        )
    };
    r.avoidance.is_none() && steps.iter().all(|step| is_planned(&step.action))
}

/// The first time at which a robot touches one of these solids, s.
pub(super) fn first_touch(
    cell: &Cell,
    recording: &Recording,
    (robot, arm): (usize, &Arm),
    objects: &[(OracleSolid, Frame)],
) -> Option<f64> {
    let parts = Guarded::all(&cell.robots[robot]);
    let pairs: Vec<(&Guarded, &(OracleSolid, Frame))> =
        parts.iter().flat_map(|part| objects.iter().map(move |object| (part, object))).collect();
    let lever_arms: Vec<Vec<f64>> = pairs.iter().map(|(part, _)| arm.lever_arms(part.link, part.radius_m)).collect();
    // How much nearer each pair may have come than at its last measurement, m.
    let mut slack_m = vec![0.0; pairs.len()];
    let samples = &recording.robots[robot].samples;
    for (k, sample) in samples.iter().enumerate() {
        let before = &samples[k.saturating_sub(1)].q;
        let mut frames = None;
        for (i, (part, (solid, at))) in pairs.iter().enumerate() {
            let motion = sample.q.iter().zip(before).zip(&lever_arms[i]);
            slack_m[i] -= motion.map(|((now, before), lever)| (now - before).abs() * lever).sum::<f64>();
            if slack_m[i] > 0.0 {
                continue;
            }
            let distance = part.distance(frames.get_or_insert_with(|| arm.frames(&sample.q)), solid, at, FAR_M);
            if distance.upper <= 0.0 {
                return Some(sample.t_s);
            }
            slack_m[i] = distance.lower;
        }
    }
    None
}
