//! The validity checker.

use fearless_simd::{Level as SimdLevel, dispatch};

use super::block::BlockModel;
use super::block_request::{BlockRequest, BlockResult, NearPair};
use super::motion_table::MotionTable;
use super::pair_table_builder::pair_tables;
use super::segment::Stretch;
use super::single::SingleKernel;
use super::single_workspace::{LinkMatrix, SingleWorkspace};
use super::workspace::Workspace;
use crate::error::ValidityError;
use crate::lanes::{LANES, detected_simd_level};
use crate::model::{CoveredLinkId, CoveredRobot};
use crate::obstacles::{BroadPhase, ObstacleSet};
use crate::validity::Validity;

/// Motion of the robot's fastest point within one block of an edge, m. Longer edges are tested block by block, in order.
const BLOCK_LENGTH_M: f64 = 3.0;
/// Length of a chord, m. A stretch with shorter chords that is not proven free is not divided further.
const SHORTEST_CHORD_M: f64 = 0.004;

/// A pair that is not proven to be apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NotCertain {
    /// Two links of the robot.
    Links(CoveredLinkId, CoveredLinkId),
    /// A body and the number of an obstacle.
    Obstacle(CoveredLinkId, usize),
}

/// Answers whether configurations and edges of a robot are free. Each thread needs its own checker.
///
/// `Free` and `Hit` are proven: rounding, motion between two samples, or a gap of a cover never makes a collision free.
/// Cases beyond the reach of the proofs, such as a slide beyond its limits or an angle beyond 10⁶ rad, are uncertain. See
/// README.md of this crate.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_spatial::{Pose, Vec3};
/// use elbowroom_validity::{CoveredRobot, ObstacleSet, Validity, ValidityChecker};
/// let arm = CoveredRobot::new(&elbowroom_robot::example::arm()?, Pose::IDENTITY)?;
/// let mut obstacles = ObstacleSet::default();
/// obstacles.add_shape(&Shape::Sphere(Sphere { radius: 0.1 }), &Pose::from_translation(Vec3::X * 5.0), 0.0);
/// let mut checker = ValidityChecker::new(&arm, &obstacles);
/// let (from, to) = (vec![0.0; arm.dof()], vec![0.3; arm.dof()]);
/// assert_eq!(checker.state(&from)?, Validity::Free);
/// assert!(checker.edge_is_free(&from, &to)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ValidityChecker<'m> {
    pub(super) robot: &'m CoveredRobot,
    pub(super) obstacles: &'m ObstacleSet,
    pub(super) outer: BroadPhase,
    inner: BroadPhase,
    /// Per body and obstacle: true if the pair is not checked. Empty if all pairs are checked.
    pub(super) skipped: Vec<bool>,
    pub(super) motion: MotionTable,
    pub(super) workspace: Workspace,
    matrix: LinkMatrix,
    single: SingleWorkspace,
    pub(super) pairs: Vec<NearPair>,
    pub(super) simd_level: SimdLevel,
    pub(super) blocks: u64,
}

/// The part of a checker that kernels read. A macro, so that its workspaces can be written at the same time.
macro_rules! block_model {
    ($checker:ident) => {
        BlockModel {
            robot: $checker.robot,
            obstacles: $checker.obstacles,
            tree: &$checker.outer,
            motion: &$checker.motion,
            skipped: &$checker.skipped,
        }
    };
}
pub(super) use block_model;

impl<'m> ValidityChecker<'m> {
    /// Creates a checker of a robot among obstacles.
    pub fn new(robot: &'m CoveredRobot, obstacles: &'m ObstacleSet) -> Self {
        let tree = |solids: &[crate::obstacles::RoundedSolid]| {
            let boxes: Vec<_> = solids.iter().map(crate::obstacles::RoundedSolid::bounds).collect();
            BroadPhase::new(&boxes, robot.reach_m)
        };
        let motion = MotionTable::new(robot);
        robot.tables.get_or_init(|| pair_tables(robot));
        Self {
            robot,
            obstacles,
            outer: tree(&obstacles.outer),
            inner: tree(&obstacles.inner),
            skipped: Vec::new(),
            workspace: Workspace::new(robot, &motion),
            matrix: LinkMatrix::new(robot),
            single: SingleWorkspace::new(robot),
            motion,
            pairs: Vec::new(),
            simd_level: detected_simd_level(),
            blocks: 0,
        }
    }

    /// Selects an instruction set other than the best of this processor. The answers are the same.
    #[must_use]
    pub fn with_simd_level(mut self, level: SimdLevel) -> Self {
        self.simd_level = level;
        self
    }

    /// Allows a body and an obstacle to touch: the pair is not checked.
    pub fn skip(&mut self, body: CoveredLinkId, obstacle: usize) {
        let count = self.obstacles.len();
        if body.0 < self.robot.covered_links.len() && obstacle < count {
            self.skipped.resize(self.robot.covered_links.len() * count, false);
            self.skipped[body.0 * count + obstacle] = true;
            self.workspace.node_obstacles.forget();
        }
    }

    /// Number of blocks of sixteen configurations tested so far.
    pub fn blocks(&self) -> u64 {
        self.blocks
    }

    /// Whether a configuration (rad, m for prismatic joints) is free.
    ///
    /// # Errors
    /// [`ValidityError::WrongCount`] if the number of values is wrong. NaN and infinite values are uncertain.
    pub fn state(&mut self, q: &[f64]) -> Result<Validity, ValidityError> {
        self.expect_count(q)?;
        Ok(self.single_state(q))
    }

    /// Whether each of several configurations is free.
    ///
    /// `q` has their values (rad, m for prismatic joints) one after the other.
    ///
    /// # Errors
    /// [`ValidityError::WrongCount`] if the number of values is not a multiple of the robot's.
    pub fn states(&mut self, q: &[f64], answers: &mut Vec<Validity>) -> Result<(), ValidityError> {
        let dof = self.robot.dof();
        if dof == 0 || !q.len().is_multiple_of(dof) {
            return Err(ValidityError::WrongCount { found: q.len(), expected: dof });
        }
        answers.clear();
        answers.extend(q.chunks(dof).map(|q| self.single_state(q)));
        Ok(())
    }

    /// True if the straight segment in joint space between two configurations is proven free. `false` proves nothing.
    ///
    /// # Errors
    /// [`ValidityError::WrongCount`] if the number of values is wrong. NaN and infinite values are not free.
    pub fn edge_is_free(&mut self, from: &[f64], to: &[f64]) -> Result<bool, ValidityError> {
        self.expect_count(from)?;
        self.expect_count(to)?;
        Ok(self.segment(from, to))
    }

    /// Lists the pairs that are not proven apart on a segment, each once.
    ///
    /// The list is empty if the segment is proven free.
    ///
    /// The list is complete: if these pairs are free on the segment, the segment is free.
    ///
    /// # Errors
    /// The errors of [`edge_is_free`](Self::edge_is_free).
    pub fn uncertain_pairs(
        &mut self,
        from: &[f64],
        to: &[f64],
        found: &mut Vec<NotCertain>,
    ) -> Result<(), ValidityError> {
        self.expect_count(from)?;
        self.expect_count(to)?;
        found.clear();
        let blocks = block_count(self.displacement_m(from, to)).saturating_mul(4);
        for i in 0..blocks {
            let share = |i: usize| i as f64 / blocks as f64;
            let stretch = Stretch { from, to, begin: share(i), end: share(i + 1) };
            self.pairs.clear();
            if !self.workspace.set_stretch(self.robot, &stretch) || self.obstacles.has_unknown {
                self.every_pair(found);
                return Ok(());
            }
            let mut pairs = std::mem::take(&mut self.pairs);
            self.run(BlockRequest { chords: true, active: 0xffff }, Some(&mut pairs));
            found.extend(pairs.iter().map(public));
            self.pairs = pairs;
        }
        found.sort_unstable();
        found.dedup();
        Ok(())
    }

    fn every_pair(&self, found: &mut Vec<NotCertain>) {
        found.clear();
        for (b, body) in self.robot.covered_links.iter().enumerate() {
            if body.frame != 0 {
                let is_checked = |o: &usize| !self.skipped.get(b * self.obstacles.len() + o).copied().unwrap_or(false);
                let obstacles = (0..self.obstacles.len()).filter(is_checked);
                found.extend(obstacles.map(|o| NotCertain::Obstacle(CoveredLinkId(b), o)));
            }
        }
        found.extend(self.robot.pairs.iter().map(|p| NotCertain::Links(p.a, p.b)));
    }

    pub(super) fn expect_count(&self, q: &[f64]) -> Result<(), ValidityError> {
        let expected = self.robot.dof();
        if q.len() == expected { Ok(()) } else { Err(ValidityError::WrongCount { found: q.len(), expected }) }
    }

    fn single_state(&mut self, q: &[f64]) -> Validity {
        if self.obstacles.has_unknown {
            return Validity::Uncertain;
        }
        self.blocks += 1;
        let (inner, matrix, workspace) = (&self.inner, &self.matrix, &mut self.single);
        let model = block_model!(self);
        dispatch!(self.simd_level, simd => {
            SingleKernel { simd, model, inner, matrix, workspace, is_touching: false }.check(q)
        })
    }

    fn displacement_m(&self, from: &[f64], to: &[f64]) -> f64 {
        self.motion.displacement_m(&self.robot.chain, from, to)
    }

    fn segment(&mut self, from: &[f64], to: &[f64]) -> bool {
        let length_m = self.displacement_m(from, to);
        let blocks = block_count(length_m);
        let share = |i: usize| i as f64 / blocks as f64;
        (0..blocks).all(|i| self.stretch(&Stretch { from, to, begin: share(i), end: share(i + 1) }, length_m))
    }

    /// Tests a stretch in one block.
    ///
    /// If only the motion between its lanes is not proven, tests each half in its own block.
    fn stretch(&mut self, stretch: &Stretch, length_m: f64) -> bool {
        if self.obstacles.has_unknown || !self.workspace.set_stretch(self.robot, stretch) {
            return false;
        }
        let result = self.run(BlockRequest { chords: true, active: 0xffff }, None);
        if result.is_free() {
            return true;
        }
        let chord_m = length_m * (stretch.end - stretch.begin) / LANES as f64;
        if result.touching != 0 || !(chord_m > SHORTEST_CHORD_M) {
            return false;
        }
        let middle = 0.5 * (stretch.begin + stretch.end);
        self.stretch(&Stretch { end: middle, ..*stretch }, length_m)
            && self.stretch(&Stretch { begin: middle, ..*stretch }, length_m)
    }

    pub(super) fn run(&mut self, request: BlockRequest, pairs: Option<&mut Vec<NearPair>>) -> BlockResult {
        self.blocks += 1;
        let model = block_model!(self);
        let workspace = &mut self.workspace;
        dispatch!(self.simd_level, simd => model.check(simd, workspace, request, pairs))
    }

    pub(super) fn hits(&mut self, pairs: &[NearPair], half_widths: &[f32]) -> u32 {
        let model = block_model!(self);
        let (inner, workspace) = (&self.inner, &mut self.workspace);
        dispatch!(self.simd_level, simd => model.hits(simd, inner, workspace, pairs, half_widths))
    }
}

/// Number of blocks in which a segment is first tested.
fn block_count(length_m: f64) -> usize {
    let blocks = (length_m / BLOCK_LENGTH_M).ceil();
    // NaN counts as 1: the block rejects it.
    if blocks > 1.0 { blocks.min(1e6) as usize } else { 1 }
}

fn public(pair: &NearPair) -> NotCertain {
    match *pair {
        NearPair::Links(a, b) => NotCertain::Links(CoveredLinkId(a as usize), CoveredLinkId(b as usize)),
        NearPair::Obstacle(body, obstacle) => NotCertain::Obstacle(CoveredLinkId(body as usize), obstacle as usize),
    }
}
