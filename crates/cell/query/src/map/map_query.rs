//! A robot of a cell that is prepared for maps.

use std::borrow::Borrow;
use std::time::{Duration, Instant};

use elbowroom_cell::{Cell, CellRobot, MapSpec};
use elbowroom_cspace::{GridAxis, ObstacleModel, OccupancyArray, RemainingJoints, RobotMapError};
use elbowroom_formats::Diagnostic;
use elbowroom_proximity::Shape;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Object;
use elbowroom_spatial::Pose;

use super::blocked_cells::{self, BlockedCells};
use super::cell_map::{CellMap, MapObstacle, MapProgress, MapRequest};
use super::link_maps::LinkMaps;
use super::map_axes::{axes, select_map};
use super::model::MapModel;
use super::solids_map::{FilledCells, SolidsMap};

/// A robot of a cell that is prepared for maps: for objects at other places only their cells are computed.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_query::map::{MapQuery, MapRequest};
/// use elbowroom_robot::ObjectId;
/// use elbowroom_spatial::{Pose, Vec3};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
/// links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [object.ball]
/// shape = "sphere"
/// at = [600, 0, 0]
/// radius = 100
/// "#)?;
/// let query = MapQuery::new(&cell, &MapRequest::default(), &|_| ())?;
/// let [before, after] = [0.6, -0.6].map(|x| {
///     query.cells_of(ObjectId(0), &Pose::from_translation(Vec3::new(x, 0.0, 0.0)), "exact".parse().unwrap())
/// });
/// assert!(before?.is_blocked(&[0.0, 0.0]) && !after?.is_blocked(&[0.0, 0.0]));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug)]
pub struct MapQuery<C> {
    cell: C,
    id: RobotId,
    spec: MapSpec,
    axes: Vec<GridAxis>,
    is_angle: Vec<bool>,
    maps: LinkMaps,
    warnings: Vec<Diagnostic>,
}

impl<C: Borrow<Cell>> MapQuery<C> {
    /// Prepares the robot of a request, which takes seconds for meshes that were never seen.
    ///
    /// # Errors
    /// An unknown or ambiguous robot, a joint without limits, too many cells for the memory.
    pub fn new(cell: C, request: &MapRequest, progress: &(dyn Fn(MapProgress<'_>) + Sync)) -> Result<Self, Diagnostic> {
        let of = cell.borrow();
        let (id, robot, spec) = select_map(of, request.robot.as_deref())?;
        let mut warnings = Vec::new();
        let (axes, is_angle) = axes(of, robot, &spec, &mut warnings)?;
        let others = if spec.others_at_start { RemainingJoints::Fixed(&robot.start) } else { RemainingJoints::Swept };
        progress(MapProgress { share: 0.0, what: &robot.name });
        let maps = LinkMaps::new(of, id, |robot| {
            SolidsMap::new(robot, &axes, &spec.joints, others, (!request.exact).then_some(0.0))
                .map_err(|e| refused(of, robot, &spec, &e))
        })?;
        Ok(Self { cell, id, spec, axes, is_angle, maps, warnings })
    }

    /// The cell.
    pub fn cell(&self) -> &Cell {
        self.cell.borrow()
    }

    /// The robot.
    pub fn robot(&self) -> &CellRobot {
        &self.cell.borrow().robots[self.id.0]
    }

    /// The joint axes, divided into cells.
    pub fn axes(&self) -> &[GridAxis] {
        &self.axes
    }

    /// The cells that an object of the cell blocks at a pose in the world.
    ///
    /// # Errors
    /// A pose or size that is not finite; a map above the memory limit.
    ///
    /// # Panics
    /// The cell does not have this object.
    pub fn cells_of(
        &self,
        object: ObjectId,
        in_world: &Pose,
        model: ObstacleModel,
    ) -> Result<BlockedCells, Diagnostic> {
        let filled = self.fill_object(object, in_world, model, &|_| ());
        filled.map(|filled| filled.blocks).map_err(|e| self.refused(&e))
    }

    fn fill_object(
        &self,
        object: ObjectId,
        in_world: &Pose,
        model: ObstacleModel,
        report: &(dyn Fn(f64) + Sync),
    ) -> Result<FilledCells, RobotMapError> {
        let shape = &self.cell.borrow().objects[object.0].shape;
        match self.maps.of(object) {
            Some(map) => map.fill(model, &[(shape, *in_world)], report),
            None => self.maps.first().fill(model, &[], report),
        }
    }

    /// The cells that other solids block, at their poses in the world: what a sensor sees, for example. No link may touch them.
    ///
    /// # Errors
    /// As for [`cells_of`](Self::cells_of).
    pub fn cells_of_solids(&self, solids: &[(Shape, Pose)], model: ObstacleModel) -> Result<BlockedCells, Diagnostic> {
        let solids: Vec<_> = solids.iter().map(|(shape, in_world)| (shape, *in_world)).collect();
        let filled = self.maps.first().fill(model, &solids, &|_| ());
        filled.map(|filled| filled.blocks).map_err(|e| self.refused(&e))
    }

    /// The union of the cells of several obstacles, cell by cell; `None` if there are too many cells.
    pub fn union<'b>(&self, all: impl IntoIterator<Item = &'b BlockedCells>) -> Option<OccupancyArray> {
        blocked_cells::union(&self.axes, all)
    }

    /// Computes the map of all objects at their initial poses. The deadline is [`MapRequest::deadline`], from the call on.
    ///
    /// # Errors
    /// As for [`map`](super::map()).
    pub fn map(
        &self,
        model: MapModel,
        deadline: Option<Duration>,
        progress: &(dyn Fn(MapProgress<'_>) + Sync),
    ) -> Result<CellMap, Diagnostic> {
        let cell = self.cell.borrow();
        let filled = self.fill(model, deadline, progress)?.map_err(|e| self.refused(&e))?;
        let obstacle = |(object, filled): (&Object, FilledCells)| {
            let FilledCells { blocks, time, spheres } = filled;
            MapObstacle { name: object.name.clone(), model, spheres, blocks, time }
        };
        let obstacles: Vec<MapObstacle> = cell.objects.iter().zip(filled).map(obstacle).collect();
        let moves = |o: ObjectId| cell.moving_objects.iter().any(|m| m.object == o);
        let dense = self.union(obstacles.iter().map(|o| &o.blocks));
        let blocked = self.count(dense.as_ref(), model, progress, &|_| true)?;
        let static_blocked = if cell.moving_objects.is_empty() {
            blocked
        } else {
            let fixed = obstacles.iter().enumerate().filter(|o| !moves(ObjectId(o.0))).map(|o| &o.1.blocks);
            self.count(self.union(fixed).as_ref(), model, progress, &|o| !moves(o))?
        };
        let robot = self.robot();
        let notes = notes(cell, robot, self.spec.line, model);
        let warnings = self.warnings.iter().cloned().chain(notes).collect();
        let (robot, axes, is_angle) = (robot.name.clone(), self.axes.clone(), self.is_angle.clone());
        Ok(CellMap { robot, axes, is_angle, obstacles, blocked, static_blocked, dense, warnings })
    }

    /// The number of cells that some objects block: those of an array, or of a tree where there are too many for one.
    fn count(
        &self,
        dense: Option<&OccupancyArray>,
        model: MapModel,
        progress: &(dyn Fn(MapProgress<'_>) + Sync),
        which: &dyn Fn(ObjectId) -> bool,
    ) -> Result<u64, Diagnostic> {
        if let Some(dense) = dense {
            return Ok(dense.blocked());
        }
        let objects_of = &self.cell.borrow().objects;
        let report = |share: f64| progress(MapProgress { share, what: "all objects together" });
        // Only maps with the robot's own solids have so many cells, and these maps support no other models.
        let MapModel::Solids(model) = model else { return Ok(0) };
        let of_map = |(map, objects): (&SolidsMap, Vec<ObjectId>)| {
            let solids: Vec<_> = objects.iter().filter(|o| which(**o)).map(|o| placed(&objects_of[o.0])).collect();
            map.fill(model, &solids, &report).map(|all| all.blocks.blocked()).map_err(|e| self.refused(&e))
        };
        // If links may touch only some objects, cells that several maps block count several times.
        let counts = self.maps.each().map(of_map).collect::<Result<Vec<u64>, Diagnostic>>()?;
        Ok(counts.into_iter().fold(0, u64::saturating_add))
    }

    fn refused(&self, e: &RobotMapError) -> Diagnostic {
        refused(self.cell.borrow(), self.robot(), &self.spec, e)
    }

    fn wrong(&self, what: &str, hint: &str) -> Diagnostic {
        Diagnostic::new(&self.cell.borrow().file, self.spec.line, what).hint(hint)
    }

    /// The cells that each object blocks. The outer error means that this map or model does not suit the request.
    fn fill(
        &self,
        model: MapModel,
        deadline: Option<Duration>,
        progress: &(dyn Fn(MapProgress<'_>) + Sync),
    ) -> Result<Result<Vec<FilledCells>, RobotMapError>, Diagnostic> {
        let every_link = || {
            self.maps.of_every_link().ok_or_else(|| {
                let what = "the file of pairs lets links touch objects: such maps have neither a deadline nor seeds";
                self.wrong(what, "--model exact, without --deadline")
            })
        };
        match (model, deadline) {
            (MapModel::Solids(model), None) => Ok(self.fill_each(model, progress)),
            (MapModel::Seeds, None) => self.expand_each(every_link()?, progress),
            (model, Some(limit)) => self.fill_until(every_link()?, model, limit),
        }
    }

    /// The cells that each object blocks.
    fn fill_each(
        &self,
        model: ObstacleModel,
        progress: &(dyn Fn(MapProgress<'_>) + Sync),
    ) -> Result<Vec<FilledCells>, RobotMapError> {
        let objects = &self.cell.borrow().objects;
        let count = objects.len() as f64;
        let fill = |(number, object): (usize, &Object)| {
            let report =
                |share: f64| progress(MapProgress { share: (number as f64 + share) / count, what: &object.name });
            report(0.0);
            self.fill_object(ObjectId(number), &object.in_world, model, &report)
        };
        objects.iter().enumerate().map(fill).collect()
    }

    /// The cells around seeds of each object. The outer error means that this map is not on sphere covers.
    fn expand_each(
        &self,
        solids_map: &SolidsMap,
        progress: &(dyn Fn(MapProgress<'_>) + Sync),
    ) -> Result<Result<Vec<FilledCells>, RobotMapError>, Diagnostic> {
        let objects = &self.cell.borrow().objects;
        let mut filled = Vec::with_capacity(objects.len());
        for (number, object) in objects.iter().enumerate() {
            progress(MapProgress { share: number as f64 / objects.len() as f64, what: &object.name });
            let (shape, in_world) = placed(object);
            let Some(found) = solids_map.expand(shape, &in_world) else {
                let what = "expansion from seeds is for maps on sphere covers: three joints that hang on one of them, without --exact";
                return Err(self.wrong(what, "--model exact, or three joints and no --exact"));
            };
            match found {
                Ok(cells) => filled.push(cells),
                Err(e) => return Ok(Err(e)),
            }
        }
        Ok(Ok(filled))
    }

    /// The cells that each object blocks, refined until a deadline. The outer error means that this model or map does not
    /// support it.
    fn fill_until(
        &self,
        solids_map: &SolidsMap,
        model: MapModel,
        limit: Duration,
    ) -> Result<Result<Vec<FilledCells>, RobotMapError>, Diagnostic> {
        let MapModel::Solids(ObstacleModel::Spheres(most)) = model else {
            let what =
                format!("a deadline is for the model of spheres, which is refined until then, not for `{model}`");
            return Err(self.wrong(&what, "--model spheres=64 --deadline 5"));
        };
        let objects: Vec<_> = self.cell.borrow().objects.iter().map(placed).collect();
        solids_map.fill_until(Instant::now() + limit, most, &objects).ok_or_else(|| {
            let what =
                "a deadline is for maps on sphere covers: three joints that hang on one of them, without --exact";
            self.wrong(what, "no --deadline, or three joints and no --exact")
        })
    }
}

/// What a map refuses, at the line of its table.
fn refused(cell: &Cell, robot: &CellRobot, spec: &MapSpec, e: &RobotMapError) -> Diagnostic {
    let hint = match e {
        RobotMapError::Memory { .. } => "step = 5   (a larger step, or fewer joints)",
        RobotMapError::Count(_) | RobotMapError::Joint { .. } => "joints = [\"joint_1\", \"joint_2\", \"joint_3\"]",
        _ => "finite poses and sizes",
    };
    Diagnostic::new(&cell.file, spec.line, format!("robot \"{}\": {e}", robot.name)).hint(hint)
}

/// Notes on what a map omits, and on what it must not be used for.
fn notes(cell: &Cell, robot: &CellRobot, line: usize, model: MapModel) -> Vec<Diagnostic> {
    let mut notes = Vec::new();
    for m in &cell.moving_objects {
        let what = format!("object \"{}\" moves: the map has it at its initial pose", cell.objects[m.object.0].name);
        notes.push(Diagnostic::new(&cell.file, line, what));
    }
    if !model.is_conservative() {
        let what = "the model `seeds` misses blocked cells that no seed leads to: for comparison only, no robot may rely on it";
        notes.push(Diagnostic::new(&cell.file, line, what));
    }
    if cell.robots.len() > 1 {
        let what = format!("the map of \"{}\" leaves the other robots out: they move", robot.name);
        notes.push(Diagnostic::new(&cell.file, line, what));
    }
    notes
}

fn placed(object: &Object) -> (&Shape, Pose) {
    (&object.shape, object.in_world)
}
