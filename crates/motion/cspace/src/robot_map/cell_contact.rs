//! Cells that are not proven free immediately: bisected until a contact is found or excluded.

use elbowroom_proximity::{DistanceSettings, Separation};
use elbowroom_spatial::Pose;

use super::motion_bound::MotionBound;
use super::pair_evaluator::{JointBox, PairEvaluator, PieceObstaclePair};
use super::settings::MAX_JOINTS;

/// Smallest decrease of the distance, to first order, as a fraction, for which a corner of the box is checked.
const CORNER_GAIN: f64 = 0.8;

impl PairEvaluator<'_> {
    /// Whether some of these pairs, with a piece that `depth` axes move, may touch in a cell.
    pub fn may_touch_in_cell(&mut self, cell: &JointBox, pairs: &[PieceObstaclePair], depth: usize) -> bool {
        if self.contains_obstacle(depth, None) {
            return true;
        }
        self.checks_left = self.task.max_checks_per_cell >> (4 * depth.saturating_sub(3));
        let pieces = &self.task.pieces.pieces;
        let mut here: Vec<PieceObstaclePair> =
            pairs.iter().filter(|pair| pieces[pair.piece as usize].depth == depth).copied().collect();
        // The nearest pair is the most likely to touch, and one contact is enough.
        here.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let touches = here.into_iter().any(|pair| self.may_touch(pair, cell, None, self.task.bisections[depth]));
        self.set_configuration(&cell.center);
        touches
    }

    /// Whether a pair may touch in a box: checks the centre, then the corner that is nearer to first order, then both
    /// halves.
    fn may_touch(
        &mut self,
        mut pair: PieceObstaclePair,
        joint_box: &JointBox,
        checked_corner: Option<&[f64; MAX_JOINTS]>,
        bisections: u32,
    ) -> bool {
        let task = self.task;
        let piece = &task.pieces.pieces[pair.piece as usize];
        let obstacle = &task.obstacles[pair.obstacle as usize];
        self.set_configuration(&joint_box.center);
        let bound = MotionBound::new(piece, task.chain, &self.state);
        let displacement = bound.max_displacement(piece, &joint_box.half);
        let in_world = self.in_world(pair.piece as usize);
        // If the solids overlap, a collision query is cheaper.
        if checked_corner.is_none() && self.collides(&pair, &in_world) {
            return true;
        }
        self.stats.distance_queries += 1;
        let (shapes, poses) = ((&piece.shape, &obstacle.shape), (&in_world, &obstacle.in_world));
        let settings = DistanceSettings {
            limit: displacement,
            warm_start: Some(&mut pair.warm_start),
            ..DistanceSettings::default()
        };
        let found = self.workspace.separation(shapes.0, poses.0, shapes.1, poses.1, settings);
        let Some(gap) = found.filter(|s| s.lower_bound <= displacement) else { return false };
        if gap.distance <= 0.0 {
            return true;
        }
        let (corner, nearer) = nearer_corner(joint_box, &bound, piece.depth, &gap);
        // If the corner is hardly nearer, a contact is unlikely.
        let is_worthwhile = nearer > CORNER_GAIN * gap.distance;
        if is_worthwhile && checked_corner.is_none_or(|checked| !is_same_configuration(checked, &corner)) {
            self.set_configuration(&corner);
            let at_corner = self.in_world(pair.piece as usize);
            if self.collides(&pair, &at_corner) {
                return true;
            }
        }
        self.checks_left = self.checks_left.saturating_sub(1);
        if bisections == 0 || self.checks_left == 0 {
            self.stats.undecided += 1;
            return true;
        }
        let displacements: [f64; MAX_JOINTS] =
            std::array::from_fn(|axis| bound.axis_displacement(piece, axis, &joint_box.half));
        let longest = (0..piece.depth).max_by(|&a, &b| displacements[a].total_cmp(&displacements[b]));
        let Some(axis) = longest else { return true };
        let toward = if corner[axis] < joint_box.center[axis] { -1.0 } else { 1.0 };
        [toward, -toward].into_iter().any(|side| {
            let mut half = *joint_box;
            half.half[axis] *= 0.5;
            half.center[axis] += side * half.half[axis];
            self.may_touch(pair, &half, Some(&corner), bisections - 1)
        })
    }

    /// Whether the solids of a pair overlap, with the piece at this pose.
    fn collides(&mut self, pair: &PieceObstaclePair, in_world: &Pose) -> bool {
        let piece = &self.task.pieces.pieces[pair.piece as usize];
        let obstacle = &self.task.obstacles[pair.obstacle as usize];
        self.stats.collision_queries += 1;
        self.workspace.collides(&piece.shape, in_world, &obstacle.shape, &obstacle.in_world)
    }
}

/// The corner of a box at which a piece is nearest to the obstacle to first order, and the decrease of the distance from
/// the centre to it, metres.
fn nearer_corner(
    joint_box: &JointBox,
    bound: &MotionBound,
    depth: usize,
    gap: &Separation,
) -> ([f64; MAX_JOINTS], f64) {
    let line = (gap.on_b - gap.on_a) * gap.distance.recip();
    let (mut corner, mut nearer) = (joint_box.center, 0.0);
    for axis in 0..depth {
        let speed = bound.point_velocity(axis, gap.on_a).dot(line);
        nearer += joint_box.half[axis] * speed.abs();
        corner[axis] += joint_box.half[axis] * if speed < 0.0 { -1.0 } else { 1.0 };
    }
    (corner, nearer)
}

/// Whether two configurations are equal up to rounding.
fn is_same_configuration(a: &[f64; MAX_JOINTS], b: &[f64; MAX_JOINTS]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9)
}
