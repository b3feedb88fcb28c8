//! A voxel grid around a solid: which voxels its surface crosses, which are outside, which inside.

use elbowroom_spatial::{Aabb, Vec3};

use super::placement::PlacedShapes;
use super::surface_voxels::{SurfaceVoxel, surface_voxels};
use super::triangle_slices::Lattice;

/// Number of voxels above which they are made larger.
const MAX_VOXELS: f64 = 6e6;
/// Edge of a voxel as a share of the slack: half a diagonal stays below the slack.
const STEP_SHARE: f64 = 0.5;
const LARGEST_STEP_SHARE: f64 = 0.9;

/// State of a voxel.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Voxel {
    Inside,
    Surface,
    Outside,
}

/// Voxels around a solid.
pub(super) struct VoxelGrid {
    pub lattice: Lattice,
    /// Per axis; one layer on each side is outside.
    pub counts: [usize; 3],
    states: Vec<Voxel>,
    /// In the order of z, y, x.
    pub surface: Vec<SurfaceVoxel>,
    /// First entry of `surface` per row along x, in the order of z, y.
    rows: Vec<u32>,
}

impl VoxelGrid {
    /// `None` where there are no triangles.
    pub fn new(placed: &PlacedShapes, slack_m: f64) -> Option<Self> {
        let bounds = Aabb::from_points(placed.triangles.iter().flatten().copied());
        if placed.triangles.is_empty() {
            return None;
        }
        let step_m = step_m(bounds.extent(), slack_m);
        let margin = Vec3::splat(1.5 * step_m);
        let lattice = Lattice { origin: bounds.min - margin, step_m };
        let size = bounds.extent() + margin * 2.0;
        let counts = [0, 1, 2].map(|axis| (size[axis] / step_m).ceil() as usize + 1);
        let surface = surface_voxels(placed, lattice);
        let mut grid = Self { lattice, counts, states: Vec::new(), surface, rows: Vec::new() };
        grid.rows = grid.row_starts();
        grid.states = grid.flood();
        grid.include_inner_corners();
        Some(grid)
    }

    pub fn index(&self, cell: [i32; 3]) -> usize {
        let [x, y, z] = cell.map(|c| c as usize);
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// The voxel that contains a point; outside beyond the grid.
    pub fn at(&self, p: Vec3) -> Voxel {
        let cell = [0, 1, 2].map(|axis| ((p[axis] - self.lattice.origin[axis]) / self.lattice.step_m).floor() as i32);
        let is_within = (0..3).all(|axis| cell[axis] >= 0 && (cell[axis] as usize) < self.counts[axis]);
        if is_within { self.states[self.index(cell)] } else { Voxel::Outside }
    }

    pub fn state(&self, index: usize) -> Voxel {
        self.states[index]
    }

    /// Indices in `surface` of the voxels of a row along x that are within a distance of a coordinate.
    pub fn row_within(&self, y: usize, z: usize, x: f64, distance_m: f64) -> std::ops::Range<usize> {
        let row = z * self.counts[1] + y;
        let (first, end) = (self.rows[row] as usize, self.rows[row + 1] as usize);
        let voxels = &self.surface[first..end];
        let column = |x: f64| ((x - self.lattice.origin.x) / self.lattice.step_m).floor();
        let (low, high) = (column(x - distance_m) - 1.0, column(x + distance_m) + 1.0);
        let from = voxels.partition_point(|v| f64::from(v.cell[0]) < low);
        let to = voxels.partition_point(|v| f64::from(v.cell[0]) <= high);
        first + from..first + to.max(from)
    }

    /// Centre of a voxel.
    pub fn centre(&self, cell: [usize; 3]) -> Vec3 {
        let half = Vec3::new(cell[0] as f64 + 0.5, cell[1] as f64 + 0.5, cell[2] as f64 + 0.5);
        self.lattice.origin + half * self.lattice.step_m
    }

    fn row_starts(&self) -> Vec<u32> {
        let rows = self.counts[1] * self.counts[2];
        let row_of = |v: &SurfaceVoxel| v.cell[2] as usize * self.counts[1] + v.cell[1] as usize;
        let mut starts = vec![0_u32; rows + 1];
        for v in &self.surface {
            starts[row_of(v) + 1] += 1;
        }
        for i in 0..rows {
            starts[i + 1] += starts[i];
        }
        starts
    }

    /// What is connected to the border of the grid without crossing the surface is outside.
    fn flood(&self) -> Vec<Voxel> {
        let mut states = vec![Voxel::Inside; self.len()];
        for v in &self.surface {
            states[self.index(v.cell)] = Voxel::Surface;
        }
        let [nx, ny, nz] = self.counts;
        let mut open = vec![0_usize];
        states[0] = Voxel::Outside;
        while let Some(i) = open.pop() {
            let (x, y, z) = (i % nx, i / nx % ny, i / (nx * ny));
            let mut visit = |inside_grid: bool, j: usize| {
                if inside_grid && states[j] == Voxel::Inside {
                    states[j] = Voxel::Outside;
                    open.push(j);
                }
            };
            visit(x > 0, i.wrapping_sub(1));
            visit(x + 1 < nx, i + 1);
            visit(y > 0, i.wrapping_sub(nx));
            visit(y + 1 < ny, i + nx);
            visit(z > 0, i.wrapping_sub(nx * ny));
            visit(z + 1 < nz, i + nx * ny);
        }
        states
    }

    /// The part of the solid in a voxel lies in the bounds of the triangles and of the corners that are not outside: on a face
    /// of the voxel that no triangle touches, all corners are inside or all are outside.
    fn include_inner_corners(&mut self) {
        let step = self.lattice.step_m;
        for i in 0..self.surface.len() {
            let voxel = self.surface[i];
            for corner in 0..8 {
                let offset = [0, 1, 2].map(|axis| (corner >> axis) & 1);
                if self.corner_is_outside(voxel.cell, offset) {
                    continue;
                }
                let at =
                    [0, 1, 2].map(|axis| self.lattice.origin[axis] + f64::from(voxel.cell[axis] + offset[axis]) * step);
                let p = Vec3::new(at[0], at[1], at[2]);
                let content = &mut self.surface[i].content;
                *content = content.union(&Aabb { min: p, max: p });
            }
        }
    }

    /// True where one of the eight voxels at a corner is outside.
    fn corner_is_outside(&self, cell: [i32; 3], offset: [i32; 3]) -> bool {
        (0..8).any(|n| {
            let neighbour = [0, 1, 2].map(|axis| cell[axis] + offset[axis] - ((n >> axis) & 1));
            self.states[self.index(neighbour)] == Voxel::Outside
        })
    }
}

fn step_m(extent: Vec3, slack_m: f64) -> f64 {
    let mut step = STEP_SHARE * slack_m;
    let voxels = |step: f64| (0..3).map(|axis| extent[axis] / step + 4.0).product::<f64>();
    while voxels(step) > MAX_VOXELS && step < LARGEST_STEP_SHARE * slack_m {
        step *= 1.1;
    }
    // Beyond this the slack is not kept, the cover is complete all the same.
    while voxels(step) > 8.0 * MAX_VOXELS {
        step *= 1.1;
    }
    step
}
