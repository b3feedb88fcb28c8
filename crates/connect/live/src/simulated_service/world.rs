//! World of a schedule: processes, carriages and time.

use std::cell::{RefCell, RefMut};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::rc::{Rc, Weak};
use std::sync::{Arc, Mutex};

use elbowroom_testkit::random::SplitMix;

use super::cell::{Follows, SimulatedCell, belt};
use super::faults::{Fault, FaultPlan};
use super::judge::Judge;
use super::network::{Wires, deliver};
use super::process::{
    ARBITER, ArbiterParts, BELT, Parts, Process, STRANGER, Start, controller_host, journal, node_host,
};
use super::process_clock::{ProcessClock, ProcessId, set_sleeper, set_true_us, true_us};
use super::rail::Carriage;
use super::waits::Waits;
use crate::client::{ControllerClient, ControllerState};
use crate::clock::Clock;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Publisher, Urgency};
use crate::region_keeper::ProgramSwitches;

/// A process that waited has ended meanwhile.
pub(super) struct Ended;

/// One service with its robots.
pub(super) struct World {
    pub(super) cell: Rc<SimulatedCell>,
    pub(super) folder: PathBuf,
    pub(super) wires: Arc<Mutex<Wires>>,
    pub(super) random: RefCell<SplitMix>,
    pub(super) processes: RefCell<Vec<Process>>,
    pub(super) judge: RefCell<Judge>,
    carriages: RefCell<Vec<Carriage>>,
    faults: RefCell<FaultPlan>,
    belt: RefCell<Option<BeltSender>>,
    pub(super) waits: RefCell<Waits>,
    pub(super) programs_switch: bool,
    is_recorded: bool,
}

/// Whoever measures the belt.
struct BeltSender {
    clock: ProcessClock,
    client: ControllerClient,
    publisher: Box<dyn Publisher>,
}

impl World {
    pub(super) fn new(cell: &Rc<SimulatedCell>, folder: &Path, seed: u64, length_us: u64) -> Rc<Self> {
        set_true_us(0);
        let mut random = SplitMix(seed);
        let wires = Arc::new(Mutex::new(Wires::new(random.bits())));
        let faults = FaultPlan::new(cell.rails, length_us, &mut random);
        let places: Vec<f64> = (0..cell.rails).map(|_| 0.05 + 0.3 * random.unit()).collect();
        let world = Rc::new(Self {
            cell: cell.clone(),
            folder: folder.to_owned(),
            wires,
            programs_switch: random.below(4) == 0,
            is_recorded: seed % 8 == 5,
            judge: RefCell::new(Judge::new(cell.follows, &places)),
            random: RefCell::new(random),
            processes: RefCell::default(),
            carriages: RefCell::default(),
            faults: RefCell::new(faults),
            belt: RefCell::default(),
            waits: RefCell::new(Waits::new(cell.rails)),
        });
        for (rail, q) in places.into_iter().enumerate() {
            let Start { clock, boot, network, .. } = world.start(controller_host(rail));
            let carriage = Carriage::new(cell, rail, q, &*network, (clock, boot));
            world.carriages.borrow_mut().push(carriage);
            world.start_node(rail, false);
        }
        world.start_arbiter();
        world.start_belt();
        let weak: Weak<Self> = Rc::downgrade(&world);
        set_sleeper(Some(Rc::new(move |process, us| {
            if let Some(world) = weak.upgrade() {
                world.sleep(process, us);
            }
        })));
        world
    }

    /// A start of a process on a host, with a clock of its own.
    pub(super) fn start(&self, host: usize) -> Start {
        let mut random = self.random.borrow_mut();
        let clock = (random.bits() % 1_000_000_000, 0.995 + 0.01 * random.unit());
        // The time of day is set back before some of the starts; no two are the same.
        let set_back_us = if random.below(6) == 0 { random.bits() % 2_000_000 } else { 0 };
        let boot = (10_000_000 + true_us() - set_back_us) * 1_000 + random.bits() % 1_000;
        Start::new(&self.wires, host, clock, boot)
    }

    pub(super) fn start_node(&self, rail: usize, has_other_file: bool) {
        let process = self.start(node_host(rail)).node(&self.cell, rail, has_other_file, self.records());
        self.processes.borrow_mut().push(process);
    }

    pub(super) fn start_arbiter(&self) {
        let programs = if self.programs_switch { ProgramSwitches::Obeyed } else { ProgramSwitches::Ignored(None) };
        let process = self.start(ARBITER).arbiter(&self.cell, &self.folder, programs);
        self.processes.borrow_mut().push(process);
    }

    /// Starts the arbiter again: it must know all regions of which its answers said that they are in force, unless its
    /// journal was lost.
    pub(super) fn restart_arbiter(&self) {
        let has_journal = journal(&self.folder).is_file();
        self.start_arbiter();
        let Some(ArbiterParts { keeper, .. }) = self.arbiter() else { return };
        let present = keeper.present().cell;
        let active = keeper.active();
        let is_on = present.regions.iter().zip(active).any(|(r, on)| on && r.region.name == "cart");
        let may_be_lost = self.plan().has_lost_journal;
        let mut judge = self.judge.borrow_mut();
        if !has_journal && may_be_lost {
            judge.zones.clear();
        } else if !has_journal && !judge.zones.is_empty() {
            judge.wrong("there is no journal");
        } else if judge.cart_on_since_us.is_some() && !is_on {
            judge.wrong("the restart switches a region off");
        }
        let is_known = |name: &str| present.regions.iter().any(|r| r.region.name == name);
        let forgotten: Vec<String> =
            judge.zones.iter().map(|zone| zone.name.clone()).filter(|name| !is_known(name)).collect();
        for name in forgotten {
            judge.wrong(&format!("{name} is forgotten by a restart"));
        }
    }

    /// The faults of the schedule.
    pub(super) fn plan(&self) -> RefMut<'_, FaultPlan> {
        self.faults.borrow_mut()
    }

    pub(super) fn restart_controller(&self, rail: usize) {
        let Start { clock, boot, network, .. } = self.start(controller_host(rail));
        self.carriages.borrow_mut()[rail].restart(&self.cell, rail, &*network, (clock, boot));
    }

    pub(super) fn start_belt(&self) {
        if self.cell.follows == Follows::Belt {
            let Start { clock, boot, network, .. } = self.start(BELT);
            let key = Keys::new(&self.cell.cell.name).encoder("belt");
            let client = ControllerClient::new(boot, 0);
            let publisher = network.publisher(&key, Urgency::RealTime).expect("a key");
            *self.belt.borrow_mut() = Some(BeltSender { clock, client, publisher });
        }
    }

    /// The parts of the arbiter that runs, if one does.
    pub(super) fn arbiter(&self) -> Option<ArbiterParts> {
        self.processes.borrow().iter().find_map(|process| match &process.parts {
            Parts::Arbiter(parts) if process.runs() => Some(parts.clone()),
            _ => None,
        })
    }

    /// Where nodes record, in one of eight schedules.
    fn records(&self) -> Option<&Path> {
        self.is_recorded.then_some(&self.folder)
    }

    /// Ends all processes of a host.
    pub(super) fn end(&self, host: usize) {
        // A switch may have been made since the last look.
        self.look_at_the_table();
        let (ended, others) = self.processes.take().into_iter().partition(|process| process.host == host);
        *self.processes.borrow_mut() = others;
        self.end_these(ended);
    }

    /// Ends all processes.
    pub(super) fn end_all(&self) {
        let ended = self.processes.take();
        self.end_these(ended);
    }

    fn end_these(&self, ended: Vec<Process>) {
        for process in ended {
            locked(&self.wires).end_process(process.id);
            let Some((ticks, difference)) = process.end() else { continue };
            *self.plan().counts.entry("ticks replayed").or_default() += ticks;
            if let Some(difference) = difference {
                self.judge.borrow_mut().wrong(&difference);
            }
        }
    }

    pub(super) fn pause(&self, host: usize, until_us: u64) {
        for process in self.processes.borrow_mut().iter_mut().filter(|process| process.host == host) {
            process.paused_until_us = until_us;
        }
    }

    pub(super) fn is_running(&self, host: usize) -> bool {
        self.processes.borrow().iter().any(|process| process.host == host)
    }

    pub(super) fn places(&self) -> Vec<f64> {
        self.carriages.borrow().iter().map(|carriage| carriage.q).collect()
    }

    pub(super) fn velocities(&self) -> Vec<f64> {
        self.carriages.borrow().iter().map(|carriage| carriage.v).collect()
    }

    pub(super) fn targets(&self) -> Vec<f64> {
        self.carriages.borrow().iter().map(|carriage| carriage.target).collect()
    }

    /// Number of targets that the carriages have reached.
    pub(super) fn arrivals(&self) -> u64 {
        self.carriages.borrow().iter().map(|carriage| carriage.arrivals).sum()
    }

    /// True time at which the last disturbance of a host ends.
    pub(super) fn disturbed_until_us(&self, host: usize) -> u64 {
        self.faults.borrow().disturbed_until_us(host)
    }

    /// A process rests; it does not return while it pauses, and never if it has ended.
    fn sleep(&self, process: ProcessId, us: u64) {
        // A step of a process, which the world waits for, must not wait for the world.
        let Ok(processes) = self.processes.try_borrow() else { return };
        drop(processes);
        self.advance(true_us() + us);
        loop {
            let processes = self.processes.borrow();
            let Some(running) = processes.iter().find(|p| p.id == process) else {
                drop(processes);
                resume_unwind(Box::new(Ended));
            };
            if running.runs() {
                return;
            }
            drop(processes);
            // In steps, as the process may end while it pauses, and start again.
            self.advance(true_us() + 1_000);
        }
    }

    /// Lets time pass.
    pub(super) fn advance(&self, until_us: u64) {
        while true_us() < until_us {
            set_true_us(true_us() + 1_000);
            let due: Vec<Fault> = self.faults.borrow_mut().take_due(true_us());
            for fault in due {
                self.apply(fault);
            }
            let paused: Vec<(ProcessId, u64)> =
                self.processes.borrow().iter().map(|process| (process.id, process.paused_until_us)).collect();
            let paused_until = |id: ProcessId| paused.iter().find(|(of, _)| *of == id).map_or(0, |(_, until)| *until);
            deliver(&self.wires, paused_until);
            for process in self.processes.borrow_mut().iter_mut().filter(|process| process.runs()) {
                process.step();
            }
            self.move_all();
        }
    }

    /// Whether the switched region is on, as the keeper has it, if programs switch it; while no keeper runs nothing
    /// changes. What people switch is as they were told.
    fn look_at_the_table(&self) {
        if !self.programs_switch && self.judge.borrow().cart_on_since_us.is_some() {
            return;
        }
        let Some(ArbiterParts { keeper, .. }) = self.arbiter() else { return };
        let (present, active) = (keeper.present().cell, keeper.active());
        let is_on = present.regions.iter().zip(active).any(|(r, on)| on && r.region.name == "cart");
        let since = &mut self.judge.borrow_mut().cart_on_since_us;
        *since = is_on.then(|| since.unwrap_or(true_us()));
    }

    fn move_all(&self) {
        let ms = true_us() / 1_000;
        let mut carriages = self.carriages.borrow_mut();
        for carriage in carriages.iter_mut() {
            carriage.step(ms, &mut self.random.borrow_mut());
        }
        if let Some(BeltSender { clock, client, publisher }) = &mut *self.belt.borrow_mut()
            && ms.is_multiple_of(8)
        {
            let (travel, speed) = belt(true_us() as f64 * 1e-6);
            let state =
                ControllerState { q: &[travel], qd: &[speed], programmed_override: 1.0, ..ControllerState::default() };
            publisher.publish(client.joint_state(Clock::simulated(*clock).micros(), &state));
        }
        if ms.is_multiple_of(997) {
            locked(&self.wires).repeat_a_message(STRANGER);
        }
        drop(carriages);
        if ms.is_multiple_of(10) {
            self.look_at_the_table();
        }
        if ms.is_multiple_of(50) {
            self.look_at_waits();
        }
        self.judge.borrow_mut().look(&self.places(), &self.velocities());
    }
}
