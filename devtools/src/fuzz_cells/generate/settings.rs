//! Common parts of all kinds of random cells: folders, laws, programs.

use std::path::Path;

use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{CellSpec, StepSpec};

/// Folders of files that cells name.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a> {
    /// Folder of the cell files.
    pub cells: &'a Path,
    /// Root of the workspace.
    pub root: &'a Path,
    /// Folder of real robots, if it exists.
    pub data: Option<&'a Path>,
}

/// Chooses tick, laws and length.
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

/// Switches the stopping-distance law off in some cells: `check` then says whether their warning zones are thick enough.
pub fn laws(spec: &mut CellSpec, random: &mut Random) {
    if random.percent(35) {
        (spec.stopping_distance, spec.direction_aware) = (false, random.percent(30));
    }
}

/// Chooses the time from full speed to rest, s: from hard category-1 stops to slow stops of large robots.
pub fn stop_time(random: &mut Random) -> f64 {
    random.scaled(0.05, 1.5)
}

/// Makes moves to these places, with waits and changes of the override in between.
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
