//! What a checker has done.

use crate::Level;

/// A number per level.
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
    /// The number of one level; 0 for [`Level::Auto`], which answers nothing itself.
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

/// What a [`Checker`](crate::Checker) has done since it was made or [`reset`](crate::Checker::reset_counts).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Questions per level that was needed to be certain.
    pub answered: PerLevel,
    /// Pairs per level that proved them far enough apart.
    pub pairs_cleared: PerLevel,
    /// Pairs whose models of that level were measured against each other one by one.
    pub pairs_tested: PerLevel,
    /// Pairs not looked at because the pair matrix knows that they cannot meet.
    pub pairs_skipped: u64,
    /// Tests of one box of a mesh against sixteen of another, in pairs of meshes.
    pub mesh_boxes: u64,
    /// Pairs of triangles that boxes and f32 did not decide, in pairs of meshes.
    pub mesh_triangles: u64,
}

impl Counts {
    pub(crate) fn meshes(&mut self, visits: elbowroom_proximity::mesh::Visits) {
        self.mesh_boxes += u64::from(visits.boxes);
        self.mesh_triangles += u64::from(visits.triangles);
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.answered.sum(&other.answered);
        self.pairs_cleared.sum(&other.pairs_cleared);
        self.pairs_tested.sum(&other.pairs_tested);
        self.pairs_skipped += other.pairs_skipped;
        self.mesh_boxes += other.mesh_boxes;
        self.mesh_triangles += other.mesh_triangles;
    }
}
