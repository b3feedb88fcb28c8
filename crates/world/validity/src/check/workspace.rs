//! Workspace of a checker.

use super::joint_stretch::JointStretch;
use super::motion_table::MotionTable;
use super::node_obstacles::NodeObstacles;
use super::placed_centres::PlacedCentres;
use crate::lanes::{LANES, Row};
use crate::model::{CoveredRobot, FrameLanes};

/// Memory that a check of sixteen configurations writes.
#[derive(Debug, Clone)]
pub(crate) struct Workspace {
    /// Per moving joint: its values.
    pub values: Vec<Row>,
    pub frames: Vec<FrameLanes>,
    /// Per sphere node: its centres in the world.
    centres: PlacedCentres,
    /// Per obstacle: the block, the body, and the lanes in which that body needs no further test.
    settled: Vec<(u32, usize, u32)>,
    /// Per moving joint: its values in a stretch.
    pub stretch: Vec<JointStretch>,
    /// Per body, then per pair of links: half of the longest chord, m.
    pub half_chord_m: Vec<Row>,
    /// Per body, then per pair of links: the largest deviation of a point from its chord, m.
    pub sag_m: Vec<Row>,
    /// Per pair of links: the square of the distance below which their bounding spheres are near, m².
    pub reach_squares: Vec<Row>,
    /// Per frame: the change of the turning joints that carry it, between two lanes, rad.
    pub turned: Vec<f32>,
    /// Per step: the change of its joint between two lanes, rad or m.
    pub deltas: Vec<f32>,
    /// Per pair of links: true if it must be checked in this block.
    pub near_pairs: Vec<bool>,
    /// Packs still to visit.
    pub open: Vec<(u32, u32)>,
    /// Obstacles found by the broad phase.
    pub found: Vec<u32>,
    pub node_obstacles: NodeObstacles,
    /// Pairs of nodes still to visit.
    pub node_pairs: Vec<(u32, u32)>,
}

impl Workspace {
    pub fn new(robot: &CoveredRobot, table: &MotionTable) -> Self {
        let rows = table.columns / LANES;
        Self {
            values: vec![Row::ZERO; robot.chain.steps.len()],
            frames: robot.chain.frames(),
            centres: PlacedCentres::new(robot.nodes.len()),
            settled: Vec::new(),
            reach_squares: vec![Row::ZERO; rows],
            stretch: vec![JointStretch::default(); robot.chain.steps.len()],
            half_chord_m: vec![Row::ZERO; rows],
            sag_m: vec![Row::ZERO; rows],
            deltas: vec![0.0; robot.chain.steps.len()],
            near_pairs: vec![true; robot.pairs.len()],
            turned: vec![0.0; robot.chain.steps.len() + 1],
            open: Vec::new(),
            found: Vec::new(),
            node_obstacles: NodeObstacles::default(),
            node_pairs: Vec::new(),
        }
    }

    /// Prepares for unrelated configurations, without motion between lanes.
    pub fn set_no_motion(&mut self) {
        self.half_chord_m.fill(Row::ZERO);
        self.sag_m.fill(Row::ZERO);
        self.deltas.fill(0.0);
    }

    /// Discards the centres of the last block.
    pub fn begin_block(&mut self) {
        if self.centres.begin_block() {
            self.settled.clear();
        }
    }

    /// Lanes in which a body and an obstacle need no further test in this block.
    pub fn settled(&self, body: usize, obstacle: u32) -> u32 {
        match self.settled.get(obstacle as usize) {
            Some(&(block, of_body, lanes)) if (block, of_body) == (self.centres.block(), body) => lanes,
            _ => 0,
        }
    }

    /// Adds lanes in which a body and an obstacle need no further test.
    pub fn settle(&mut self, body: usize, obstacle: u32, lanes: u32) {
        let lanes = lanes | self.settled(body, obstacle);
        if self.settled.len() <= obstacle as usize {
            self.settled.resize(obstacle as usize + 1, (0, 0, 0));
        }
        self.settled[obstacle as usize] = (self.centres.block(), body, lanes);
    }

    /// Centres of a node in the world.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub fn centre<S: fearless_simd::Simd>(&mut self, simd: S, robot: &CoveredRobot, node: u32) -> crate::lanes::V3<S> {
        let i = node as usize;
        if self.centres.are_placed(i) {
            return self.centres.row(i).load(simd);
        }
        let n = &robot.nodes[i];
        let centre = self.frames[n.frame as usize].point(simd, n.centre);
        self.centres.place(i, centre);
        centre
    }

    /// Centres of a node, which must be computed for this block already.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub fn known_centre<S: fearless_simd::Simd>(&self, simd: S, node: u32) -> crate::lanes::V3<S> {
        self.centres.row(node as usize).load(simd)
    }

    /// Computes `reach_squares` from the radii of the bounding spheres and the chords.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of a kernel")]
    pub fn square_reaches<S: fearless_simd::Simd>(&mut self, simd: S, table: &MotionTable) {
        for (r, radii) in table.root_radii_m().iter().enumerate() {
            let reach = radii.load(simd) + self.half_chord_m[r].load(simd);
            self.reach_squares[r].store(reach * reach);
        }
    }
}
