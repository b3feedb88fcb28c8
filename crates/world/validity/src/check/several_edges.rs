//! Rejection of several edges at once.

use fearless_simd::dispatch;

use super::block::BlockModel;
use super::checker::{ValidityChecker, block_model};
use super::segment::Stretch;
use crate::error::ValidityError;
use crate::lanes::LANES;

/// Largest number of edges that are tested at once.
pub const EDGES_AT_ONCE: usize = 4;
/// Configurations per edge.
const PER_EDGE: usize = LANES / EDGES_AT_ONCE;

impl ValidityChecker<'_> {
    /// Which of up to [`EDGES_AT_ONCE`] edges cannot be proven free, because a link is deep in an obstacle at one of four of
    /// their configurations: one bit per edge. Edges without a bit may be free or not. Far cheaper than
    /// [`edge_is_free`](Self::edge_is_free), which is false for an edge with a bit.
    ///
    /// Further edges than the first [`EDGES_AT_ONCE`] have no bit, nor have edges with NaN or infinite values, or on which a
    /// joint changes by more than 4.5 rad or m.
    ///
    /// # Errors
    /// [`ValidityError::WrongCount`] if the number of values is wrong.
    ///
    /// ```
    /// use elbowroom_proximity::{Shape, Sphere};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// use elbowroom_validity::{CoveredRobot, ObstacleSet, ValidityChecker};
    /// let arm = CoveredRobot::new(&elbowroom_robot::example::arm()?, Pose::IDENTITY)?;
    /// let mut obstacles = ObstacleSet::default();
    /// obstacles.add_shape(&Shape::Sphere(Sphere { radius: 50.0 }), &Pose::IDENTITY, 0.0);
    /// let mut checker = ValidityChecker::new(&arm, &obstacles);
    /// let (from, to) = (vec![0.0; arm.dof()], vec![0.3; arm.dof()]);
    /// assert_eq!(checker.edges_in_obstacles(&[(&from, &to)])?, 1);
    /// assert!(!checker.edge_is_free(&from, &to)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn edges_in_obstacles(&mut self, edges: &[(&[f64], &[f64])]) -> Result<u32, ValidityError> {
        let edges = &edges[..edges.len().min(EDGES_AT_ONCE)];
        let mut active = 0u32;
        for (index, (from, to)) in edges.iter().enumerate() {
            self.expect_count(from)?;
            self.expect_count(to)?;
            if self.workspace.set_stretch(self.robot, &Stretch { from, to, begin: 0.0, end: 1.0 }) {
                self.workspace.put_stretch(index * PER_EDGE, PER_EDGE);
                active |= 1 << index;
            }
        }
        if active == 0 {
            return Ok(0);
        }
        // The other lanes repeat an edge, so that they do not enlarge what the broad phase looks around.
        for index in (0..EDGES_AT_ONCE).filter(|index| active >> index & 1 == 0) {
            self.workspace.copy_lanes(active.trailing_zeros() as usize * PER_EDGE, index * PER_EDGE, PER_EDGE);
        }
        self.blocks += 1;
        let model = block_model!(self);
        let workspace = &mut self.workspace;
        let touching = dispatch!(self.simd_level, simd => {
            model.root_touches(simd, workspace, |touching| of_edges(touching) & active == active)
        });
        Ok(of_edges(touching) & active)
    }
}

/// One bit per edge that has a lane.
fn of_edges(lanes: u32) -> u32 {
    let bit = |edge: usize| u32::from(lanes >> (edge * PER_EDGE) & ((1 << PER_EDGE) - 1) != 0) << edge;
    (0..EDGES_AT_ONCE).map(bit).fold(0, |bits, bit| bits | bit)
}
