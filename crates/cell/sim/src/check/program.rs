//! The guarded volumes of each robot, and their speeds in its program.

use elbowroom_cell::Cell;
use elbowroom_formats::FormatError;
use elbowroom_monitor::{Guards, Volume};
use elbowroom_robot::RobotId;

use super::sphere_swept_hull::SphereSweptHull;
use super::stopping_profile::{LinkSolid, Profile, StoppingProfile};
use crate::motion::{GripAction, PlanStep, ProgramPlan, plan};

/// The guarded volumes of a robot, and the motion profile of its program.
pub(super) struct RobotProgram {
    /// Without what it grips.
    pub volumes: Vec<Volume>,
    /// What it grips, where it is in the hand then.
    gripped: Vec<Volume>,
    /// Where it grips.
    pub grips: Vec<PlannedGrip>,
    /// Those of `volumes`, then those of `gripped`.
    pub profile: Profile,
}

/// A step that grips.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlannedGrip {
    pub action: GripAction,
    /// Joint values then, rad or m.
    pub q: Vec<f64>,
}

impl RobotProgram {
    fn of(cell: &Cell, robot: RobotId) -> Result<Self, FormatError> {
        let plan = plan(cell, robot, 1, &mut Vec::new())?;
        let volumes = cell.robots[robot.0].guarded_volumes();
        let grips = grips(&plan);
        let solid =
            |v: &Volume| LinkSolid { link: v.link, hull: SphereSweptHull::new(&v.shape, &v.in_link), grip: None };
        let mut solids: Vec<_> = volumes.iter().map(solid).collect();
        let mut gripped = Vec::new();
        for PlannedGrip { action, .. } in &grips {
            let Some(attachment) = action.attachment.clone() else { continue };
            // The last one is the object.
            if let Some(volume) = cell.volumes_holding(robot, &[(action.object, attachment)]).pop() {
                solids.push(LinkSolid { grip: Some(action.clone()), ..solid(&volume) });
                gripped.push(volume);
            }
        }
        Ok(Self { profile: Profile::of(cell, robot, &plan, &solids), volumes, gripped, grips })
    }

    /// The stopping profiles of the volumes that count for these guards.
    pub fn stopping_profiles(&self, guards: Guards) -> impl Iterator<Item = &StoppingProfile> {
        self.volumes
            .iter()
            .chain(&self.gripped)
            .zip(&self.profile.stopping_profiles)
            .filter(move |(v, _)| v.part.counts_for(guards))
            .map(|(_, p)| p)
    }
}

/// The steps of a plan that grip, each once.
fn grips(plan: &ProgramPlan) -> Vec<PlannedGrip> {
    let (mut grips, mut q) = (Vec::new(), plan.start.clone());
    for step in &plan.steps {
        if let PlanStep::Grip(action) = step {
            let grip = PlannedGrip { action: action.clone(), q: q.clone() };
            if action.grips && !grips.contains(&grip) {
                grips.push(grip);
            }
        }
        q = step.end().unwrap_or(q);
    }
    grips
}

pub(super) fn programs(cell: &Cell) -> Result<Vec<RobotProgram>, FormatError> {
    (0..cell.robots.len()).map(|robot| RobotProgram::of(cell, RobotId(robot))).collect()
}
