//! Simulated controllers: run the programs of the cell file under the overrides that arrive.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, SyncSender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use elbowroom_cell::{Cell, configure};
use elbowroom_interlock::Micros;
use elbowroom_robot::RobotId;
use elbowroom_sim::motion::{PlanStep, PlannedPaths, ProgramClock, ProgramPlan, plan};
use elbowroom_sim::replanning::ObjectPlaces;

use crate::carried_volumes::CarriedVolumes;
use crate::client::{ControllerClient, ControllerState};
use crate::clock::{Clock, boot_number};
use crate::configuration_number::configuration_number;
use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, Publisher, Subscription, Urgency};
use crate::sensors::{FrameInput, GuardedProgram, GuardedPrograms, SensorGuards};
use crate::service_error::ServiceError;
use crate::switch_requests::SwitchRequests;

/// A thread that is late by more than this many ticks does not catch up: its robots have paused in the meantime.
const MOST_LATE_TICKS: u32 = 5;

/// Controllers of simulated robots. They end when they are dropped.
pub struct SimulatedControllers {
    is_closed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedControllers {
    /// Starts the programs of these robots. When a program has finished it begins again, from where it ended. `frames` are the sensors
    /// whose pictures do not come from the folder of the cell file; `of_controllers` is the network of all controllers' joint values.
    ///
    /// # Errors
    /// [`ServiceError`] if a program cannot be planned, or a sensor not be used.
    pub(crate) fn start(
        cell: &Arc<Cell>,
        robots: &[RobotId],
        frames: &[(String, FrameInput)],
        (network, of_controllers): (&Arc<dyn Network>, &Arc<dyn Network>),
        (clock, on_event): (Clock, Option<EventHandler>),
    ) -> Result<Self, ServiceError> {
        let is_closed = Arc::new(AtomicBool::new(false));
        let (started, is_started) = mpsc::sync_channel(1);
        let thread = {
            let (robots, network, is_closed) = (robots.to_vec(), network.clone(), is_closed.clone());
            let of_controllers = of_controllers.clone();
            let start = Start { cell: cell.clone(), frames: frames.to_vec(), network, of_controllers, clock, on_event };
            move || run(&start, &robots, &started, &is_closed)
        };
        let thread = std::thread::Builder::new().name("controllers".into()).spawn(thread);
        let controllers = Self { is_closed, thread: thread.ok() };
        match is_started.recv() {
            Ok(Err(error)) => Err(error),
            _ => Ok(controllers),
        }
    }

    /// False if the thread has ended.
    pub fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for SimulatedControllers {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What the controllers start with.
struct Start {
    cell: Arc<Cell>,
    frames: Vec<(String, FrameInput)>,
    network: Arc<dyn Network>,
    of_controllers: Arc<dyn Network>,
    clock: Clock,
    on_event: Option<EventHandler>,
}

fn run(start: &Start, robots: &[RobotId], started: &SyncSender<Result<(), ServiceError>>, is_closed: &AtomicBool) {
    let Start { cell, clock, .. } = start;
    let (mut controllers, sensors) = match controllers(start, robots) {
        Ok(controllers) => controllers,
        Err(error) => {
            // The service may have been dropped; then the error has no receiver.
            let _ = started.send(Err(error));
            return;
        }
    };
    let _ = started.send(Ok(()));
    let period = Duration::from_secs_f64(cell.timing.tick_s);
    // The joint values of a simulated robot are those at the nominal time of its tick, however late the thread is. The
    // nominal time is the clock's, which continues while the computer sleeps.
    let period_us = period.as_micros() as u64;
    let mut due = clock.micros();
    // Without the thread of the sensors no robot that they guard moves: then the service ends, and says so.
    let is_guarded = || sensors.as_ref().is_none_or(SensorGuards::is_running);
    while !is_closed.load(Ordering::SeqCst) && is_guarded() {
        for controller in &mut controllers {
            controller.tick(due, *clock);
        }
        due = due + Micros(period_us);
        let now = clock.micros();
        if now > due + Micros(period_us * u64::from(MOST_LATE_TICKS)) {
            due = now;
        }
        std::thread::sleep(Duration::from_micros((due - now).0));
    }
}

/// The controllers, and what guards their programs by sensors.
fn controllers(
    start: &Start,
    robots: &[RobotId],
) -> Result<(Vec<SimulatedController>, Option<SensorGuards>), ServiceError> {
    let Start { cell, frames, network, of_controllers, clock, on_event } = start;
    let (objects, setups) = (Arc::new(Mutex::new(ObjectPlaces::new(cell))), configure::setups(cell)?);
    let carried = |robot: RobotId| CarriedVolumes::new(cell, robot, setups[robot.0].clone(), objects.clone());
    let controller = |robot: &RobotId| SimulatedController::new(start, *robot, carried(*robot));
    let controllers = robots.iter().map(controller).collect::<Result<Vec<_>, _>>()?;
    let programs = robots.iter().zip(&controllers).map(|(robot, c)| (*robot, c.program.clone())).collect();
    let programs = GuardedPrograms { cell: cell.clone(), programs, objects };
    let sensors = SensorGuards::start(programs, frames, (network, of_controllers), *clock, on_event.clone())?;
    Ok((controllers, sensors))
}

/// The controller of one robot.
struct SimulatedController {
    name: String,
    program: Arc<Mutex<GuardedProgram>>,
    /// The program for its repetitions, starting at its end.
    again: Option<ProgramPlan>,
    tick_s: f64,
    /// Time until a command takes effect, s.
    reaction_s: f64,
    carried: CarriedVolumes,
    client: Arc<Mutex<ControllerClient>>,
    /// False for a mechanism, which follows no override.
    obeys: bool,
    joint_states: Box<dyn Publisher>,
    switches: SwitchRequests,
    velocity: Vec<f64>,
    bytes: Vec<u8>,
    on_event: Option<EventHandler>,
    _answers: Subscription,
}

impl SimulatedController {
    fn new(start: &Start, robot: RobotId, carried: CarriedVolumes) -> Result<Self, ServiceError> {
        let Start { cell, network, on_event, .. } = start;
        let at = &cell.robots[robot.0];
        let keys = Keys::new(&cell.name);
        let paths = PlannedPaths::new(cell);
        let once = plan(&paths, robot, 1, &mut Vec::new())?;
        let again = repetition(&paths, robot, &once);
        let watchdog = Micros::from_seconds(cell.monitoring.laws.stale_s);
        let client = ControllerClient::new(boot_number(), configuration_number(cell)).with_watchdog(watchdog);
        let client = Arc::new(Mutex::new(client));
        let answers = {
            let client = client.clone();
            let handler = Box::new(move |bytes: &[u8]| {
                // A refused answer is of another start, or late: the watchdog handles that.
                let _ = locked(&client).receive(bytes);
            });
            network.subscribe(&keys.speed_override(&at.name), handler)?
        };
        Ok(Self {
            name: at.name.clone(),
            program: Arc::new(Mutex::new(GuardedProgram::new(ProgramClock::new(once, at.limits.clone())))),
            again,
            tick_s: cell.timing.tick_s,
            reaction_s: cell.monitoring.reaction_delay_s,
            carried,
            client,
            obeys: !at.is_mechanism(),
            joint_states: network.publisher(&keys.joint_states(&at.name), Urgency::RealTime)?,
            switches: SwitchRequests::new(cell, robot, network)?,
            velocity: Vec::new(),
            bytes: Vec::new(),
            on_event: on_event.clone(),
            _answers: answers,
        })
    }

    /// Advances by a tick under the present override, and sends the joint state to the node.
    fn tick(&mut self, nominal: Micros, clock: Clock) {
        let now = clock.micros();
        let speed_override = if self.obeys { locked(&self.client).speed_override(now) } else { 1.0 };
        let shared = self.program.clone();
        let mut program = locked(&shared);
        let (is_held, news) = program.must_hold(clock.seconds(), self.reaction_s, self.tick_s);
        let clock_of_program = &mut program.clock;
        clock_of_program.advance(self.tick_s, if is_held { 0.0 } else { speed_override });
        self.carry_out(clock_of_program, clock.seconds());
        if let Some(again) = self.again.as_ref().filter(|_| clock_of_program.finished()) {
            clock_of_program.restart(again.clone());
            // Whoever reads the new path must know what is gripped at its start.
            self.carry_out(clock_of_program, clock.seconds());
        }
        self.velocity.clear();
        self.velocity.extend(clock_of_program.velocity());
        let state = ControllerState {
            q: &clock_of_program.point().q,
            qd: &self.velocity,
            intent: clock_of_program.intent(),
            // A robot that is held is not commanded to move: its constant joint values are no frozen reading.
            programmed_override: if is_held { 0.0 } else { clock_of_program.programmed_override() },
            attached: self.carried.volumes(),
            stamp: Some(nominal),
        };
        self.bytes.clear();
        self.bytes.extend_from_slice(locked(&self.client).joint_state(now, &state));
        drop(program);
        self.joint_states.publish(&self.bytes);
        self.switches.send();
        if let (Some(news), Some(on_event)) = (news, &self.on_event) {
            on_event(&format!("{}: {news}", self.name));
        }
    }

    /// Switches regions, exchanges tools, grips and releases as the program has said since the last call.
    fn carry_out(&mut self, program: &mut ProgramClock, t_s: f64) {
        for switch in program.take_switches() {
            self.switches.want(switch.region, switch.active);
        }
        self.carried.follow(program, t_s);
    }
}

/// Plans the repetition of a program, from its end: the steps of a second pass. `None` for a robot without a program,
/// or if a third pass would not begin where the second one began.
fn repetition(paths: &PlannedPaths<'_>, robot: RobotId, once: &ProgramPlan) -> Option<ProgramPlan> {
    let twice = plan(paths, robot, 2, &mut Vec::new()).ok()?;
    let steps = twice.steps.get(once.steps.len()..).filter(|steps| !steps.is_empty())?;
    let end = |plan: &ProgramPlan| plan.steps.iter().rev().find_map(PlanStep::end);
    let (first, second) = (end(once)?, end(&twice)?);
    let is_closed = first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-9);
    is_closed.then(|| ProgramPlan { start: first, speed_override: once.speed_override, steps: steps.to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::{JointState, OverrideAnswer};
    use crate::network::LocalNetwork;

    const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.arm]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }]
links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }]
[object.part]
shape = "box"
at = [450, 0, 0]
size = [60, 60, 60]
[program.arm]
steps = [{ grip = "part" }, { move = "joint", to = [20] }, { move = "joint", to = [0] }, { release = "part" }]
"#;

    /// Whoever reads a program between two ticks sees all that it has gripped, also at the start of a repetition.
    #[test]
    fn between_ticks_nothing_that_a_program_gripped_is_unknown() {
        let cell = Arc::new(Cell::parse("grip.toml", CELL).unwrap());
        let network: Arc<dyn Network> = Arc::new(LocalNetwork::default());
        let (of_controllers, clock) = (network.clone(), Clock::start());
        let start = Start { cell: cell.clone(), frames: Vec::new(), network, of_controllers, clock, on_event: None };
        let (mut controllers, _) = controllers(&start, &[RobotId(0)]).unwrap();
        let keys = Keys::new(&cell.name);
        let said = Arc::new(Mutex::new(Vec::new()));
        let heard = said.clone();
        let handler = Box::new(move |bytes: &[u8]| *locked(&heard) = bytes.to_vec());
        let _states = start.network.subscribe(&keys.joint_states("arm"), handler).unwrap();
        let mut answers = start.network.publisher(&keys.speed_override("arm"), Urgency::RealTime).unwrap();
        let (mut repetitions, mut before) = (0, 0);
        for sequence in 1..=6000 {
            controllers[0].tick(clock.micros(), clock);
            let mut state = JointState::default();
            state.decode(&locked(&said)).unwrap();
            let mut bytes = Vec::new();
            let JointState { checksum, boot, sequence: echo, .. } = state;
            let answer = OverrideAnswer { checksum, boot, echo, sequence, speed_override: 1.0, ..Default::default() };
            answer.encode(&mut bytes);
            answers.publish(&bytes);
            let mut program = locked(&controllers[0].program);
            assert!(program.clock.take_grips().is_empty(), "tick {sequence}");
            let (step, _) = program.clock.position();
            repetitions += usize::from(step < before);
            before = step;
        }
        assert!(repetitions >= 2, "{repetitions}");
    }
}
