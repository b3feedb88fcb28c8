//! What all kinds of random cells have in common: folders, laws, programs.

use std::path::Path;

use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{CellSpec, StepSpec};

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

/// Tick, laws and length.
pub fn settings(random: &mut Random) -> CellSpec {
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

/// Lets some cells do without the stopping distance: `check` says where their warning zones are thick enough.
pub fn laws(spec: &mut CellSpec, random: &mut Random) {
    if random.percent(35) {
        (spec.stopping_distance, spec.direction_aware) = (false, random.percent(30));
    }
}

/// Full speed to rest: hard category-1 stops to the slow ones of big robots.
pub fn stop_time(random: &mut Random) -> f64 {
    random.scaled(0.05, 1.5)
}

/// Moves to these places, with waits and changes of the override in between.
pub fn program(places: Vec<Vec<f64>>, linear: Option<(f64, f64)>, random: &mut Random) -> Vec<StepSpec> {
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
