//! Decides which regions the active laws keep robots out of, and what is missing if they do not (`elbowroom check`).
//!
//! For each region and each robot that it guards, [`check`] decides whether entry is excluded, and why. The thickness
//! that the warning zone needs without the stopping-distance law is computed from the cell: v²/2a + v·t
//! (`docs/laws.md`, section 2), with the largest speed v of any guarded point in the robot's program, the deceleration
//! a of its joints (`stop_time`) and the reaction time t.
//!
//! ```
//! use elbowroom_cell::Cell;
//! use elbowroom_sim::check::check;
//! let text = r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.cart]
//! dh = [{ kind = "prismatic", min = 0, max = 5000, speed = 2000, acceleration = 8000 }]
//! links = [{ sphere = { radius = 50 } }]
//! stop_time = 0.25
//! [region.wall]
//! shape = "box"
//! base = [0, 0, 3500]
//! size = [1000, 1000, 1000]
//! warning = 50
//! [program.cart]
//! steps = [{ move = "joint", to = [5000] }]
//! "#;
//! let without_law = check(&Cell::parse("cart.toml", text)?)?;
//! assert!(!without_law[0].excluded);
//! assert!((without_law[0].needed_warning_m.unwrap() - 0.254).abs() < 1e-3); // 2²/(2·8) + 2·0.002, and a margin
//! let stopping = check(&Cell::parse("cart.toml", &format!("{text}[monitor]\nstopping_distance = true\n"))?)?;
//! assert!(stopping[0].excluded);
//! # Ok::<(), elbowroom_diagnostic::Diagnostic>(())
//! ```

mod entry_analysis;
mod entry_check;
mod initial_overlaps;
mod mounted_overlap;
mod program;
mod region_speed;
mod sphere_swept_hull;
mod stopping_profile;
mod table;
mod thickness;

use elbowroom_cell::trajectory::recording_warnings;
use elbowroom_cell::{Cell, CellRegionId, configure};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_robot::RobotId;

use entry_analysis::{EntryAnalysis, EntryDecision};
use initial_overlaps::{initial_overlaps, region_at_start, start_states};
use program::programs;
use region_speed::max_region_speed_m_s;

use crate::motion::PlannedPaths;

pub use entry_check::EntryCheck;
pub use table::table;

/// Analyses every region for every robot that it guards; regions in file order.
///
/// # Errors
/// [`Diagnostic`] at the line of an infeasible step of a program.
pub fn check(cell: &Cell) -> Result<Vec<EntryCheck>, Diagnostic> {
    check_planned(&PlannedPaths::new(cell))
}

/// Like [`check`], with paths that may be known already.
///
/// # Errors
/// As for [`check`].
pub fn check_planned(paths: &PlannedPaths<'_>) -> Result<Vec<EntryCheck>, Diagnostic> {
    let (cell, programs) = (paths.cell(), programs(paths)?);
    let slots = configure::slots(cell);
    let states = start_states(cell, &programs);
    let overlaps = initial_overlaps(cell, &programs, &states);
    let mut checks = Vec::new();
    for (index, region) in cell.regions.iter().enumerate() {
        let region_speed_m_s = max_region_speed_m_s(paths, region)?;
        let id = CellRegionId(index);
        for &robot in &region.robots {
            let shares = |other: CellRegionId| slots[other.0].is_some() && slots[other.0] == slots[index];
            let analysis = EntryAnalysis {
                cell,
                region: id,
                robot,
                program: &programs[robot.0],
                region_speed_m_s,
                region_in_world: region_at_start(cell, region, &states),
                starts_inside: overlaps.contains(&(id, robot)),
                shared_at_start: overlaps.iter().any(|(r, other)| *other != robot && shares(*r)),
            };
            let EntryDecision { excluded, reason, write_instead, needed_warning_m } = analysis.decide();
            let overrun = analysis.overrun();
            checks.push(EntryCheck { region: id, robot, excluded, reason, write_instead, needed_warning_m, overrun });
        }
    }
    Ok(checks)
}

/// Warnings before a run: one for each region and robot that can overrun its border under the active laws, with the
/// needed thickness of the warning zone.
///
/// # Errors
/// As for [`check`].
pub fn overruns(paths: &PlannedPaths<'_>) -> Result<Vec<Diagnostic>, Diagnostic> {
    Ok(check_planned(paths)?.into_iter().filter_map(|c| c.overrun).collect())
}

/// Warnings for recordings that exceed the joint limits of the cell; a run repeats them in its notes.
pub fn recordings(cell: &Cell) -> Vec<Diagnostic> {
    (0..cell.robots.len()).flat_map(|robot| recording_warnings(cell, RobotId(robot))).collect()
}
