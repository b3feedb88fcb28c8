//! Random cells.

mod exchange;
mod faults;
mod moving;
mod region;
mod robot;

use std::path::Path;

use elbowroom_cell::Cell;

use super::random::Random;
use super::spec::{CellSpec, StepSpec};

/// What a cell is to find out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Forbidden regions, with the stopping distance on.
    Stop,
    /// Exchange regions of 2 to 6 robots.
    Exchange,
    /// As `Stop`, with faults in the monitors' input.
    Faults,
}

impl Kind {
    pub const ALL: [Self; 3] = [Self::Stop, Self::Exchange, Self::Faults];

    pub fn name(self) -> &'static str {
        match self {
            Self::Stop => "stop",
            Self::Exchange => "exchange",
            Self::Faults => "faults",
        }
    }

    /// The random numbers of one case.
    pub fn random(self, seed: u64, case: u64) -> Random {
        Random::of_case(seed, case + ((self as u64) << 32))
    }
}

/// Where files are that cells name.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a> {
    /// The folder that the cell files stand in.
    pub cells: &'a Path,
    /// The workspace.
    pub root: &'a Path,
    /// The folder of real robots, where there is one.
    pub data: Option<&'a Path>,
}

/// A random cell of a kind; always the same for the same stream.
pub fn cell(kind: Kind, random: &mut Random, places: &Places<'_>) -> CellSpec {
    match kind {
        Kind::Exchange => exchange::cell(random),
        Kind::Stop => stop(random, places),
        Kind::Faults => {
            let mut spec = stop(random, places);
            faults::add(&mut spec, random);
            spec
        }
    }
}

fn stop(random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = settings(random);
    spec.robots.push(robot::any(random, places));
    if random.percent(15) {
        let mut second = robot::small(random);
        second.at = [random.between(-1.5, 1.5), random.between(-1.5, 1.5), random.between(-0.5, 0.5)];
        spec.robots.push(second);
    }
    // Without regions first: they are put where the robot will come.
    let Ok(cell) = Cell::parse(places.cells.join("fuzz.toml"), &spec.to_toml()) else { return spec };
    for i in 0..random.whole(1, 3) {
        if let Some(region) = region::in_the_way(&spec, &cell, &format!("g{i}"), random) {
            spec.regions.push(region);
        }
    }
    moving::some(&mut spec, random);
    spec
}

/// Tick, laws and length.
fn settings(random: &mut Random) -> CellSpec {
    CellSpec {
        tick_ms: random.one(&[1.0, 2.0, 4.0, 4.0, 8.0]),
        max_s: 8.0,
        stopping_distance: true,
        reaction_ms: if random.percent(30) { 0.0 } else { (random.unit() * 60.0).round() },
        direction_aware: random.percent(50),
        recovery_percent: random.one(&[0.0, 10.0, 50.0]),
        ..CellSpec::default()
    }
}

/// Full speed to rest: hard category-1 stops to the slow ones of big robots.
fn stop_time(random: &mut Random) -> f64 {
    random.scaled(0.05, 1.5)
}

/// Moves to these places, with waits and changes of the override in between.
fn program(places: Vec<Vec<f64>>, linear: Option<(f64, f64)>, random: &mut Random) -> Vec<StepSpec> {
    let mut steps = Vec::new();
    for to in places {
        if random.percent(20) {
            steps.push(StepSpec::Wait(random.between(0.01, 0.2)));
        }
        if random.percent(20) {
            steps.push(StepSpec::Override(random.whole(20, 100) as f64));
        }
        steps.push(match linear {
            Some((low, high)) if random.percent(50) => StepSpec::Linear { to, speed: random.scaled(low, high) },
            _ => StepSpec::Joint { to, percent: if random.percent(60) { 100.0 } else { random.whole(20, 100) as f64 } },
        });
    }
    steps
}
