//! Test of sixteen boxes of joint space against the groups of balls that may be near in them.

use elbowroom_validity::lanes::simd::Simd;
use elbowroom_validity::lanes::{LANES, splat};

use super::ball_tree::LEAF;
use super::block_level::Frame;
use super::cover_class::CoverClass;
use super::kernel::{GroupPlace, HalfWidths, Target, at_most, gaps, near_balls};
use super::obstacle::Element;
use super::obstacle_lanes::{CellPose, ObstacleLanes};
use super::place_memo::PlaceMemo;
use super::witnesses::Witnesses;
use crate::bits::ones;

/// Ratio of a ball's radius to its motion in a box above which the ball is replaced by the balls inside it.
const EXPANSION_SHARE: f32 = 3.0;

/// Balls of a group and an element of the obstacle that may touch in some of sixteen boxes.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearGroup {
    pub group: u32,
    pub element: u32,
    pub boxes: u32,
    pub balls: u32,
}

/// A test of sixteen boxes.
pub(super) struct BoxTest<'a> {
    pub obstacle: &'a ObstacleLanes<'a>,
    pub class: &'a CoverClass,
    pub level: usize,
    pub frames: &'a [Frame],
    pub poses: &'a [CellPose],
    pub half: HalfWidths,
    /// Boxes that are undecided: balls may be near, and no contact is known yet.
    pub live: u32,
    /// Groups of the largest balls that may touch in some of the boxes, one bit each.
    pub probes: u32,
    /// Boxes in which any ball is near.
    pub near: u32,
    /// Boxes that are in contact throughout; for single cells, blocked cells.
    pub contact: u32,
}

#[allow(clippy::inline_always, reason = "parts of a kernel")]
impl BoxTest<'_> {
    /// Tests groups; adds the undecided ones to `left`.
    #[inline(always)]
    pub fn run<S: Simd>(
        &mut self,
        simd: S,
        pairs: &[NearGroup],
        places: &mut PlaceMemo,
        witnesses: &mut [Witnesses],
        open: &mut Vec<NearGroup>,
        left: &mut Vec<NearGroup>,
    ) {
        if self.level > 0 {
            self.probe(simd, places);
        }
        open.clear();
        if self.level <= 1 {
            self.recall(simd, witnesses);
        }
        for &pair in pairs {
            open.push(pair);
            while let Some(pair) = open.pop() {
                if self.live == 0 {
                    return;
                }
                self.test(simd, pair, places, witnesses, open, left);
            }
        }
    }

    /// Finds boxes in contact with the largest balls.
    ///
    /// A cell is blocked if any configuration in it is in contact. The centre of a box of two cells along every axis is
    /// a corner of all its cells, so a contact there blocks them all. A contact that lasts from the centre of a box of
    /// four cells to the centres of its halves also blocks the whole box.
    #[inline(always)]
    fn probe<S: Simd>(&mut self, simd: S, places: &mut PlaceMemo) {
        let [element] = self.obstacle.elements else { return };
        let reach = element.radius - self.obstacle.rounding;
        let target = Target { core: element.core, centre: element.centre, reach };
        let lasts_for = if self.level == 2 { 1 } else { self.level };
        for (number, &at) in self.class.probes.iter().take(32).enumerate() {
            if self.probes >> number & 1 == 0 {
                continue;
            }
            let group = &self.class.groups[at as usize];
            let place = places.place(simd, self.class, at, self.frames, self.half);
            let paths = self.class.motions[self.level][at as usize].paths.load(simd);
            let zero = splat(simd, 0.0);
            let stays =
                if self.level == 1 { zero } else { zero - self.class.motions[lasts_for][at as usize].paths.load(simd) };
            let (mut near, mut rest) = (0, self.live);
            while rest != 0 {
                let lane = rest.trailing_zeros();
                rest &= rest - 1;
                let gaps = gaps(simd, group, place, &self.poses[lane as usize], &target);
                if at_most(gaps, stays) & group.lanes != 0 {
                    self.contact |= 1 << lane;
                    self.live &= !(1 << lane);
                }
                near |= at_most(gaps, paths) & group.lanes;
            }
            self.probes &= !(u32::from(near == 0) << number);
        }
    }

    /// Finds cells that are blocked by balls that blocked other cells before. Also finds boxes of two cells along every
    /// axis that these balls touch at the centre, which is a corner of all their cells.
    #[inline(always)]
    fn recall<S: Simd>(&mut self, simd: S, witnesses: &[Witnesses]) {
        for witnesses in witnesses {
            let group = &witnesses.group;
            if group.lanes == 0 || self.live == 0 {
                continue;
            }
            let path = &self.class.paths[group.path as usize];
            let mut place = GroupPlace::ZERO;
            place.compute(simd, group, path, self.frames, self.half);
            let element = &self.obstacle.elements[witnesses.element as usize];
            let rounding = if self.level == 0 { self.obstacle.rounding } else { -self.obstacle.rounding };
            let target = Target { core: element.core, centre: element.centre, reach: element.radius + rounding };
            let mut rest = self.live;
            while rest != 0 {
                let lane = rest.trailing_zeros();
                rest &= rest - 1;
                let pose = &self.poses[lane as usize];
                let touching = if self.level == 0 {
                    near_balls(simd, group, &place, &witnesses.motion, pose, &target, self.half)
                } else {
                    at_most(gaps(simd, group, &place, pose, &target), splat(simd, 0.0)) & group.lanes
                };
                if touching != 0 {
                    self.contact |= 1 << lane;
                    self.live &= !(1 << lane);
                }
            }
        }
    }

    /// Tests a group in its boxes; adds the groups below to `open` and the undecided groups to `left`.
    #[inline(always)]
    fn test<S: Simd>(
        &mut self,
        simd: S,
        pair: NearGroup,
        places: &mut PlaceMemo,
        witnesses: &mut [Witnesses],
        open: &mut Vec<NearGroup>,
        left: &mut Vec<NearGroup>,
    ) {
        let boxes = pair.boxes & self.live;
        if boxes == 0 {
            return;
        }
        let class = self.class;
        let group = &class.groups[pair.group as usize];
        let element = &self.obstacle.elements[pair.element as usize];
        let motion = &class.motions[self.level][pair.group as usize];
        let place = places.place(simd, class, pair.group, self.frames, self.half);
        let reach = element.radius + self.obstacle.rounding;
        let target = Target { core: element.core, centre: element.centre, reach };
        let mut boxes_of = [0; LANES];
        let (mut any, mut rest) = (0, boxes);
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let pose = &self.poses[lane];
            let near = near_balls(simd, group, place, motion, pose, &target, self.half) & pair.balls;
            if near == 0 {
                continue;
            }
            if self.level == 0 && element.is_leaf && near & group.leaves != 0 {
                self.contact |= 1 << lane;
                self.live &= !(1 << lane);
                let ball = (near & group.leaves).trailing_zeros();
                witnesses[group.path as usize].add(class, pair.group, ball, pair.element);
                continue;
            }
            any |= near;
            let mut balls = near;
            while balls != 0 {
                boxes_of[balls.trailing_zeros() as usize] |= 1 << lane;
                balls &= balls - 1;
            }
        }
        if any != 0 {
            self.divide(pair, any, &boxes_of, open, left);
        }
    }

    /// Replaces large near balls by the balls inside them, and the element if it is larger; keeps the other balls.
    fn divide(
        &mut self,
        pair: NearGroup,
        any: u32,
        boxes_of: &[u32; LANES],
        open: &mut Vec<NearGroup>,
        left: &mut Vec<NearGroup>,
    ) {
        let group = &self.class.groups[pair.group as usize];
        let element = &self.obstacle.elements[pair.element as usize];
        let paths = &self.class.motions[self.level][pair.group as usize].paths.0;
        let are_cells = self.level == 0;
        let is_large = |radius: f32, ball: usize| are_cells || radius > EXPANSION_SHARE * paths[ball];
        let (mut of_element, mut kept) = (0, 0);
        for ball in ones(any.into()) {
            let is_leaf = group.below[ball] == LEAF;
            let element_first = !element.is_leaf && (is_leaf || element.radius > group.radii.0[ball]);
            if element_first && is_large(element.radius, ball) {
                of_element |= 1 << ball;
            } else if !element_first && !is_leaf && is_large(group.radii.0[ball], ball) {
                open.push(NearGroup { group: group.below[ball], boxes: boxes_of[ball], balls: 0xffff, ..pair });
            } else {
                kept |= 1 << ball;
            }
        }
        let boxes = |balls: u32| ones(balls.into()).fold(0, |sum, ball| sum | boxes_of[ball]);
        if of_element != 0 {
            push_elements(
                NearGroup { boxes: boxes(of_element), balls: of_element, ..pair },
                self.obstacle.elements,
                open,
            );
        }
        if kept != 0 && !are_cells {
            self.near |= boxes(kept);
            left.push(NearGroup { boxes: boxes(kept), balls: kept, ..pair });
        }
    }
}

/// Adds the same balls with the elements below.
fn push_elements(pair: NearGroup, elements: &[Element], open: &mut Vec<NearGroup>) {
    let mut child = pair.element + 1;
    while child < elements[pair.element as usize].end {
        open.push(NearGroup { element: child, ..pair });
        child = elements[child as usize].end;
    }
}
