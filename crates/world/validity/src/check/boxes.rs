//! Boxes in joint space that are proven in collision as a whole: what disconnects two configurations.

use super::block::BlockRequest;
use super::checker::ValidityChecker;
use crate::error::ValidityError;
use crate::lanes::LANES;

/// Half widths in single precision are never below those in double precision.
const ROUNDED_UP: f64 = 1.0 + 1e-6;

impl ValidityChecker<'_> {
    /// Whether *every* configuration of a box in joint space is proven in collision, for several boxes of the same size: those
    /// within `half_widths` (rad, m for prismatic joints, within their limits; infinite if a joint may be anywhere) of a centre. `centres` has the
    /// values of all centres one after the other. False proves nothing.
    ///
    /// Proven by depth: at the centre an inner sphere of a link overlaps an obstacle or another link deeper than either moves
    /// within the box.
    ///
    /// ```
    /// use elbowroom_proximity::{Cuboid, Shape};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// use elbowroom_validity::{CoveredRobot, ObstacleSet, ValidityChecker};
    /// let arm = CoveredRobot::new(&elbowroom_robot::example::arm()?, Pose::IDENTITY)?;
    /// let mut obstacles = ObstacleSet::default();
    /// let block = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.6) });
    /// obstacles.add_shape(&block, &Pose::from_translation(Vec3::Z * 0.8), 0.0);
    /// let mut checker = ValidityChecker::new(&arm, &obstacles);
    /// let (mut narrow, mut wide) = (Vec::new(), Vec::new());
    /// checker.boxes_are_in_collision(&[0.0; 3], &[0.05; 3], &mut narrow)?;
    /// checker.boxes_are_in_collision(&[0.0; 3], &[3.0; 3], &mut wide)?;
    /// assert_eq!((narrow, wide), (vec![true], vec![false]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A number of values that is not a multiple of the robot's, or another number of half widths.
    pub fn boxes_are_in_collision(
        &mut self,
        centres: &[f64],
        half_widths: &[f64],
        answers: &mut Vec<bool>,
    ) -> Result<(), ValidityError> {
        let dof = self.robot.dof();
        for found in [centres.len(), half_widths.len()] {
            if dof == 0 || !found.is_multiple_of(dof) {
                return Err(ValidityError::WrongCount { found, expected: dof });
            }
        }
        if half_widths.len() != dof {
            return Err(ValidityError::WrongCount { found: half_widths.len(), expected: dof });
        }
        let half_widths = self.half_widths_of_steps(half_widths);
        answers.clear();
        for block in centres.chunks(LANES * dof) {
            let hits = self.block_of_boxes(block, &half_widths);
            answers.extend((0..block.len() / dof).map(|lane| hits >> lane & 1 == 1));
        }
        Ok(())
    }

    /// Of each moving joint, also of those that follow another. NaN and negative numbers count as anywhere.
    fn half_widths_of_steps(&self, half_widths: &[f64]) -> Vec<f32> {
        let of_step = |index: usize, multiplier: f64| {
            let half = half_widths[index];
            let half = if half >= 0.0 { half } else { f64::INFINITY };
            // A mimic joint with multiplier 0 does not move (0·∞ is NaN).
            if multiplier == 0.0 { 0.0 } else { ((half * multiplier.abs() * ROUNDED_UP) as f32).next_up() }
        };
        self.robot.chain.steps.iter().map(|step| of_step(step.index, step.multiplier)).collect()
    }

    /// Lanes whose boxes are in collision, one bit each.
    fn block_of_boxes(&mut self, centres: &[f64], half_widths: &[f32]) -> u32 {
        let dof = self.robot.dof();
        let mut active = 0;
        for lane in 0..LANES {
            // Lanes that do not count repeat the first.
            let at = if (lane + 1) * dof <= centres.len() { lane * dof } else { 0 };
            let is_accepted = self.workspace.set_lane(self.robot, lane, &centres[at..at + dof]);
            active |= u32::from(is_accepted && at == lane * dof) << lane;
        }
        self.workspace.set_no_motion();
        let mut pairs = std::mem::take(&mut self.pairs);
        pairs.clear();
        self.run(BlockRequest { chords: false, active }, Some(&mut pairs));
        let hits = self.hits(&pairs, half_widths) & active;
        self.pairs = pairs;
        hits
    }
}
