//! The monitors of a cell, ticked by a host that knows all robots, answer as in a run.

use std::sync::Arc;

use elbowroom_cell::{Cell, CellInstant, CellMonitors, CellRegionId};
use elbowroom_monitor::{AccessClass, OverrideReason, RegionId, VolumeId};
use elbowroom_robot::RobotId;
use elbowroom_sim::run::{ObservedInstant, ObservedTick, RunObserver, simulate_observed};
use elbowroom_sim::{PlannedPaths, RunOptions};
use elbowroom_spatial::Pose;
use elbowroom_testkit::folder::examples;

/// What the monitors of all robots read at an instant, side by side, and what each answered.
#[derive(Default)]
struct Instant {
    now_s: f64,
    q: Vec<f64>,
    qd: Vec<f64>,
    intent: Vec<f64>,
    answers: Vec<(f64, OverrideReason)>,
}

/// The instants of a run; in a cell with exchange regions the first one is before the run.
#[derive(Default)]
struct Journal {
    instants: Vec<Instant>,
}

impl RunObserver for Journal {
    fn switched(&mut self, _: RobotId, _: RegionId, _: bool) {}
    fn attached(&mut self, _: RobotId, _: VolumeId, _: &Pose) {}
    fn detached(&mut self, _: RobotId, _: VolumeId) {}
    fn instant(&mut self, _: &ObservedInstant<'_>) {}

    fn ticked(&mut self, tick: &ObservedTick<'_>) {
        let s = tick.snapshot;
        if tick.robot.0 == 0 {
            self.instants.push(Instant { now_s: s.now_s, ..Instant::default() });
        }
        let instant = self.instants.last_mut().unwrap();
        instant.q.extend(s.q);
        instant.qd.extend(s.qd);
        instant.intent.extend(s.intent.unwrap());
        instant.answers.push((tick.report.speed_override, tick.report.reason));
    }
}

#[test]
fn overrides_of_a_host_are_those_of_a_run() {
    for (example, before) in [("figure12", 0), ("conveyor", 0), ("exchange", 1), ("fence", 0)] {
        let cell = Arc::new(Cell::load(examples().join(example).join("cell.toml")).unwrap());
        let mut journal = Journal::default();
        let paths = PlannedPaths::new(&cell);
        simulate_observed(&paths, &RunOptions::default(), &mut |_| {}, Some(&mut journal)).unwrap();
        let mut monitors = CellMonitors::new(cell.clone()).unwrap();
        let mut slowed = 0;
        for Instant { now_s, q, qd, intent, answers } in &journal.instants[before..] {
            assert!(*now_s >= 0.0, "{example}");
            let instant = CellInstant { now_s: *now_s, q, qd, intent, programmed_override: 1.0 };
            let found = monitors.tick(&instant);
            for (tick, expected) in found.iter().zip(answers) {
                assert_eq!((tick.report.speed_override, tick.report.reason), *expected, "{example} at {now_s} s");
                slowed += usize::from(expected.0 < 1.0);
            }
            assert_eq!(found.len(), answers.len());
        }
        assert!(slowed > 50, "{example}: {slowed} of {}", journal.instants.len());
    }
}

#[test]
fn too_few_values_stop_the_robots_that_lack_them() {
    let cell = Arc::new(Cell::load(examples().join("exchange/cell.toml")).unwrap());
    let q: Vec<f64> = cell.robots.iter().flat_map(|robot| robot.start.clone()).collect();
    let mut monitors = CellMonitors::new(cell).unwrap();
    let mut tick = |now_s: f64, q: &[f64]| {
        let qd = vec![0.0; q.len()];
        let instant = CellInstant { now_s, q, qd: &qd, intent: &qd, programmed_override: 1.0 };
        monitors.tick(&instant).iter().map(|tick| tick.report.reason).collect::<Vec<_>>()
    };
    let is_fault = |reasons: Vec<OverrideReason>| {
        reasons.iter().map(|reason| matches!(reason, OverrideReason::Fault(_))).collect::<Vec<_>>()
    };
    assert_eq!(is_fault(tick(0.0, &q)), [false, false]);
    assert_eq!(is_fault(tick(0.002, &q[..q.len() - 1])), [false, true]);
    assert_eq!(is_fault(tick(0.004, &[])), [true, true]);
    assert_eq!(is_fault(tick(0.006, &q)), [false, false]);
}

/// An arm at rest, and a cart with a region on it that approaches the arm.
const CART: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[monitor]
stopping_distance = true
[robot.arm]
dh = [{ a = 300, speed = 90 }]
links = [{ sphere = { radius = 50 } }]
[robot.cart]
base = { at = [-2500, 0, 0], rpy = [0, 90, 0] }
dh = [{ kind = "prismatic", min = 0, max = 3000, speed = 1500 }]
links = [{ sphere = { radius = 50 } }]
[region.load]
shape = "sphere"
centre = [0, 0, 0]
radius = 100
warning = 400
robots = ["arm"]
guards = ["arm"]
follow = { robot = "cart", frame = "link_1" }
"#;

#[test]
fn velocities_that_are_not_known_never_count_as_rest() {
    let cell = Arc::new(Cell::parse("cart.toml", CART).unwrap());
    // The cart drives at 0.9 m/s; the second host does not tell how fast.
    let overrides = |knows: bool| {
        let mut monitors = CellMonitors::new(cell.clone()).unwrap();
        let mut answer = |tick: u32| {
            let now_s = f64::from(tick) * 0.002;
            let (q, qd) = ([0.0, 0.9 * now_s], [0.0, 0.9]);
            let intent = [0.0, 0.9];
            let qd = if knows { &qd[..] } else { &[] };
            let instant = CellInstant { now_s, q: &q, qd, intent: &intent, programmed_override: 1.0 };
            monitors.tick(&instant)[0].report
        };
        (0..1500).map(&mut answer).collect::<Vec<_>>()
    };
    let (known, unknown) = (overrides(true), overrides(false));
    assert!(
        unknown[0].speed_override == 0.0 && matches!(unknown[0].reason, OverrideReason::Fault(_)),
        "{:?}",
        unknown[0]
    );
    assert!(known[100].speed_override == 1.0, "{:?}", known[100]);
    assert!(known.iter().any(|r| r.speed_override == 0.0), "{:?}", known[1499]);
    for (tick, (known, unknown)) in known.iter().zip(&unknown).enumerate() {
        assert!(unknown.speed_override <= known.speed_override + 1e-6, "{tick}: {known:?} {unknown:?}");
    }
    // In cells with exchange regions too, whose monitors tick once before the first tick.
    let cell = Arc::new(Cell::load(examples().join("exchange/cell.toml")).unwrap());
    let q: Vec<f64> = cell.robots.iter().flat_map(|robot| robot.start.clone()).collect();
    let mut monitors = CellMonitors::new(cell).unwrap();
    let instant = CellInstant { now_s: 0.0, q: &q, qd: &[], intent: &[], programmed_override: 1.0 };
    assert!(monitors.tick(&instant).iter().all(|tick| tick.report.speed_override == 0.0));
    let events = monitors.tick(&CellInstant { now_s: 0.002, ..instant });
    assert!(events.iter().all(|tick| tick.report.speed_override > 0.0), "{events:?}");
}

#[test]
fn a_permanent_region_is_not_switched_even_if_no_monitor_has_it() {
    let cell = Arc::new(Cell::parse("cart.toml", CART).unwrap());
    let mut monitors = CellMonitors::new(cell).unwrap();
    assert!(monitors.switch(CellRegionId(0), true, AccessClass::Integrator).is_err());
}
