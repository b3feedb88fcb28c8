//! The monitors of a cell, ticked by a host that knows all robots, answer as in a run.

use std::sync::Arc;

use elbowroom_cell::{Cell, CellInstant, CellMonitors};
use elbowroom_monitor::{OverrideReason, RegionId, VolumeId};
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

/// The instants of a run; the first has the ticks before the run.
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
    for example in ["figure12", "conveyor", "exchange", "fence"] {
        let cell = Arc::new(Cell::load(examples().join(example).join("cell.toml")).unwrap());
        let mut journal = Journal::default();
        let paths = PlannedPaths::new(&cell);
        simulate_observed(&paths, &RunOptions::default(), &mut |_| {}, Some(&mut journal)).unwrap();
        let mut monitors = CellMonitors::new(cell.clone()).unwrap();
        let mut slowed = 0;
        for Instant { now_s, q, qd, intent, answers } in &journal.instants[1..] {
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
