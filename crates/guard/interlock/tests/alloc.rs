//! A tick with its messages does not allocate. Without the test harness, because the counter includes all threads of the process.

mod rail;

use elbowroom_interlock::wire::{MAX_BYTES, decode_state, encode_grants};
use elbowroom_interlock::{Arbiter, ArbiterSettings, Boot, Micros, RobotSettings, StateMessage};
use elbowroom_monitor::{EventKind, Snapshot};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use rail::{Carriage, REGION, SLOT};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let mut robot = Carriage::new(0, 0.0, 1.0).robot;
    let settings = ArbiterSettings::new(vec![RobotSettings::of(robot.monitor().configuration())], 1);
    let mut arbiter = Arbiter::new(settings, Boot(1));
    let mut message = StateMessage::with_slots(1);
    let mut bytes = Vec::with_capacity(MAX_BYTES);
    let (mut allocations, mut granted) = (0, 0);
    for tick in 0..10_000_u64 {
        // To and fro through the region.
        let t = tick as f64 * 0.002;
        let (q, qd) = ([2.0 - 1.5 * t.cos()], [1.5 * t.sin()]);
        let now = Micros(1 + tick * 2_000);
        let counter = AllocationCounter::start();
        let snapshot = Snapshot { qd: &qd, intent: Some(&qd), ..Snapshot::stationary(now.0 as f64 * 1e-6, &q) };
        robot.tick(&snapshot, now);
        granted += robot.monitor().events().iter().filter(|e| e.kind == EventKind::Granted).count();
        let state = robot.state(now);
        decode_state(state, &mut message).expect("a state");
        allocations += counter.changes();
        // The arbiter allocates: it is no part of the tick of a robot.
        let replies = arbiter.receive(&message, now).replies;
        let counter = AllocationCounter::start();
        for reply in &replies {
            assert!(encode_grants(reply, &mut bytes));
            robot.receive(&bytes).expect("grants");
        }
        allocations += counter.changes();
    }
    assert!(granted > 3 && robot.monitor().is_active(REGION), "granted {granted}");
    assert_eq!((allocations, robot.guard().must_halt(SLOT)), (0, false));
}
