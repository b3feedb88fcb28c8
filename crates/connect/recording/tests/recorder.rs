//! Recorder of a service: it never waits, counts its losses, and leaves a readable file if it is killed.
#![allow(clippy::print_stdout)]

use std::io::{self, BufRead, BufReader, Cursor, Seek, SeekFrom, Write};
use std::process::{Command, Stdio};
use std::sync::atomic::Ordering::SeqCst;
use std::time::{Duration, Instant};

use crate::common::{SlowFile, position, rail, velocity};
use elbowroom_monitor::{AccessClass, Fault, Monitor, Snapshot};
use elbowroom_recording::{BagError, CellWriter, Recorder, TickRecorder, replay};
use elbowroom_status::{CellStatus, RobotStatus};

/// Names the file that the second process of the test records into.
const FILE: &str = "ELBOWROOM_TEST_RECORDING";

fn tick(monitor: &mut Monitor, recorder: &mut TickRecorder, t_s: f64) -> CellStatus {
    let (q, qd) = ([position(t_s)], [velocity(t_s)]);
    let snapshot = Snapshot { qd: &qd, ..Snapshot::stationary(t_s, &q) };
    let report = monitor.tick(&snapshot);
    recorder.tick(t_s, &snapshot, &report, monitor);
    let robots = vec![RobotStatus::of_tick(t_s, monitor, &snapshot, &report, None)];
    CellStatus { t_s, robots, ..CellStatus::default() }
}

#[test]
fn what_a_service_records_replays_to_the_bit() {
    let (cell, mut monitor) = rail();
    let file = SlowFile::default();
    let recorder =
        Recorder::start(CellWriter::new(file.clone(), &cell, 1_700_000_000_000_000_000).unwrap(), |_| ()).unwrap();
    let mut ticks = recorder.robot(0, &monitor, 0.0);
    let gate = monitor.region("gate").unwrap();
    for i in 0..5000_u32 {
        if i % 500 == 250 {
            let on = i % 1000 == 250;
            monitor.switch(gate, on, AccessClass::Programmer).unwrap();
            ticks.switched(gate, on);
        }
        monitor.set_external_fault((2300..2600).contains(&i).then_some(Fault::Regions));
        recorder.status(tick(&mut monitor, &mut ticks, 0.002 * f64::from(i)));
        if i % 100 == 0 {
            // The test has no time between its ticks, so the recorder gets time here.
            while recorder.waiting_ticks() > 0 {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
    }
    assert_eq!(recorder.lost_ticks(), 0);
    recorder.finish().unwrap();
    let bytes = file.bytes.lock().unwrap().get_ref().clone();
    let found = replay(&bytes[..]).unwrap();
    assert_eq!((found.ticks, found.differences, found.cut_off), (5000, 0, false));
    let slowed = found.messages > 5000;
    assert!(slowed);
}

#[test]
fn a_file_that_does_not_answer_costs_ticks_and_no_time() {
    let (cell, mut monitor) = rail();
    let file = SlowFile::default();
    let recorder = Recorder::start(CellWriter::new(file.clone(), &cell, 0).unwrap(), |_| ()).unwrap();
    let mut ticks = recorder.robot(0, &monitor, 0.0);
    for i in 0..100_u32 {
        tick(&mut monitor, &mut ticks, 0.002 * f64::from(i));
    }
    std::thread::sleep(Duration::from_millis(100));
    file.is_closed.store(true, SeqCst);
    let begin = Instant::now();
    for i in 100..100_000_u32 {
        recorder.status(tick(&mut monitor, &mut ticks, 0.002 * f64::from(i)));
    }
    println!("100,000 ticks in {:?}", begin.elapsed());
    assert!(begin.elapsed() < Duration::from_mins(1));
    let lost = recorder.lost_ticks();
    // The data in memory is bounded: the ticks of one robot, and a chunk.
    assert!(lost > 80_000, "only {lost} ticks were left out");
    file.is_closed.store(false, SeqCst);
    std::thread::sleep(Duration::from_millis(200));
    tick(&mut monitor, &mut ticks, 200.0);
    recorder.finish().unwrap();
    let found = replay(&file.bytes.lock().unwrap().get_ref()[..]).unwrap();
    let robot = &found.robots[0];
    assert_eq!((found.lost_ticks, found.differences), (lost, 0));
    // Ticks after the first missing one are not compared.
    assert!(robot.ticks >= 100 && robot.skipped >= 1);
    assert_eq!(robot.ticks + lost + robot.skipped, 100_001);
}

/// A file on a disk with room for a limited number of bytes.
struct SmallDisk {
    file: Cursor<Vec<u8>>,
    room: usize,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.file.get_ref().len() + bytes.len() > self.room {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for SmallDisk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

#[test]
fn a_full_disk_is_said_once_and_at_once() {
    let (cell, mut monitor) = rail();
    let disk = SmallDisk { file: Cursor::default(), room: 200_000 };
    let (said, hears) = std::sync::mpsc::channel();
    let on_error = move |e: &BagError| said.send(e.to_string()).unwrap();
    let recorder = Recorder::start(CellWriter::new(disk, &cell, 0).unwrap(), on_error).unwrap();
    let mut ticks = recorder.robot(0, &monitor, 0.0);
    let began = Instant::now();
    let message = (0..).find_map(|i| {
        assert!(began.elapsed() < Duration::from_secs(30), "nothing was said");
        recorder.status(tick(&mut monitor, &mut ticks, 0.002 * f64::from(i)));
        std::thread::sleep(Duration::from_micros(200));
        hears.try_recv().ok()
    });
    assert!(message.as_ref().is_some_and(|m| m.contains("the recording cannot be written")), "{message:?}");
    assert!(recorder.finish().is_err());
    assert!(hears.try_recv().is_err(), "it was said twice");
}

/// Not a separate test: the process that [`a_killed_process_leaves_a_file_up_to_its_last_second`] starts.
#[test]
fn records_until_it_is_killed() {
    let Some(path) = std::env::var_os(FILE) else { return };
    let (cell, mut monitor) = rail();
    let recorder = Recorder::start(CellWriter::create(path.as_ref(), &cell, 0).unwrap(), |_| ()).unwrap();
    let mut ticks = recorder.robot(0, &monitor, 0.0);
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_mins(1) {
        let t_s = begin.elapsed().as_secs_f64();
        recorder.status(tick(&mut monitor, &mut ticks, t_s));
        println!("tick {t_s}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_killed_process_leaves_a_file_up_to_its_last_second() {
    // One process is killed after its first written second, one after its second, both at the same time.
    std::thread::scope(|scope| {
        for lifetime_s in [1.7, 2.7] {
            scope.spawn(move || killed_after(lifetime_s));
        }
    });
}

fn killed_after(lifetime_s: f64) {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("killed.mcap");
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "recorder::records_until_it_is_killed", "--nocapture"])
        .env(FILE, &file)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let output = BufReader::new(child.stdout.take().unwrap());
    let mut lines = output.lines().map_while(Result::ok).filter_map(|l| l.strip_prefix("tick ")?.parse().ok());
    let first: f64 = lines.next().unwrap();
    let last = lines.find(|t: &f64| *t - first > lifetime_s).unwrap();
    // SIGKILL.
    child.kill().unwrap();
    child.wait().unwrap();
    let found = replay(std::fs::File::open(&file).unwrap()).unwrap();
    println!("killed at {last:.3} s, readable until {:.3} s", found.robots[0].until_s);
    assert!(found.cut_off && found.differences == 0);
    // A second, and the delay of a busy machine.
    assert!(last - found.robots[0].until_s < 1.5, "{} of {last}", found.robots[0].until_s);
}

#[test]
fn a_urdf_that_lies_there_without_a_recording_is_not_overwritten() {
    let dir = tempfile::tempdir().unwrap();
    let (recording, urdf) = (dir.path().join("arm.mcap"), dir.path().join("arm.urdf"));
    let (cell, _) = rail();
    std::fs::write(&urdf, "made by hand").unwrap();
    let error = CellWriter::create(&recording, &cell, 0).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("arm.urdf: is there already\n  write: "), "{error}");
    assert_eq!(std::fs::read_to_string(&urdf).unwrap(), "made by hand");
    assert!(!recording.exists());
    // A URDF that was written with a recording is replaced together with it.
    std::fs::remove_file(&urdf).unwrap();
    for _ in 0..2 {
        CellWriter::create(&recording, &cell, 0).map(|_| ()).unwrap();
        assert!(std::fs::read_to_string(&urdf).unwrap().contains("<robot"));
    }
}
