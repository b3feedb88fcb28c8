//! Paths of a robot through the free cells of its joint-space map.

use std::fmt;
use std::time::Instant;

use elbowroom_cell::Cell;
use elbowroom_cspace::{ObstacleModel, OccupancyBitmap, RemainingJoints, RobotMapError};
use elbowroom_formats::Diagnostic;
use elbowroom_planner::{
    GridPlanner, GridPlannerError, GridPlannerSettings, JointPath, RrtConnect, RrtConnectError, RrtConnectSettings,
};
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::Pose;

use crate::map::mapped_joints::MappedJoints;
use crate::map::{BlockedCells, LinkMaps, SolidsMap, blocked_cells};

/// Purpose of a map of three joints in this module, and the alternative to it.
pub(super) const PURPOSE: (&str, Option<&str>) = ("paths through free cells", Some("the planner rrt-connect"));
/// Distance (rad) within which an end in a blocked cell is connected to a free cell. Such ends exist because a whole
/// cell counts.
const EXIT_RAD: f64 = 0.35;

/// Plans paths of one robot through the free cells of its joint-space map of three joints, also after obstacles have
/// moved.
///
/// The other joints keep their values: the map is valid for these values only.
///
/// The cells of an object are computed when it is first seen, and when it has moved. The map does not contain what the
/// robot carries, the robot itself, other robots and regions, so each path is proven in the exact scene.
#[derive(Debug)]
pub struct MapPlanner {
    robot: RobotId,
    mapped: MappedJoints,
    /// Values of all joints. Joints that are not in the map keep their values.
    held: Vec<f64>,
    clearance_m: f64,
    maps: LinkMaps,
    /// Per object of the cell: its last pose, and the cells that it blocks there.
    known: Vec<Option<(Pose, BlockedCells)>>,
    planner: GridPlanner,
}

/// Reason why a [`MapPlanner`] has no path.
#[derive(Debug)]
pub enum MapPlannerError {
    /// An end has another value of a joint that is not in the map.
    OtherJoint(usize),
    /// The ends are not connected through free cells, or are not in the map.
    Grid(GridPlannerError),
    /// A straight segment of the path through free cells is not proven free in the scene.
    Unproven {
        /// The corners of the path.
        waypoints: Vec<Vec<f64>>,
        /// Number of the waypoint at the end of the segment.
        segment: usize,
    },
    /// An end in collision or beyond limits, a setting out of range.
    Exact(RrtConnectError),
}

impl fmt::Display for MapPlannerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherJoint(joint) => write!(f, "an end moves joint {}, which is not in the map", joint + 1),
            Self::Grid(e) => e.fmt(f),
            Self::Unproven { segment, .. } => {
                write!(f, "the path through free cells is not proven free before waypoint {segment}")
            }
            Self::Exact(e) => e.fmt(f),
        }
    }
}

impl std::error::Error for MapPlannerError {}

impl MapPlanner {
    /// Creates a planner for a robot of a cell, without obstacles.
    ///
    /// Joints that are not in the map have their values in `held` (values of all joints, rad or m). If the map is on
    /// sphere covers, cells count as blocked up to the distance `clearance_m` (m) from an object.
    ///
    /// # Errors
    /// [`Diagnostic`] if the robot's map does not have three joints, or has too many cells.
    pub fn new(cell: &Cell, id: RobotId, held: &[f64], clearance_m: f64) -> Result<Self, Diagnostic> {
        let robot = &cell.robots[id.0];
        // `elbowroom map` gives the warnings.
        let mapped = MappedJoints::of(cell, robot, PURPOSE, &mut Vec::new())?;
        let wrong = |what: String| Diagnostic::new(&cell.file, robot.line, format!("robot \"{}\": {what}", robot.name));
        let axes = mapped.grid.axes();
        let maps = LinkMaps::new(cell, id, |robot| {
            SolidsMap::new(robot, axes, &mapped.joints, RemainingJoints::Fixed(held), Some(clearance_m))
        });
        let maps = maps.map_err(|e| wrong(e.to_string()))?;
        let empty = OccupancyBitmap::new(mapped.grid.shape());
        let planner = GridPlanner::new(&mapped.grid, &empty).map_err(|e| wrong(e.to_string()))?;
        let (held, known) = (held.to_vec(), vec![None; cell.objects.len()]);
        Ok(Self { robot: id, mapped, held, clearance_m, maps, known, planner })
    }

    /// Whether the joints that are not in the map have their held values in `q` (values of all joints).
    pub fn serves(&self, q: &[f64]) -> bool {
        self.mapped.moved_otherwise(&self.held, q).is_none()
    }

    /// Whether a new planner for a robot, these values of its joints and this clearance (m) would be the same.
    pub(super) fn is_of(&self, id: RobotId, q: &[f64], clearance_m: f64) -> bool {
        let held =
            |q: &[f64]| (0..q.len()).filter(|j| !self.mapped.joints.contains(j)).map(|j| q[j]).collect::<Vec<_>>();
        self.robot == id && self.clearance_m == clearance_m && held(q) == held(&self.held)
    }

    /// Updates the obstacles: the objects of the cell, which come first in the scene, and `others`, each with its pose
    /// in the world.
    ///
    /// # Errors
    /// A solid whose pose or size is not finite, or a map above the memory limit.
    pub fn update(&mut self, scene: &Scene, state: &SceneState, others: &[(Shape, Pose)]) -> Result<(), RobotMapError> {
        let fill = |map: &SolidsMap, solids: &[(&Shape, Pose)]| map.fill(ObstacleModel::Exact, solids, &|_| ());
        for (i, (object, known)) in scene.objects().iter().zip(&mut self.known).enumerate() {
            let id = ObjectId(i);
            let Some(in_world) = state.pose(scene, GeometryId::Object(id)) else { continue };
            let is_carried = state.attachment(id).is_some_and(|a| a.robot == self.robot);
            let Some(map) = self.maps.of(id).filter(|_| !is_carried) else {
                *known = None;
                continue;
            };
            if known.as_ref().is_none_or(|(pose, _)| *pose != in_world) {
                *known = Some((in_world, fill(map, &[(&object.shape, in_world)])?.blocks));
            }
        }
        let others: Vec<_> = others.iter().map(|(shape, in_world)| (shape, *in_world)).collect();
        let others = fill(self.maps.first(), &others)?.blocks;
        let all = self.known.iter().flatten().map(|(_, cells)| cells).chain([&others]);
        let occupancy = blocked_cells::table(self.mapped.grid.axes(), all);
        // The table has the shape of the grid.
        let _ = self.planner.update(&occupancy);
        Ok(())
    }

    /// Plans a path from the robot's position in `start` to a goal, and proves it in the scene of `exact`.
    ///
    /// The map must [serve](Self::serves) both ends.
    ///
    /// # Errors
    /// [`MapPlannerError`] with the reason why no path was found.
    pub fn plan(
        &mut self,
        exact: &mut RrtConnect<'_>,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, MapPlannerError> {
        let begin = Instant::now();
        let from = start.q(self.robot);
        if let Some(joint) = [from, goal].into_iter().find_map(|q| self.mapped.moved_otherwise(&self.held, q)) {
            return Err(MapPlannerError::OtherJoint(joint));
        }
        let [a, b] = [from, goal].map(|q| self.mapped.of_whole(q));
        let shift = GridPlannerSettings { max_end_shift_rad: EXIT_RAD, ..GridPlannerSettings::default() };
        let found = self.planner.plan(a, b, &shift).map_err(MapPlannerError::Grid)?;
        let whole = |q: &[f64; 3]| {
            let mut all = from.to_vec();
            self.mapped.joints.iter().zip(q).for_each(|(j, v)| all[*j] = *v);
            all
        };
        let path = JointPath::of(found.waypoints.iter().map(whole).collect(), begin.elapsed());
        let path = path.with_ends([from, goal].map(<[f64]>::to_vec));
        match exact.first_unproven_segment(start, &path.waypoints, settings).map_err(MapPlannerError::Exact)? {
            Some(segment) => Err(MapPlannerError::Unproven { waypoints: path.waypoints, segment }),
            None => Ok(path),
        }
    }
}
