//! Voxels that a surface crosses, each with the bounds of what lies in it.

use elbowroom_spatial::{Aabb, Vec3};

use super::placement::PlacedShapes;
use super::triangle_slices::Lattice;

/// A voxel that the surface crosses.
#[derive(Clone, Copy)]
pub(super) struct SurfaceVoxel {
    /// Its cell.
    pub cell: [i32; 3],
    /// Bounds of the triangles in it; later also of its corners that are not outside.
    pub content: Aabb,
    /// One of the triangles.
    pub triangle: u32,
}

impl SurfaceVoxel {
    pub fn centre(&self) -> Vec3 {
        self.content.center()
    }

    pub fn half(&self) -> Vec3 {
        self.content.extent() * 0.5
    }
}

/// All voxels that triangles cross, one entry each, in the order of z, y, x.
pub(super) fn surface_voxels(placed: &PlacedShapes, lattice: Lattice) -> Vec<SurfaceVoxel> {
    let mut voxels = Vec::new();
    for (i, &triangle) in placed.triangles.iter().enumerate() {
        let triangle_index = i as u32;
        lattice.slice(triangle, |cell, content| voxels.push(SurfaceVoxel { cell, content, triangle: triangle_index }));
    }
    voxels.sort_by_key(|v| (v.cell[2], v.cell[1], v.cell[0], v.triangle));
    voxels.dedup_by(|next, kept| {
        let same = next.cell == kept.cell;
        if same {
            kept.content = kept.content.union(&next.content);
        }
        same
    });
    voxels
}
