//! Largest speed of a dynamic region.

use elbowroom_cell::{Cell, CellRegion, Drive, Follow, Frames, MeasuredSource, PoseRate};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_monitor::SourceLimits;
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
    if let Some(index) = Frames::new(cell).measured_source(&follow) {
        // A live cell moves it as messages say, not as the file; a robot stops if they exceed the limits.
        let SourceLimits { speed_m_s, turn_rad_s, .. } = region.source_limits;
        let hull = SphereSweptHull::new(&region.region.shape, &in_source);
        return Ok(match cell.frame_sources.measured[index] {
            MeasuredSource::Encoder(_) => speed_m_s,
            MeasuredSource::Object(_) => speed_m_s + turn_rad_s * hull.farthest_m(),
        });
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The speed of a region on a belt that stands in the file, or on an object that stands.
    fn speed(belt: &str, thing: &str, follow: &str) -> f64 {
        let text = format!(
            r#"
version = 1
units = {{ length = "mm", angle = "rad" }}
[robot.rail]
dh = [{{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }}]
links = [{{ sphere = {{ radius = 50 }} }}]
[encoder.belt]
speed = 0
{belt}
[object.thing]
shape = "box"
size = [100, 100, 100]
at = [3000, 0, 0]
{thing}
[region.ball]
shape = "sphere"
centre = [300, 0, 0]
radius = 200
warning = 100
follow = {{ {follow} }}
"#
        );
        let cell = Cell::parse("ball.toml", &text).unwrap_or_else(|e| panic!("{e}"));
        max_region_speed_m_s(&PlannedPaths::new(&cell), &cell.regions[0]).unwrap()
    }

    #[test]
    fn what_is_measured_may_be_as_fast_as_its_limits() {
        let measured = "measured = true";
        let belt = "encoder = \"belt\", max_speed = 500";
        let thing = "object = \"thing\", max_speed = 500, max_turn = 2";
        let on_belt = "follow = { encoder = \"belt\" }";
        assert_eq!((speed("", "", belt), speed("", "", thing), speed("", on_belt, thing)), (0.0, 0.0, 0.0));
        assert_eq!((speed(measured, "", belt), speed(measured, on_belt, thing)), (0.5, 0.5));
        assert_eq!(speed(measured, "", "encoder = \"belt\""), SourceLimits::default().speed_m_s);
        // The far side of the ball is 0.5 m from the origin of the thing.
        assert!((speed("", measured, thing) - (0.5 + 2.0 * 0.5)).abs() < 1e-12);
    }
}
