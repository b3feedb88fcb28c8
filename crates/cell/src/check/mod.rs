//! Which regions are kept free by the laws that are on, and what is missing where they are not (`elbowroom check`).
//!
//! For each region and each robot that it concerns, [`check`] says whether entry is excluded and why. The thickness that the
//! warning zone needs without the stopping-distance law is worked out from the cell's own numbers: v²/2a + v·t
//! (`docs/laws.md`, section 2), with the largest speed v that any guarded point reaches in the robot's program, the
//! deceleration a of its joints (`stop_time`) and the reaction time t.
//!
//! ```
//! use elbowroom_cell::{Cell, check::check};
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
//! let bare = check(&Cell::parse("cart.toml", text)?)?;
//! assert!(!bare[0].excluded);
//! assert!((bare[0].needed_warning_m.unwrap() - 0.254).abs() < 1e-3); // 2²/(2·8) + 2·0.002, and a margin
//! let stopping = check(&Cell::parse("cart.toml", &format!("{text}[monitor]\nstopping_distance = true\n"))?)?;
//! assert!(stopping[0].excluded);
//! # Ok::<(), elbowroom_formats::FormatError>(())
//! ```

mod decide;
mod outline;
mod profile;
mod start;
mod table;
mod thickness;
mod travel;

use elbowroom_formats::{FormatError, Warning};
use elbowroom_monitor::{Guards, Kind};

use crate::motion::recording_warnings;
use crate::{Cell, configure};
use decide::{Decision, Pair};
use outline::Outline;
use profile::{Profile, Rider};

pub use table::table;

/// What is known of one region and one robot that it concerns.
#[derive(Debug, Clone, PartialEq)]
pub struct EntryCheck {
    /// Index of the region in the cell.
    pub region: usize,
    /// Index of the robot in the cell.
    pub robot: usize,
    /// True where the laws that are on keep the robot out, under the assumptions in `reason`. False for a monitored region,
    /// which is not meant to keep anybody out.
    pub excluded: bool,
    /// Why, in words.
    pub reason: String,
    /// What to write into the cell file instead, where entry is not excluded and that can be said.
    pub write_instead: Option<String>,
    /// Thickness (m) of the warning zone from which the robot stops in time without the stopping-distance law; `None` for a
    /// monitored region, and where no thickness is enough.
    pub needed_warning_m: Option<f64>,
    /// Where the robot can overrun the border: what to tell the user before a run.
    pub overrun: Option<Warning>,
}

impl EntryCheck {
    /// True where a robot can enter a region that is meant to keep it out.
    pub fn is_bad(&self, cell: &Cell) -> bool {
        !self.excluded && !matches!(cell.regions[self.region].region.kind, Kind::Monitored { .. })
    }
}

/// Judges every region for every robot that it concerns; regions in file order.
///
/// # Errors
/// [`FormatError`] at the line of a program's step that cannot be done.
pub fn check(cell: &Cell) -> Result<Vec<EntryCheck>, FormatError> {
    let programs = programs(cell)?;
    let slots = configure::slots(cell);
    let inside = start::inside(cell, &programs);
    let mut checks = Vec::new();
    for (index, region) in cell.regions.iter().enumerate() {
        let travel_m_s = travel::fastest(cell, region)?;
        for robot in &region.robots {
            let shares = |other: &usize| slots[*other].is_some() && slots[*other] == slots[index];
            let pair = Pair {
                cell,
                region: index,
                robot: *robot,
                program: &programs[*robot],
                travel_m_s,
                starts_inside: inside.contains(&(index, *robot)),
                shared_at_start: inside.iter().any(|(r, other)| other != robot && shares(r)),
            };
            let Decision { excluded, reason, write_instead, needed_warning_m } = pair.decide();
            let overrun = pair.overrun();
            let robot = *robot;
            checks.push(EntryCheck {
                region: index,
                robot,
                excluded,
                reason,
                write_instead,
                needed_warning_m,
                overrun,
            });
        }
    }
    Ok(checks)
}

/// What to tell the user before a run: one warning for each region and robot that can overrun its border by the laws that
/// are on, with the thickness that the warning zone needs.
///
/// # Errors
/// As for [`check`].
pub fn overruns(cell: &Cell) -> Result<Vec<Warning>, FormatError> {
    Ok(check(cell)?.into_iter().filter_map(|c| c.overrun).collect())
}

/// What to tell the user of recordings that ask more of a joint than the cell states of it. A run tells it among its notes.
pub fn recordings(cell: &Cell) -> Vec<Warning> {
    (0..cell.robots.len()).flat_map(|robot| recording_warnings(cell, robot)).collect()
}

/// A robot's program and the guarded volumes that it moves.
struct RobotProgram {
    volumes: Vec<elbowroom_monitor::Volume>,
    profile: Profile,
}

impl RobotProgram {
    /// The paces of the volumes that count for these guards.
    fn paces(&self, guards: Guards) -> impl Iterator<Item = &profile::Pace> {
        self.volumes.iter().zip(&self.profile.paces).filter(move |(v, _)| v.part.counts_for(guards)).map(|(_, p)| p)
    }
}

fn programs(cell: &Cell) -> Result<Vec<RobotProgram>, FormatError> {
    let of = |index: usize| {
        let volumes = cell.robots[index].guarded_volumes();
        let riders: Vec<_> =
            volumes.iter().map(|v| Rider { link: v.link, outline: Outline::new(&v.shape, &v.in_link) }).collect();
        Ok(RobotProgram { profile: Profile::of(cell, index, &riders)?, volumes })
    };
    (0..cell.robots.len()).map(of).collect()
}
