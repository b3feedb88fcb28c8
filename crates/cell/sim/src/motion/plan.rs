//! Planning of a program: every move is computed before the simulation starts.

use std::sync::Arc;

use elbowroom_cell::trajectory::{Playback, motion_bounds, recording_warnings, volume_motion_bounds};
use elbowroom_cell::{Cell, CellRobot, MoveTarget, PathPlanner, Program, ProgramBody, ProgramStep, StepAction};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::{JointTrajectory, LinkId};
use elbowroom_query::plan::{KeptAxis, KeptDirection, PathGoal, PathRequest, TcpMotion};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;

use super::planned_parts::{PartError, PlannedParts};
use super::planned_paths::{PathOrigin, PlannedPaths, Tooling};
use super::program_plan::{PlanStep, ProgramPlan};
use super::{GripAction, MovePath, Segment, TcpLine};

/// Largest number of steps of a plan, including repetitions.
const MAX_STEPS: u64 = 1_000_000;

/// Plans the program of one robot of the cell of `paths`, run `repeat` times (times the program's own `repeat`).
///
/// # Errors
/// [`Diagnostic`] at the line of an infeasible step: out of reach, through a singularity, beyond limits.
pub fn plan(
    paths: &PlannedPaths<'_>,
    robot: RobotId,
    repeat: u32,
    notes: &mut Vec<Diagnostic>,
) -> Result<ProgramPlan, Diagnostic> {
    let passes = repeat.max(1);
    plan_passes(paths, robot, Passes { wanted: passes, required: passes }, notes)
}

/// Plans the program of a robot, and a second pass as far as it is feasible, which includes the way back to the start.
///
/// # Errors
/// As for [`plan`].
pub fn repeated_plan(paths: &PlannedPaths<'_>, robot: RobotId) -> Result<ProgramPlan, Diagnostic> {
    plan_passes(paths, robot, Passes { wanted: 2, required: 1 }, &mut Vec::new())
}

/// How often a program runs.
#[derive(Debug, Clone, Copy)]
struct Passes {
    wanted: u32,
    /// Passes that must be feasible. An infeasible step of a later pass ends the plan without an error.
    required: u32,
}

fn plan_passes(
    paths: &PlannedPaths<'_>,
    robot: RobotId,
    passes: Passes,
    notes: &mut Vec<Diagnostic>,
) -> Result<ProgramPlan, Diagnostic> {
    let cell = paths.cell();
    let at = &cell.robots[robot.0];
    let Some(program) = &at.program else {
        return Ok(ProgramPlan { start: at.start.clone(), speed_override: 1.0, steps: Vec::new() });
    };
    let of_program = |passes: u32| u64::from(passes) * u64::from(program.repeat);
    let (wanted, required) = (of_program(passes.wanted), of_program(passes.required));
    let mut planner = ProgramPlanner::new(paths, robot, notes);
    match &program.body {
        ProgramBody::Steps(steps) => {
            let most = MAX_STEPS / steps.len().max(1) as u64;
            planner.steps(program, steps, wanted.min(most), required.min(most))
        }
        ProgramBody::Trajectory(trajectory) => {
            planner.notes.extend(recording_warnings(cell, robot));
            planner.playback(program, trajectory, wanted.min(MAX_STEPS))
        }
    }
}

/// Plans the step in which the program of a robot first grips an object; `None` if it never does.
///
/// # Errors
/// [`Diagnostic`] at the line of the grip, or of an earlier step, if that step is infeasible.
pub fn first_grip(cell: &Cell, robot: RobotId, object: ObjectId) -> Result<Option<GripAction>, Diagnostic> {
    let Some(program) = &cell.robots[robot.0].program else { return Ok(None) };
    let ProgramBody::Steps(steps) = &program.body else { return Ok(None) };
    let grips = |s: &ProgramStep| matches!(s.action, StepAction::Grip(o) if o == object);
    let Some(index) = steps.iter().position(grips) else { return Ok(None) };
    let (paths, mut notes) = (PlannedPaths::new(cell), Vec::new());
    let plan = ProgramPlanner::new(&paths, robot, &mut notes).steps(program, &steps[..=index], 1, 1)?;
    Ok(plan
        .steps
        .into_iter()
        .next_back()
        .and_then(|s| if let PlanStep::Grip(action) = s { Some(action) } else { None }))
}

struct ProgramPlanner<'p, 'a> {
    cell: &'a Cell,
    paths: &'p PlannedPaths<'a>,
    id: RobotId,
    /// The robot, with its tools after the steps so far.
    robot: CellRobot,
    /// Joint values after the steps so far.
    q: Vec<f64>,
    notes: &'p mut Vec<Diagnostic>,
    /// Moves of earlier passes.
    planned_moves: Vec<PlannedMoveEntry>,
    /// The objects after the steps so far.
    parts: PlannedParts<'a>,
}

/// What a step says of its planned move.
#[derive(Clone, Copy)]
struct PlannedMove<'s> {
    to: &'s MoveTarget,
    speed: f64,
    planner: PathPlanner,
    keep: Option<KeptAxis>,
}

/// A planned move, identified by its step, its start joint values and the flange.
struct PlannedMoveEntry {
    step: usize,
    from: Vec<f64>,
    flange: LinkId,
    segment: Arc<Segment>,
}

impl<'p, 'a> ProgramPlanner<'p, 'a> {
    fn new(paths: &'p PlannedPaths<'a>, id: RobotId, notes: &'p mut Vec<Diagnostic>) -> Self {
        let cell = paths.cell();
        let robot = cell.robots[id.0].clone();
        Self {
            cell,
            paths,
            id,
            q: robot.start.clone(),
            robot,
            notes,
            planned_moves: Vec::new(),
            parts: PlannedParts::new(cell, id),
        }
    }

    fn steps(
        &mut self,
        program: &Program,
        steps: &[ProgramStep],
        passes: u64,
        required: u64,
    ) -> Result<ProgramPlan, Diagnostic> {
        let mut plan = ProgramPlan { start: self.q.clone(), speed_override: program.speed_override, steps: Vec::new() };
        for pass in 0..passes {
            if pass > 0 {
                plan.steps.push(PlanStep::Override(program.speed_override));
            }
            for (i, step) in steps.iter().enumerate() {
                match self.step(i, step) {
                    Ok(planned) => plan.steps.push(planned),
                    Err(_) if pass >= required => return Ok(plan),
                    Err(e) => return Err(e),
                }
            }
        }
        Ok(plan)
    }

    fn step(&mut self, i: usize, step: &ProgramStep) -> Result<PlanStep, Diagnostic> {
        Ok(match &step.action {
            StepAction::Switch { region, active } => PlanStep::Switch { region: *region, active: *active },
            StepAction::Wait(s) => PlanStep::Wait(*s),
            StepAction::Override(o) => PlanStep::Override(*o),
            StepAction::Joint { .. } | StepAction::Linear { .. } => PlanStep::Move(self.segment(i, step)?),
            StepAction::Grip(object) => {
                let gripped = self.parts.grip(*object, &self.robot, &self.q);
                let attachment = gripped.map_err(|e| self.part_error(i, step, e))?;
                PlanStep::Grip(self.grip_action(*object, true, attachment, step))
            }
            StepAction::Release(object) => {
                self.parts.release(*object, &self.q).map_err(|e| self.part_error(i, step, e))?;
                PlanStep::Grip(self.grip_action(*object, false, None, step))
            }
            StepAction::Tool(tool) => {
                self.change_tool(i, step, *tool)?;
                PlanStep::Tool(*tool)
            }
            StepAction::Planned { to, speed, planner, keep } => {
                let (speed, planner, keep) = (*speed, *planner, *keep);
                let kept = keep.map(|keep| KeptDirection::of(&self.robot, keep, &self.q));
                let play = self.planned(i, step, PlannedMove { to, speed, planner, keep })?;
                PlanStep::Planned { play, speed, planner, keep: kept }
            }
        })
    }

    fn change_tool(&mut self, index: usize, step: &ProgramStep, tool: usize) -> Result<(), Diagnostic> {
        let changed = self.robot.with_tool(tool);
        let is_taken_off = |link: LinkId| changed.payload.tools.iter().any(|t| t.link == link && !t.mounted);
        if let Some(part) = self.parts.held_by(is_taken_off) {
            let what = format!("takes off the tool that holds \"{part}\"");
            return Err(self.error(index, step, &what).hint(format!("{{ release = \"{part}\" }} before it")));
        }
        self.robot = changed;
        Ok(())
    }

    fn grip_action(
        &self,
        object: ObjectId,
        grips: bool,
        attachment: Option<Attachment>,
        step: &ProgramStep,
    ) -> GripAction {
        GripAction { object, grips, link: self.robot.flange, attachment, line: step.line }
    }

    fn segment(&mut self, index: usize, step: &ProgramStep) -> Result<Arc<Segment>, Diagnostic> {
        let flange = self.robot.flange;
        let is_known = |k: &&PlannedMoveEntry| k.step == index && k.from == self.q && k.flange == flange;
        let planned = self.planned_moves.iter().find(is_known).map(|k| k.segment.clone());
        let segment = if let Some(segment) = planned {
            segment
        } else {
            let segment = Arc::new(self.timed(index, step)?);
            let from = self.q.clone();
            self.planned_moves.push(PlannedMoveEntry { step: index, from, flange, segment: segment.clone() });
            segment
        };
        self.q = segment.end();
        Ok(segment)
    }

    /// Plans a path around everything at its place at the start of the run, or at the place where this program has put
    /// it.
    fn planned(
        &mut self,
        index: usize,
        step: &ProgramStep,
        planned: PlannedMove<'_>,
    ) -> Result<Arc<Playback>, Diagnostic> {
        let origin = PathOrigin {
            tooling: Tooling::of(self.id, &self.robot),
            step: index,
            from: self.q.clone(),
            parts: self.parts.clone(),
        };
        let play = self.paths.known_or(origin, || self.path(index, step, planned))?;
        self.q = play.q(play.duration());
        Ok(play)
    }

    fn path(
        &self,
        index: usize,
        step: &ProgramStep,
        PlannedMove { to, speed, planner, keep }: PlannedMove<'_>,
    ) -> Result<Playback, Diagnostic> {
        let carried = self.parts.carried().map_err(|e| self.part_error(index, step, e))?;
        let request = PathRequest {
            robot: Some(self.robot.name.clone()),
            from: Some(self.q.clone()),
            to: match to {
                MoveTarget::Joints(q) => PathGoal::Joints(q.clone()),
                MoveTarget::Tcp(target) => PathGoal::Tcp(target.clone()),
            },
            planner,
            tcp_motion: keep.map_or(TcpMotion::Free, TcpMotion::KeptAxis),
            speed,
            placed: self.parts.placed(),
            carried,
            ..PathRequest::default()
        };
        let answer = self.paths.ask(self.id, &self.robot, |query| {
            let volumes = query.cell().volumes_holding(self.id, &request.carried);
            Ok((query.plan(&request)?, volumes))
        });
        let (answer, volumes) =
            answer.map_err(|e| self.error(index, step, &e.message).hint(e.hint.unwrap_or_default()))?;
        let Some(timed) = answer.timed else {
            let why = answer.reason.unwrap_or_default();
            return Err(self.error(index, step, &why).hint("another target, or a joint move over a free point"));
        };
        Ok(Playback::new(timed.trajectory, &volume_motion_bounds(&self.robot.robot.chain, &volumes)))
    }

    fn part_error(&self, index: usize, step: &ProgramStep, e: PartError) -> Diagnostic {
        self.error(index, step, &e.message).hint(e.hint)
    }

    fn error(&self, index: usize, step: &ProgramStep, what: impl std::fmt::Display) -> Diagnostic {
        let what = format!("`program.{}`, step {}: {what}", self.robot.name, index + 1);
        Diagnostic::new(&self.cell.file, step.line, what)
    }

    fn timed(&mut self, index: usize, step: &ProgramStep) -> Result<Segment, Diagnostic> {
        let limits = &self.robot.limits;
        match &step.action {
            StepAction::Linear { to, speed } => {
                let line = self.line(index, step, to)?;
                let rate = if line.length() > 1e-9 { speed / line.length() } else { f64::INFINITY };
                if !line.keeps_orientation {
                    let what = "the robot has too few axes to turn the tool along this line: only the TCP follows it";
                    let note = self.error(index, step, what);
                    self.notes.push(note);
                }
                let segment = Segment::new(MovePath::TcpLine(Box::new(line)), limits, 1.0, rate)
                    .map_err(|e| self.error(index, step, &e))?;
                if segment.speed_share < 0.999 {
                    let share = segment.speed_share * 100.0;
                    let reached = self.cell.units.show_length(speed * segment.speed_share);
                    let what =
                        format!("the joints allow {share:.0} % of the programmed speed on this line: {reached}/s");
                    let note = self.error(index, step, &what);
                    self.notes.push(note);
                }
                Ok(segment)
            }
            StepAction::Joint { to, speed } => {
                let to = self.joint_target(index, step, to)?;
                let path = MovePath::Joint { from: self.q.clone(), to };
                Segment::new(path, limits, *speed, f64::INFINITY).map_err(|e| self.error(index, step, &e))
            }
            _ => Err(self.error(index, step, "is not a move")),
        }
    }

    fn line(&self, index: usize, step: &ProgramStep, to: &MoveTarget) -> Result<TcpLine, Diagnostic> {
        let to_in_root = match to {
            MoveTarget::Tcp(target) => self.robot.base_in_world.inverse_mul(&target.in_world),
            MoveTarget::Joints(q) => self.robot.tcp_in_root(q),
        };
        TcpLine::new(&self.robot, self.cell.units, &self.q, to_in_root).map_err(|error| {
            let [at, length] = [error.at_m, error.length_m].map(|m| format!("{:.1} mm", m * 1000.0));
            let what = format!("the line of {length} cannot be followed beyond {at}: {}", error.why);
            let hint = "a target within reach on this side of the arm, or a joint move to it";
            self.error(index, step, &what).hint(hint)
        })
    }

    fn joint_target(&self, index: usize, step: &ProgramStep, to: &MoveTarget) -> Result<Vec<f64>, Diagnostic> {
        match to {
            MoveTarget::Joints(q) => Ok(q.clone()),
            MoveTarget::Tcp(target) => target
                .joint_values(&self.robot, self.cell.units, &self.q)
                .map_err(|why| self.error(index, step, &why).hint("a pose within reach, or joint values")),
        }
    }

    fn playback(
        &mut self,
        program: &Program,
        trajectory: &JointTrajectory,
        passes: u64,
    ) -> Result<ProgramPlan, Diagnostic> {
        let (Some(first), Some(last)) = (trajectory.first(), trajectory.last()) else {
            return Ok(ProgramPlan::default());
        };
        let farthest = first.iter().zip(&self.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if self.robot.start_given && farthest > 1e-6 {
            let what = format!(
                "the trajectory of \"{}\" does not begin at `start`: it begins at its first row",
                self.robot.name
            );
            self.notes.push(Diagnostic::new(&self.cell.file, program.line, what).hint("leave `start` out"));
        }
        let mut plan = ProgramPlan { start: first.to_vec(), speed_override: program.speed_override, steps: Vec::new() };
        let play = Arc::new(Playback::new(trajectory.clone(), &motion_bounds(&self.robot)));
        let back = MovePath::Joint { from: last.to_vec(), to: first.to_vec() };
        let back = Segment::new(back, &self.robot.limits, 0.5, f64::INFINITY)
            .map_err(|e| Diagnostic::new(&self.cell.file, program.line, e))?;
        let back = Arc::new(back);
        for pass in 0..passes {
            if pass > 0 {
                plan.steps.push(PlanStep::Move(back.clone()));
            }
            plan.steps.push(PlanStep::Play(play.clone()));
        }
        Ok(plan)
    }
}
