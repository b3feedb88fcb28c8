//! Where robots start, and how far regions are from them.

use elbowroom_cell::{Cell, ProgramBody};

use super::arm::Arm;
use super::guarded::Guarded;
use super::place::Place;

/// Returns the least distance (m) of a region at the start from the solids that it guards against, up to a metre; 0 inside.
pub fn start_distance(cell: &Cell, region: usize) -> f64 {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    let frames: Vec<_> = arms.iter().enumerate().map(|(robot, arm)| arm.frames(start(cell, robot))).collect();
    let place = Place::new(cell, region, None);
    let at = place.at(0.0, &frames);
    let one = |robot: &usize| {
        let counts = |g: &Guarded| g.counts_for(place.guards) && g.is_there_at_start(&cell.robots[*robot]);
        let guarded = Guarded::all(&cell.robots[*robot]).into_iter().filter(counts);
        let distance = |g: Guarded| {
            let is_inside = place.contains(&at, g.any_point(&frames[*robot]));
            if is_inside { 0.0 } else { g.distance(&frames[*robot], &place.solid, &at, 1.0).lower }
        };
        guarded.map(distance).fold(1.0, f64::min)
    };
    place.robots.iter().map(one).fold(1.0, f64::min)
}

/// Returns the joint values at the start; for a recording its first row.
pub fn start(cell: &Cell, robot: usize) -> &[f64] {
    match cell.robots[robot].program.as_ref().map(|p| &p.body) {
        Some(ProgramBody::Trajectory(trajectory)) => trajectory.first().unwrap_or(&cell.robots[robot].start),
        _ => &cell.robots[robot].start,
    }
}
