//! Paths of a robot through the free cells of its joint-space map.

use std::fmt;
use std::time::Instant;

use elbowroom_cell::Cell;
use elbowroom_cspace::{ObstacleModel, OccupancyBitmap, RemainingJoints, RobotMapError};
use elbowroom_formats::FormatError;
use elbowroom_planner::{
    GridPlanner, GridPlannerError, GridPlannerSettings, PlannedPath, RrtConnect, RrtConnectError, RrtConnectSettings,
};
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::Pose;

use crate::map::mapped_joints::MappedJoints;
use crate::map::{BlockedCells, LinkMaps, SolidsMap, blocked_cells};

/// What a map of three joints is for here, and what else plans paths.
pub(super) const PURPOSE: (&str, Option<&str>) = ("paths through free cells", Some("the planner rrt-connect"));
/// An end in a blocked cell, because a whole cell counts, is left for a free one (or reached from it) within this distance, rad.
const EXIT_RAD: f64 = 0.35;

/// Plans paths of one robot through the free cells of its joint-space map of three joints, and again when obstacles have moved.
/// The other joints stay where they are: the map is one for these values of them.
///
/// The cells of an object are computed when it is seen for the first time and where it has moved. What the robot carries,
/// the robot itself, other robots and regions are not in the map: each path is proven in the exact scene.
#[derive(Debug)]
pub struct MapPlanner {
    robot: RobotId,
    mapped: MappedJoints,
    /// Values of all joints; those that are not in the map stay so.
    held: Vec<f64>,
    maps: LinkMaps,
    /// Per object of the cell: where it was seen last, and the cells that it blocks there.
    known: Vec<Option<(Pose, BlockedCells)>>,
    planner: GridPlanner,
}

/// Why a [`MapPlanner`] has no path.
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
    /// For a robot of a cell whose joints that are not in the map are as in `held` (values of all joints, rad or m); cells count as
    /// blocked from this distance to an object on, m, where the map is on sphere covers. No obstacles yet.
    ///
    /// # Errors
    /// [`FormatError`] if the robot's map has not three joints, or has too many cells.
    pub fn new(cell: &Cell, id: RobotId, held: &[f64], clearance_m: f64) -> Result<Self, FormatError> {
        let robot = &cell.robots[id.0];
        // `elbowroom map` gives the warnings.
        let mapped = MappedJoints::of(cell, robot, PURPOSE, &mut Vec::new())?;
        let wrong =
            |what: String| FormatError::new(&cell.file, robot.line, format!("robot \"{}\": {what}", robot.name));
        let axes = mapped.grid.axes();
        let maps = LinkMaps::new(cell, id, |robot| {
            SolidsMap::new(robot, axes, &mapped.joints, RemainingJoints::Fixed(held), Some(clearance_m))
        });
        let maps = maps.map_err(|e| wrong(e.to_string()))?;
        let empty = OccupancyBitmap::new(mapped.grid.shape());
        let planner = GridPlanner::new(&mapped.grid, &empty).map_err(|e| wrong(e.to_string()))?;
        Ok(Self { robot: id, mapped, held: held.to_vec(), maps, known: vec![None; cell.objects.len()], planner })
    }

    /// Whether joints that are not in the map are as in these values of all joints.
    pub fn serves(&self, q: &[f64]) -> bool {
        self.mapped.moved_otherwise(&self.held, q).is_none()
    }

    /// Takes over where obstacles are: the objects of the cell, which are the first ones of the scene, and `others`, each with its
    /// pose in the world.
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

    /// A path from where the robot is in `start` to a goal, proven in the scene of `exact`. The map must [serve](Self::serves) both.
    ///
    /// # Errors
    /// [`MapPlannerError`] says why there is none.
    pub fn plan(
        &mut self,
        exact: &mut RrtConnect<'_>,
        start: &SceneState,
        goal: &[f64],
        settings: &RrtConnectSettings,
    ) -> Result<PlannedPath, MapPlannerError> {
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
        let path = PlannedPath::of(found.waypoints.iter().map(whole).collect(), begin.elapsed());
        let path = path.with_ends([from, goal].map(<[f64]>::to_vec));
        match exact.first_unproven_segment(start, &path.waypoints, settings).map_err(MapPlannerError::Exact)? {
            Some(segment) => Err(MapPlannerError::Unproven { waypoints: path.waypoints, segment }),
            None => Ok(path),
        }
    }
}
