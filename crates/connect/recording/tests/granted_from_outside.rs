//! Monitors whose exchange regions are granted from outside the process replay to the bit, halts included.

use std::sync::Arc;

use crate::common::{SlowFile, position, velocity};
use elbowroom_cell::{Cell, configure};
use elbowroom_monitor::{Interlock, Monitor, OverrideReason, SlotGrants, SlotId, Snapshot};
use elbowroom_recording::{CellWriter, Recorder, replay};

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
[robot.other]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
base = { at = [5000, 0, 0], rpy = [0, 0, 0] }
[region.table]
shape = "sphere"
centre = [0, 0, 900]
radius = 300
kind = "exchange"
warning = 200
guards = ["tcp"]
[region.bin]
shape = "sphere"
centre = [0, 0, 1900]
radius = 100
kind = "exchange"
warning = 100
guards = ["tcp"]
[monitor]
stopping_distance = true
"#;

#[test]
fn grants_and_halts_replay_to_the_bit() {
    let cell = Cell::parse("granted.toml", CELL).unwrap();
    let setups = configure::setups(&cell).unwrap();
    let slots = configure::zone_arbiter(&cell).unwrap().slots();
    assert_eq!(slots, 2);
    let grants = Arc::new(SlotGrants::new(slots));
    let interlock = Some(Interlock::Granted(grants.clone()));
    let mut monitor = Monitor::new(setups[0].configuration.clone(), interlock).unwrap();
    let file = SlowFile::default();
    let recorder = Recorder::start(CellWriter::new(file.clone(), &cell, 0).unwrap(), |_| ()).unwrap();
    let mut ticks = recorder.robot(0, &monitor, 0.0);
    let (mut waiting, mut halted, mut free) = (0, 0, 0);
    for i in 0..20_000_u32 {
        let t_s = 0.002 * f64::from(i);
        // The table is granted for three of every four seconds; from time to time another robot is found in it.
        grants.write(SlotId(0), i % 2000 < 1500, i % 3000 > 2900);
        grants.write(SlotId(1), i % 700 < 350, false);
        let (q, qd) = ([position(t_s)], [velocity(t_s)]);
        let snapshot = Snapshot { qd: &qd, ..Snapshot::stationary(t_s, &q) };
        let report = monitor.tick(&snapshot);
        match report.reason {
            OverrideReason::Waiting(_) => waiting += 1,
            OverrideReason::Halted(_) => halted += 1,
            OverrideReason::Free => free += 1,
            _ => {}
        }
        ticks.tick(t_s, &snapshot, &report, &monitor);
        if i % 500 == 0 {
            // The test has no time between its ticks, so the recorder gets time here.
            while recorder.waiting_ticks() > 0 {
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
        }
    }
    // The rail moves on when it should not: most of the rest are faults, which are replayed too.
    assert!(waiting > 100 && halted > 10 && free > 1000, "{waiting} {halted} {free}");
    assert_eq!(recorder.lost_ticks(), 0);
    recorder.finish().unwrap();
    let found = replay(&file.bytes.lock().unwrap().get_ref()[..]).unwrap();
    assert_eq!((found.ticks, found.differences), (20_000, 0), "{:?}", found.robots);
}
