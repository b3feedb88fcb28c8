//! One slice, copied over the first joint: the fastest model of the joint-space paper (section III), for any robot.
//!
//! The obstacle is enclosed in a sector of a ring about the first joint's axis. The ring looks the same from all values
//! of that joint, so the cells of the two other joints that touch it are computed once, without the first joint. The
//! links that touch the ring there cover a range of angles; the first joint's cells that turn this range into the
//! sector are blocked. The range of angles is computed for boxes of few cells, the contact for single cells.

use std::cmp::Ordering;
use std::f64::consts::{PI, TAU};

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;
use elbowroom_validity::lanes::simd::{Level as SimdLevel, Simd, dispatch};
use elbowroom_validity::lanes::{Row, detected_simd_level};

use super::super::sector_bounds::SectorBounds;
use super::axis_roles::AxisRoles;
use super::ball_tree::LEAF;
use super::block_level::Frame;
use super::cell_bits::CellBits;
use super::cover_class::{CoverClass, GroupMotion};
use super::kernel::{GroupPlace, HalfWidths};
use super::slice_kernel::{CoveredAngles, RingContact, RingSection, covered_angles, ring_contact};
use super::step_chain::Step;
use crate::bits::{ones, set_range};
use crate::{ConvexObstacle, GridAxis};

/// Level of the boxes whose angles are computed: four cells along every axis.
const ANGLE_LEVEL: usize = 2;
/// Ratio of a ball's radius to its motion in a box above which the ball is replaced by the balls inside it.
const EXPANSION_SHARE: f32 = 3.0;
/// Like `ROUNDING_SHARE` of obstacles in lanes.
const ROUNDING_SHARE: f64 = 5e-6;

/// Bounds of motions without the first joint, per class, level and group.
pub(super) type SliceMotions = Vec<Vec<Vec<GroupMotion>>>;

/// A sector of a ring, relative to the first joint at 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingSector {
    section: RingSection,
    /// First angle and width, rad.
    first: f64,
    width: f64,
}

impl RingSector {
    /// Computes a sector around a solid in the world; `None` if the solid is unbounded or too far away. `reach_m`
    /// bounds the robot's coordinates.
    pub fn new(shape: &Shape, in_world: &Pose, joint: &Step, reach_m: f64) -> Option<Self> {
        let bounds = SectorBounds::new(shape, &(joint.at_zero.inverse() * *in_world))?;
        let SectorBounds { first, width, near, far, low, high } = bounds;
        if !(far.max(low.abs()).max(high.abs()) <= ConvexObstacle::MAX_COORDINATE_M) {
            return None;
        }
        let rounding = ROUNDING_SHARE * (1.0 + 2.0 * reach_m + far + low.abs().max(high.abs()));
        let [near, far, low, high] = [near, far, low, high].map(|v| v as f32);
        Some(Self { section: RingSection { near, far, low, high, rounding: rounding as f32 }, first, width })
    }
}

/// Balls of a group that may touch the ring.
#[derive(Debug, Clone, Copy)]
struct NearBalls {
    group: u32,
    balls: u32,
}

/// A box of cells of the two other joints.
#[derive(Debug, Clone, Copy)]
struct SliceBox {
    level: usize,
    others: [usize; 2],
}

/// Angles that links cover, in front of the axis and behind it; low above high means an empty range.
type AngleRanges = [[f32; 2]; 2];
const NO_ANGLES: AngleRanges = [[f32::INFINITY, f32::NEG_INFINITY]; 2];

/// Fills the map of one sector.
pub(super) struct SliceDivision<'a> {
    sector: RingSector,
    classes: &'a [CoverClass],
    motions: &'a [Vec<Vec<GroupMotion>>],
    roles: AxisRoles,
    first: &'a Step,
    axis: &'a GridAxis,
    simd_level: SimdLevel,
    /// Undecided balls, box by box.
    open: Vec<NearBalls>,
    work: Vec<NearBalls>,
    /// Cells of the first joint that touch in the current box.
    lanes: Vec<u64>,
    pub bits: CellBits,
}

impl<'a> SliceDivision<'a> {
    pub fn new(
        sector: RingSector,
        classes: &'a [CoverClass],
        motions: &'a SliceMotions,
        roles: AxisRoles,
        first: &'a Step,
        axis: &'a GridAxis,
    ) -> Self {
        Self {
            sector,
            classes,
            motions,
            roles,
            first,
            axis,
            simd_level: detected_simd_level(),
            open: Vec::new(),
            work: Vec::new(),
            lanes: vec![0; roles.lane_count().div_ceil(64)],
            bits: CellBits::new(roles),
        }
    }

    /// Fills the map, class by class.
    pub fn run(&mut self) {
        for number in 0..self.classes.len() {
            let class = &self.classes[number];
            let level = class.levels.len() - 1;
            let blocks = class.levels[level].blocks;
            for others in (0..blocks[0]).flat_map(|i| (0..blocks[1]).map(move |j| [i, j])) {
                self.open.clear();
                self.open.extend(class.roots.iter().map(|&group| NearBalls { group, balls: 0xffff }));
                self.divide(number, SliceBox { level, others }, 0, !0);
            }
        }
    }

    /// Divides a box; the undecided balls are those from `from` on, and the groups of the largest balls are in
    /// `probes`.
    fn divide(&mut self, class: usize, at: SliceBox, from: usize, probes: u32) {
        let end = self.open.len();
        let angle_level = ANGLE_LEVEL.min(self.classes[class].levels.len() - 1);
        let wants = match at.level.cmp(&angle_level) {
            Ordering::Greater => Wants::Division,
            Ordering::Equal => Wants::Angles,
            Ordering::Less => Wants::Contact,
        };
        let found = self.assess(class, at, from, probes, wants);
        if found.is_near && at.level == angle_level {
            self.find_lanes(&found.angles);
        }
        let reaches = at.level > angle_level || self.lanes.iter().any(|&word| word != 0);
        if found.is_near && reaches {
            if found.is_blocked && at.level <= angle_level {
                self.block(class, at);
            } else if at.level > 0 {
                self.divide_parts(class, at, end, found.probes);
            }
        }
        self.open.truncate(end);
    }

    /// Halves a box along both axes.
    fn divide_parts(&mut self, class: usize, at: SliceBox, from: usize, probes: u32) {
        let level = at.level - 1;
        let CoverClass { uses, ref levels, .. } = self.classes[class];
        let blocks = levels[level].blocks;
        for i in 0..=usize::from(uses[0]) {
            for j in 0..=usize::from(uses[1]) {
                let parts = [[at.others[0], i], [at.others[1], j]];
                let others = [0, 1].map(|k| if uses[k] { 2 * parts[k][0] + parts[k][1] } else { 0 });
                if others[0] < blocks[0] && others[1] < blocks[1] {
                    self.divide(class, SliceBox { level, others }, from, probes);
                }
            }
        }
    }

    /// Blocks the cells of the first joint in a box of the other joints.
    fn block(&mut self, class: usize, at: SliceBox) {
        let (uses, size) = (self.classes[class].uses, 1usize << at.level);
        let range = |k: usize| [at.others[k] * size, (at.others[k] + 1) * size];
        let others = [0, 1].map(|k| if uses[k] { range(k) } else { [0, usize::MAX] });
        self.bits.add_lanes(&self.lanes, others);
    }

    /// Tests the undecided balls; adds the remaining ones to `open`.
    fn assess(&mut self, class: usize, at: SliceBox, from: usize, probes: u32, wants: Wants) -> SliceState {
        let covers = &self.classes[class];
        let level = &covers.levels[at.level];
        let motions = &self.motions[class];
        let half = HalfWidths {
            lanes: 0.0,
            lanes_turn: false,
            others: self.roles.others.map(|axis| level.half[axis] as f32 * (1.0 + 1e-6)),
        };
        let test = SliceTest {
            ring: &self.sector.section,
            class: covers,
            frames: level.frames(at.others),
            motions: &motions[at.level],
            // As in maps of three joints: the centre of a box of two cells along every axis is a corner of each cell,
            // and a contact that lasts from the centre of a box of four cells to the centres of its halves blocks the
            // whole box.
            stays: match at.level {
                0 => None,
                1 => Some(Stays::Nowhere),
                2 => Some(Stays::Within(&motions[1])),
                level => Some(Stays::Within(&motions[level])),
            },
            half,
            wants,
            is_cell: at.level == 0,
        };
        let (open, work) = (&mut self.open, &mut self.work);
        let simd_level = self.simd_level;
        dispatch!(simd_level, simd => test.run(simd, from, probes, open, work))
    }

    /// Finds the first joint's cells that turn some angles into the sector.
    fn find_lanes(&mut self, angles: &AngleRanges) {
        self.lanes.fill(0);
        for ([low, high], side) in angles.iter().zip([0.0, PI]) {
            if low > high {
                continue;
            }
            let lowest = self.sector.first - side - f64::from(*high);
            let highest = self.sector.first + self.sector.width - side - f64::from(*low);
            self.add_lanes(lowest, highest);
        }
    }

    /// Adds the cells that contain an angle of the first joint in a range, in any turn.
    fn add_lanes(&mut self, lowest: f64, highest: f64) {
        let last = self.roles.lane_count() as u16 - 1;
        if highest - lowest >= TAU {
            set_range(&mut self.lanes, 0, last);
            return;
        }
        let by = 1.0 / self.first.multiplier;
        let [low, high] = [(lowest * by).min(highest * by), (lowest * by).max(highest * by)];
        let period = TAU * by.abs();
        let ends = [self.axis.border(0), self.axis.border(self.axis.count())];
        let turns = [((ends[0] - high) / period).floor() as i64, ((ends[1] - low) / period).ceil() as i64];
        for turn in turns[0]..=turns[1] {
            let shift = turn as f64 * period;
            if let Some((from, to)) = self.axis.cells_touching(low + shift, high + shift)
                && from <= usize::from(last)
            {
                set_range(&mut self.lanes, from as u16, last.min(to as u16));
            }
        }
    }
}

/// The motion during which a contact must last.
#[derive(Clone, Copy)]
enum Stays<'a> {
    Nowhere,
    Within(&'a [GroupMotion]),
}

/// The purpose of a test of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Wants {
    /// Find the undecided balls in the parts of the box.
    Division,
    /// Find the angles of all undecided balls, and these balls.
    Angles,
    /// Find out whether the box is blocked, and if not, the undecided balls.
    Contact,
}

/// Results for a box.
struct SliceState {
    is_near: bool,
    is_blocked: bool,
    angles: AngleRanges,
    /// Groups of the largest balls that may touch in parts of the box.
    probes: u32,
}

/// The test of one box.
struct SliceTest<'a> {
    ring: &'a RingSection,
    class: &'a CoverClass,
    frames: &'a [Frame],
    motions: &'a [GroupMotion],
    stays: Option<Stays<'a>>,
    half: HalfWidths,
    wants: Wants,
    is_cell: bool,
}

#[allow(clippy::inline_always, reason = "parts of a kernel")]
impl SliceTest<'_> {
    #[inline(always)]
    fn run<S: Simd>(
        &self,
        simd: S,
        from: usize,
        probes: u32,
        open: &mut Vec<NearBalls>,
        work: &mut Vec<NearBalls>,
    ) -> SliceState {
        let mut state = SliceState { is_near: false, is_blocked: false, angles: NO_ANGLES, probes };
        if !self.is_cell {
            self.probe(simd, &mut state);
            if state.is_blocked && self.wants == Wants::Contact {
                return state;
            }
        }
        let end = open.len();
        for number in from..end {
            work.push(open[number]);
            while let Some(next) = work.pop() {
                let kept = self.test(simd, next, &mut state, work);
                if state.is_blocked && self.wants == Wants::Contact {
                    work.clear();
                    open.truncate(end);
                    return state;
                }
                if kept != 0 {
                    open.push(NearBalls { group: next.group, balls: kept });
                }
            }
        }
        state
    }

    /// Tests the largest balls, which find most contacts and most of the angles.
    #[inline(always)]
    fn probe<S: Simd>(&self, simd: S, state: &mut SliceState) {
        for (number, &group) in self.class.probes.iter().take(32).enumerate() {
            if state.probes >> number & 1 == 0 {
                continue;
            }
            let (place, found) = self.contact(simd, group);
            if found.near == 0 {
                state.probes &= !(1 << number);
                continue;
            }
            state.is_near = true;
            state.is_blocked |= found.contact != 0;
            if self.wants == Wants::Angles {
                let angles = self.angles(simd, group, &place);
                ones(found.near.into()).for_each(|ball| state.add(&angles, ball));
            }
        }
    }

    /// Tests balls of a group; adds the balls below to `work` and returns the balls to keep.
    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, next: NearBalls, state: &mut SliceState, work: &mut Vec<NearBalls>) -> u32 {
        let group = &self.class.groups[next.group as usize];
        let (place, found) = self.contact(simd, next.group);
        let near = found.near & next.balls;
        if near == 0 {
            return 0;
        }
        state.is_near |= self.wants != Wants::Contact || !self.is_cell;
        state.is_blocked |= found.contact & near & group.leaves != 0;
        if self.is_cell && near & group.leaves != 0 {
            (state.is_near, state.is_blocked) = (true, true);
        }
        let angles = (self.wants == Wants::Angles).then(|| self.angles(simd, next.group, &place));
        let mut kept = 0;
        for ball in ones(near.into()) {
            let is_leaf = group.below[ball] == LEAF;
            let is_large = group.radii.0[ball] > EXPANSION_SHARE * self.motions[next.group as usize].paths.0[ball];
            let is_known = angles.as_ref().is_some_and(|angles| state.covers(angles, ball));
            let expands = match self.wants {
                Wants::Angles => !is_known,
                Wants::Division | Wants::Contact => is_large || self.is_cell,
            };
            if !is_leaf && expands {
                work.push(NearBalls { group: group.below[ball], balls: 0xffff });
                continue;
            }
            kept |= 1 << ball;
            if let Some(angles) = &angles {
                state.add(angles, ball);
            }
        }
        kept
    }

    #[inline(always)]
    fn contact<S: Simd>(&self, simd: S, number: u32) -> (GroupPlace, RingContact) {
        let group = &self.class.groups[number as usize];
        let mut place = GroupPlace::ZERO;
        place.compute(simd, group, &self.class.paths[group.path as usize], self.frames, self.half);
        let stays = match self.stays {
            None => None,
            Some(Stays::Nowhere) => Some(&Row::ZERO),
            Some(Stays::Within(motions)) => Some(&motions[number as usize].paths),
        };
        let found = ring_contact(simd, group, &place, &self.motions[number as usize], stays, self.ring);
        (place, found)
    }

    #[inline(always)]
    fn angles<S: Simd>(&self, simd: S, number: u32, place: &GroupPlace) -> CoveredAngles {
        let number = number as usize;
        covered_angles(simd, &self.class.groups[number], place, &self.motions[number], self.ring)
    }
}

impl SliceState {
    fn covers(&self, angles: &CoveredAngles, ball: usize) -> bool {
        let [low, high] = self.angles[(angles.behind >> ball & 1) as usize];
        angles.low[ball] >= low && angles.high[ball] <= high
    }

    fn add(&mut self, angles: &CoveredAngles, ball: usize) {
        let [low, high] = &mut self.angles[(angles.behind >> ball & 1) as usize];
        (*low, *high) = (low.min(angles.low[ball]), high.max(angles.high[ball]));
    }
}
