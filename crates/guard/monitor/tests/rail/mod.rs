//! Carriages on rails through one exchange region, with monitors, guards, an arbiter, and encoded messages between
//! them.
#![allow(dead_code, reason = "every test program uses a part of it")]

use elbowroom_interlock::wire::{decode_state, encode_grants};
use elbowroom_interlock::{Arbiter, ArbiterSettings, Boot, Guard, Micros, RobotSettings, StateMessage};
use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, GuardedMonitor, Guards, Laws, Life, Region, RegionId, RegionKind, RobotSlot,
    SlotId, Snapshot, StoppingSettings, TickReport, Volume,
};
use elbowroom_spatial::{Pose, Vec3};

pub const SLOT: SlotId = SlotId(0);
pub const REGION: RegionId = RegionId(0);
/// Borders of the region on the rail, m, and its warning zone.
pub const BORDERS: (f64, f64) = (1.7, 2.3);
pub const WARNING_M: f64 = 0.5;
pub const TICK_S: f64 = 0.002;
const BRAKE_M_S2: f64 = 5.0;
/// A state is sent in every fifth tick.
const SEND_TICKS: u64 = 5;

pub fn laws() -> Laws {
    let stopping = StoppingSettings {
        reaction_s: 0.004,
        period_s: TICK_S,
        joint_deceleration: vec![BRAKE_M_S2],
        joint_acceleration: vec![BRAKE_M_S2],
    };
    Laws { stopping_distance: Some(stopping), ..Laws::default() }
}

pub fn configuration(laws: Laws) -> Configuration {
    let rail = Joint {
        name: "rail".into(),
        kind: JointKind::Prismatic,
        parent: LinkId(0),
        child: LinkId(1),
        origin: Pose::IDENTITY,
        axis: Vec3::X,
        limits: Limits { velocity: Some(2.0), ..Limits::range(-10.0, 100.0) },
        mimic: None,
    };
    let (center, radius) = (0.5 * (BORDERS.0 + BORDERS.1), 0.5 * (BORDERS.1 - BORDERS.0));
    let region = Region::sphere("table", Vec3::X * center, radius).warning(WARNING_M).guards(Guards::TCP);
    let parts = ConfigurationParts {
        robot: "rail".into(),
        base_in_world: Pose::IDENTITY,
        chain: Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail]).unwrap(),
        volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)],
        regions: vec![region.kind(RegionKind::Exchange { slot: SLOT }).life(Life::Temporary)],
        sources: vec![],
        grids: vec![],
        laws,
    };
    Configuration::new(parts).unwrap()
}

/// A carriage with its monitor and guard.
pub struct Carriage {
    pub x: f64,
    pub v: f64,
    /// Velocity of the program at override 1, m/s.
    pub program: f64,
    pub robot: GuardedMonitor,
    /// True if messages pass in both directions.
    pub is_connected: bool,
    /// True if the monitor gets valid input.
    pub is_seen: bool,
    /// Velocity at which a person moves the carriage, whatever its override, m/s.
    pub by_hand: Option<f64>,
    pub report: Option<TickReport>,
}

impl Carriage {
    pub fn new(index: usize, x: f64, program: f64) -> Self {
        let mut robot =
            GuardedMonitor::new(configuration(laws()), Guard::new(RobotSlot(index), 1, 0, Boot(1))).unwrap();
        robot.monitor_mut().switch(REGION, true, elbowroom_monitor::AccessClass::Programmer).unwrap();
        Self { x, v: 0.0, program, robot, is_connected: true, is_seen: true, by_hand: None, report: None }
    }

    pub fn is_inside(&self) -> bool {
        BORDERS.0 < self.x && self.x < BORDERS.1
    }

    pub fn speed_override(&self) -> f64 {
        self.report.map_or(0.0, |report| report.speed_override)
    }

    fn tick(&mut self, now: Micros) {
        let now_s = now.0 as f64 * 1e-6;
        let q = [if self.is_seen { self.x } else { f64::NAN }];
        let (qd, intent) = ([self.v], [self.program]);
        let snapshot = Snapshot { qd: &qd, intent: Some(&intent), ..Snapshot::stationary(now_s, &q) };
        self.report = Some(self.robot.tick(&snapshot, now));
        let wanted = self.by_hand.unwrap_or(self.program * self.speed_override());
        self.v += (wanted - self.v).clamp(-BRAKE_M_S2 * TICK_S, BRAKE_M_S2 * TICK_S);
        self.x += self.v * TICK_S;
    }
}

pub struct Cell {
    pub arbiter: Arbiter,
    pub carriages: Vec<Carriage>,
    pub ticks: u64,
    message: StateMessage,
    bytes: Vec<u8>,
}

impl Cell {
    pub fn new(carriages: Vec<Carriage>) -> Self {
        let settings = vec![RobotSettings::new("rail", [SLOT]); carriages.len()];
        let arbiter = Arbiter::new(ArbiterSettings::new(settings, 1), Boot(1));
        Self { arbiter, carriages, ticks: 0, message: StateMessage::with_slots(1), bytes: Vec::new() }
    }

    pub fn now(&self) -> Micros {
        Micros(1_000_000 + self.ticks * 2_000)
    }

    /// Performs one tick of all robots, and delivers their messages.
    pub fn step(&mut self) {
        let now = self.now();
        for carriage in &mut self.carriages {
            carriage.tick(now);
        }
        let inside = || self.carriages.iter().filter(|c| c.is_inside());
        // Two robots that start inside halt once the arbiter has received both messages, and they have received its answer.
        let may_halt_still = self.ticks <= 2 * SEND_TICKS;
        assert!(inside().count() <= 1 || may_halt_still || inside().all(|c| c.speed_override() == 0.0));
        if self.ticks.is_multiple_of(SEND_TICKS) {
            (0..self.carriages.len()).for_each(|r| self.exchange(r, now));
        }
        self.ticks += 1;
    }

    pub fn is_halted(&self) -> bool {
        self.carriages.iter().all(|c| c.robot.guard().must_halt(SLOT))
    }

    fn exchange(&mut self, r: usize, now: Micros) {
        let bytes = self.carriages[r].robot.state(now).to_vec();
        if !self.carriages[r].is_connected {
            return;
        }
        decode_state(&bytes, &mut self.message).unwrap();
        for reply in self.arbiter.receive(&self.message, now).replies {
            assert!(encode_grants(&reply, &mut self.bytes));
            let to = &mut self.carriages[reply.robot.0];
            if to.is_connected {
                to.robot.receive(&self.bytes).unwrap();
            }
        }
    }

    /// Steps until the condition holds, for at most ten seconds.
    pub fn until(&mut self, what: &str, condition: impl Fn(&Self) -> bool) {
        let reached = (0..5_000).any(|_| {
            self.step();
            condition(self)
        });
        assert!(reached, "never: {what}");
    }

    pub fn run(&mut self, seconds: f64) {
        (0..(seconds / TICK_S) as u64).for_each(|_| self.step());
    }
}
