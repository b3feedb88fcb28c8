//! Boxes of joint space, halved until each is free or blocked.

use elbowroom_validity::lanes::{LANES, detected_simd_level};
use fearless_simd::{Level as SimdLevel, Simd, dispatch};

use super::axis_roles::AxisRoles;
use super::cell_bits::{CellBits, CellBox};
use super::cover_class::{CoverClass, CoverNode};
use super::kernel::{HalfWidths, NodePlace, Target, assess};
use super::obstacle::Element;
use super::obstacle_lanes::{ContactCore, ObstacleLanes};
use super::step_chain::Step;

/// A node is replaced by those below where its radius is larger than this share of its motion in a box.
const EXPANSION_SHARE: f32 = 1.5;

/// A node of a cover and an element of the obstacle that may touch in some of sixteen boxes.
#[derive(Debug, Clone, Copy)]
struct NearPair {
    node: u32,
    element: u32,
    lanes: u32,
}

/// Sixteen boxes that differ in the axis in lanes alone.
#[derive(Debug, Clone, Copy)]
struct Boxes {
    level: usize,
    others: [usize; 2],
    /// Boxes of the axis in lanes from `16 · group` on.
    group: usize,
}

/// Cells that are not proven free, nor blocked.
#[derive(Debug, Clone, Copy)]
pub(super) struct OpenCells {
    /// Number of the class of covers.
    pub class: usize,
    pub others: [usize; 2],
    pub group: usize,
    pub lanes: u32,
}

/// Fills the map of one obstacle.
pub(super) struct Filler<'a> {
    obstacle: &'a ObstacleLanes<'a>,
    classes: &'a [CoverClass],
    roles: AxisRoles,
    /// The joint of the axis in lanes.
    first: &'a Step,
    simd_level: SimdLevel,
    /// Pairs in question, box by box.
    pairs: Vec<NearPair>,
    /// Those that are left.
    left: Vec<NearPair>,
    open: Vec<NearPair>,
    pub bits: CellBits,
    pub uncertain: Vec<OpenCells>,
}

/// What is known of sixteen boxes.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// Not yet known to be in contact.
    live: u32,
    /// Where any pair is near.
    near: u32,
    contact: u32,
}

impl<'a> Filler<'a> {
    pub fn new(obstacle: &'a ObstacleLanes<'a>, classes: &'a [CoverClass], roles: AxisRoles, first: &'a Step) -> Self {
        Self {
            obstacle,
            classes,
            roles,
            first,
            simd_level: detected_simd_level(),
            pairs: Vec::new(),
            left: Vec::new(),
            open: Vec::new(),
            bits: CellBits::new(roles),
            uncertain: Vec::new(),
        }
    }

    /// Fills the map, class by class.
    pub fn fill(&mut self) {
        for (number, class) in self.classes.iter().enumerate() {
            let level = class.levels.len() - 1;
            let blocks = class.levels[level].blocks;
            for others in (0..blocks[0]).flat_map(|i| (0..blocks[1]).map(move |j| [i, j])) {
                for group in 0..self.obstacle.poses[level].len() {
                    self.pairs.clear();
                    let pair = |&node: &u32| NearPair { node, element: 0, lanes: 0xffff };
                    self.pairs.extend(class.roots.iter().map(pair));
                    self.divide(number, Boxes { level, others, group }, 0);
                }
            }
        }
    }

    /// Divides boxes; the pairs in question are those from `from` on.
    fn divide(&mut self, class: usize, boxes: Boxes, from: usize) {
        let left = self.left.len();
        let known = self.assess(class, boxes, from);
        if known.contact != 0 {
            self.block(class, boxes, known.contact);
        }
        let open = known.near & !known.contact;
        if open != 0 {
            if boxes.level == 0 {
                let Boxes { others, group, .. } = boxes;
                self.uncertain.push(OpenCells { class, others, group, lanes: open });
            } else {
                self.divide_parts(class, boxes, open, left);
            }
        }
        self.left.truncate(left);
    }

    /// Halves the boxes that are open along each axis.
    fn divide_parts(&mut self, class: usize, boxes: Boxes, open: u32, left: usize) {
        let level = boxes.level - 1;
        let uses = self.classes[class].uses;
        let blocks = self.classes[class].levels[level].blocks;
        for half in 0..2 {
            // Each box becomes two lanes; the first eight boxes fill the first sixteen.
            let part = |lanes: u32| doubled(lanes >> (8 * half) & 0xff);
            let group = 2 * boxes.group + half as usize;
            if part(open) == 0 || group >= self.obstacle.poses[level].len() {
                continue;
            }
            let from = self.pairs.len();
            for at in left..self.left.len() {
                let pair = self.left[at];
                let lanes = part(pair.lanes & open);
                if lanes != 0 {
                    self.pairs.push(NearPair { lanes, ..pair });
                }
            }
            for i in 0..=usize::from(uses[0]) {
                for j in 0..=usize::from(uses[1]) {
                    let at = [[boxes.others[0], i], [boxes.others[1], j]];
                    let others = [0, 1].map(|k| if uses[k] { 2 * at[k][0] + at[k][1] } else { 0 });
                    if others[0] < blocks[0] && others[1] < blocks[1] {
                        self.divide(class, Boxes { level, others, group }, from);
                    }
                }
            }
            self.pairs.truncate(from);
        }
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
        let covers = &self.classes[class];
        if boxes.level == 0 {
            // What links of fewer axes block needs no test; these were filled before.
            live &= !self.bits.sixteen(boxes.others, boxes.group);
        }
        let half = &covers.levels[boxes.level].half;
        let task = BoxTask {
            obstacle: self.obstacle,
            class: covers,
            boxes,
            half: HalfWidths {
                lanes: (half[self.roles.lanes] * self.first.multiplier) as f32 * (1.0 + 1e-6),
                lanes_turn: self.first.turns,
                others: self.roles.others.map(|axis| half[axis] as f32 * (1.0 + 1e-6)),
            },
        };
        let mut known = Known { live, near: 0, contact: 0 };
        let (pairs, left, open) = (&self.pairs[from..], &mut self.left, &mut self.open);
        let simd_level = self.simd_level;
        dispatch!(simd_level, simd => task.assess(simd, pairs, &mut known, open, left));
        known
    }
}

/// A test of sixteen boxes.
struct BoxTask<'a> {
    obstacle: &'a ObstacleLanes<'a>,
    class: &'a CoverClass,
    boxes: Boxes,
    half: HalfWidths,
}

impl BoxTask<'_> {
    /// Tests pairs; adds those that are left to `left`.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    fn assess<S: Simd>(
        &self,
        simd: S,
        pairs: &[NearPair],
        known: &mut Known,
        open: &mut Vec<NearPair>,
        left: &mut Vec<NearPair>,
    ) {
        let (class, level) = (self.class, self.boxes.level);
        let are_cells = level == 0;
        let frames = class.levels[level].frames(self.boxes.others);
        let motions = &class.motions[level];
        let poses = &self.obstacle.poses[level][self.boxes.group];
        let rounding = self.obstacle.rounding;
        for &first in pairs {
            open.clear();
            open.push(first);
            while let Some(pair) = open.pop() {
                let live = pair.lanes & known.live;
                if live == 0 {
                    continue;
                }
                let node = &class.nodes[pair.node as usize];
                let element = &self.obstacle.elements[pair.element as usize];
                let motion = motions[pair.node as usize];
                let place = NodePlace::new(node, &class.paths[node.path as usize], frames, self.half);
                let is_leaf = node.is_leaf && element.is_leaf;
                let contact = self.obstacle.contacts[pair.element as usize].filter(|_| node.is_leaf && self.proves_contact());
                let contact = contact.map(|c| ContactCore { radius: node.radius + c.radius - rounding, ..c });
                let reach = node.radius + element.radius + rounding;
                let target = Target { poses, core: element.core, centre: element.centre, reach, contact };
                let found = assess(simd, &place, &target, motion, are_cells, live);
                known.contact |= found.contact;
                known.live &= !found.contact;
                let near = found.near & !found.contact;
                if near == 0 {
                    continue;
                }
                if !is_leaf && (are_cells || expands(node, element, motion.path)) {
                    expand(NearPair { lanes: near, ..pair }, class, self.obstacle.elements, open);
                } else if are_cells && !self.obstacle.is_exact {
                    known.contact |= near;
                    known.live &= !near;
                } else {
                    known.near |= near;
                    if !are_cells {
                        left.push(NearPair { lanes: near, ..pair });
                    }
                }
            }
            if known.live == 0 {
                break;
            }
        }
    }

    /// True where a contact that is found spares anything.
    fn proves_contact(&self) -> bool {
        self.boxes.level > 0 || self.obstacle.is_exact
    }
}

/// True where a pair is to be replaced by those below it.
fn expands(node: &CoverNode, element: &Element, path_m: f32) -> bool {
    let radius = match (node.is_leaf, element.is_leaf) {
        (false, true) => node.radius,
        (true, false) => element.radius,
        _ => node.radius.max(element.radius),
    };
    radius > EXPANSION_SHARE * path_m
}

/// Adds the pairs below: of the larger one of both.
fn expand(pair: NearPair, class: &CoverClass, elements: &[Element], open: &mut Vec<NearPair>) {
    let (node, element) = (&class.nodes[pair.node as usize], &elements[pair.element as usize]);
    if element.is_leaf || (!node.is_leaf && node.radius >= element.radius) {
        let mut child = pair.node + 1;
        while child < node.end {
            open.push(NearPair { node: child, ..pair });
            child = class.nodes[child as usize].end;
        }
    } else {
        let mut child = pair.element + 1;
        while child < element.end {
            open.push(NearPair { element: child, ..pair });
            child = elements[child as usize].end;
        }
    }
}

/// Each of eight bits twice.
fn doubled(bits: u32) -> u32 {
    let spread = (bits | bits << 4) & 0x0f0f;
    let spread = (spread | spread << 2) & 0x3333;
    let spread = (spread | spread << 1) & 0x5555;
    spread | spread << 1
}
