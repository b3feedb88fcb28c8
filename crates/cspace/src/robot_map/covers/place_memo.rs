//! Where groups of balls are, for the boxes in work: the same for all values of the axis in lanes.

use fearless_simd::Simd;

use super::block_level::Frame;
use super::cover_class::CoverClass;
use super::kernel::{GroupPlace, HalfWidths};

/// Places of a class's groups, level by level.
#[derive(Debug, Default)]
pub(super) struct PlaceMemo {
    levels: Vec<LevelMemo>,
}

#[derive(Debug)]
struct LevelMemo {
    others: [usize; 2],
    /// Changes with the box.
    version: u32,
    /// The version of each place.
    versions: Vec<u32>,
    places: Vec<GroupPlace>,
}

impl PlaceMemo {
    /// For another class.
    pub fn start(&mut self, class: &CoverClass) {
        let count = class.groups.len();
        let memo = || LevelMemo {
            others: [usize::MAX; 2],
            version: 0,
            versions: vec![0; count],
            places: vec![GroupPlace::ZERO; count],
        };
        self.levels = class.levels.iter().map(|_| memo()).collect();
    }

    /// For a box of a level.
    pub fn enter(&mut self, level: usize, others: [usize; 2]) {
        let memo = &mut self.levels[level];
        if memo.others != others {
            memo.others = others;
            memo.version += 1;
        }
    }

    /// The place of a group in the box that was entered.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub fn place<S: Simd>(
        &mut self,
        simd: S,
        class: &CoverClass,
        level: usize,
        group: u32,
        frames: &[Frame],
        half: HalfWidths,
    ) -> &GroupPlace {
        let memo = &mut self.levels[level];
        let at = group as usize;
        if memo.versions[at] != memo.version {
            memo.versions[at] = memo.version;
            let balls = &class.groups[at];
            memo.places[at].compute(simd, balls, &class.paths[balls.path as usize], frames, half);
        }
        &memo.places[at]
    }
}
