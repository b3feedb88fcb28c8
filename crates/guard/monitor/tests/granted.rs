//! Exchange regions that are granted from outside the process, and regions that are switched off with a robot
//! inside.

use std::sync::Arc;

use crate::common::{arm_volumes, gantry, parts};
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{
    AccessClass, ConfigError, Configuration, ConfigurationParts, EventKind, ExchangeState, Interlock, Laws, Life,
    Monitor, Occupancy, OverrideReason, Part, Presence, Region, RegionId, RegionKind, RobotSlot, SlotGrants, SlotId,
    Snapshot, SourceId, SourceState, StoppingSettings, TickReport, Volume, ZoneArbiter,
};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

const TICK_S: f64 = 0.002;
const SLOT: SlotId = SlotId(0);
const REGION: RegionId = RegionId(0);

fn laws() -> Laws {
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: TICK_S,
        joint_deceleration: vec![5.0; 6],
        joint_acceleration: vec![5.0; 6],
    };
    Laws { direction_aware: true, stopping_distance: Some(stopping), ..Laws::default() }
}

fn table() -> Region {
    Region::sphere("table", Vec3::X * 4.0, 0.3)
        .warning(0.6)
        .kind(RegionKind::Exchange { slot: SLOT })
        .life(Life::Temporary)
}

/// A gantry whose tool moves along x; it reaches the region when its first joint is near 3 m.
struct Robot {
    monitor: Monitor,
    ticks: u32,
    x: f64,
    sources: Vec<SourceState>,
}

impl Robot {
    fn new(region: Region, interlock: impl Into<Interlock>) -> Self {
        Self::of(arm_volumes(), region, interlock)
    }

    fn of(volumes: Vec<Volume>, region: Region, interlock: impl Into<Interlock>) -> Self {
        let sources = if region.follow.is_some() { vec!["belt".into()] } else { vec![] };
        let parts = ConfigurationParts { laws: laws(), sources, ..parts(gantry(), volumes, vec![region]) };
        let mut monitor = Monitor::new(Configuration::new(parts).unwrap(), Some(interlock.into())).unwrap();
        monitor.switch(REGION, true, AccessClass::Programmer).unwrap();
        Self { monitor, ticks: 0, x: 0.0, sources: vec![] }
    }

    fn tick(&mut self, velocity: f64) -> TickReport {
        let now_s = f64::from(self.ticks) * TICK_S;
        self.ticks += 1;
        self.x += velocity * TICK_S;
        let (q, qd) = ([self.x, 0.0, 0.0, 0.0, 0.0, 0.0], [velocity, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let intent = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        self.sources.iter_mut().for_each(|source| source.stamp_s = now_s);
        let snapshot = Snapshot { qd: &qd, intent: Some(&intent), ..Snapshot::stationary(now_s, &q) };
        self.monitor.tick(&Snapshot { sources: &self.sources, ..snapshot })
    }
}

fn granted() -> (Arc<SlotGrants>, Robot) {
    let grants = Arc::new(SlotGrants::new(1));
    let robot = Robot::new(table(), Interlock::Granted(grants.clone()));
    (grants, robot)
}

impl Robot {
    /// Moves at 1 m/s until the state is reached; returns the report of that tick.
    fn seek(&mut self, state: ExchangeState) -> TickReport {
        for _ in 0..5_000 {
            let report = self.tick(1.0);
            if self.monitor.exchange_state(REGION) == Some(state) {
                return report;
            }
        }
        panic!("never {state:?}")
    }
}

#[test]
fn a_grant_counts_from_the_tick_in_which_it_is_there_until_the_tick_in_which_it_is_not() {
    let (grants, mut robot) = granted();
    assert_eq!(grants.occupancy(SLOT), Occupancy::Unknown);
    robot.tick(0.0);
    assert_eq!((grants.occupancy(SLOT), grants.is_needed(SLOT)), (Occupancy::Outside, false));
    assert!(matches!(robot.seek(ExchangeState::Waiting).reason, OverrideReason::Free | OverrideReason::Waiting(_)));
    assert_eq!((grants.occupancy(SLOT), grants.is_needed(SLOT)), (Occupancy::Warning, true));
    (0..20).for_each(|_| _ = robot.tick(1.0));
    assert!(robot.tick(1.0).speed_override < 1.0 && robot.monitor.is_closed(REGION));
    grants.write(SLOT, true, false);
    assert_eq!(robot.tick(1.0).speed_override, 1.0);
    assert!(robot.monitor.holds(REGION) && robot.monitor.events().iter().any(|e| e.kind == EventKind::Granted));
    grants.write(SLOT, false, false);
    let report = robot.tick(1.0);
    assert_eq!(report.reason, OverrideReason::Waiting(REGION));
    assert!(report.speed_override < 1.0 && !robot.monitor.holds(REGION));
}

#[test]
fn a_committed_robot_goes_on_without_the_grant_until_it_can_stop_outside() {
    let (grants, mut robot) = granted();
    grants.write(SLOT, true, false);
    robot.seek(ExchangeState::Committed);
    grants.write(SLOT, false, false);
    assert_eq!(robot.seek(ExchangeState::Inside).speed_override, 1.0);
    assert!(robot.monitor.holds(REGION));
    robot.seek(ExchangeState::Outside);
    assert_eq!((grants.occupancy(SLOT), robot.monitor.holds(REGION)), (Occupancy::Outside, false));
}

#[test]
fn a_robot_that_starts_inside_moves_once_it_is_granted() {
    let (grants, mut robot) = granted();
    robot.x = 3.9;
    assert_eq!(robot.tick(0.0).speed_override, 0.0);
    assert_eq!((grants.occupancy(SLOT), grants.state(SLOT)), (Occupancy::Inside, ExchangeState::Inside));
    grants.write(SLOT, true, false);
    assert_eq!(robot.tick(0.0).speed_override, 1.0);
}

#[test]
fn a_halt_stops_whatever_is_granted_but_not_for_a_region_that_is_switched_off() {
    let (grants, mut robot) = granted();
    grants.write(SLOT, true, false);
    robot.seek(ExchangeState::Inside);
    grants.write(SLOT, true, true);
    let report = robot.tick(0.0);
    assert_eq!((report.speed_override, report.reason), (0.0, OverrideReason::Halted(REGION)));
    assert!(report.governing.is_some_and(|g| g.region == REGION));
    robot.monitor.switch(REGION, false, AccessClass::Programmer).unwrap();
    assert_eq!(robot.tick(0.0).speed_override, 1.0);
}

#[test]
fn invalid_input_leaves_what_was_found() {
    let (grants, mut robot) = granted();
    robot.seek(ExchangeState::Waiting);
    robot.x = f64::NAN;
    assert!(matches!(robot.tick(0.0).reason, OverrideReason::Fault(_)));
    assert_eq!((grants.occupancy(SLOT), grants.state(SLOT)), (Occupancy::Warning, ExchangeState::Waiting));
}

#[test]
fn a_robot_in_a_region_that_is_switched_off_is_reported_until_it_has_left() {
    let (grants, mut robot) = granted();
    grants.write(SLOT, true, false);
    robot.seek(ExchangeState::Inside);
    robot.monitor.switch(REGION, false, AccessClass::Programmer).unwrap();
    grants.write(SLOT, false, false);
    let report = robot.tick(1.0);
    assert_eq!((grants.occupancy(SLOT), grants.is_needed(SLOT)), (Occupancy::Inside, false));
    // For everything else the region does not exist.
    assert_eq!((report.speed_override, report.governing), (1.0, None));
    assert!(!robot.monitor.is_inside(REGION) && !robot.monitor.is_warned(REGION));
    assert!(robot.monitor.events().iter().any(|e| e.kind == EventKind::InsideOut));
    // The robot does not wait for the grant, and is afterwards beyond the region and its warning zone.
    let seen: Vec<_> = (0..3_000).map(|_| (robot.tick(1.0).speed_override, grants.occupancy(SLOT))).collect();
    assert!(seen.iter().all(|(speed_override, _)| *speed_override == 1.0));
    let mut occupancies: Vec<_> = seen.iter().map(|(_, occupancy)| *occupancy).collect();
    occupancies.dedup();
    assert_eq!(occupancies.first(), Some(&Occupancy::Inside), "{occupancies:?}");
    assert_eq!(occupancies.last(), Some(&Occupancy::Outside), "{occupancies:?}");
}

#[test]
fn the_arbiter_of_the_process_keeps_the_slot_of_a_region_that_is_switched_off() {
    let arbiter = Arc::new(ZoneArbiter::new(&["a", "b"], &["table"]));
    let mut robot = Robot::new(table(), (arbiter.clone(), RobotSlot(0)));
    robot.seek(ExchangeState::Inside);
    robot.monitor.switch(REGION, false, AccessClass::Programmer).unwrap();
    assert_eq!(robot.tick(1.0).speed_override, 1.0);
    assert_eq!((arbiter.holder(SLOT), arbiter.occupancy(SLOT, RobotSlot(0))), (Some(RobotSlot(0)), Occupancy::Inside));
    robot.seek(ExchangeState::Outside);
    assert_eq!(arbiter.holder(SLOT), None);
    // A robot that enters while the region is off requests nothing, but others see it.
    robot.x = 2.0;
    let mut other = Robot::new(table(), (arbiter.clone(), RobotSlot(1)));
    other.monitor.switch(REGION, false, AccessClass::Programmer).unwrap();
    other.seek(ExchangeState::Inside);
    assert_eq!((arbiter.holder(SLOT), arbiter.occupancy(SLOT, RobotSlot(1))), (None, Occupancy::Inside));
}

#[test]
fn a_region_that_is_switched_off_and_whose_source_is_lost_may_be_anywhere() {
    let grants = Arc::new(SlotGrants::new(1));
    let mut robot = Robot::new(table().follow(SourceId(0)), Interlock::Granted(grants.clone()));
    robot.sources = vec![SourceState { pose: Pose::IDENTITY, motion: FrameMotion::REST, stamp_s: 0.0 }];
    robot.tick(0.0);
    assert_eq!(grants.occupancy(SLOT), Occupancy::Outside);
    robot.monitor.switch(REGION, false, AccessClass::Programmer).unwrap();
    robot.sources[0].pose = Pose::from_translation(Vec3::X * f64::NAN);
    assert_eq!(robot.tick(0.0).speed_override, 1.0);
    assert_eq!(grants.occupancy(SLOT), Occupancy::Unknown);
    robot.sources[0].pose = Pose::IDENTITY;
    robot.tick(0.0);
    assert_eq!(grants.occupancy(SLOT), Occupancy::Outside);
}

#[test]
fn grants_from_outside_need_the_stopping_distance_and_the_slot() {
    let new = |laws: Laws, slots: usize| {
        let parts = ConfigurationParts { laws, ..parts(gantry(), arm_volumes(), vec![table()]) };
        let interlock = Interlock::Granted(Arc::new(SlotGrants::new(slots)));
        Monitor::new(Configuration::new(parts).unwrap(), Some(interlock)).unwrap_err()
    };
    assert_eq!(new(Laws::default(), 1), ConfigError::NoStoppingDistance("table".into()));
    assert_eq!(new(laws(), 0), ConfigError::NoArbiter("table".into()));
}

/// If the volume that cannot stop is measured first, the other volumes do not undo its result.
#[test]
fn a_robot_is_committed_by_any_of_its_volumes() {
    let ball = |name: &str, x: f64| Volume {
        name: name.into(),
        part: Part::Arm,
        link: LinkId(6),
        shape: Shape::Sphere(Sphere { radius: 0.05 }),
        in_link: Pose::from_translation(Vec3::X * x),
        presence: Presence::Always,
    };
    for offsets in [[0.0, -0.5], [-0.5, 0.0]] {
        let volumes = vec![ball("a", offsets[0]), ball("b", offsets[1])];
        let grants = Arc::new(SlotGrants::new(1));
        let mut robot = Robot::of(volumes, table(), Interlock::Granted(grants.clone()));
        grants.write(SLOT, true, false);
        robot.seek(ExchangeState::Committed);
        // The other ball is half a metre behind and could stop.
        assert!(robot.x > 3.3 && robot.x < 3.65, "{offsets:?}: {}", robot.x);
    }
}
