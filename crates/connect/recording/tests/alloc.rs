//! Recording a tick does not allocate. Without the test harness, because its threads also allocate, and the counter
//! includes the whole process.
#![allow(clippy::print_stdout)]

mod common;

use std::sync::atomic::Ordering::SeqCst;
use std::time::Duration;

use common::{SlowFile, position, rail, velocity};
use elbowroom_monitor::{AccessClass, Snapshot};
use elbowroom_recording::{CellWriter, Recorder};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let (cell, mut monitor) = rail();
    let file = SlowFile::default();
    let recorder = Recorder::start(CellWriter::new(file.clone(), &cell, 0).unwrap(), |_| ()).unwrap();
    let mut ticks = recorder.robot(0, &monitor, 0.0);
    let gate = monitor.region("gate").unwrap();
    // The first switch allocates memory for all others.
    ticks.switched(gate, false);
    std::thread::sleep(Duration::from_millis(1200));
    // From now on the thread of the recorder waits for its file, so that it does not allocate either.
    file.is_closed.store(true, SeqCst);
    let mut run = |from: u32, to: u32| {
        for i in from..to {
            let t_s = 0.002 * f64::from(i);
            let (q, qd) = ([position(t_s)], [velocity(t_s)]);
            let snapshot = Snapshot { qd: &qd, intent: Some(&qd), ..Snapshot::stationary(t_s, &q) };
            if i % 100 == 50 {
                monitor.switch(gate, i % 200 == 50, AccessClass::Programmer).unwrap();
                ticks.switched(gate, i % 200 == 50);
            }
            let report = monitor.tick(&snapshot);
            ticks.tick(t_s, &snapshot, &report, &monitor);
        }
    };
    // Until the next flush is due, which waits for the file.
    run(0, 10);
    std::thread::sleep(Duration::from_millis(1200));
    let counter = AllocationCounter::start();
    run(10, 900);
    assert_eq!(counter.allocations(), 0);
    assert_eq!(recorder.lost_ticks(), 0);
    // Ticks beyond the capacity are omitted, also without an allocation.
    run(900, 3000);
    assert_eq!(counter.allocations(), 0);
    assert!(recorder.lost_ticks() > 1500);
    file.is_closed.store(false, SeqCst);
    recorder.finish().unwrap();
    println!("890 recorded ticks and 2,100 more: no allocation");
}
