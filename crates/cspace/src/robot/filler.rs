//! A robot's maps, made on threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use elbowroom_proximity::{Shape, collides};
use elbowroom_scene::Robot;
use elbowroom_spatial::Pose;

use super::blocks::{Blocks, Cells, Node};
use super::joints::{Drive, MOST_JOINTS, Others, RobotMapError};
use super::part::Parts;
use super::search::{Search, Task, TooLarge};
use super::target::Target;
use crate::Axis;

/// A cell at the border is cut until its parts are no wider than twice this (rad, or m where a joint slides), before it counts
/// as blocked: its doubtful ones are then few of all blocked cells.
const FINE: f64 = 3e-4;
/// How often it is cut at most: with many axes its border has many parts.
const MOST_LOOKS: u32 = 24;
/// Slabs per thread: they take unequal times.
const SLABS: usize = 8;

/// What making a map took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FillCounts {
    /// Boxes of joint space looked at, cells included.
    pub boxes: u64,
    /// Times that a piece and an obstacle were asked to be apart by so much.
    pub looks: u64,
    /// Configurations tried for contact.
    pub tried: u64,
    /// Times that a cell was called blocked because nothing was proven either way.
    pub unsure: u64,
}

/// Makes maps of one robot: any solids, any number of joints.
///
/// Its own links against the given obstacles; not link against link, and not links that none of the joints moves.
///
/// ```
/// use elbowroom_cspace::{Axis, Others, RobotFiller};
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_scene::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// let scene = example::two_arms();
/// let robot = &scene.robots()[0];
/// let axes = ["a", "b", "c"].map(|name| Axis::from_degrees(name, -90.0, 90.0, 5.0).unwrap());
/// let filler = RobotFiller::new(&robot.robot, Pose::IDENTITY, &axes, &[0, 1, 2], Others::Any)?;
/// let half_extents = Vec3::new(0.1, 0.2, 0.2);
/// let crate_ = (Shape::Cuboid(Cuboid { half_extents }), Pose::from_translation(Vec3::new(0.6, 0.0, 0.6)));
/// let blocks = filler.fill(&[crate_])?;
/// assert!(blocks.is_blocked(&[0.0, 0.6, 0.6]) && !blocks.is_blocked(&[1.5, 0.0, 0.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct RobotFiller {
    drive: Drive,
    parts: Parts,
    axes: Vec<Axis>,
    /// How often a cell is cut, where the user says so.
    looks: Option<u32>,
    most_bytes: usize,
    threads: usize,
}

impl RobotFiller {
    /// Memory for the answer unless told otherwise.
    pub const MOST_BYTES: usize = 1 << 30;

    /// Prepares for a robot that stands at `base_in_world`; `joints[i]` is the place among the joint values of axis `i`.
    ///
    /// # Errors
    /// Joints that the robot does not have, too many of them, values at which others are held that do not fit, solids
    /// or a base whose places are not finite.
    pub fn new(
        robot: &Robot,
        base_in_world: Pose,
        axes: &[Axis],
        joints: &[usize],
        others: Others<'_>,
    ) -> Result<Self, RobotMapError> {
        if axes.len() != joints.len() {
            return Err(RobotMapError::Count(axes.len()));
        }
        let drive = Drive::new(&robot.chain, base_in_world, joints, others)?;
        let parts = Parts::of(robot, &drive)?;
        let threads = std::thread::available_parallelism().map_or(1, Into::into);
        let axes = axes.to_vec();
        Ok(Self { drive, parts, axes, looks: None, most_bytes: Self::MOST_BYTES, threads })
    }

    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The frame of the first axis in the world, for [`Model::solids`](crate::Model::solids): its z lies along the axis.
    pub fn base_in_world(&self) -> Pose {
        self.drive.base_axis()
    }

    /// How often a cell at the border is cut in two before it counts as blocked: 0 is fast and blocks more cells than
    /// need be, 18 (about what 2 degrees have unless told otherwise) hardly any.
    #[must_use]
    pub fn with_looks(self, looks: u32) -> Self {
        Self { looks: Some(looks.min(60)), ..self }
    }

    /// Memory that the answer may take, bytes.
    #[must_use]
    pub fn with_most_bytes(self, most_bytes: usize) -> Self {
        Self { most_bytes, ..self }
    }

    /// Number of threads; as many as the machine runs at once unless told otherwise.
    #[must_use]
    pub fn with_threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    /// What the solids (placed in the world) block: every cell in whose box any configuration touches one of them.
    ///
    /// # Errors
    /// A solid whose place or size is not finite, or more memory than allowed.
    pub fn fill(&self, obstacles: &[(Shape, Pose)]) -> Result<Blocks, RobotMapError> {
        self.fill_counted(obstacles).map(|(blocks, _)| blocks)
    }

    /// The same, and what it took.
    ///
    /// # Errors
    /// As [`RobotFiller::fill`].
    pub fn fill_counted(&self, obstacles: &[(Shape, Pose)]) -> Result<(Blocks, FillCounts), RobotMapError> {
        let targets: Vec<Target> =
            obstacles.iter().map(|(shape, in_world)| Target::new(shape, in_world)).collect::<Result<_, _>>()?;
        let suspects = self.suspects(&targets);
        if self.is_blocked_throughout(&targets) {
            return Ok((
                Blocks { axes: self.axes.clone(), slabs: vec![(0, vec![Node::Blocked])] },
                FillCounts::default(),
            ));
        }
        let slabs = self.slabs();
        let task = Task {
            drive: &self.drive,
            parts: &self.parts,
            axes: &self.axes,
            targets: &targets,
            suspects: &suspects,
            looks: self.looks(),
            most_nodes: self.most_bytes / size_of::<Node>(),
            used: &AtomicUsize::new(0),
        };
        let done = self.run(task, &slabs);
        let mut out = Blocks { axes: self.axes.clone(), slabs: Vec::with_capacity(slabs.len()) };
        let mut counts = FillCounts::default();
        for (cells, result) in slabs.iter().zip(done) {
            let Some(Ok((nodes, part))) = result else {
                return Err(RobotMapError::Memory { mib: self.most_bytes >> 20 });
            };
            out.slabs.push((cells.first[0], nodes));
            counts.add(part);
        }
        Ok((out, counts))
    }

    /// Per number of axes, counted from the first: how often to cut.
    fn looks(&self) -> [u32; MOST_JOINTS + 1] {
        let mut out = [0; MOST_JOINTS + 1];
        for (i, axis) in self.axes.iter().enumerate() {
            let more = (0.5 * axis.step() / FINE).log2().ceil().clamp(0.0, 60.0) as u32;
            out[i + 1] = self.looks.unwrap_or(MOST_LOOKS.min(out[i] + more));
        }
        out
    }

    fn run(&self, task: Task<'_>, slabs: &[Cells]) -> Vec<Option<Done>> {
        let next = AtomicUsize::new(0);
        let done: Mutex<Vec<Option<Done>>> = Mutex::new((0..slabs.len()).map(|_| None).collect());
        let work = || {
            let mut search = Search::new(task);
            while let Some((number, cells)) =
                Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|n| Some((n, slabs.get(n)?)))
            {
                search.counts = FillCounts::default();
                let result = search.run(cells).map(|nodes| (nodes, search.counts));
                let mut all = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                all[number] = Some(result);
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..self.threads.min(slabs.len()) {
                scope.spawn(work);
            }
            work();
        });
        done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// True where something can be touched by what none of the axes moves and other joints may have anywhere.
    fn is_blocked_throughout(&self, targets: &[Target]) -> bool {
        let touches = |(shape, at): &(Shape, Pose), t: &Target| collides(shape, at, &t.shape, &t.in_world);
        self.parts.still.iter().any(|solid| targets.iter().any(|t| touches(solid, t)))
    }

    /// Cuts along the first axis.
    fn slabs(&self) -> Vec<Cells> {
        let all = Cells::all(&self.axes);
        let count = all.count(0);
        let parts = if self.threads == 1 { 1 } else { (self.threads * SLABS).min(usize::from(count)) as u16 };
        let border = |i: u16| (u32::from(count) * u32::from(i) / u32::from(parts)) as u16;
        (0..parts)
            .map(|i| {
                let mut slab = all;
                (slab.first[0], slab.end[0]) = (border(i), border(i + 1));
                slab
            })
            .collect()
    }

    /// Solids that are hollow, and what would fit into them.
    fn suspects(&self, targets: &[Target]) -> Vec<(u32, u32)> {
        let mut out = Vec::new();
        for (solid, hollow) in self.parts.hollows.iter().enumerate() {
            let fits = |(_, t): &(usize, &Target)| t.fits_into(hollow.part.radius);
            out.extend(targets.iter().enumerate().filter(fits).map(|(target, _)| (solid as u32, target as u32)));
        }
        out
    }
}

type Done = Result<(Vec<Node>, FillCounts), TooLarge>;

impl FillCounts {
    fn add(&mut self, other: Self) {
        self.boxes += other.boxes;
        self.looks += other.looks;
        self.tried += other.tried;
        self.unsure += other.unsure;
    }
}
