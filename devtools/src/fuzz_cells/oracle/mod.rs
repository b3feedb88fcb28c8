//! The oracle of the fuzzer: it knows the cell, the recorded positions and the switches, and nothing of what the monitors
//! reported.
//!
//! Kinematics and distances are its own, on another path than the monitors': no code of `elbowroom-kinematics`,
//! `elbowroom-proximity` or `elbowroom-monitor` computes here. Between two ticks joints are taken to go straight.

mod arm;
mod exchange;
pub mod findings;
mod frame;
mod guarded;
mod motion;
mod physics;
mod place;
mod presence;
mod simplex;
mod solid;
mod sweep;
#[cfg(test)]
mod tests;

pub use arm::Arm;
pub use findings::{Finding, Findings};
pub use guarded::Guarded;

use elbowroom_cell::Cell;
use elbowroom_sim::Recording;

/// Checks a recording; `has_violation` says whether the run reported that something went wrong.
///
/// # Errors
/// Names a region whose motion the oracle does not know.
pub fn check(cell: &Cell, recording: &Recording, has_violation: bool) -> Result<Findings, String> {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    let guarded: Vec<Vec<Guarded>> = cell.robots.iter().map(Guarded::all).collect();
    let motion = motion::OracleMotion::new(cell, recording, &arms)?;
    let mut findings = Findings::default();
    presence::entries(&motion, &guarded, &mut findings);
    exchange::check(&motion, &guarded, has_violation, &mut findings);
    physics::check(cell, recording, &mut findings);
    Ok(findings)
}

/// Least distance (m) of a region from what it guards at the start, to a metre; 0 inside.
pub fn start_distance(cell: &Cell, region: usize) -> f64 {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    let frames: Vec<_> = arms.iter().zip(&cell.robots).map(|(arm, r)| arm.frames(&r.start)).collect();
    // What cannot be checked is not called outside.
    let Ok(place) = place::Place::new(cell, region, &arms) else { return 0.0 };
    let at = place.at(place.travel_at(0.0).0, &frames);
    let one = |robot: &usize| {
        let guarded = Guarded::all(&cell.robots[*robot]);
        let near = guarded.iter().filter(|g| g.counts_for(place.guards));
        near.map(|g| g.distance(&frames[*robot], &place.solid, &at, 1.0).lower).fold(1.0, f64::min)
    };
    let surface = place.robots.iter().map(one).fold(1.0, f64::min);
    let inside = place.robots.iter().any(|r| {
        Guarded::all(&cell.robots[*r])
            .iter()
            .any(|g| g.counts_for(place.guards) && place.contains(&at, g.center(&frames[*r])))
    });
    if inside { 0.0 } else { surface }
}
