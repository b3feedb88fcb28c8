//! The covers of the links that the same axes move.

use elbowroom_spatial::Vec3;
use elbowroom_validity::lanes::{LANES, PointRow, Row};
use elbowroom_validity::{Ball, SphereCover};

use super::super::rigid_groups::RigidGroup;
use super::axis_roles::AxisRoles;
use super::ball_tree::{LEAF, ball_tree};
use super::block_level::{BlockLevel, single};
use super::step_chain::StepChain;
use crate::Grid;

/// Largest box, rad or m, unless there are too many boxes.
const WIDEST_BLOCK: f64 = 0.3;
/// Number of boxes above which larger boxes are worthwhile.
const MOST_BLOCKS: usize = 4096;
/// Largest number of halvings.
const MOST_LEVELS: u32 = 8;

/// Balls around a link that are tested at the same time: each ball is a leaf of the link's cover, or encloses the balls
/// of another group.
#[derive(Debug, Clone)]
pub(super) struct CoverGroup {
    /// Centres in the frame of the last step of its path, m.
    pub centres: PointRow,
    /// Radii, m.
    pub radii: Row,
    /// Per ball, the index of the group below, or [`LEAF`].
    pub below: [u32; LANES],
    /// Lanes that contain a ball.
    pub lanes: u32,
    /// Lanes that contain a leaf.
    pub leaves: u32,
    pub largest: f32,
    /// Index of the group's path.
    pub path: u32,
}

/// A step in a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathStep {
    pub step: u32,
    /// The one of the two other axes that moves the step.
    pub axis: usize,
    pub multiplier: f32,
    pub turns: bool,
}

/// The steps that move a link, without the first step.
#[derive(Debug, Clone, Default)]
pub(super) struct CoverPath {
    /// The last step.
    pub last: u32,
    pub steps: Vec<PathStep>,
}

/// Bounds of the motion of a group's balls within a box, m.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroupMotion {
    /// Length of the path of a centre, m.
    pub paths: Row,
    /// Distance of a centre from the point to which its velocity leads, m.
    pub curvatures: Row,
}

/// Covers of links that the axis in lanes and the same other axes move.
#[derive(Debug, Clone)]
pub(super) struct CoverClass {
    /// For each of the two other axes, whether it moves the links.
    pub uses: [bool; 2],
    pub groups: Vec<CoverGroup>,
    /// Root groups, one per group of links.
    pub roots: Vec<u32>,
    /// Groups of the largest balls, which find boxes that are in contact throughout.
    pub probes: Vec<u32>,
    pub paths: Vec<CoverPath>,
    /// Levels of boxes; the first level is single cells.
    pub levels: Vec<BlockLevel>,
    /// Motions per level and group of balls.
    pub motions: Vec<Vec<GroupMotion>>,
    /// Largest lever arm, m.
    pub reach_m: f64,
}

/// A group of links with its cover and its path of steps.
#[derive(Debug)]
pub(super) struct CoveredGroup<'a> {
    pub group: &'a RigidGroup,
    pub cover: SphereCover,
    pub path: Vec<usize>,
}

/// The classes of some groups; classes that few axes move are first.
pub(super) fn classes(
    groups: &[CoveredGroup<'_>],
    steps: &StepChain,
    grid: &Grid,
    roles: &AxisRoles,
) -> Vec<CoverClass> {
    let uses = |group: &CoveredGroup<'_>| roles.others.map(|axis| group.group.joints.iter().any(|j| j.axis == axis));
    let kinds = [[false, false], [true, false], [false, true], [true, true]];
    let of_kind = |kind: [bool; 2]| {
        let here: Vec<_> = groups.iter().filter(|g| !g.cover.outer.is_empty() && uses(g) == kind).collect();
        (!here.is_empty()).then(|| CoverClass::new(kind, &here, steps, grid, roles))
    };
    kinds.into_iter().filter_map(of_kind).collect()
}

impl CoverClass {
    fn new(uses: [bool; 2], groups: &[&CoveredGroup<'_>], steps: &StepChain, grid: &Grid, roles: &AxisRoles) -> Self {
        let mut class = Self {
            uses,
            groups: Vec::new(),
            roots: Vec::new(),
            probes: Vec::new(),
            paths: Vec::new(),
            levels: Vec::new(),
            motions: Vec::new(),
            reach_m: 0.0,
        };
        for group in groups {
            class.add_group(group, steps, roles);
        }
        let paths: Vec<&[usize]> = groups.iter().map(|group| group.path.as_slice()).collect();
        for level in 0..=class.top_level(grid, roles) {
            let level = BlockLevel::new(level, grid, roles, uses, steps);
            class.add_motions(steps, &paths, &level.half);
            class.levels.push(level);
        }
        class
    }

    fn add_group(&mut self, group: &CoveredGroup<'_>, steps: &StepChain, roles: &AxisRoles) {
        let Some(&last) = group.path.last() else { return };
        let in_frame = steps.child_in_frame(last);
        let first = self.groups.len() as u32;
        let path = self.paths.len() as u32;
        self.roots.push(first);
        let below = |at: u32| if at == LEAF { LEAF } else { first + at };
        for part in ball_tree(&group.cover.outer) {
            let mut balls = CoverGroup::empty(path);
            for (lane, (ball, &at)) in part.balls.iter().zip(&part.below).enumerate() {
                balls.set(lane, single(in_frame.transform_point(ball.centre)), ball.radius as f32, below(at));
            }
            self.groups.push(balls);
        }
        let mut probes = CoverGroup::empty(path);
        for (lane, ball) in largest(&group.cover.outer).iter().enumerate() {
            probes.set(lane, single(in_frame.transform_point(ball.centre)), ball.radius as f32, LEAF);
        }
        self.probes.push(self.groups.len() as u32);
        self.groups.push(probes);
        let path_step = |&at: &usize| {
            let step = &steps.steps[at];
            let axis = roles.others.iter().position(|&axis| axis == step.axis)?;
            Some(PathStep { step: at as u32, axis, multiplier: step.multiplier as f32, turns: step.turns })
        };
        self.paths.push(CoverPath { last: last as u32, steps: group.path.iter().filter_map(path_step).collect() });
    }

    /// Adds the bounds of the motions in boxes with these half widths.
    fn add_motions(&mut self, steps: &StepChain, paths: &[&[usize]], half: &[f64; 3]) {
        let of_group = |group: &CoverGroup| group.motion(steps, paths[group.path as usize], half);
        let (motions, reaches): (Vec<GroupMotion>, Vec<f64>) = self.groups.iter().map(of_group).unzip();
        self.motions.push(motions);
        self.reach_m = reaches.into_iter().fold(self.reach_m, f64::max);
    }

    /// Bounds of the motions in boxes of each level if the axis in lanes does not move, per level and group.
    pub fn motions_in_slice(&self, steps: &StepChain, roles: &AxisRoles) -> Vec<Vec<GroupMotion>> {
        let path = |path: &CoverPath| path.steps.iter().map(|step| step.step as usize).collect();
        let paths: Vec<Vec<usize>> = self.paths.iter().map(path).collect();
        let of_level = |level: &BlockLevel| {
            let mut half = level.half;
            half[roles.lanes] = 0.0;
            self.groups.iter().map(|group| group.motion(steps, &paths[group.path as usize], &half).0).collect()
        };
        self.levels.iter().map(of_level).collect()
    }

    /// The level of the largest boxes.
    fn top_level(&self, grid: &Grid, roles: &AxisRoles) -> u32 {
        let counts = roles.other_counts();
        let widest = |level: u32| {
            let axes = [0, 1].into_iter().filter(|&k| self.uses[k]).map(|k| roles.others[k]).chain([roles.lanes]);
            axes.map(|axis| grid.axes()[axis].step() * f64::from(1 << level)).fold(0.0, f64::max)
        };
        let blocks = |level: u32| (0..2).filter(|&k| self.uses[k]).map(|k| counts[k] >> level).product::<usize>();
        let is_enough = |level: &u32| widest(level + 1) > WIDEST_BLOCK && blocks(*level) <= MOST_BLOCKS;
        (0..MOST_LEVELS).find(is_enough).unwrap_or(MOST_LEVELS)
    }
}

impl CoverGroup {
    pub fn empty(path: u32) -> Self {
        let (centres, radii) = (PointRow::ZERO, Row::ZERO);
        Self { centres, radii, below: [LEAF; LANES], lanes: 0, leaves: 0, largest: 0.0, path }
    }

    pub fn set(&mut self, lane: usize, centre: [f32; 3], radius: f32, below: u32) {
        for (row, c) in self.centres.0.iter_mut().zip(centre) {
            row.0[lane] = c;
        }
        self.radii.0[lane] = radius;
        self.below[lane] = below;
        self.lanes |= 1 << lane;
        self.leaves |= u32::from(below == LEAF) << lane;
        self.largest = self.largest.max(radius);
    }

    /// Bounds of the motions of the group's balls by the joints of a path in a box with these half widths, and the
    /// largest lever arm, m.
    fn motion(&self, steps: &StepChain, path: &[usize], half: &[f64; 3]) -> (GroupMotion, f64) {
        let mut bounds = GroupMotion { paths: Row::ZERO, curvatures: Row::ZERO };
        let mut reach_m = 0.0;
        for lane in 0..self.lanes.count_ones() as usize {
            let [x, y, z] = self.centre(lane).map(f64::from);
            let levers = steps.lever_arms(path, Vec3::new(x, y, z));
            reach_m = levers.iter().copied().fold(reach_m, f64::max);
            let found = steps.motion(path, &levers, half);
            bounds.paths.0[lane] = (found.path_m as f32).next_up();
            bounds.curvatures.0[lane] = (found.curvature_m as f32).next_up();
        }
        (bounds, reach_m)
    }

    pub fn centre(&self, lane: usize) -> [f32; 3] {
        [0, 1, 2].map(|k| self.centres.0[k].0[lane])
    }
}

/// The largest balls; no ball has its centre in another one.
fn largest(balls: &[Ball]) -> Vec<Ball> {
    let mut sorted = balls.to_vec();
    sorted.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let mut found: Vec<Ball> = Vec::new();
    for ball in sorted {
        if found.len() < LANES && !found.iter().any(|f| f.contains(ball.centre)) {
            found.push(ball);
        }
    }
    found
}
