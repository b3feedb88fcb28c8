//! Query statistics of a checker.

use crate::Level;

/// A number per resolution level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PerLevel {
    /// [`Level::L1`].
    pub l1: u64,
    /// [`Level::L2`].
    pub l2: u64,
    /// [`Level::Capsule`].
    pub capsule: u64,
    /// [`Level::Hull`].
    pub hull: u64,
    /// [`Level::L3`].
    pub l3: u64,
}

impl PerLevel {
    /// The number of one level; 0 for [`Level::Auto`], which is not a model of its own.
    pub fn get(&self, level: Level) -> u64 {
        match level {
            Level::Auto => 0,
            Level::L1 => self.l1,
            Level::L2 => self.l2,
            Level::Capsule => self.capsule,
            Level::Hull => self.hull,
            Level::L3 => self.l3,
        }
    }

    /// The sum over all levels.
    pub fn total(&self) -> u64 {
        self.l1 + self.l2 + self.capsule + self.hull + self.l3
    }

    /// Adds each number.
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
            Level::L2 => self.l2 += n,
            Level::Capsule => self.capsule += n,
            Level::Hull => self.hull += n,
            Level::L3 => self.l3 += n,
        }
    }
}

/// Work of a [`Checker`](crate::Checker) since it was made or [`reset`](crate::Checker::reset_stats).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CheckerStats {
    /// Queries, by the finest level that each needed.
    pub answered: PerLevel,
    /// Pairs proven far enough apart, by the level that proved it.
    pub pairs_cleared: PerLevel,
    /// Pairs tested one by one, by the level of the models tested.
    pub pairs_tested: PerLevel,
    /// Pairs skipped because the allowed collision matrix proves them out of reach.
    pub pairs_skipped: u64,
    /// Tests of one box of a mesh against sixteen boxes of another, in pairs of meshes.
    pub mesh_boxes: u64,
    /// Pairs of triangles left undecided by boxes and single precision, in pairs of meshes.
    pub mesh_triangles: u64,
    /// Triangles of meshes whose distance to a shape that is not a mesh was computed; for continuous witness points, once more per
    /// face of that shape.
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
