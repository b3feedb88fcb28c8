//! Boxes in joint space that are proven to be in collision as a whole, to prove that two configurations are disconnected.

use super::block_request::BlockRequest;
use super::checker::ValidityChecker;
use crate::error::ValidityError;
use crate::lanes::LANES;

/// Factor by which half widths in single precision are never below the half widths in double precision.
const ROUNDED_UP: f64 = 1.0 + 1e-6;

impl ValidityChecker<'_> {
    /// Whether *every* configuration of a box in joint space is proven to be in collision, for several boxes of one size.
    ///
    /// A box holds the configurations within `half_widths` (rad, or m for prismatic joints) of a centre; prismatic joints
    /// stay within their limits. A half width is infinite if a joint may have any value. `centres` has the values of all
    /// centres one after the other. `false` proves nothing.
    ///
    /// The proof uses depth: at the centre, an inner sphere of a link overlaps an obstacle or another link deeper than
    /// the two can move against each other within the box.
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
    /// [`ValidityError::WrongCount`] if the number of values in `centres` is not a multiple of the robot's, or the number
    /// of half widths is not the robot's.
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

    /// Half width of each moving joint, including joints that follow another. NaN and negative numbers count as infinite.
    fn half_widths_of_steps(&self, half_widths: &[f64]) -> Vec<f32> {
        let of_step = |index: usize, multiplier: f64| {
            let half = half_widths[index];
            let half = if half >= 0.0 { half } else { f64::INFINITY };
            // A mimic joint with multiplier 0 does not move (0·∞ is NaN).
            if multiplier == 0.0 { 0.0 } else { ((half * multiplier.abs() * ROUNDED_UP) as f32).next_up() }
        };
        self.robot.chain.steps.iter().map(|step| of_step(step.index, step.multiplier)).collect()
    }

    /// Lanes whose boxes are proven to be in collision, one bit each.
    fn block_of_boxes(&mut self, centres: &[f64], half_widths: &[f32]) -> u32 {
        let dof = self.robot.dof();
        let mut active = 0;
        for lane in 0..LANES {
            // Unused lanes repeat the first lane.
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
