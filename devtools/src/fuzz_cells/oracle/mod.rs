//! Oracle of the fuzzer: it knows the cell, the recorded positions and the switches, but nothing that the monitors
//! reported.
//!
//! Kinematics and distances are its own, computed in a different way than the monitors': it uses no code of
//! `elbowroom-kinematics`, `elbowroom-proximity` or `elbowroom-monitor`. Between two ticks joints are assumed to move
//! linearly.

mod arm;
pub mod as_written;
mod carrier;
mod cooperating;
mod entry;
mod exchange;
pub mod findings;
mod frame;
mod grids;
mod guarded;
mod guided;
mod held_parts;
mod in_view;
mod kept_axes;
mod mechanisms;
mod motion;
mod mounted;
mod physics;
mod place;
mod planned_paths;
#[cfg(test)]
mod planted_tests;
mod presence;
mod promises;
pub mod readings;
pub mod recorded;
pub mod seen;
mod seen_box;
mod seen_part;
mod shield;
mod simplex;
mod solid;
mod start;
mod sweep;
#[cfg(test)]
mod tests;
mod track;
mod while_inside;

pub use arm::Arm;
pub use findings::{Finding, Findings, Judged};
pub use frame::Frame;
pub use guarded::Guarded;
pub use guided::is_clear as is_clear_at_start;
pub use promises::Promises;
pub use seen_box::is_clear_of_box;
pub use start::start_distance;

use elbowroom_cell::Cell;
use elbowroom_sim::Recording;

/// Checks a recording against the promises of `check` for its cell; `has_violation` is whether the run reported that
/// something went wrong.
pub fn check(cell: &Cell, recording: &Recording, promises: &Promises<'_>, has_violation: bool) -> Findings {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    let motion = motion::OracleMotion::new(cell, recording, &arms);
    let guarded = guarded(cell, &motion);
    let mut findings = Findings::default();
    presence::entries(&motion, &guarded, promises, &mut findings);
    exchange::check(&motion, &guarded, promises, has_violation, &mut findings);
    physics::check(cell, recording, &mut findings);
    guided::check(cell, recording, &arms, &mut findings);
    entry::check(cell, recording, &arms, &mut findings);
    cooperating::check(cell, recording, &arms, &mut findings);
    planned_paths::check(cell, recording, &arms, &mut findings);
    kept_axes::check(cell, recording, &arms, &mut findings);
    grids::check(cell, recording, &arms, &mut findings);
    mechanisms::check(cell, recording, &mut findings);
    while_inside::check(&motion, &guarded, &mut findings);
    findings
}

/// Returns the solids of each robot that can count at some time of a run.
fn guarded(cell: &Cell, motion: &motion::OracleMotion<'_>) -> Vec<Vec<Guarded>> {
    let mut guarded: Vec<Vec<Guarded>> = cell.robots.iter().map(Guarded::all).collect();
    for grip in &motion.grips {
        guarded[grip.robot].push(grip.guarded(cell));
    }
    guarded
}
