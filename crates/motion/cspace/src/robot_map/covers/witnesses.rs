//! Balls that blocked cells: they are likely to block neighbouring cells as well.

use elbowroom_validity::lanes::{LANES, Row};

use super::ball_tree::LEAF;
use super::cover_class::{CoverClass, CoverGroup, GroupMotion};

/// The balls of a path that blocked cells most recently, with the element of the obstacle that they touched.
#[derive(Debug)]
pub(super) struct Witnesses {
    pub group: CoverGroup,
    /// Motion within a cell.
    pub motion: GroupMotion,
    pub element: u32,
    /// Group and lane of each ball.
    known: [(u32, u32); LANES],
    oldest: usize,
}

impl Witnesses {
    /// Creates empty memories, one per path of a class.
    pub fn none(class: &CoverClass) -> Vec<Self> {
        let none = |path: usize| Self {
            group: CoverGroup::empty(path as u32),
            motion: GroupMotion { paths: Row::ZERO, curvatures: Row::ZERO },
            element: 0,
            known: [(u32::MAX, 0); LANES],
            oldest: 0,
        };
        (0..class.paths.len()).map(none).collect()
    }

    /// Stores a ball in place of the oldest one.
    pub fn add(&mut self, class: &CoverClass, group: u32, lane: u32, element: u32) {
        if self.element != element {
            self.element = element;
            self.group = CoverGroup::empty(self.group.path);
            (self.known, self.oldest) = ([(u32::MAX, 0); LANES], 0);
        }
        if self.known.contains(&(group, lane)) {
            return;
        }
        let at = self.oldest;
        self.oldest = (at + 1) % LANES;
        self.known[at] = (group, lane);
        let (balls, motion, lane) = (&class.groups[group as usize], &class.motions[0][group as usize], lane as usize);
        self.group.set(at, balls.centre(lane), balls.radii.0[lane], LEAF);
        self.motion.paths.0[at] = motion.paths.0[lane];
        self.motion.curvatures.0[at] = motion.curvatures.0[lane];
    }
}
