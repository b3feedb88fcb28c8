//! The axis of the map in lanes, and the number of different cells of each axis.

use std::f64::consts::TAU;

use super::super::rigid_groups::RigidGroup;
use crate::Grid;

/// The axes of a map by their role.
#[derive(Debug, Clone, Copy)]
pub(super) struct AxisRoles {
    /// The axis of the first joint of every link that the map moves.
    pub lanes: usize,
    /// The other two, ascending.
    pub others: [usize; 2],
    /// Number of computed cells of each axis: the cells of one turn if the axis has more.
    pub counts: [usize; 3],
}

impl AxisRoles {
    /// Assigns the roles; `None` if not all links have the same first joint, or its axis also moves another joint.
    pub fn new(grid: &Grid, groups: &[RigidGroup]) -> Option<Self> {
        let Some(first) = groups.first().and_then(|group| group.joints.first()) else {
            return Some(Self { lanes: 0, others: [1, 2], counts: grid.shape() });
        };
        let has_it_first = |group: &RigidGroup| group.joints.first().is_some_and(|joint| joint.child == first.child);
        let is_alone = |group: &RigidGroup| group.joints[1..].iter().all(|joint| joint.axis != first.axis);
        let lanes = first.axis;
        let fits = groups.iter().all(|group| has_it_first(group) && is_alone(group));
        let others = [usize::from(lanes == 0), if lanes == 2 { 1 } else { 2 }];
        fits.then(|| Self { lanes, others, counts: computed_counts(grid, groups) })
    }

    /// Number of cells of the axis in lanes.
    pub fn lane_count(&self) -> usize {
        self.counts[self.lanes]
    }

    /// Number of cells of each of the two other axes.
    pub fn other_counts(&self) -> [usize; 2] {
        self.others.map(|axis| self.counts[axis])
    }
}

/// Number of different cells of each axis: the cells of one turn if the axis has more and all its joints turn by whole
/// turns.
fn computed_counts(grid: &Grid, groups: &[RigidGroup]) -> [usize; 3] {
    [0, 1, 2].map(|number| {
        let axis = &grid.axes()[number];
        let period = (TAU / axis.step()).round();
        let joints = || groups.iter().flat_map(|g| &g.joints).filter(|joint| joint.axis == number);
        let is_periodic = joints().all(|joint| joint.turns && joint.multiplier.fract() == 0.0);
        let divides = (period * axis.step() - TAU).abs() <= 1e-12 * TAU;
        if is_periodic && divides { axis.count().min(period as usize) } else { axis.count() }
    })
}
