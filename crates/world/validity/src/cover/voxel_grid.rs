//! A voxel grid around a solid: voxels that its surface crosses, voxels outside, and voxels inside.

use elbowroom_spatial::{Aabb, Vec3};

use super::surface_voxels::{SurfaceVoxels, TrianglePieces};
use super::triangle_slices::Lattice;
use super::voxel_bits::VoxelBits;

/// Largest number of voxels. Above it, the voxels are made larger.
const MAX_VOXELS: f64 = 48e6;
/// Range of the edge of a voxel, as a fraction of the slack: half a diagonal stays below the slack.
const STEP_SHARES: std::ops::RangeInclusive<f64> = 0.6..=0.9;
/// Target number of surface voxels, by the area (the surface crosses more).
///
/// It takes little time; small voxels need fewer spheres.
const SURFACE_VOXELS: f64 = 30e3;

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
    /// Number of voxels per axis; one layer on each side is outside.
    pub counts: [usize; 3],
    outside: VoxelBits,
    /// Voxels that the surface encloses, and surface voxels that are not near the outside.
    pub inside: VoxelBits,
    pub surface: SurfaceVoxels,
}

impl VoxelGrid {
    /// Returns `None` if there are no triangles.
    pub fn new(triangles: &[[Vec3; 3]], slack_m: f64) -> Option<Self> {
        if triangles.is_empty() {
            return None;
        }
        let bounds = Aabb::from_points(triangles.iter().flatten().copied());
        let step_m = step_m(triangles, bounds.extent(), slack_m);
        let margin = Vec3::splat(1.5 * step_m);
        let lattice = Lattice { origin: bounds.min - margin, step_m };
        let size = bounds.extent() + margin * 2.0;
        let counts = [0, 1, 2].map(|axis| (size[axis] / step_m).ceil() as usize + 1);
        let pieces = TrianglePieces::new(triangles, lattice);
        let outside = pieces.crossed(counts).flood_around();
        let surface = SurfaceVoxels::new(&pieces, lattice, &outside, triangles);
        let inside = outside.neither(&surface.cells);
        Some(Self { lattice, counts, outside, inside, surface })
    }

    /// The state of the voxel that contains a point; outside beyond the grid.
    pub fn at(&self, p: Vec3) -> Voxel {
        let cell = [0, 1, 2].map(|axis| ((p[axis] - self.lattice.origin[axis]) / self.lattice.step_m).floor() as i32);
        if (0..3).any(|axis| cell[axis] < 0 || cell[axis] as usize >= self.counts[axis]) {
            return Voxel::Outside;
        }
        let cell = cell.map(|c| c as usize);
        match (self.outside.contains(cell), self.inside.contains(cell)) {
            (true, _) => Voxel::Outside,
            (false, true) => Voxel::Inside,
            (false, false) => Voxel::Surface,
        }
    }

    /// Centre of a voxel.
    pub fn centre(&self, cell: [usize; 3]) -> Vec3 {
        let [x, y, z] = cell.map(|c| (c as f64 + 0.5) * self.lattice.step_m);
        self.lattice.origin + Vec3::new(x, y, z)
    }
}

fn step_m(triangles: &[[Vec3; 3]], extent: Vec3, slack_m: f64) -> f64 {
    let area: f64 = triangles.iter().map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length()).sum();
    let mut step = (area / SURFACE_VOXELS).sqrt().clamp(STEP_SHARES.start() * slack_m, STEP_SHARES.end() * slack_m);
    let voxels = |step: f64| (0..3).map(|axis| extent[axis] / step + 4.0).product::<f64>();
    // With larger voxels the slack may be exceeded, but the cover is still complete.
    while voxels(step) > MAX_VOXELS {
        step *= 1.1;
    }
    step
}
