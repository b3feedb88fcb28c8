//! Targets that a robot reaches without contact, from any place of its base.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::LinkId;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_proximity::penetration;
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{
    Checker, CheckerOptions, MatrixError, PairEdit, Reason, Scene, SceneError, SceneState, Selection,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::rows::cores;

/// Starts of the numeric method per target, for robots without a closed form.
const STARTS: usize = 16;
/// Number of targets that a thread takes at once.
const BLOCK: usize = 32;
/// What is nearer (m) to links that no joint moves may be touched: the floor, a pedestal. They may sink in by so much more, too.
const STANDS_ON_M: f64 = 1e-3;

/// A place for the tool, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReachTarget {
    /// The frame of the tool.
    Frame(Pose),
    /// The tool's origin at a point (m) and its z axis along a direction; any turn about the axis will do.
    Axis {
        /// The point.
        point: Vec3,
        /// The direction; its length does not matter.
        direction: Vec3,
    },
}

impl ReachTarget {
    /// The frames of the tool that are tried: one, or so many turns about the axis.
    fn frames(self, turns: usize) -> impl Iterator<Item = Pose> {
        let (first, count) = match self {
            Self::Frame(pose) => (pose, 1),
            Self::Axis { point, direction } => {
                (Pose::new(Rotation::from_z(direction.try_normalize().unwrap_or(Vec3::Z)), point), turns)
            }
        };
        let turn = move |k: usize| Rotation::from_axis_angle(Vec3::Z, std::f64::consts::TAU * k as f64 / count as f64);
        (0..count).map(move |k| Pose::new(first.rotation * turn(k), first.translation))
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::Frame(pose) => pose.is_finite(),
            Self::Axis { point, direction } => point.is_finite() && direction.try_normalize().is_some(),
        }
    }
}

/// How a robot reaches a target.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reach {
    /// Number of joint states within the limits that bring the tool there; 0: out of reach.
    pub solutions: usize,
    /// Number of those in which the robot touches nothing.
    pub free: usize,
    /// Of these the nearest to the state at the start, rad or m; of several turns the first that has one.
    pub q: Option<Vec<f64>>,
}

/// A robot among the things of a cell, whose base can be anywhere.
///
/// Reachability by all solutions of the inverse kinematics follows Zacharias et al., "Capturing robot workspace structure:
/// representing robot capabilities" (IROS 2007); each solution is tested against all solids.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_query::{ReachQuery, ReachTarget};
/// use elbowroom_robot::RobotId;
/// use elbowroom_spatial::{Pose, Vec3};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "m", angle = "rad" }
/// [robot.slide]
/// dh = [{ kind = "prismatic", min = 0, max = 1, speed = 1 }]
/// links = [{ capsule = { from = [0, 0, -0.2], to = [0, 0, -0.1], radius = 0.05 } }]
/// [object.lid]
/// shape = "sphere"
/// at = [0, 0, 0.9]
/// radius = 0.2
/// "#)?;
/// let query = ReachQuery::of_cell(&cell, RobotId(0))?;
/// let at = |z| ReachTarget::Frame(Pose::from_translation(Vec3::Z * z));
/// let reach = query.evaluate(&Pose::IDENTITY, &[at(0.5), at(0.9), at(1.5)], None)?;
/// let counts: Vec<_> = reach.iter().map(|reach| (reach.solutions, reach.free)).collect();
/// assert_eq!(counts, [(1, 1), (1, 0), (0, 0)]);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug)]
pub struct ReachQuery {
    file: PathBuf,
    scene: Scene,
    robot: RobotId,
    solver: IkSolver,
    start: SceneState,
    stands_on: Vec<Standing>,
    turns: NonZeroUsize,
}

/// A link that no joint moves, something that it touches in the model, and how deep (m) it is inside of it.
#[derive(Debug, Clone, Copy)]
struct Standing {
    a: GeometryId,
    b: GeometryId,
    depth_m: f64,
}

impl ReachQuery {
    /// A robot of a cell with the tool that the file names; everything else stands as at the start.
    ///
    /// # Errors
    /// [`Diagnostic`] if the scene refuses the cell.
    pub fn of_cell(cell: &Cell, robot: RobotId) -> Result<Self, Diagnostic> {
        let placed = &cell.robots[robot.0];
        Self::new(&QueryModel::of_cell(cell), robot, placed.flange, placed.tcp_in_flange)
    }

    /// A robot of a model; the tool is a frame of a link.
    ///
    /// Links that no joint moves are tested too, as they may stand somewhere else; what they touch in the model, such as the
    /// floor, they may touch everywhere, no deeper than there. Contacts of other things with each other do not count.
    ///
    /// # Errors
    /// [`Diagnostic`] if the scene refuses the model.
    pub fn new(model: &QueryModel, robot: RobotId, link: LinkId, tool_in_link: Pose) -> Result<Self, Diagnostic> {
        let refused = |e: SceneError| Diagnostic::new(&model.file, None, e);
        let scene = model.scene(OutOfReachProofs::Omit)?;
        let mut start = SceneState::new(&scene);
        for (i, other) in model.robots.iter().enumerate() {
            start.set_q(&scene, RobotId(i), &other.start).map_err(refused)?;
        }
        let (scene, stands_on) =
            with_standing_links(scene, robot, &start).map_err(|e| Diagnostic::new(&model.file, None, e))?;
        let options = IkOptions { restarts: STARTS, ..IkOptions::default() };
        let solver = IkSolver::new(&model.robots[robot.0].robot.chain, link, tool_in_link, options);
        let turns = NonZeroUsize::MIN;
        Ok(Self { file: model.file.clone(), scene, robot, solver, start, stands_on, turns })
    }

    /// Sets the number of turns about the axis that are tried for each [`ReachTarget::Axis`]; without it 1.
    #[must_use]
    pub fn turns(self, turns: NonZeroUsize) -> Self {
        Self { turns, ..self }
    }

    /// The pose of the base in the model.
    pub fn base_in_world(&self) -> Pose {
        self.scene.robots()[self.robot.0].base_in_world
    }

    /// Answers for every target, with the base at a pose, on so many threads or one per core. The number of threads does not
    /// change the answers.
    ///
    /// # Errors
    /// [`Diagnostic`] if the pose of the base or a target is not finite.
    pub fn evaluate(
        &self,
        base_in_world: &Pose,
        targets: &[ReachTarget],
        threads: Option<NonZeroUsize>,
    ) -> Result<Vec<Reach>, Diagnostic> {
        let refused = |what: String| Diagnostic::new(&self.file, None, what).hint("finite numbers, in metres");
        if let Some(at) = targets.iter().position(|target| !target.is_finite()) {
            return Err(refused(format!("target {at} (from 0) is not finite, or its direction has no length")));
        }
        let scene = self.scene.with_base(self.robot, *base_in_world).map_err(|e| refused(e.to_string()))?;
        let mut state = SceneState::new(&scene);
        for robot in (0..scene.robots().len()).map(RobotId) {
            state.set_q(&scene, robot, self.start.q(robot)).map_err(|e| refused(e.to_string()))?;
        }
        let is_sunk = |on: &Standing| depth_m(&scene, &state, on.a, on.b) > on.depth_m + STANDS_ON_M;
        let is_placed = !self.stands_on.iter().any(is_sunk);
        let mut reached = vec![Reach::default(); targets.len()];
        let open = AtomicUsize::new(0);
        let blocks: Vec<_> = targets.chunks(BLOCK).zip(reached.chunks_mut(BLOCK)).map(std::sync::Mutex::new).collect();
        let work = || {
            let mut worker = Worker::new(self, &scene, state.clone(), is_placed);
            while let Some(block) = blocks.get(open.fetch_add(1, Ordering::Relaxed)) {
                let mut block = block.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                let (targets, reached) = &mut *block;
                for (target, place) in targets.iter().zip(reached.iter_mut()) {
                    *place = worker.reach(*target);
                }
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..cores(blocks.len(), threads) {
                scope.spawn(work);
            }
            work();
        });
        drop(blocks);
        Ok(reached)
    }
}

/// Tests the links of a robot that no joint moves, but against what they stand on, which is returned.
fn with_standing_links(
    scene: Scene,
    robot: RobotId,
    start: &SceneState,
) -> Result<(Scene, Vec<Standing>), MatrixError> {
    let is_of_robot = |id: GeometryId| matches!(id, GeometryId::Link { robot: of, .. } if of == robot);
    let entries = scene.allowed_collision_matrix().entries().iter();
    let standing = entries.filter(|e| e.reason == Reason::NoJointBetween && is_of_robot(e.a) != is_of_robot(e.b));
    let standing: Vec<(GeometryId, GeometryId)> = standing.map(|e| (e.a, e.b)).collect();
    let mut matrix = scene.allowed_collision_matrix().clone();
    for &(a, b) in &standing {
        matrix.edit(&scene, a, b, PairEdit::Test("the base may stand elsewhere".into()))?;
    }
    let tested = scene.clone().with_allowed_collision_matrix(matrix.clone())?;
    let mut checker = Checker::new(&tested, CheckerOptions::default());
    let mut stands_on = Vec::new();
    for (a, b) in standing {
        if checker.between(a.into(), b.into()).within(start, STANDS_ON_M).is_some() {
            matrix.edit(&scene, a, b, PairEdit::Skip("the robot stands on it".into()))?;
            stands_on.push(Standing { a, b, depth_m: depth_m(&scene, start, a, b) });
        }
    }
    Ok((scene.with_allowed_collision_matrix(matrix)?, stands_on))
}

/// The depth (m) to which two geometries are inside of each other; of meshes that of their hulls.
fn depth_m(scene: &Scene, state: &SceneState, a: GeometryId, b: GeometryId) -> f64 {
    let (Some(a_in_world), Some(b_in_world)) = (state.pose(scene, a), state.pose(scene, b)) else { return 0.0 };
    let pairs = scene.shapes(a).flat_map(|a| scene.shapes(b).map(move |b| (a, b)));
    let depth = |((a, in_a), (b, in_b))| {
        penetration(a, &(a_in_world * in_a), b, &(b_in_world * in_b)).map_or(0.0, |found| found.depth)
    };
    pairs.map(depth).fold(0.0, f64::max)
}

/// What one thread works with.
struct Worker<'q> {
    robot: RobotId,
    turns: usize,
    /// Whether the base does not sink into what it stands on.
    is_placed: bool,
    world_in_base: Pose,
    seed: Vec<f64>,
    solver: IkSolver,
    scene: &'q Scene,
    state: SceneState,
    checker: Checker<'q>,
}

impl<'q> Worker<'q> {
    fn new(query: &ReachQuery, scene: &'q Scene, state: SceneState, is_placed: bool) -> Self {
        Self {
            robot: query.robot,
            turns: query.turns.get(),
            is_placed,
            world_in_base: scene.robots()[query.robot.0].base_in_world.inverse(),
            seed: state.q(query.robot).to_vec(),
            solver: query.solver.clone(),
            scene,
            state,
            checker: Checker::new(scene, CheckerOptions::default()),
        }
    }

    fn reach(&mut self, target: ReachTarget) -> Reach {
        let mut reach = Reach::default();
        for frame in target.frames(self.turns) {
            for q in self.solver.solve_all(&(self.world_in_base * frame), &self.seed) {
                reach.solutions += 1;
                if self.is_free(&q) {
                    reach.free += 1;
                    reach.q.get_or_insert(q);
                }
            }
        }
        reach
    }

    fn is_free(&mut self, q: &[f64]) -> bool {
        if !(self.is_placed && self.state.set_q(self.scene, self.robot, q).is_ok()) {
            return false;
        }
        self.checker.between(Selection::Robot(self.robot), Selection::All).collides(&self.state).is_none()
    }
}
