//! Boxes of joint space, halved until each is free or blocked.

use std::ops::Range;

use elbowroom_validity::lanes::simd::{Level as SimdLevel, SimdBase, dispatch};
use elbowroom_validity::lanes::{LANES, detected_simd_level};
use rayon::prelude::*;

use super::axis_roles::AxisRoles;
use super::cell_bits::{CellBits, CellBox, CellRows};
use super::cover_class::CoverClass;
use super::group_test::{BoxTest, NearGroup};
use super::kernel::{GroupPlace, HalfWidths, Target, gaps};
use super::obstacle_lanes::ObstacleLanes;
use super::place_memo::PlaceMemo;
use super::solid_core::SolidCore;
use super::step_chain::Step;
use super::witnesses::Witnesses;

/// Sixteen boxes that differ only in the axis in lanes.
#[derive(Debug, Clone, Copy)]
struct Boxes {
    level: usize,
    others: [usize; 2],
    /// Index of sixteen boxes of the axis in lanes, which start at box `16 · group`.
    group: usize,
    /// Groups of the largest balls that may touch, one bit each.
    probes: u32,
}

/// Largest level of the boxes that a strip begins with: a strip, which one core works on, has at most 2³ values of an axis.
const STRIP_LEVEL: usize = 3;

/// Fills the map of one obstacle, on all cores.
pub(super) fn fill(obstacle: &ObstacleLanes<'_>, classes: &[CoverClass], roles: AxisRoles, first: &Step) -> CellBits {
    let mut bits = CellBits::new(roles);
    for (number, class) in classes.iter().enumerate() {
        let top = class.levels.len() - 1;
        let divide = |places: &mut PlaceMemo, rows: CellRows<'_>, level: usize, blocks: Range<usize>| {
            let mut division = BoxDivision::new(obstacle, classes, roles, first, rows);
            std::mem::swap(&mut division.places, places);
            division.run(number, level, blocks);
            std::mem::swap(&mut division.places, places);
        };
        if class.uses[0] {
            let level = top.min(STRIP_LEVEL);
            let strips = bits.strips(1 << level).enumerate();
            strips.for_each_init(PlaceMemo::default, |places, (strip, rows)| {
                divide(places, rows, level, strip..strip + 1);
            });
        } else {
            divide(&mut PlaceMemo::default(), bits.all(), top, 0..1);
        }
    }
    bits
}

/// Divides the boxes of some rows of the map of one obstacle.
pub(super) struct BoxDivision<'a> {
    obstacle: &'a ObstacleLanes<'a>,
    classes: &'a [CoverClass],
    roles: AxisRoles,
    /// The joint of the axis in lanes.
    first: &'a Step,
    simd_level: SimdLevel,
    /// Undecided groups, box by box.
    pairs: Vec<NearGroup>,
    /// Groups left undecided by the tests.
    left: Vec<NearGroup>,
    open: Vec<NearGroup>,
    places: PlaceMemo,
    witnesses: Vec<Witnesses>,
    bits: CellRows<'a>,
}

impl<'a> BoxDivision<'a> {
    pub fn new(
        obstacle: &'a ObstacleLanes<'a>,
        classes: &'a [CoverClass],
        roles: AxisRoles,
        first: &'a Step,
        bits: CellRows<'a>,
    ) -> Self {
        Self {
            obstacle,
            classes,
            roles,
            first,
            simd_level: detected_simd_level(),
            pairs: Vec::new(),
            left: Vec::new(),
            open: Vec::new(),
            places: PlaceMemo::default(),
            witnesses: Vec::new(),
            bits,
        }
    }

    /// Divides the boxes of a level with these indices on the first of the two other axes.
    fn run(&mut self, number: usize, level: usize, blocks: Range<usize>) {
        let class = &self.classes[number];
        self.places.start(class);
        self.witnesses = Witnesses::none(class);
        let second = class.levels[level].blocks[1];
        for others in blocks.flat_map(|i| (0..second).map(move |j| [i, j])) {
            for group in 0..self.obstacle.poses[level].len().div_ceil(LANES) {
                self.pairs.clear();
                let pair = |&group: &u32| NearGroup { group, element: 0, boxes: 0xffff, balls: 0xffff };
                self.pairs.extend(class.roots.iter().map(pair));
                self.divide(number, Boxes { level, others, group, probes: !0 }, 0);
            }
        }
    }

    /// Whether a cell, given by its index on each axis, is not proven free.
    pub fn may_touch(&mut self, cell: [usize; 3]) -> bool {
        let (lane, others) = (cell[self.roles.lanes], self.roles.others.map(|axis| cell[axis]));
        (0..self.classes.len()).any(|number| {
            let class = &self.classes[number];
            self.places.start(class);
            self.witnesses = Witnesses::none(class);
            let others = [0, 1].map(|k| if class.uses[k] { others[k] } else { 0 });
            let boxes = 1 << (lane % LANES);
            self.pairs.clear();
            let pair = |&group: &u32| NearGroup { group, element: 0, boxes, balls: 0xffff };
            self.pairs.extend(class.roots.iter().map(pair));
            let known = self.assess(number, Boxes { level: 0, others, group: lane / LANES, probes: !0 }, 0);
            self.left.clear();
            known.contact != 0
        })
    }

    /// Class index and root group index, for all links.
    pub fn roots(&self) -> Vec<(usize, u32)> {
        let of_class =
            |(class, covers): (usize, &CoverClass)| covers.roots.iter().map(move |&root| (class, root)).collect();
        self.classes.iter().enumerate().flat_map(|all| -> Vec<_> { of_class(all) }).collect()
    }

    /// Distance of a group's balls from the centre of the obstacle at the centre of a cell, minus their radii, m.
    pub fn distance_from_centre(&self, class: usize, group: u32, cell: [usize; 3]) -> f32 {
        let covers = &self.classes[class];
        let level = &covers.levels[0];
        let others = [0, 1].map(|k| if covers.uses[k] { cell[self.roles.others[k]] } else { 0 });
        let (balls, frames) = (&covers.groups[group as usize], level.frames(others));
        let pose = &self.obstacle.poses[0][cell[self.roles.lanes]];
        let target = Target { core: SolidCore::Point, centre: self.obstacle.elements[0].centre, reach: 0.0 };
        let half = HalfWidths { lanes: 0.0, lanes_turn: false, others: [0.0; 2] };
        let simd_level = self.simd_level;
        let gaps = dispatch!(simd_level, simd => {
            let mut place = GroupPlace::ZERO;
            place.compute(simd, balls, &covers.paths[balls.path as usize], frames, half);
            gaps(simd, balls, &place, pose, &target).to_array()
        });
        gaps[..balls.lanes.count_ones() as usize].iter().copied().fold(f32::INFINITY, f32::min)
    }

    /// Divides boxes; the undecided pairs are those from `from` on.
    fn divide(&mut self, class: usize, boxes: Boxes, from: usize) {
        let left = self.left.len();
        let known = self.assess(class, boxes, from);
        let boxes = Boxes { probes: known.probes, ..boxes };
        if known.contact != 0 {
            self.block(class, boxes, known.contact);
        }
        let open = known.near & !known.contact;
        if open != 0 && boxes.level > 0 {
            self.divide_parts(class, boxes, open, left);
        }
        self.left.truncate(left);
    }

    /// Halves the open boxes along each axis.
    fn divide_parts(&mut self, class: usize, boxes: Boxes, open: u32, left: usize) {
        let level = boxes.level - 1;
        let uses = self.classes[class].uses;
        let blocks = self.classes[class].levels[level].blocks;
        // Boxes that differ only in the axis in lanes follow each other, because the links are at the same places in
        // them.
        for i in 0..=usize::from(uses[0]) {
            for j in 0..=usize::from(uses[1]) {
                let at = [[boxes.others[0], i], [boxes.others[1], j]];
                let others = [0, 1].map(|k| if uses[k] { 2 * at[k][0] + at[k][1] } else { 0 });
                if others[0] < blocks[0] && others[1] < blocks[1] {
                    for half in 0..2 {
                        self.divide_half(class, Boxes { level, others, ..boxes }, half, open, left);
                    }
                }
            }
        }
    }

    /// Divides one half of the boxes of the axis in lanes: each box becomes two lanes, so that eight boxes fill sixteen
    /// lanes.
    fn divide_half(&mut self, class: usize, boxes: Boxes, half: usize, open: u32, left: usize) {
        let part = |lanes: u32| doubled(lanes >> (8 * half) & 0xff);
        let group = 2 * boxes.group + half;
        if part(open) == 0 || group * LANES >= self.obstacle.poses[boxes.level].len() {
            return;
        }
        let from = self.pairs.len();
        for at in left..self.left.len() {
            let pair = self.left[at];
            let lanes = part(pair.boxes & open);
            if lanes != 0 {
                self.pairs.push(NearGroup { boxes: lanes, ..pair });
            }
        }
        self.divide(class, Boxes { group, ..boxes }, from);
        self.pairs.truncate(from);
    }

    /// Blocks boxes.
    fn block(&mut self, class: usize, boxes: Boxes, lanes: u32) {
        let uses = self.classes[class].uses;
        if boxes.level == 0 && uses == [true, true] {
            self.bits.set_sixteen(boxes.others, boxes.group, lanes);
            return;
        }
        let size = 1usize << boxes.level;
        let range = |at: usize| [at * size, (at + 1) * size];
        let others = [0, 1].map(|k| if uses[k] { range(boxes.others[k]) } else { [0, usize::MAX] });
        let mut rest = lanes;
        while rest != 0 {
            let first = rest.trailing_zeros();
            let run = (!(rest >> first)).trailing_zeros();
            rest &= !(((1u32 << run) - 1) << first);
            let begin = (boxes.group * LANES + first as usize) * size;
            self.bits.set(&CellBox { lanes: [begin, begin + run as usize * size], others });
        }
    }

    fn assess(&mut self, class: usize, boxes: Boxes, from: usize) -> Known {
        let count = self.roles.lane_count().div_ceil(1 << boxes.level) - LANES * boxes.group;
        let mut live = if count >= LANES { 0xffff } else { (1 << count) - 1 };
        live &= self.pairs[from..].iter().fold(0, |all, pair| all | pair.boxes);
        let covers = &self.classes[class];
        // Cells blocked by links of fewer axes need no test; they were set before. A cell of a class that does not use
        // the first axis represents all its values, and other classes may have blocked only some of them.
        if boxes.level == 0 && covers.uses != [false, true] {
            live &= !self.bits.sixteen(boxes.others, boxes.group);
        }
        let half = &covers.levels[boxes.level].half;
        let half = HalfWidths {
            lanes: (half[self.roles.lanes] * self.first.multiplier) as f32 * (1.0 + 1e-6),
            lanes_turn: self.first.turns,
            others: self.roles.others.map(|axis| half[axis] as f32 * (1.0 + 1e-6)),
        };
        let Boxes { level, others, group, probes } = boxes;
        let mut test = BoxTest {
            obstacle: self.obstacle,
            class: covers,
            level,
            frames: covers.levels[level].frames(others),
            poses: &self.obstacle.poses[level][LANES * group..],
            half,
            live,
            probes,
            near: 0,
            contact: 0,
        };
        self.places.enter(level, others);
        let (pairs, left, open) = (&self.pairs[from..], &mut self.left, &mut self.open);
        let (places, witnesses) = (&mut self.places, &mut self.witnesses);
        let simd_level = self.simd_level;
        dispatch!(simd_level, simd => test.run(simd, pairs, places, witnesses, open, left));
        Known { near: test.near, contact: test.contact, probes: test.probes }
    }
}

/// Results for sixteen boxes.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// Boxes in which any ball is near.
    near: u32,
    contact: u32,
    /// Groups of the largest balls that may still touch.
    probes: u32,
}

/// Doubles each of eight bits.
fn doubled(bits: u32) -> u32 {
    let spread = (bits | bits << 4) & 0x0f0f;
    let spread = (spread | spread << 2) & 0x3333;
    let spread = (spread | spread << 1) & 0x5555;
    spread | spread << 1
}
