//! Simulation of a cell: programs on one clock, under the monitors.

mod avoiding_robot;
mod carried_parts;
mod carrying;
mod contact_recorder;
mod deadlock_detector;
mod end_detector;
mod fault_injection;
mod final_waits;
mod finish;
mod guided_robot;
mod idle_detector;
mod journal;
mod observation;
mod observer;
mod options;
mod outcome;
mod override_delay;
mod own_motion;
mod region_recorder;
mod release;
mod run_end;
mod sensor_guards;
mod simulated_robot;
mod simulation;
mod stop_state;
mod virtual_robot;
mod zone_claims;

use elbowroom_cell::configure;
use elbowroom_cell::{Cell, CellRobot, Frames};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::{Robot, RobotId};
use elbowroom_scene::Scene;

use crate::motion::{PlannedPaths, ProgramClock, ProgramPlan, plan};
use crate::recording::{Recording, RegionTrack};
use crate::replanning::{PathGuard, PathReplanner, PerceivedObstacles, SearchTiming};
use avoiding_robot::AvoidingRobot;
pub use avoiding_robot::evasion_limits;
use contact_recorder::ContactRecorder;
use deadlock_detector::DeadlockDetector;
use end_detector::EndDetector;
use fault_injection::FaultInjector;
pub use fault_injection::{InputFault, InputFaultKind};
use guided_robot::GuidedRobot;
use journal::Journal;
pub use observer::{ObservedInstant, ObservedTick, RunObserver};
pub use options::{RunOptions, RunProgress, SilentFrom};
use own_motion::OwnMotion;
use region_recorder::RegionRecorder;
use simulated_robot::SimulatedRobot;
use simulation::Simulation;
use virtual_robot::{CooperatingRobot, CooperatingRobots};
use zone_claims::ZoneClaims;

/// Result of a simulation.
#[derive(Debug, Clone)]
pub struct RunOutcome {
    /// The recording.
    pub recording: Recording,
    /// Notes on the programs: speeds beyond the joint limits, and the like.
    pub notes: Vec<Diagnostic>,
}

impl RunOutcome {
    /// True if a robot collided, a forbidden region was entered, or robots are in a deadlock: exit status 1. Collisions of
    /// mechanisms count if a robot takes part in them.
    pub fn has_violation(&self) -> bool {
        let r = &self.recording;
        r.robots.iter().any(|r| !r.collisions.is_empty() && !r.is_mechanism())
            || r.regions.iter().any(RegionTrack::is_violated)
            || !r.deadlocks.is_empty()
    }
}

/// Simulates the programs of a cell.
///
/// All robot states of an instant are computed before the first monitor runs, so followed frames have no latency; the
/// override of a tick applies to the motion from this tick to the next.
///
/// # Errors
/// [`Diagnostic`] at the line of an infeasible step. The error comes before any motion, except if a part that another
/// robot moves cannot be gripped.
pub fn simulate(cell: &Cell, options: &RunOptions) -> Result<RunOutcome, Diagnostic> {
    simulate_observed(&PlannedPaths::new(cell), options, &mut |_| {}, None)
}

/// Like [`simulate`], with paths that may be known already, a progress callback, and an observer of the monitors'
/// ticks.
///
/// The observer can, for example, record the ticks.
///
/// # Errors
/// As for [`simulate`].
pub fn simulate_observed(
    paths: &PlannedPaths<'_>,
    options: &RunOptions,
    progress: &mut dyn FnMut(RunProgress),
    observer: Option<&mut dyn RunObserver>,
) -> Result<RunOutcome, Diagnostic> {
    let (cell, mut notes) = (paths.cell(), Vec::new());
    let setups = configure::setups(cell)?;
    let arbiter = configure::zone_arbiter(cell);
    let monitors = configure::monitors_with(cell, &setups, arbiter.as_ref())?;
    let perceived = PerceivedObstacles::of_cell(cell, &mut notes)?;
    let mut robots = Vec::new();
    for (i, (setup, monitor)) in setups.iter().zip(monitors).enumerate() {
        let plan = plan(paths, RobotId(i), options.repeat, &mut notes)?;
        let arbiter = arbiter.as_deref().filter(|_| keeps_to_plan(cell, options, RobotId(i), &plan, &perceived));
        let claims = arbiter.and_then(|arbiter| ZoneClaims::of_plan(cell, RobotId(i), setup, &plan, arbiter));
        let clock = ProgramClock::new(plan, cell.robots[i].limits.clone());
        robots.push(SimulatedRobot::new(cell, RobotId(i), setup, monitor, clock, claims));
    }
    let scene = cell.scene_of_guidance()?;
    let virtual_robots = own_motions(cell, &scene, options, &mut robots, &mut notes)?;
    let models: Vec<Robot> = cell.robots.iter().map(CellRobot::with_all_tools).collect();
    let states: Vec<ChainState> = cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
    for robot in &mut robots {
        let avoids = robot.own_motion.avoiding().is_some();
        robot.guard = path_guard(cell, (robot.id, &robot.clock), avoids, &perceived, &states, &mut notes)?;
    }
    let journal = Journal::new(cell, observer.map(|observer| observer as &mut dyn RunObserver));
    let mut run = Simulation {
        cell,
        options,
        states,
        arbiter,
        deadlocks: DeadlockDetector::new(cell.robots.len()),
        perceived: Some(perceived),
        frames: Frames::new(cell),
        fault_injector: FaultInjector::new(&options.faults, cell.robots.len()),
        regions: RegionRecorder::new(cell, &setups),
        contacts: ContactRecorder::new(cell, &models),
        released: Vec::new(),
        virtual_robots,
        ends: EndDetector::new(cell),
        journal,
        robots,
    };
    let (t_s, end) = run.run(progress)?;
    notes.extend(run.robots.iter().filter_map(|robot| robot.own_motion.avoiding()?.fault_warning(cell)));
    notes.extend(run.virtual_robots.iter().filter_map(|robots| robots.warning(cell)));
    run.perceived.iter_mut().for_each(|p| p.take_warnings(&mut notes));
    Ok(RunOutcome { recording: run.finish(t_s, end), notes })
}

/// Gives robots what moves them besides their programs; returns the virtual robots.
fn own_motions<'a>(
    cell: &'a Cell,
    scene: &'a Scene,
    options: &RunOptions,
    robots: &mut [SimulatedRobot<'a>],
    notes: &mut Vec<Diagnostic>,
) -> Result<Vec<CooperatingRobots<'a>>, Diagnostic> {
    if options.avoidance {
        for robot in robots.iter_mut() {
            if let Some(avoiding) = AvoidingRobot::of_robot(cell, scene, robot.id, &robot.clock)? {
                robot.own_motion = OwnMotion::Avoiding(Box::new(avoiding));
            }
        }
    }
    for robot in robots.iter_mut() {
        if let Some(guided) = GuidedRobot::of_robot(cell, scene, robot.id, notes)? {
            robot.own_motion = OwnMotion::Guided(Box::new(guided));
        }
    }
    let mut virtual_robots = Vec::new();
    for spec in &cell.guidance.virtual_robots {
        virtual_robots.push(CooperatingRobots::new(spec, cell, scene)?);
        for member in &spec.members {
            let own_motion = CooperatingRobot::new(&cell.robots[member.robot.0].start);
            robots[member.robot.0].own_motion = OwnMotion::Cooperating(Box::new(own_motion));
        }
    }
    Ok(virtual_robots)
}

/// True if the robot keeps to its program, so that its claims are known.
///
/// A robot with avoidance, or with planned moves around obstacles that sensors see, may leave its program; a guided one
/// has none.
fn keeps_to_plan(
    cell: &Cell,
    options: &RunOptions,
    robot: RobotId,
    plan: &ProgramPlan,
    perceived: &PerceivedObstacles<'_>,
) -> bool {
    let avoids = options.avoidance && cell.robots[robot.0].avoidance.is_some();
    let replans = plan.has_planned_moves() && perceived.search_s(robot).is_some();
    let guidance = &cell.guidance;
    let is_guided = guidance.operator_of(robot).is_some() || guidance.virtual_robot_of(robot).is_some();
    options.apply_override && !avoids && !replans && !is_guided
}

/// The guard of a robot against what sensors see; `None` for one that no sensor guards.
fn path_guard<'a>(
    cell: &'a Cell,
    (id, clock): (RobotId, &ProgramClock),
    avoids: bool,
    perceived: &PerceivedObstacles<'_>,
    states: &[ChainState],
    notes: &mut Vec<Diagnostic>,
) -> Result<Option<(PathGuard, PathReplanner<'a>)>, Diagnostic> {
    let Some(search_s) = perceived.search_s(id) else { return Ok(None) };
    if !avoids {
        return PathGuard::new(cell, (id, clock), (search_s, SearchTiming::Simulated), states).map(Some);
    }
    let robot = &cell.robots[id.0];
    let what = format!(
        "robot \"{}\" has [avoidance.{}], which does not know what sensors see: it does not keep clear of that",
        robot.name, robot.name
    );
    notes.push(
        Diagnostic::new(&cell.file, robot.line, what).hint("run --no-avoidance, or robots = [...] of the sensor"),
    );
    Ok(None)
}
