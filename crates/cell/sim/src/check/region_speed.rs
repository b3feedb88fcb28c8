//! Largest speed of a dynamic region.

use elbowroom_cell::{Cell, CellRegion, Drive, Follow, PoseRate};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_robot::RobotId;

use super::sphere_swept_hull::SphereSweptHull;
use super::stopping_profile::{LinkSolid, Profile};
use crate::motion::{PlannedPaths, repeated_plan};

/// Largest speed (m/s) of any point of the region, as its source moves it.
///
/// 0 for a fixed region, infinite for a region on a robot that may leave its program.
pub(super) fn max_region_speed_m_s(paths: &PlannedPaths<'_>, region: &CellRegion) -> Result<f64, Diagnostic> {
    let Some(follow) = region.follow else { return Ok(0.0) };
    let cell = paths.cell();
    let in_source = region.region.anchor * region.region.shape_in_anchor;
    match follow {
        Follow::Encoder(e) => Ok(cell.frame_sources.encoders[e].fastest(0.0, cell.timing.max_s)),
        Follow::Object(o) => {
            let drive = cell.moving_objects.iter().find(|m| m.object == o).map(|m| &m.drive);
            let hull = SphereSweptHull::new(&region.region.shape, &in_source);
            Ok(match drive {
                None => 0.0,
                Some(Drive::Belt(encoder)) => encoder.fastest(0.0, cell.timing.max_s),
                Some(Drive::Path(path)) => path.fastest(hull.farthest_m()),
            })
        }
        Follow::Poses(p) => {
            let hull = SphereSweptHull::new(&region.region.shape, &in_source);
            let rates = cell.frame_sources.pose_tracks[p].rates();
            // A half-space in pure translation has one velocity everywhere.
            let fastest = |rate: PoseRate| {
                let PoseRate { speed_m_s, turn_rad_s, .. } = rate;
                if turn_rad_s > 0.0 { speed_m_s + turn_rad_s * hull.farthest_m() } else { speed_m_s }
            };
            Ok(rates.map(fastest).fold(0.0, f64::max))
        }
        Follow::Robot { robot, .. } if leaves_its_program(cell, robot) => Ok(f64::INFINITY),
        Follow::Robot { robot, link, in_link } => {
            let hull = SphereSweptHull::new(&region.region.shape, &(in_link * in_source));
            let plan = repeated_plan(paths, robot)?;
            let profile = Profile::of(cell, robot, &plan, &[LinkSolid { link, hull, grip: None }]);
            Ok(profile.stopping_profiles[0].fastest_m_s)
        }
    }
}

/// Whether a robot may leave its program, because it evades, replans around obstacles that sensors see, or is guided.
fn leaves_its_program(cell: &Cell, robot: RobotId) -> bool {
    let evades = cell.robots[robot.0].avoidance.is_some();
    evades || replans(cell, robot) || cell.guidance.operator_of(robot).is_some()
}

/// Whether a robot with a program replans around obstacles that sensors see.
pub(super) fn replans(cell: &Cell, robot: RobotId) -> bool {
    cell.robots[robot.0].program.is_some() && cell.sensors.iter().any(|sensor| sensor.robots.contains(&robot))
}
