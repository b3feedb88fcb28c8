//! Pairs of a piece and an obstacle in a box of joint space: proven apart, proven in contact, or neither.

use std::sync::atomic::AtomicUsize;

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{WarmStart, Workspace};
use elbowroom_spatial::{Pose, Vec3};

use super::box_tree::CellRange;
use super::driven_chain::DrivenChain;
use super::motion_bound::MotionBound;
use super::pair_distance::distance_within;
use super::placed_obstacle::{PlacedObstacle, depth_inside};
use super::robot_pieces::{ClosedMesh, RobotPieces};
use super::settings::{MAX_JOINTS, RobotMapStats};
use crate::GridAxis;

/// Fraction of the required distance below which the distance in an enclosing box makes a new query pointless.
const RECHECK_RATIO: f64 = 0.85;

/// A piece of the robot and an obstacle that it may touch in the current box.
#[derive(Debug, Clone, Copy)]
pub(super) struct PieceObstaclePair {
    pub piece: u32,
    pub obstacle: u32,
    /// Estimate of the distance, metres, from this box or an enclosing one; infinite before the first query.
    pub distance: f64,
    pub warm_start: WarmStart,
}

/// A closed mesh of the robot and an obstacle small enough to be inside.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContainmentCandidate {
    pub closed_mesh: u32,
    pub obstacle: u32,
}

/// Data shared by all threads.
#[derive(Debug, Clone, Copy)]
pub(super) struct SubdivisionTask<'a> {
    pub chain: &'a DrivenChain,
    pub pieces: &'a RobotPieces,
    pub axes: &'a [GridAxis],
    pub obstacles: &'a [PlacedObstacle],
    pub containment_candidates: &'a [ContainmentCandidate],
    /// Number of bisections of a cell at the boundary, per number of axes that move a piece.
    pub bisections: [u32; MAX_JOINTS + 1],
    /// Number of checks of a cell of three axes.
    pub max_checks_per_cell: u32,
    /// Largest number of nodes of all slabs together.
    pub max_nodes: usize,
    /// Number of nodes of the finished slabs.
    pub used_nodes: &'a AtomicUsize,
}

/// A box of joint values.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointBox {
    pub center: [f64; MAX_JOINTS],
    pub half: [f64; MAX_JOINTS],
}

impl JointBox {
    /// Centre and half widths of a range of cells, within the limits.
    pub fn new(axes: &[GridAxis], cells: &CellRange) -> Self {
        let mut joint_box = Self { center: [0.0; MAX_JOINTS], half: [0.0; MAX_JOINTS] };
        for (i, axis) in axes.iter().enumerate() {
            let low = axis.border(cells.first[i].into());
            let high = axis.border(cells.end[i].into()).min(axis.max()).max(low);
            joint_box.center[i] = 0.5 * (low + high);
            // A value on the border belongs to one of two cells; both cells include it.
            joint_box.half[i] = 0.5 * (high - low) + 1e-8 * axis.step();
        }
        joint_box
    }
}

/// Evaluates pairs; use one evaluator per thread.
pub(super) struct PairEvaluator<'a> {
    pub task: SubdivisionTask<'a>,
    pub state: ChainState,
    pub workspace: Workspace,
    pub stats: RobotMapStats,
    /// Number of checks left for the current cell.
    pub checks_left: u32,
}

impl<'a> PairEvaluator<'a> {
    pub fn new(task: SubdivisionTask<'a>) -> Self {
        Self {
            state: task.chain.state(),
            task,
            workspace: Workspace::new(),
            stats: RobotMapStats::default(),
            checks_left: 0,
        }
    }

    pub fn set_configuration(&mut self, q: &[f64; MAX_JOINTS]) {
        self.task.chain.set_axes(&mut self.state, &q[..self.task.axes.len()]);
    }

    /// Pose of a piece at the current configuration.
    pub fn in_world(&self, piece: usize) -> Pose {
        let piece = &self.task.pieces.pieces[piece];
        self.task.chain.link_in_world(&self.state, piece.link) * piece.in_link
    }

    /// Whether a pair is proven apart in the whole box, in which the piece moves at most by `displacement`. Stores the
    /// distance found for the pair.
    pub fn is_apart(&mut self, pair: &mut PieceObstaclePair, bound: &MotionBound, displacement: f64) -> bool {
        let piece = &self.task.pieces.pieces[pair.piece as usize];
        let obstacle = &self.task.obstacles[pair.obstacle as usize];
        if obstacle.min_distance(bound.center) - piece.radius > displacement {
            return true;
        }
        // The pair is certainly not farther apart than the displacement.
        if obstacle.points.first().is_some_and(|p| p.distance(bound.center) + piece.radius <= displacement) {
            return false;
        }
        // The pair was nearer in an enclosing box: a query is unlikely to prove it apart.
        if pair.distance < RECHECK_RATIO * displacement {
            return false;
        }
        self.stats.distance_queries += 1;
        let in_world = self.in_world(pair.piece as usize);
        let warm_start = &mut pair.warm_start;
        let found = distance_within(&mut self.workspace, &piece.shape, &in_world, obstacle, displacement, warm_start);
        pair.distance = found.unwrap_or(displacement);
        found.is_none()
    }

    /// Whether the nearest of some pairs is in contact in the whole box, because one solid is deep enough inside the
    /// other.
    pub fn is_in_contact_throughout(&mut self, joint_box: &JointBox, pairs: &[PieceObstaclePair]) -> bool {
        let Some(&nearest) = pairs.iter().min_by(|a, b| a.distance.total_cmp(&b.distance)) else { return false };
        let piece = &self.task.pieces.pieces[nearest.piece as usize];
        let obstacle = &self.task.obstacles[nearest.obstacle as usize];
        let in_world = self.in_world(nearest.piece as usize);
        self.stats.collision_queries += 1;
        if !self.workspace.collides(&piece.shape, &in_world, &obstacle.shape, &obstacle.in_world) {
            return false;
        }
        let link = self.task.chain.link_in_world(&self.state, piece.link);
        let bound = MotionBound::new(piece, self.task.chain, &self.state);
        let stays =
            |depth: f64, p: Vec3| depth > 0.0 && depth > bound.max_point_displacement(piece, &joint_box.half, p);
        piece.points.iter().map(|p| link.transform_point(*p)).any(|p| stays(obstacle.depth_of(p), p))
            || obstacle.points.iter().any(|&p| stays(depth_inside(&piece.shape, &in_world, p), p))
    }

    /// Whether an obstacle is inside a link that at most `depth` axes move, at the current configuration, without
    /// touching its surface. With a box: only if the obstacle is deep enough inside to stay there in the whole box.
    pub fn contains_obstacle(&self, depth: usize, throughout: Option<&JointBox>) -> bool {
        self.task.containment_candidates.iter().any(|candidate| {
            let ClosedMesh { mesh, piece } = &self.task.pieces.closed_meshes[candidate.closed_mesh as usize];
            if piece.depth > depth {
                return false;
            }
            let link = self.task.chain.link_in_world(&self.state, piece.link);
            let center = link.transform_point(piece.center);
            let mesh_in_world = link * piece.in_link;
            // The surfaces do not touch, so a connected component is inside as a whole or not at all.
            let inside = |p: &Vec3| {
                let near = center.distance(*p) <= piece.radius * (1.0 + 1e-9);
                near && mesh.contains(mesh_in_world.inverse_transform_point(*p))
            };
            let stays = |p: &Vec3| {
                throughout.is_none_or(|joint_box| {
                    let bound = MotionBound::new(piece, self.task.chain, &self.state);
                    let displacement = bound.max_point_displacement(piece, &joint_box.half, *p);
                    depth_inside(&piece.shape, &mesh_in_world, *p) > displacement
                })
            };
            self.task.obstacles[candidate.obstacle as usize].points.iter().any(|p| inside(p) && stays(p))
        })
    }
}
