//! A file that waits, and a monitor with something to record.

#![allow(dead_code)]

use std::io::{Cursor, Result, Seek, SeekFrom, Write};
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use elbowroom_cell::{Cell, configure};
use elbowroom_monitor::Monitor;

/// A file in memory that accepts nothing while it is closed, like a disk that does not respond.
#[derive(Clone, Default)]
pub struct SlowFile {
    pub bytes: Arc<Mutex<Cursor<Vec<u8>>>>,
    pub is_closed: Arc<AtomicBool>,
}

impl SlowFile {
    fn wait(&self) {
        while self.is_closed.load(SeqCst) {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

impl Write for SlowFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.wait();
        self.bytes.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        self.wait();
        Ok(())
    }
}

impl Seek for SlowFile {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.bytes.lock().unwrap().seek(to)
    }
}

/// Makes a rail with a forbidden region, and its monitor.
pub fn rail() -> (Cell, Monitor) {
    let text = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
[region.end]
shape = "plane"
origin = [0, 0, 1900]
x = [0, 1, 1900]
y = [1, 0, 1900]
warning = 300
guards = ["tcp"]
[region.gate]
shape = "sphere"
centre = [0, 0, 300]
radius = 50
warning = 200
life = "temporary"
guards = ["tcp"]
"#;
    let cell = Cell::parse("rail.toml", text).unwrap();
    let setups = configure::setups(&cell).unwrap();
    let monitor = configure::monitors(&cell, &setups).unwrap().remove(0);
    (cell, monitor)
}

/// Position of the rail at a time: it always moves.
pub fn position(t_s: f64) -> f64 {
    0.9 + 0.8 * (0.5 * t_s).sin()
}

/// Velocity of the rail at a time.
pub fn velocity(t_s: f64) -> f64 {
    0.4 * (0.5 * t_s).cos()
}
