//! The guarded volumes of each robot, and their speeds in its program.

use elbowroom_cell::CellRobot;
use elbowroom_diagnostic::Diagnostic;
use elbowroom_monitor::{Guards, Volume};
use elbowroom_robot::RobotId;

use super::sphere_swept_hull::SphereSweptHull;
use super::stopping_profile::{LinkSolid, Profile, StoppingProfile};
use crate::motion::{GripAction, PlanStep, PlannedPaths, ProgramPlan, repeated_plan};

/// The guarded volumes of a robot, and the motion profile of its program.
pub(super) struct RobotProgram {
    /// Guarded volumes, without gripped parts.
    pub volumes: Vec<Volume>,
    /// Volumes of gripped parts, at their poses in the hand.
    gripped: Vec<Volume>,
    /// Grips and tool exchanges.
    pub mounts: Vec<PlannedMount>,
    /// Profile of the program, with stopping profiles of `volumes`, then of `gripped`.
    pub profile: Profile,
}

/// A step after which something counts as a part of the robot.
#[derive(Debug, Clone)]
pub(super) struct PlannedMount {
    pub what: Mount,
    /// Joint values at the step, rad or m.
    pub q: Vec<f64>,
    /// The robot with the tools that it has before the step.
    pub robot: CellRobot,
}

/// The part or tool that a step mounts.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Mount {
    /// A gripped object.
    Part(GripAction),
    /// Index of the tool that becomes active.
    Tool(usize),
}

impl RobotProgram {
    fn of(paths: &PlannedPaths<'_>, robot: RobotId) -> Result<Self, Diagnostic> {
        let (cell, plan) = (paths.cell(), repeated_plan(paths, robot)?);
        let volumes = cell.robots[robot.0].guarded_volumes();
        let mounts = mounts(&cell.robots[robot.0], &plan);
        let solid =
            |v: &Volume| LinkSolid { link: v.link, hull: SphereSweptHull::new(&v.shape, &v.in_link), grip: None };
        let mut solids: Vec<_> = volumes.iter().map(solid).collect();
        let mut gripped = Vec::new();
        for action in parts(&mounts) {
            let Some(attachment) = action.attachment.clone() else { continue };
            // The last volume is the object.
            if let Some(volume) = cell.volumes_holding(robot, &[(action.object, attachment)]).pop() {
                solids.push(LinkSolid { grip: Some(action.clone()), ..solid(&volume) });
                gripped.push(volume);
            }
        }
        let profile = Profile::of(cell, robot, &plan, &solids);
        Ok(Self { volumes, gripped, mounts, profile })
    }

    /// The grips of the program.
    pub fn parts(&self) -> impl Iterator<Item = &GripAction> {
        parts(&self.mounts)
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

fn parts(mounts: &[PlannedMount]) -> impl Iterator<Item = &GripAction> {
    mounts.iter().filter_map(|mount| if let Mount::Part(action) = &mount.what { Some(action) } else { None })
}

/// The steps of a plan that grip or exchange tools, each once.
fn mounts(robot: &CellRobot, plan: &ProgramPlan) -> Vec<PlannedMount> {
    let (mut mounts, mut q, mut robot) = (Vec::<PlannedMount>::new(), plan.start.clone(), robot.clone());
    for step in &plan.steps {
        let what = match step {
            PlanStep::Grip(action) if action.grips => Some(Mount::Part(action.clone())),
            PlanStep::Tool(tool) => Some(Mount::Tool(*tool)),
            _ => None,
        };
        let is_known = |what: &Mount| mounts.iter().any(|known| known.what == *what && known.q == q);
        if let Some(what) = what.filter(|what| !is_known(what)) {
            mounts.push(PlannedMount { what, q: q.clone(), robot: robot.clone() });
        }
        if let PlanStep::Tool(tool) = step {
            robot = robot.with_tool(*tool);
        }
        q = step.end().unwrap_or(q);
    }
    mounts
}

pub(super) fn programs(paths: &PlannedPaths<'_>) -> Result<Vec<RobotProgram>, Diagnostic> {
    (0..paths.cell().robots.len()).map(|robot| RobotProgram::of(paths, RobotId(robot))).collect()
}
