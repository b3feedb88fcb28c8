//! The thread that watches the sensors of a live cell, checks the paths of the simulated robots, and plans other ones.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, SyncSender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use elbowroom_cell::configure::{self, MonitorSetup};
use elbowroom_cell::{Cell, CellSensor, Frames};
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{AccessClass, Monitor, RegionId};
use elbowroom_robot::RobotId;
use elbowroom_sim::replanning::{
    ClosedRegions, ExecutedMotion, ObjectPlaces, PathGuard, PerceivedObstacle, PerceivedObstacles, SearchTiming,
};

use super::frame_inputs::{FrameInputs, FrameSource};
use super::guarded_program::{GuardedProgram, PathCheck};
use super::joint_history::JointHistory;
use crate::clock::Clock;
use crate::control::JointsHeard;
use crate::event_handler::EventHandler;
use crate::network::Network;
use crate::node::AttachedVolumes;
use crate::service_error::ServiceError;
use crate::switch_requests::RegionSwitches;

/// So often the thread looks for pictures and new paths.
const PERIOD: Duration = Duration::from_millis(2);
/// A robot that is not heard for this long is named, s.
const SILENCE_S: f64 = 1.0;

/// The simulated programs of a process, and the objects that they grip.
#[derive(Clone)]
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
    /// Starts to guard; `None` if no sensor guards one of these robots.
    ///
    /// # Errors
    /// [`ServiceError`] if a folder of pictures cannot be read, or a robot has no joint-space map.
    pub(crate) fn start(
        programs: GuardedPrograms,
        sources: &[(String, FrameSource)],
        network: &Arc<dyn Network>,
        clock: Clock,
        on_event: Option<EventHandler>,
    ) -> Result<Option<Self>, ServiceError> {
        let is_guarded = |robot: &RobotId| programs.cell.sensors.iter().any(|sensor| sensor.robots.contains(robot));
        if !programs.programs.iter().any(|(robot, _)| is_guarded(robot)) {
            return Ok(None);
        }
        // Whatever becomes of the thread: without a check of its path no guarded robot moves.
        for (_, program) in programs.programs.iter().filter(|(robot, _)| is_guarded(robot)) {
            program.lock().unwrap_or_else(PoisonError::into_inner).check = Some(PathCheck::default());
        }
        let inputs = FrameInputs::start(&programs.cell, sources, network, clock, on_event.as_ref())?;
        let joints = JointHistory::new(&programs.cell, JointsHeard::start(&programs.cell, network, clock)?);
        let switches = RegionSwitches::start(&programs.cell, network)?;
        let sent = sources.iter().map(|(name, _)| name.clone()).collect();
        let parts = Parts { programs, inputs, joints, switches, sent, clock, on_event, silent: None };
        let is_closed = Arc::new(AtomicBool::new(false));
        let (started, is_started) = mpsc::sync_channel(1);
        let closed = is_closed.clone();
        let run = move || run(parts, &started, &closed);
        let thread = std::thread::Builder::new().name("sensors".into()).spawn(run);
        let guards = Self { is_closed, thread: thread.ok() };
        match is_started.recv() {
            Ok(Err(error)) => Err(error),
            _ => Ok(Some(guards)),
        }
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

/// What the thread works with.
struct Parts {
    programs: GuardedPrograms,
    inputs: FrameInputs,
    joints: JointHistory,
    switches: RegionSwitches,
    /// The sensors whose folder is not read.
    sent: Vec<String>,
    clock: Clock,
    on_event: Option<EventHandler>,
    /// The robot that is not heard, since when (s), and whether that was told.
    silent: Option<(RobotId, f64, bool)>,
}

fn run(mut parts: Parts, started: &SyncSender<Result<(), ServiceError>>, is_closed: &AtomicBool) {
    let programs = parts.programs.clone();
    let cell = &programs.cell;
    let begun = configure::setups(cell).and_then(|setups| Ok((configure::monitors(cell, &setups)?, setups)));
    let guarded = begun.and_then(|(monitors, setups)| {
        let mut notes = Vec::new();
        let is_sent = |sensor: &CellSensor| parts.sent.contains(&sensor.name);
        let perceived = PerceivedObstacles::of_live_cell(cell, is_sent, &mut notes)?;
        for note in &notes {
            tell(parts.on_event.as_ref(), &format!("warning: {note}"));
        }
        let robots = setups.into_iter().zip(monitors).enumerate();
        let robots = robots.filter_map(|(i, guards)| GuardedRobot::new(&programs, RobotId(i), guards, &perceived));
        let robots = robots.collect::<Result<Vec<_>, _>>()?;
        Ok((perceived, robots))
    });
    let (mut perceived, mut robots) = match guarded {
        Ok(guarded) => guarded,
        Err(error) => {
            // Nobody waits for an error after the service was dropped.
            let _ = started.send(Err(error.into()));
            return;
        }
    };
    let _ = started.send(Ok(()));
    while !is_closed.load(Ordering::SeqCst) {
        parts.step(cell, &mut perceived, &mut robots);
        std::thread::sleep(PERIOD);
    }
}

fn tell(on_event: Option<&EventHandler>, what: &str) {
    if let Some(on_event) = on_event {
        on_event(what);
    }
}

impl Parts {
    /// Processes what was sent, and checks the paths for which something has changed.
    fn step(&mut self, cell: &Cell, perceived: &mut PerceivedObstacles<'_>, robots: &mut [GuardedRobot<'_>]) {
        let t_s = self.clock.seconds();
        let silent = self.joints.update(cell, t_s).err();
        self.tell_of_silence(cell, silent, t_s);
        if silent.is_some() {
            // Where a robot is that is not heard, nobody knows: no picture can be used, and soon the sensors count as silent.
            return;
        }
        let mut has_news = perceived.process_due(t_s, &|taken_s| self.joints.at(taken_s));
        while let Some(frame) = self.inputs.next() {
            let q = self.joints.at(frame.taken_s);
            let processed = perceived.process(&frame.sensor, &frame.bytes, frame.taken_s, &q);
            has_news |= processed.is_some_and(|(_, is_accepted)| is_accepted);
        }
        let objects = self.programs.objects.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let around = Around { cell, states: self.joints.states(), objects: &objects, t_s };
        for robot in robots {
            self.switches.apply(&mut robot.monitor, &robot.setup);
            let named = self.joints.attached(robot.guard.robot());
            robot.attached.apply(named, &mut robot.monitor, |_, _| ());
            if robot.step(&around, perceived, has_news) {
                let name = &cell.robots[robot.guard.robot().0].name;
                tell(self.on_event.as_ref(), &format!("{name}: continues on a new path"));
            }
        }
    }

    /// Names a robot that is not heard for a while: the robots that the sensors guard wait for it.
    fn tell_of_silence(&mut self, cell: &Cell, silent: Option<RobotId>, t_s: f64) {
        let since = |robot: &RobotId| self.silent.filter(|(before, ..)| before == robot);
        self.silent = silent.map(|robot| since(&robot).unwrap_or((robot, t_s, false)));
        if let Some((robot, since_s, is_told)) = &mut self.silent
            && !*is_told
            && t_s - *since_s > SILENCE_S
        {
            *is_told = true;
            let name = &cell.robots[robot.0].name;
            let what = format!("{name}: its joint values are not received; the robots that sensors guard wait");
            tell(self.on_event.as_ref(), &what);
        }
    }
}

/// What is around the robots at an instant.
struct Around<'a> {
    cell: &'a Cell,
    states: &'a [ChainState],
    objects: &'a ObjectPlaces,
    t_s: f64,
}

/// A robot whose path is checked.
struct GuardedRobot<'a> {
    guard: PathGuard<'a>,
    program: Arc<Mutex<GuardedProgram>>,
    setup: MonitorSetup,
    /// It has the regions and volumes of the robot as they are now, for questions: it never ticks.
    monitor: Monitor,
    attached: AttachedVolumes,
}

impl<'a> GuardedRobot<'a> {
    /// `None` for a robot of another process, or that no sensor guards.
    fn new(
        programs: &'a GuardedPrograms,
        robot: RobotId,
        (setup, monitor): (MonitorSetup, Monitor),
        perceived: &PerceivedObstacles<'_>,
    ) -> Option<Result<Self, elbowroom_formats::FormatError>> {
        let cell: &'a Cell = &programs.cell;
        let search_s = perceived.search_s(robot)?;
        let (_, program) = programs.programs.iter().find(|(id, _)| *id == robot)?;
        let mut states: Vec<ChainState> = cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
        for (state, robot) in states.iter_mut().zip(&cell.robots) {
            state.q.copy_from_slice(&robot.start);
        }
        let mut shared = program.lock().unwrap_or_else(PoisonError::into_inner);
        let guard = PathGuard::new(cell, (robot, &shared.clock), (search_s, SearchTiming::Live), &states);
        shared.check =
            Some(PathCheck { sights: perceived.last_sights(robot).cloned().collect(), ..PathCheck::default() });
        drop(shared);
        let attached = AttachedVolumes::new(&setup.configuration);
        Some(guard.map(|guard| Self { guard, program: program.clone(), setup, monitor, attached }))
    }

    /// Checks the path if that is due, and searches for another one. Returns whether the robot is on a new one.
    fn step(&mut self, around: &Around<'_>, perceived: &PerceivedObstacles<'_>, has_news: bool) -> bool {
        let robot = self.guard.robot();
        let mut program = self.program.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = self.guard.is_due(program.clock.path_number(), has_news);
        let motion = is_due.then(|| program.clock.executed_motion());
        if let Some(check) = &mut program.check {
            check.sights.clear();
            check.sights.extend(perceived.last_sights(robot).cloned());
        }
        drop(program);
        let Some(motion) = motion else { return false };
        let seen = perceived.obstacles(robot).cloned().collect();
        self.observe(around, &motion, perceived, seen);
        self.say_checked();
        self.guard.is_search_due(around.t_s, motion.path) && self.search(around, &motion)
    }

    fn observe(
        &mut self,
        around: &Around<'_>,
        motion: &ExecutedMotion,
        perceived: &PerceivedObstacles<'_>,
        seen: Vec<PerceivedObstacle>,
    ) {
        let Around { cell, states, objects, t_s } = *around;
        let (setup, monitor) = (&self.setup, &self.monitor);
        let regions = || ClosedRegions { monitor, sources: Frames::new(cell).sources(&setup.sources, states, t_s) };
        let surroundings = || objects.surroundings(cell, states, t_s, seen);
        self.guard.observe(t_s, motion, perceived, surroundings, regions);
    }

    fn search(&mut self, around: &Around<'_>, motion: &ExecutedMotion) -> bool {
        let Around { cell, states, objects, t_s } = *around;
        let (setup, monitor, program) = (&self.setup, &self.monitor, &self.program);
        let regions = || ClosedRegions { monitor, sources: Frames::new(cell).sources(&setup.sources, states, t_s) };
        let surroundings = |seen| objects.surroundings(cell, states, t_s, seen);
        self.guard.end_search(t_s, motion, surroundings, regions, |new| {
            let mut program = program.lock().unwrap_or_else(PoisonError::into_inner);
            let entered = new.enter(&mut program.clock);
            if entered {
                // The search has proven it free of what was seen; the next step checks it against what is seen by then.
                let path = Some(program.clock.path_number());
                program.check.iter_mut().for_each(|check| (check.path, check.blocked) = (path, None));
            }
            entered
        })
    }

    /// Passes the result of the check to the controller.
    fn say_checked(&self) {
        let (path, blocked) = self.guard.checked();
        let mut program = self.program.lock().unwrap_or_else(PoisonError::into_inner);
        program.check.iter_mut().for_each(|check| (check.path, check.blocked) = (path, blocked.cloned()));
    }
}

impl RegionSwitches {
    /// Switches the regions of a monitor as the table of regions says.
    fn apply(&self, monitor: &mut Monitor, setup: &MonitorSetup) {
        for (local, region) in setup.regions.iter().enumerate() {
            // Of a permanent region it is refused, which leaves it on.
            let _ = monitor.switch(RegionId(local), self.is_on(*region), AccessClass::Programmer);
        }
    }
}
