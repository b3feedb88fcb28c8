//! What judges a run: it knows the cell and the recorded positions and switches, and nothing that the monitors said.
//!
//! Kinematics and distances are its own, on another path than the monitors': no code of `elbowroom-kinematics`,
//! `elbowroom-proximity` or `elbowroom-monitor` computes here. Between two ticks joints are taken to go straight.

mod arm;
mod exchange;
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
pub use guarded::Guarded;

use elbowroom_cell::{Cell, Recording};

/// A surface counts as crossed when it is crossed by more than this, m: rounding is below it.
pub const TOLERANCE_M: f64 = 1e-6;

/// What a run did that it must not do.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// A robot drove into a forbidden region that it was outside of.
    Entry { robot: usize, region: usize, t_s: f64, speed: f64 },
    /// Two robots were inside one exchange region.
    TwoInside { region: usize, robots: [usize; 2], t_s: f64 },
    /// Robots wait for one another for ever, and the recording does not say so.
    SilentDeadlock { robots: Vec<usize> },
    /// A joint slowed down harder than it can.
    TooHard { robot: usize, joint: usize, t_s: f64, deceleration: f64, limit: f64 },
}

/// What was found, and what else is worth counting.
#[derive(Debug, Clone, Default)]
pub struct Opinion {
    pub findings: Vec<Finding>,
    /// Entries into regions that ride on another robot, or on a belt that just changed its speed: nobody can foresee that.
    pub unforeseen_entries: usize,
    /// Sets of robots that wait for one another for ever.
    pub deadlocks: usize,
    /// Pairs of robot and region that were watched for entry.
    pub watched: usize,
}

/// Judges a recording; `bad_news` says whether the run reported that something went wrong.
///
/// # Errors
/// Names a region whose motion the oracle does not know.
pub fn judge(cell: &Cell, recording: &Recording, bad_news: bool) -> Result<Opinion, String> {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    let guarded: Vec<Vec<Guarded>> = cell.robots.iter().map(Guarded::all).collect();
    let motion = motion::Motion::new(cell, recording, &arms)?;
    let mut opinion = Opinion::default();
    presence::entries(&motion, &guarded, &mut opinion);
    exchange::judge(&motion, &guarded, bad_news, &mut opinion);
    physics::judge(cell, recording, &mut opinion);
    Ok(opinion)
}

/// Least distance (m) of a region from what it guards at the start, to a metre; 0 inside.
pub fn start_distance(cell: &Cell, region: usize) -> f64 {
    let arms: Vec<Arm> = cell.robots.iter().map(Arm::new).collect();
    let frames: Vec<_> = arms.iter().zip(&cell.robots).map(|(arm, r)| arm.frames(&r.start)).collect();
    // What cannot be judged is not called outside.
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
