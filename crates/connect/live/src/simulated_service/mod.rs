//! Schedules of a whole service in simulated time: arbiter, keeper of the regions, control requests, nodes, controllers and
//! a measured belt are the parts that a process runs, without their threads; network, clocks, disks and restarts are drawn.
//!
//! `ELBOWROOM_SCHEDULES=100000` runs that many schedules, `ELBOWROOM_SCHEDULES=500..501` that one.

mod cell;
mod fault_effects;
mod faults;
mod judge;
mod network;
mod process;
mod process_clock;
mod rail;
mod recording;
mod requests;
mod wait_reasons;
mod waits;
mod world;

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use cell::{Follows, SimulatedCell};
use judge::Findings;
use process_clock::{set_sleeper, true_us};
use world::World;

pub(crate) use process_clock::ProcessClock;

use crate::locked::locked;

/// Number of findings after which no further schedule begins.
const ENOUGH: usize = 10;
/// Number of schedules between two lines of progress.
const PROGRESS: u64 = 1_000;
/// Length of a schedule.
const LENGTH_US: u64 = 5_000_000;

/// Cells of the schedules, read once per thread.
fn cells(folder: &std::path::Path) -> Vec<Rc<SimulatedCell>> {
    let kinds = [(2, Follows::Nothing), (3, Follows::Nothing), (3, Follows::Carriage), (3, Follows::Belt)];
    let cell = |(number, (rails, follows))| {
        let folder = folder.join(format!("cell{number}"));
        std::fs::create_dir_all(&folder).expect("a folder");
        Rc::new(SimulatedCell::new(rails, follows, &folder))
    };
    kinds.into_iter().enumerate().map(cell).collect()
}

/// What schedules have shown, and how often each thing has happened.
#[derive(Debug, Default)]
struct Outcome {
    findings: Findings,
    counts: BTreeMap<&'static str, u64>,
}

impl Outcome {
    fn add(&mut self, seed: u64, other: Self) {
        self.findings.wrong.extend(other.findings.wrong.into_iter().map(|wrong| format!("schedule {seed}: {wrong}")));
        self.findings.passages += other.findings.passages;
        self.findings.arrivals += other.findings.arrivals;
        self.findings.held_ms += other.findings.held_ms;
        for (what, count) in other.counts {
            *self.counts.entry(what).or_default() += count;
        }
    }
}

fn schedule(cells: &[Rc<SimulatedCell>], seed: u64) -> Outcome {
    let folder = tempfile::tempdir().expect("a folder");
    let world = World::new(&cells[(seed % 4) as usize], folder.path(), seed, LENGTH_US);
    while true_us() < LENGTH_US {
        let pause_us = 50_000 + world.random.borrow_mut().bits() % 900_000;
        world.advance(true_us() + pause_us);
        // Without requests, waits are longer than their usual reasons.
        if !seed.is_multiple_of(5) {
            world.ask();
        }
    }
    set_sleeper(None);
    world.end_all();
    let mut findings = std::mem::take(&mut world.judge.borrow_mut().findings);
    findings.arrivals = world.arrivals();
    let counts = std::mem::take(&mut world.plan().counts);
    Outcome { findings, counts }
}

/// Runs schedules on all cores.
fn run(seeds: &Range<u64>) -> Outcome {
    let (next, all) = (AtomicU64::new(seeds.start), Mutex::new(Outcome::default()));
    let work = || {
        let folder = tempfile::tempdir().expect("a folder");
        let cells = cells(folder.path());
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end || locked(&all).findings.wrong.len() >= ENOUGH {
                return;
            }
            let outcome = schedule(&cells, seed);
            locked(&all).add(seed, outcome);
            if seed % PROGRESS == PROGRESS - 1 {
                eprintln!("{} schedules, {} findings", seed + 1 - seeds.start, locked(&all).findings.wrong.len());
            }
        }
    };
    std::thread::scope(|scope| {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        (0..workers).for_each(|_| drop(scope.spawn(work)));
    });
    all.into_inner().expect("no schedule panicked")
}

/// The seeds to run: `ELBOWROOM_SCHEDULES` is their number or range (`20000..30000`).
fn seeds(default: u64) -> Range<u64> {
    let text = std::env::var("ELBOWROOM_SCHEDULES").unwrap_or_default();
    let (from, to) = text.split_once("..").unwrap_or(("0", &text));
    from.parse().unwrap_or(0)..to.parse().unwrap_or(default)
}

#[test]
#[allow(clippy::print_stdout, reason = "figures of a test")]
fn nobody_enters_what_an_answer_has_closed_and_no_region_is_shared() {
    let seeds = seeds(40);
    let Outcome { findings, counts } = run(&seeds);
    println!("schedules {seeds:?} of {} s: {findings:?}\n{counts:?}", LENGTH_US / 1_000_000);
    assert!(findings.wrong.is_empty(), "{} findings, the first: {}", findings.wrong.len(), findings.wrong[0]);
    if seeds.clone().count() >= 40 {
        let happened = [
            "add",
            "move",
            "remove",
            "switch",
            "requests refused",
            "killed",
            "paused",
            "cut",
            "late",
            "full disks",
            "second nodes",
            "ticks replayed",
            "looks at waits",
        ];
        let missing: Vec<&str> = happened.into_iter().filter(|what| !counts.contains_key(what)).collect();
        assert!(
            missing.is_empty() && findings.passages > 40 && findings.arrivals > 40 && findings.held_ms > 0,
            "{missing:?}"
        );
    }
}

/// A schedule that was found is found again: nothing depends on threads, time or memory.
#[test]
fn a_schedule_is_the_same_every_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let cells = cells(folder.path());
    let once = |seed| {
        let Outcome { findings, counts } = schedule(&cells, seed);
        (findings, counts)
    };
    for seed in 0..4 {
        assert_eq!(once(seed), once(seed));
    }
}
