//! The covers of the links that the same axes move.

use elbowroom_spatial::Vec3;
use elbowroom_validity::{Ball, SphereCover};

use super::super::error::RobotMapError;
use super::super::rigid_groups::RigidGroup;
use super::axis_roles::AxisRoles;
use super::ball_tree::ball_tree;
use super::block_level::{BlockLevel, single};
use super::step_chain::StepChain;
use crate::Grid;

/// Boxes are not larger than this, rad or m, unless there are too many of them.
const WIDEST_BLOCK: f64 = 0.3;
/// More boxes than this make larger ones worth while.
const MOST_BLOCKS: usize = 4096;
/// Most halvings.
const MOST_LEVELS: u32 = 8;

/// A sphere of a link's cover, or a node of its tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct CoverNode {
    /// In the frame of the last step of its path, m.
    pub centre: [f32; 3],
    /// m.
    pub radius: f32,
    /// Number of its path.
    pub path: u32,
    /// Number of the node after all that are below this one.
    pub end: u32,
    pub is_leaf: bool,
}

/// A step in a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathStep {
    pub step: u32,
    /// Which of the two other axes moves it.
    pub axis: usize,
    pub multiplier: f32,
    pub turns: bool,
}

/// The steps that move a link, but for the first.
#[derive(Debug, Clone, Default)]
pub(super) struct CoverPath {
    /// The last step.
    pub last: u32,
    pub steps: Vec<PathStep>,
}

/// Bound of a node's motion within a box, m.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeMotion {
    /// Length of the path of its centre.
    pub path: f32,
    /// Distance of its centre from where its velocity leads.
    pub curvature: f32,
}

/// Covers of links that the axis in lanes and the same others move.
#[derive(Debug, Clone)]
pub(super) struct CoverClass {
    /// Which of the two other axes move the links.
    pub uses: [bool; 2],
    pub nodes: Vec<CoverNode>,
    /// Root nodes, one per group of links.
    pub roots: Vec<u32>,
    pub paths: Vec<CoverPath>,
    /// Cells first.
    pub levels: Vec<BlockLevel>,
    /// Per level and node.
    pub motions: Vec<Vec<NodeMotion>>,
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

/// The cover of a group's solids.
pub(super) fn cover(group: &RigidGroup, slack_m: f64) -> Result<SphereCover, RobotMapError> {
    let solids: Vec<_> = group.solids.iter().map(|(shape, pose)| (shape, *pose)).collect();
    let invalid = || RobotMapError::InvalidPlacement("a link of the robot".into());
    SphereCover::new(&solids, slack_m).ok_or_else(invalid)
}

/// The classes of some groups, those that few axes move first.
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
    fn new(
        uses: [bool; 2],
        groups: &[&CoveredGroup<'_>],
        steps: &StepChain,
        grid: &Grid,
        roles: &AxisRoles,
    ) -> Self {
        let mut class = Self {
            uses,
            nodes: Vec::new(),
            roots: Vec::new(),
            paths: Vec::new(),
            levels: Vec::new(),
            motions: Vec::new(),
            reach_m: 0.0,
        };
        for group in groups {
            class.add_group(group, steps, roles);
        }
        let paths: Vec<&[usize]> = groups.iter().map(|group| group.path.as_slice()).collect();
        let levers = class.levers(steps, &paths);
        class.reach_m = levers.iter().flatten().copied().fold(0.0, f64::max);
        for level in 0..=class.top_level(grid, roles) {
            class.levels.push(BlockLevel::new(level, grid, roles, uses, steps));
        }
        let motions = |level: &BlockLevel| class.motions(steps, &paths, &levers, &level.half);
        class.motions = class.levels.iter().map(motions).collect();
        class
    }

    fn add_group(&mut self, group: &CoveredGroup<'_>, steps: &StepChain, roles: &AxisRoles) {
        let Some(&last) = group.path.last() else { return };
        let in_frame = steps.child_in_frame(last);
        let first = self.nodes.len();
        let path = self.paths.len() as u32;
        self.roots.push(first as u32);
        let node = |ball: Ball, end: usize, is_leaf: bool| {
            let centre = single(in_frame.transform_point(ball.centre));
            CoverNode { centre, radius: ball.radius as f32, path, end: (first + end) as u32, is_leaf }
        };
        self.nodes.extend(ball_tree(&group.cover.outer).iter().map(|n| node(n.ball, n.end, n.is_leaf)));
        let path_step = |&at: &usize| {
            let step = &steps.steps[at];
            let axis = roles.others.iter().position(|&axis| axis == step.axis)?;
            Some(PathStep { step: at as u32, axis, multiplier: step.multiplier as f32, turns: step.turns })
        };
        self.paths.push(CoverPath { last: last as u32, steps: group.path.iter().filter_map(path_step).collect() });
    }

    /// Per node, its lever arms.
    fn levers(&self, steps: &StepChain, paths: &[&[usize]]) -> Vec<Vec<f64>> {
        let levers = |node: &CoverNode| {
            let [x, y, z] = node.centre.map(f64::from);
            steps.lever_arms(paths[node.path as usize], Vec3::new(x, y, z))
        };
        self.nodes.iter().map(levers).collect()
    }

    fn motions(
        &self,
        steps: &StepChain,
        paths: &[&[usize]],
        levers: &[Vec<f64>],
        half: &[f64; 3],
    ) -> Vec<NodeMotion> {
        let motion = |(node, levers): (&CoverNode, &Vec<f64>)| {
            let motion = steps.motion(paths[node.path as usize], levers, half);
            NodeMotion { path: (motion.path_m as f32).next_up(), curvature: (motion.curvature_m as f32).next_up() }
        };
        self.nodes.iter().zip(levers).map(motion).collect()
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
