//! Query statistics of a checker.

use crate::Level;

/// A number per resolution level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PerLevel {
    /// Number for [`Level::L1`].
    pub l1: u64,
    /// Number for [`Level::L2`] and all depths of the box trees.
    pub l2: u64,
    /// Number for [`Level::Capsule`].
    pub capsule: u64,
    /// Number for [`Level::Hull`].
    pub hull: u64,
    /// Number for [`Level::L3`].
    pub l3: u64,
}

impl PerLevel {
    /// The number of one level; 0 for [`Level::Auto`], which has no model.
    pub fn get(&self, level: Level) -> u64 {
        match level {
            Level::Auto => 0,
            Level::L1 => self.l1,
            Level::L2 | Level::L2Depth(_) => self.l2,
            Level::Capsule => self.capsule,
            Level::Hull => self.hull,
            Level::L3 => self.l3,
        }
    }

    /// The sum over all levels.
    pub fn total(&self) -> u64 {
        self.l1 + self.l2 + self.capsule + self.hull + self.l3
    }

    /// Adds the numbers of each level.
    fn sum(&mut self, other: &Self) {
        self.l1 += other.l1;
        self.l2 += other.l2;
        self.capsule += other.capsule;
        self.hull += other.hull;
        self.l3 += other.l3;
    }

    pub(crate) fn add(&mut self, level: Level, n: u64) {
        match level {
            Level::Auto => {}
            Level::L1 => self.l1 += n,
            Level::L2 | Level::L2Depth(_) => self.l2 += n,
            Level::Capsule => self.capsule += n,
            Level::Hull => self.hull += n,
            Level::L3 => self.l3 += n,
        }
    }
}

/// Work of a [`Checker`](crate::Checker) since its creation or the last [reset](crate::Checker::reset_stats).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CheckerStats {
    /// Number of queries, by the finest level that each used.
    pub answered: PerLevel,
    /// Number of pairs proven far enough apart, by the level that proved it.
    pub pairs_cleared: PerLevel,
    /// Number of pairs tested one by one, by the level of the models tested.
    pub pairs_tested: PerLevel,
    /// Number of pairs skipped because the allowed collision matrix proves them out of reach.
    pub pairs_skipped: u64,
    /// Number of tests of one box of a mesh against sixteen boxes of another, in pairs of meshes.
    pub mesh_boxes: u64,
    /// Number of pairs of triangles that boxes and single precision left undecided, in pairs of meshes.
    pub mesh_triangles: u64,
    /// Number of mesh triangles whose distance to a shape other than a mesh was computed.
    ///
    /// For continuous witness points, each triangle counts once more per face of that shape.
    pub triangles_beside_solids: u64,
}

impl CheckerStats {
    pub(crate) fn add_mesh_query(&mut self, visits: elbowroom_proximity::QueryStats) {
        self.mesh_boxes += u64::from(visits.boxes);
        self.mesh_triangles += u64::from(visits.triangles);
        self.triangles_beside_solids += u64::from(visits.triangles_beside_solids);
    }
}

impl std::ops::AddAssign for CheckerStats {
    fn add_assign(&mut self, other: Self) {
        self.answered.sum(&other.answered);
        self.pairs_cleared.sum(&other.pairs_cleared);
        self.pairs_tested.sum(&other.pairs_tested);
        self.pairs_skipped += other.pairs_skipped;
        self.mesh_boxes += other.mesh_boxes;
        self.mesh_triangles += other.mesh_triangles;
        self.triangles_beside_solids += other.triangles_beside_solids;
    }
}
