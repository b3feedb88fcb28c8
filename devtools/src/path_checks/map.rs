//! Paths on the joint-space map of the planner's example arm.

use elbowroom_kinematics::JointLimits;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use elbowroom_cspace::{ConvexObstacle, Grid, JointMap};
use elbowroom_planner::{GridPlanner, GridPlannerSettings, example};
use elbowroom_testkit::random::SplitMix;

use super::course::{Course, along};

/// Width of a cell, degrees.
const STEP: f64 = 2.0;
/// Time between rows of a motion, s.
const PERIOD: f64 = 0.004;

/// Plans between the centres of random free cells.
pub fn course(folder: &Path, name: &str, obstacles: &[ConvexObstacle], pairs: usize) -> Result<Course, String> {
    fn text(e: impl std::fmt::Display) -> String {
        e.to_string()
    }
    let grid = example::grid(STEP).map_err(text)?;
    let scene = example::scene(&grid, obstacles).map_err(text)?;
    let mut map = JointMap::new(example::ARM, &grid).map_err(text)?;
    map.set_fixed(obstacles);
    let mut planner = GridPlanner::new(&grid, map.occupancy()).map_err(text)?;
    let limits = [[1.5, 3.0, 30.0], [1.5, 3.0, 30.0], [2.0, 5.0, 50.0]].map(|[v, a, j]| JointLimits::new(v, a, j));
    let mut course = Course::new(name, urdf(folder, &grid)?, scene);
    let mut random = SplitMix(1);
    while course.asked < pairs {
        let [from, to] = [0, 1].map(|_| free(&grid, &map, &mut random));
        course.asked += 1;
        let clock = Instant::now();
        let path = planner.plan(from, to, &GridPlannerSettings::default());
        course.planning.push(clock.elapsed());
        let Ok(path) = path else { continue };
        course.found += 1;
        course.straight += usize::from(path.waypoints.len() == 2);
        course.corners += path.waypoints.len().saturating_sub(2);
        let clock = Instant::now();
        let motion = planner
            .time_parametrize(&path, &limits)
            .and_then(|motion| motion.aligned_to_ticks(PERIOD))
            .map_err(text)?;
        course.timing.push(clock.elapsed());
        course.stops += motion.stops();
        course.paths.push(along(&path.waypoints));
        course.paths.push(motion.samples(PERIOD).map_err(text)?);
    }
    Ok(course)
}

fn free(grid: &Grid, map: &JointMap, random: &mut SplitMix) -> [f64; 3] {
    loop {
        let cell = map.occupancy().shape().map(|n| ((random.unit() * n as f64) as usize).min(n - 1) as u16);
        if !map.occupancy().is_blocked(cell) {
            return grid.center(cell);
        }
    }
}

/// Writes the arm's joints for Pinocchio; its solids are passed separately.
fn urdf(folder: &Path, grid: &Grid) -> Result<PathBuf, String> {
    let robot = example::robot(grid).map_err(|e| e.to_string())?;
    let chain = &robot.chain;
    let mut text = String::from("<robot name=\"arm\">\n");
    for link in chain.links() {
        let _ = writeln!(text, "  <link name=\"{link}\"/>");
    }
    for j in chain.joints() {
        let ([x, y, z], a) = (j.origin.translation.to_array(), j.axis.to_array());
        let (parent, child) = (&chain.links()[j.parent.0], &chain.links()[j.child.0]);
        let _ = writeln!(
            text,
            "  <joint name=\"{}\" type=\"revolute\"><origin xyz=\"{x} {y} {z}\"/><axis xyz=\"{} {} {}\"/>\
             <parent link=\"{parent}\"/><child link=\"{child}\"/><limit lower=\"{}\" upper=\"{}\" effort=\"1\" velocity=\"1\"/></joint>",
            j.name, a[0], a[1], a[2], j.limits.lower, j.limits.upper
        );
    }
    text.push_str("</robot>\n");
    let path = folder.join("arm.urdf");
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(path)
}
