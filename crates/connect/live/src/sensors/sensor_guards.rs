//! Guards simulated programs by the sensors of a live cell: a thread processes pictures and checks paths, one more per robot
//! searches for other paths.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, SyncSender};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, Scope};
use std::time::Duration;

use elbowroom_cell::{Cell, CellRobot, CellSensor, configure};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;
use elbowroom_sim::replanning::{ObjectPlaces, PathGuard, PathReplanner, PerceivedObstacles, SearchTiming};

use super::checked_robot::{CellView, CheckedRobot};
use super::frame_inputs::{FrameInput, FrameInputs};
use super::guarded_program::{GuardedProgram, PathCheck};
use super::joint_history::JointHistory;
use super::path_worker::work;
use super::robot_regions::RobotRegions;
use super::sensor_news::SensorNews;
use crate::clock::Clock;
use crate::event_handler::EventHandler;
use crate::locked::locked;
use crate::network::Network;
use crate::service_error::ServiceError;
use crate::switch_requests::RegionSwitches;

/// So often the thread looks for pictures and new paths.
const PERIOD: Duration = Duration::from_millis(2);

/// The simulated programs of a process, and the objects that they grip.
pub(crate) struct GuardedPrograms {
    pub cell: Arc<Cell>,
    pub programs: Vec<(RobotId, Arc<Mutex<GuardedProgram>>)>,
    pub objects: Arc<Mutex<ObjectPlaces>>,
}

/// Guards simulated programs by the sensors of their cell. It ends when it is dropped: the robots stop then.
pub(crate) struct SensorGuards {
    is_closed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl SensorGuards {
    /// Starts to guard; `None` if no sensor guards one of these robots. `controllers` is the network of their joint values.
    ///
    /// # Errors
    /// [`ServiceError`] if a folder of pictures cannot be read, a robot has no joint-space map, or a thread cannot be started.
    pub(crate) fn start(
        programs: GuardedPrograms,
        sources: &[(String, FrameInput)],
        (network, controllers): (&Arc<dyn Network>, &Arc<dyn Network>),
        clock: Clock,
        on_event: Option<EventHandler>,
    ) -> Result<Option<Self>, ServiceError> {
        let cell = &programs.cell;
        let is_guarded = |robot: &RobotId| cell.sensors.iter().any(|sensor| sensor.robots.contains(robot));
        if !programs.programs.iter().any(|(robot, _)| is_guarded(robot)) {
            return Ok(None);
        }
        // Whatever becomes of the thread: without a check of its path no guarded robot moves.
        for (_, program) in programs.programs.iter().filter(|(robot, _)| is_guarded(robot)) {
            locked(program).check = Some(PathCheck::default());
        }
        let inputs = Inputs {
            frames: FrameInputs::start(cell, sources, network, clock, on_event.as_ref())?,
            joints: JointHistory::start(cell, controllers, clock)?,
            switches: RegionSwitches::start(cell, network)?,
            sent: sources.iter().map(|(name, _)| name.clone()).collect(),
            news: SensorNews::new(on_event),
            clock,
        };
        let is_closed = Arc::new(AtomicBool::new(false));
        let (started, is_started) = mpsc::sync_channel(1);
        let closed = is_closed.clone();
        let run = move || std::thread::scope(|scope| run(scope, &programs, inputs, &started, &closed));
        let thread = std::thread::Builder::new().name("sensors".into()).spawn(run).map_err(ServiceError::Thread)?;
        match is_started.recv() {
            Ok(Ok(())) => Ok(Some(Self { is_closed, thread: Some(thread) })),
            Ok(Err(error)) => Err(error),
            Err(_) => Err(ServiceError::Thread(std::io::Error::other("the thread of the sensors has ended"))),
        }
    }

    /// False if the thread has ended: then nothing that it guarded moves any more.
    pub(crate) fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for SensorGuards {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What the thread listens to.
struct Inputs {
    frames: FrameInputs,
    joints: JointHistory,
    switches: RegionSwitches,
    /// The sensors whose pictures do not come from their folder.
    sent: Vec<String>,
    news: SensorNews,
    clock: Clock,
}

fn run<'scope, 'env>(
    scope: &'scope Scope<'scope, 'env>,
    programs: &'env GuardedPrograms,
    mut inputs: Inputs,
    started: &SyncSender<Result<(), ServiceError>>,
    is_closed: &AtomicBool,
) {
    let guarded = guard(scope, programs, &mut inputs);
    let (mut perceived, mut robots) = match guarded {
        Ok(guarded) => guarded,
        Err(error) => {
            // The service may have been dropped; then the error has no receiver.
            let _ = started.send(Err(error));
            return;
        }
    };
    let _ = started.send(Ok(()));
    while !is_closed.load(Ordering::SeqCst) {
        inputs.step(programs, &mut perceived, &mut robots, is_closed);
        std::thread::sleep(PERIOD);
    }
}

/// The sensors, and the guarded robots with their threads that search.
fn guard<'scope, 'env>(
    scope: &'scope Scope<'scope, 'env>,
    programs: &'env GuardedPrograms,
    inputs: &mut Inputs,
) -> Result<(PerceivedObstacles<'env>, Vec<CheckedRobot>), ServiceError> {
    let cell: &'env Cell = &programs.cell;
    let mut notes = Vec::new();
    let robots: Vec<RobotId> = programs.programs.iter().map(|(robot, _)| *robot).collect();
    let is_sent = |sensor: &CellSensor| inputs.sent.contains(&sensor.name);
    let perceived = PerceivedObstacles::of_live_cell(cell, &robots, is_sent, &mut notes)?;
    inputs.news.warn(&notes);
    let mut guarded = Vec::new();
    for (robot, program) in &programs.programs {
        let Some(search_s) = perceived.search_s(*robot) else { continue };
        let (guard, replanner) = path_guard(cell, *robot, program, search_s)?;
        let (of_guard, of_worker) = (regions(cell, *robot)?, regions(cell, *robot)?);
        let (robot, (jobs, results)) = CheckedRobot::new(guard, program.clone(), of_guard);
        let work = move || work(replanner, of_worker, &jobs, &results);
        std::thread::Builder::new().name("paths".into()).spawn_scoped(scope, work).map_err(ServiceError::Thread)?;
        guarded.push(robot);
    }
    Ok((perceived, guarded))
}

fn path_guard<'c>(
    cell: &'c Cell,
    robot: RobotId,
    program: &Mutex<GuardedProgram>,
    search_s: f64,
) -> Result<(PathGuard, PathReplanner<'c>), Diagnostic> {
    let at_start = |robot: &CellRobot| {
        let mut state = ChainState::new(&robot.robot.chain);
        state.q.copy_from_slice(&robot.start);
        state
    };
    let states: Vec<ChainState> = cell.robots.iter().map(at_start).collect();
    let program = locked(program);
    PathGuard::new(cell, (robot, &program.clock), (search_s, SearchTiming::Live), &states)
}

fn regions(cell: &Cell, robot: RobotId) -> Result<RobotRegions, Diagnostic> {
    let mut setups = configure::setups(cell)?;
    let mut monitors = configure::monitors(cell, &setups)?;
    Ok(RobotRegions::new(setups.swap_remove(robot.0), monitors.swap_remove(robot.0)))
}

impl Inputs {
    /// Processes what was sent, and checks the paths for which something has changed.
    fn step(
        &mut self,
        programs: &GuardedPrograms,
        perceived: &mut PerceivedObstacles<'_>,
        robots: &mut [CheckedRobot],
        is_closed: &AtomicBool,
    ) {
        let cell = &*programs.cell;
        for robot in &mut *robots {
            if robot.take_result(self.clock.seconds()) {
                self.news.tell(&format!("{}: continues on a new path", cell.robots[robot.robot().0].name));
            }
        }
        let silent = self.joints.update(cell).err();
        self.news.silence(cell, silent, self.clock.seconds());
        if silent.is_some() {
            // Where a robot is that is not heard, nobody knows: no picture can be used, and soon the sensors count as silent.
            return;
        }
        let has_news = self.process(perceived, is_closed);
        for robot in robots.iter_mut().filter(|_| !is_closed.load(Ordering::SeqCst)) {
            let Self { joints, switches, clock, .. } = self;
            robot.check(
                clock.seconds(),
                &CellView { cell, joints, objects: &programs.objects, switches, perceived },
                has_news,
            );
        }
    }

    /// Processes what was sent up to now; returns whether something was accepted.
    fn process(&mut self, perceived: &mut PerceivedObstacles<'_>, is_closed: &AtomicBool) -> bool {
        let joints = &self.joints;
        let here = || joints.states().iter().map(|state| state.q.clone()).collect();
        let mut has_news =
            perceived.process_due(self.clock.seconds(), &|taken_s| joints.at(taken_s).unwrap_or_else(here));
        for frame in self.frames.take() {
            if is_closed.load(Ordering::SeqCst) {
                return has_news;
            }
            match joints.at(frame.taken_s) {
                Some(q) => has_news |= perceived.process(&frame.sensor, &frame.bytes, frame.taken_s, &q),
                None => perceived.reject(&frame.sensor, "where the robots were when it was taken is not known"),
            }
        }
        let mut notes = Vec::new();
        perceived.take_warnings(&mut notes);
        self.news.warn(&notes);
        self.news.rejections(perceived.rejections());
        has_news
    }
}
