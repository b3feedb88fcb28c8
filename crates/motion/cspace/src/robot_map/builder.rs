//! Builder of maps of a robot, on several threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use elbowroom_proximity::{Shape, collides};
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;

use super::box_tree::{BoxTree, CellRange, Node};
use super::driven_chain::{DrivenChain, RemainingJoints};
use super::error::RobotMapError;
use super::pair_evaluator::{ContainmentCandidate, SubdivisionTask};
use super::placed_obstacle::PlacedObstacle;
use super::robot_pieces::{ClosedMesh, RobotPieces};
use super::settings::{MAX_JOINTS, RobotMapSettings, RobotMapStats};
use super::subdivision::{NodeLimitReached, Slab, Subdivision};
use crate::{GridAxis, ObstacleModel};

/// Largest number of bisections of a cell for the boundary resolution: with many axes its boundary has many parts.
const MAX_BISECTIONS: u32 = 24;
/// Number of slabs per thread: slabs take unequal times.
const SLABS_PER_THREAD: usize = 8;

/// Builds maps of one robot: any solids, any number of joints.
///
/// A map contains contacts of the robot's links with obstacles. It does not contain self-collisions, or contacts of
/// links that neither an axis of the map nor a swept joint moves.
///
/// ```
/// use elbowroom_cspace::{GridAxis, RemainingJoints, RobotMapBuilder};
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_robot::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// let robot = example::arm()?;
/// let axes = ["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 5.0).unwrap());
/// let builder = RobotMapBuilder::new(&robot, Pose::IDENTITY, &axes, &[0, 1, 2], RemainingJoints::Swept)?;
/// let half_extents = Vec3::new(0.1, 0.2, 0.2);
/// let obstacle = (Shape::Cuboid(Cuboid { half_extents }), Pose::from_translation(Vec3::new(0.6, 0.0, 0.6)));
/// let tree = builder.build(&[obstacle])?;
/// assert!(tree.is_blocked(&[0.0, 0.6, 0.6]) && !tree.is_blocked(&[1.5, 0.0, 0.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct RobotMapBuilder {
    pub(super) chain: DrivenChain,
    pieces: RobotPieces,
    axes: Vec<GridAxis>,
    settings: RobotMapSettings,
}

impl RobotMapBuilder {
    /// Creates a builder for a robot with its base at `base_in_world`; `joints[i]` is the index of axis `i` among the
    /// joint values.
    ///
    /// # Errors
    /// The robot does not have a joint, there are too many joints, the fixed values do not fit, or the poses of solids
    /// or base are not finite.
    pub fn new(
        robot: &Robot,
        base_in_world: Pose,
        axes: &[GridAxis],
        joints: &[usize],
        remaining: RemainingJoints<'_>,
    ) -> Result<Self, RobotMapError> {
        if axes.len() != joints.len() {
            return Err(RobotMapError::Count(axes.len()));
        }
        let chain = DrivenChain::new(&robot.chain, base_in_world, axes, joints, remaining)?;
        let pieces = RobotPieces::new(robot, &chain)?;
        Ok(Self { chain, pieces, axes: axes.to_vec(), settings: RobotMapSettings::default() })
    }

    /// Replaces the default settings.
    #[must_use]
    pub fn with_settings(self, settings: RobotMapSettings) -> Self {
        Self { settings, ..self }
    }

    /// The axes.
    pub fn axes(&self) -> &[GridAxis] {
        &self.axes
    }

    /// The frame of the first axis in the world, for [`ObstacleModel::solids`](crate::ObstacleModel::solids): its z
    /// direction is along the axis.
    pub fn base_in_world(&self) -> Pose {
        self.chain.base_axis()
    }

    /// Builds the map of some solids, placed in the world: blocks every cell whose box contains a configuration that
    /// touches one of them.
    ///
    /// # Errors
    /// The pose or size of a solid is not finite, or the map is above the memory limit.
    pub fn build(&self, obstacles: &[(Shape, Pose)]) -> Result<BoxTree, RobotMapError> {
        self.build_with_stats(obstacles).map(|(tree, _)| tree)
    }

    /// Like [`build`](Self::build), of a model of some obstacles; calls `progress` from any thread with the finished fraction, 0
    /// to 1. More spheres never block more
    /// cells than fewer: their cells are intersected with those of 1, 2, 4, 8 … spheres.
    ///
    /// # Errors
    /// The errors of [`RobotMapBuilder::build`].
    pub fn build_model(
        &self,
        model: ObstacleModel,
        obstacles: &[(&Shape, Pose)],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<BoxTree, RobotMapError> {
        let models = model.coarser_to_finer();
        let base = self.base_in_world();
        let step = |done: usize| {
            let solids: Vec<_> =
                obstacles.iter().flat_map(|(shape, at)| models[done].solids(shape, at, &base)).collect();
            let progress = |share: f64| progress((done as f64 + share) / models.len() as f64);
            self.build_all(&solids, &progress).map(|(tree, _)| tree)
        };
        let mut common = step(0)?;
        for done in 1..models.len() {
            common = common.intersection(&step(done)?);
        }
        Ok(common)
    }

    /// Like [`build`](Self::build), with statistics.
    ///
    /// # Errors
    /// The errors of [`RobotMapBuilder::build`].
    pub fn build_with_stats(&self, obstacles: &[(Shape, Pose)]) -> Result<(BoxTree, RobotMapStats), RobotMapError> {
        self.build_all(obstacles, &|_| ())
    }

    fn build_all(
        &self,
        obstacles: &[(Shape, Pose)],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(BoxTree, RobotMapStats), RobotMapError> {
        let obstacles: Vec<PlacedObstacle> =
            obstacles.iter().map(|(shape, in_world)| PlacedObstacle::new(shape, in_world)).collect::<Result<_, _>>()?;
        if self.is_blocked_throughout(&obstacles) {
            let slabs = vec![(0, vec![Node::Blocked])];
            return Ok((BoxTree { axes: self.axes.clone(), slabs }, RobotMapStats::default()));
        }
        let threads = self.threads();
        let slabs = self.slabs(threads);
        let candidates = self.containment_candidates(&obstacles);
        let used_nodes = AtomicUsize::new(0);
        let task = self.task(&obstacles, &candidates, &used_nodes);
        let mut tree = BoxTree { axes: self.axes.clone(), slabs: Vec::with_capacity(slabs.len()) };
        let mut stats = RobotMapStats::default();
        for (cells, result) in slabs.iter().zip(run(task, &slabs, threads, progress)) {
            let Some(Ok(slab)) = result else {
                return Err(RobotMapError::Memory { mib: self.settings.max_bytes >> 20 });
            };
            tree.slabs.push((cells.first[0], slab.nodes));
            stats.add(slab.stats);
        }
        Ok((tree, stats))
    }

    /// The shared task of all threads.
    pub(super) fn task<'a>(
        &'a self,
        obstacles: &'a [PlacedObstacle],
        containment_candidates: &'a [ContainmentCandidate],
        used_nodes: &'a AtomicUsize,
    ) -> SubdivisionTask<'a> {
        SubdivisionTask {
            chain: &self.chain,
            pieces: &self.pieces,
            axes: &self.axes,
            obstacles,
            containment_candidates,
            bisections: self.bisections(),
            max_checks_per_cell: self.settings.max_checks_per_cell,
            max_nodes: self.settings.max_bytes / size_of::<Node>(),
            used_nodes,
        }
    }

    pub(super) fn threads(&self) -> usize {
        let available = || std::thread::available_parallelism().map_or(1, Into::into);
        self.settings.threads.unwrap_or_else(available).max(1)
    }

    /// Number of bisections of a cell, per number of axes counted from the first.
    fn bisections(&self) -> [u32; MAX_JOINTS + 1] {
        let mut out = [0; MAX_JOINTS + 1];
        for (i, axis) in self.axes.iter().enumerate() {
            let more = (0.5 * axis.step() / self.settings.boundary_resolution).log2().ceil().clamp(0.0, 60.0) as u32;
            out[i + 1] = match self.settings.bisections {
                Some(bisections) => bisections.min(60),
                None => MAX_BISECTIONS.min(out[i] + more),
            };
        }
        out
    }

    /// Whether the robot has swept volumes that no axis of the map moves.
    pub(super) fn has_static_solids(&self) -> bool {
        !self.pieces.static_solids.is_empty()
    }

    /// Whether an obstacle touches a swept volume that no axis of the map moves.
    pub(super) fn is_blocked_throughout(&self, obstacles: &[PlacedObstacle]) -> bool {
        let touches = |(shape, in_world): &(Shape, Pose), obstacle: &PlacedObstacle| {
            collides(shape, in_world, &obstacle.shape, &obstacle.in_world)
        };
        self.pieces.static_solids.iter().any(|solid| obstacles.iter().any(|obstacle| touches(solid, obstacle)))
    }

    /// Divides the cells along the first axis.
    fn slabs(&self, threads: usize) -> Vec<CellRange> {
        let all = CellRange::all(&self.axes);
        let count = all.count(0);
        let slabs = if threads == 1 { 1 } else { (threads * SLABS_PER_THREAD).min(usize::from(count)) as u16 };
        let border = |i: u16| (u32::from(count) * u32::from(i) / u32::from(slabs)) as u16;
        (0..slabs)
            .map(|i| {
                let mut slab = all;
                (slab.first[0], slab.end[0]) = (border(i), border(i + 1));
                slab
            })
            .collect()
    }

    /// Pairs of the robot's closed meshes with the obstacles that fit inside.
    pub(super) fn containment_candidates(&self, obstacles: &[PlacedObstacle]) -> Vec<ContainmentCandidate> {
        let mut out = Vec::new();
        for (closed_mesh, ClosedMesh { piece, .. }) in self.pieces.closed_meshes.iter().enumerate() {
            for (obstacle, _) in obstacles.iter().enumerate().filter(|(_, o)| o.fits_inside(piece.radius)) {
                out.push(ContainmentCandidate { closed_mesh: closed_mesh as u32, obstacle: obstacle as u32 });
            }
        }
        out
    }
}

/// Subdivides slabs on threads; `None` for slabs that were not reached.
fn run(
    task: SubdivisionTask<'_>,
    slabs: &[CellRange],
    threads: usize,
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<Option<Result<Slab, NodeLimitReached>>> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new((0..slabs.len()).map(|_| None).collect::<Vec<_>>());
    let work = || {
        let mut subdivision = Subdivision::new(task);
        while let Some((number, cells)) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|n| Some((n, slabs.get(n)?)))
        {
            let result = subdivision.run(cells);
            let mut all = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            all[number] = Some(result);
            let count = all.iter().flatten().count();
            drop(all);
            progress(count as f64 / slabs.len() as f64);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.min(slabs.len()) {
            scope.spawn(work);
        }
        work();
    });
    done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
}
