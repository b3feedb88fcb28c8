//! Workspace for one configuration at a time.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::Simd;

use super::placed_centres::PlacedCentres;
use super::segment::joint_value;
use crate::lanes::{LANES, PointRow, Row, V3};
use crate::model::{CoveredRobot, Frame, JointTurns, RootSphere, SpherePack, SpherePacks};

/// Marks links that form no pair.
const NO_PAIR: u32 = u32::MAX;

/// Pairs of links that must not touch, and how near their bounding spheres may be.
///
/// The matrix has one row per link and one lane per other link.
#[derive(Debug, Clone)]
pub(crate) struct LinkMatrix {
    /// Number of rows of sixteen links.
    pub rows: usize,
    /// Squares of distances, m².
    squares: Vec<Row>,
    partners: Vec<u32>,
    pairs: Vec<u32>,
}

impl LinkMatrix {
    pub fn new(robot: &CoveredRobot) -> Self {
        let links = robot.covered_links.len();
        let rows = links.div_ceil(LANES);
        let mut matrix = Self {
            rows,
            squares: vec![Row::ZERO; links * rows],
            partners: vec![0; links * rows],
            pairs: vec![NO_PAIR; links * rows * LANES],
        };
        for (p, pair) in robot.pairs.iter().enumerate() {
            let (a, b) = (pair.a.0.min(pair.b.0), pair.a.0.max(pair.b.0));
            if robot.covered_links[a].nodes.is_empty() || robot.covered_links[b].nodes.is_empty() {
                continue;
            }
            // If a pair is given twice, the larger margin counts.
            let known = &mut matrix.pairs[a * rows * LANES + b];
            if *known != NO_PAIR && robot.pairs[*known as usize].margin_m >= pair.margin_m {
                continue;
            }
            *known = p as u32;
            let reach = robot.bounding_radius_m(pair.a) + robot.bounding_radius_m(pair.b) + pair.margin_m;
            matrix.squares[a * rows + b / LANES].0[b % LANES] = reach * reach;
            matrix.partners[a * rows + b / LANES] |= 1 << (b % LANES);
        }
        matrix
    }

    #[inline(always)]
    pub fn square_reaches(&self, a: usize, row: usize) -> &Row {
        &self.squares[a * self.rows + row]
    }

    /// One bit per link of a row that forms a pair with a link.
    #[inline(always)]
    pub fn partners(&self, a: usize, row: usize) -> u32 {
        self.partners[a * self.rows + row]
    }

    /// The index of the pair of two links that form one.
    #[inline(always)]
    pub fn pair(&self, a: usize, b: usize) -> usize {
        self.pairs[a * self.rows * LANES + b] as usize
    }
}

/// A sphere in the world, with the pack of the spheres below it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WorldSphere {
    pub centre: [f32; 3],
    pub radius: f32,
    pub below: Option<u32>,
}

/// Memory that a check of one configuration writes.
#[derive(Debug, Clone)]
pub(crate) struct SingleWorkspace {
    /// Values of the joints, sixteen in a row.
    pub values: Vec<Row>,
    pub turns: JointTurns,
    pub frames: Vec<Frame>,
    /// Centres of the nodes of the broad phase in the world, and their radii.
    pub roots: Vec<PointRow>,
    pub root_radii: Vec<Row>,
    /// Centres of the links' bounding spheres.
    pub links: Vec<PointRow>,
    /// Per pair of links: true if a table proves them apart.
    pub is_excluded: Vec<bool>,
    /// Per step: its cell in the tables.
    cells: Vec<[i32; LANES]>,
    /// Per pack: the centres of its spheres in the world, in blocks of one configuration.
    centres: PlacedCentres,
    /// Packs of boxes still to visit.
    pub open: Vec<(u32, u32)>,
    pub found: Vec<u32>,
    pub found_inner: Vec<u32>,
    /// Links and obstacles that touch without a proven collision; further tests of such a pair add nothing.
    pub unproven: Vec<(u32, u32)>,
    /// Packs of spheres still to visit.
    pub open_packs: Vec<u32>,
    pub open_pairs: Vec<(WorldSphere, u32)>,
}

impl SingleWorkspace {
    pub fn new(robot: &CoveredRobot) -> Self {
        let rows = robot.chain.steps.len().div_ceil(LANES);
        let packs = &robot.packs;
        let mut root_radii = vec![Row::ZERO; packs.broad_phase.len().div_ceil(LANES)];
        packs.broad_phase.iter().enumerate().for_each(|(i, r)| root_radii[i / LANES].0[i % LANES] = r.radius);
        Self {
            values: vec![Row::ZERO; rows],
            turns: JointTurns::new(rows),
            frames: robot.chain.single_frames(),
            roots: vec![PointRow::ZERO; root_radii.len()],
            root_radii,
            links: vec![PointRow::ZERO; packs.links.len().div_ceil(LANES)],
            is_excluded: vec![false; robot.pairs.len()],
            cells: vec![[0; LANES]; rows],
            centres: PlacedCentres::new(packs.packs.len()),
            open: Vec::new(),
            found: Vec::new(),
            found_inner: Vec::new(),
            unproven: Vec::new(),
            open_packs: Vec::new(),
            open_pairs: Vec::new(),
        }
    }

    /// Sets the values of the joints and discards the last configuration. False if the bounds do not hold for the values.
    #[inline(always)]
    pub fn begin(&mut self, robot: &CoveredRobot, q: &[f64]) -> bool {
        self.centres.begin_block();
        self.unproven.clear();
        let mut is_valid = true;
        for (i, step) in robot.chain.steps.iter().enumerate() {
            let (value, accepted) = joint_value(step, q);
            is_valid &= accepted;
            self.values[i / LANES].0[i % LANES] = value;
        }
        is_valid
    }

    /// Places the nodes of the broad phase.
    #[inline(always)]
    pub fn place_roots<S: Simd>(&mut self, simd: S, packs: &SpherePacks) {
        for (i, root) in packs.broad_phase.iter().enumerate() {
            place(simd, root, &self.frames, &mut self.roots[i / LANES], i % LANES);
        }
    }

    /// Places the bounding spheres of the links.
    #[inline(always)]
    pub fn place_links<S: Simd>(&mut self, simd: S, packs: &SpherePacks) {
        for (i, root) in packs.links.iter().enumerate() {
            if let Some(root) = root {
                place(simd, root, &self.frames, &mut self.links[i / LANES], i % LANES);
            }
        }
    }

    #[inline(always)]
    pub fn root_centre(&self, i: usize) -> [f32; 3] {
        lane_of(&self.roots[i / LANES], i % LANES)
    }

    #[inline(always)]
    pub fn link_centre(&self, i: usize) -> [f32; 3] {
        lane_of(&self.links[i / LANES], i % LANES)
    }

    /// Marks the pairs that the tables exclude.
    #[inline(always)]
    pub fn exclude_by_tables<S: Simd>(&mut self, simd: S, robot: &CoveredRobot) {
        let Some(tables) = robot.tables.get() else { return };
        for (cells, values) in self.cells.iter_mut().zip(&self.values) {
            crate::model::cells(simd, values.load(simd), cells);
        }
        for table in tables {
            let cell = |step: usize| self.cells[step / LANES][step % LANES] as usize;
            let near = table.near_at([cell(table.steps[0]), cell(table.steps[1])]);
            for (bit, &pair) in table.pairs.iter().enumerate() {
                self.is_excluded[pair] = near >> bit & 1 == 0;
            }
        }
    }

    /// The centres of a pack in the world.
    #[inline(always)]
    pub fn centres<S: Simd>(&mut self, simd: S, pack: &SpherePack, index: u32) -> V3<S> {
        let i = index as usize;
        if self.centres.are_placed(i) {
            return self.centres.row(i).load(simd);
        }
        let frame = &self.frames[pack.frame as usize];
        let local = pack.centres.load(simd);
        let mut at = splat3(simd, frame.origin);
        at = splat3(simd, frame.columns[0]).times_plus(local.0, at);
        at = splat3(simd, frame.columns[1]).times_plus(local.1, at);
        at = splat3(simd, frame.columns[2]).times_plus(local.2, at);
        self.centres.place(i, at);
        at
    }

    /// The centre of a sphere of a pack, which must be computed already.
    #[inline(always)]
    pub fn centre(&self, pack: u32, lane: usize) -> [f32; 3] {
        lane_of(self.centres.row(pack as usize), lane)
    }
}

#[inline(always)]
fn place<S: Simd>(simd: S, root: &RootSphere, frames: &[Frame], row: &mut PointRow, lane: usize) {
    let at = frames[root.frame as usize].point(simd, root.centre);
    for k in 0..3 {
        row.0[k].0[lane] = at[k];
    }
}

#[inline(always)]
fn lane_of(row: &PointRow, lane: usize) -> [f32; 3] {
    [row.0[0].0[lane], row.0[1].0[lane], row.0[2].0[lane]]
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, v: [f32; 4]) -> V3<S> {
    V3::splat(simd, [v[0], v[1], v[2]])
}
