//! Memory of the places of groups of balls in the current box: they are equal for all values of the axis in lanes.

use elbowroom_validity::lanes::simd::Simd;

use super::block_level::Frame;
use super::cover_class::CoverClass;
use super::kernel::{GroupPlace, HalfWidths};

/// Places of a class's groups in one box.
#[derive(Debug, Default)]
pub(super) struct PlaceMemo {
    /// Level and indices of the box.
    of: Option<(usize, [usize; 2])>,
    /// Changes with the box.
    version: u32,
    /// The version of each place.
    versions: Vec<u32>,
    places: Vec<GroupPlace>,
}

impl PlaceMemo {
    /// Prepares the memory for another class.
    pub fn start(&mut self, class: &CoverClass) {
        self.of = None;
        let count = self.places.len().max(class.groups.len());
        self.versions.resize(count, 0);
        self.places.resize(count, GroupPlace::ZERO);
    }

    /// Prepares the memory for a box of a level.
    pub fn enter(&mut self, level: usize, others: [usize; 2]) {
        if self.of != Some((level, others)) {
            self.of = Some((level, others));
            self.version += 1;
        }
    }

    /// The place of a group in the entered box.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub fn place<S: Simd>(
        &mut self,
        simd: S,
        class: &CoverClass,
        group: u32,
        frames: &[Frame],
        half: HalfWidths,
    ) -> &GroupPlace {
        let at = group as usize;
        if self.versions[at] != self.version {
            self.versions[at] = self.version;
            let balls = &class.groups[at];
            self.places[at].compute(simd, balls, &class.paths[balls.path as usize], frames, half);
        }
        &self.places[at]
    }
}
