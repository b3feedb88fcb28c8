//! Voxels that a surface crosses, with their content.

use elbowroom_spatial::{Aabb, Vec3};

use super::triangle_slices::Lattice;
use super::voxel_bits::VoxelBits;

/// Largest number of points of a voxel. Above it, the corners of their bounding box replace the points.
const MAX_POINTS: usize = 24;

/// A part of a triangle in a voxel.
struct Piece {
    key: u64,
    cell: [u32; 3],
    triangle: u32,
    /// Range of its corners in the list of all points.
    first: u32,
    end: u32,
}

/// All parts of triangles, sorted by voxel along a curve on which near voxels are close together.
pub(super) struct TrianglePieces {
    pieces: Vec<Piece>,
    points: Vec<Vec3>,
}

/// A voxel that the surface crosses.
#[derive(Clone, Copy)]
pub(super) struct SurfaceVoxel {
    /// Range of its points in the list of all points: their convex hull contains the content of the voxel.
    first: u32,
    end: u32,
    /// One of the triangles.
    pub triangle: u32,
    /// A point of this triangle in the voxel.
    pub anchor: Vec3,
    /// Neighbouring voxels that are outside, one bit each.
    outside: u32,
}

impl SurfaceVoxel {
    /// Direction away from the outside: a mean of the normals nearby. `None` if the outside is on all sides.
    pub fn inward(&self) -> Option<Vec3> {
        let offset = |i: u32| Vec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - Vec3::splat(1.0);
        let outside = (0..27).filter(|i| self.outside >> i & 1 == 1);
        outside.fold(Vec3::ZERO, |sum, i| sum - offset(i)).try_normalize()
    }
}

/// The surface voxels near the outside, and their points.
pub(super) struct SurfaceVoxels {
    pub voxels: Vec<SurfaceVoxel>,
    /// Cells of the voxels.
    pub cells: VoxelBits,
    points: Vec<Vec3>,
    /// Triangles in these voxels: whole ones if possible, else parts.
    pub visible: Vec<[Vec3; 3]>,
}

impl TrianglePieces {
    pub fn new(triangles: &[[Vec3; 3]], lattice: Lattice) -> Self {
        let (mut pieces, mut points) = (Vec::new(), Vec::new());
        for (i, &triangle) in triangles.iter().enumerate() {
            lattice.slice(triangle, |cell, corners| {
                let (cell, first) = (cell.map(|c| c as u32), points.len() as u32);
                points.extend_from_slice(corners);
                let (key, end) = (curve_key(cell), points.len() as u32);
                pieces.push(Piece { key, cell, triangle: i as u32, first, end });
            });
        }
        pieces.sort_unstable_by_key(|p| (p.key, p.triangle));
        Self { pieces, points }
    }

    /// The voxels that triangles cross.
    pub fn crossed(&self, counts: [usize; 3]) -> VoxelBits {
        let mut crossed = VoxelBits::none(counts);
        self.pieces.iter().for_each(|p| crossed.insert(p.cell.map(|c| c as usize)));
        crossed
    }
}

impl SurfaceVoxels {
    /// Collects the voxels that have an outside voxel as a neighbour.
    ///
    /// The part of the solid in a voxel lies in the convex hull of the triangles' parts and of the corners that are not
    /// outside.
    pub fn new(all: &TrianglePieces, lattice: Lattice, outside: &VoxelBits, triangles: &[[Vec3; 3]]) -> Self {
        let cells = VoxelBits::none(outside.counts);
        let mut surface = Self { voxels: Vec::new(), cells, points: Vec::new(), visible: Vec::new() };
        for pieces in all.pieces.chunk_by(|a, b| a.key == b.key) {
            let cell = pieces[0].cell.map(|c| c as usize);
            let near = outside.neighbourhood(cell);
            if near != 0 {
                surface.cells.insert(cell);
                surface.push(all, pieces, lattice, near);
            }
        }
        surface.visible = surface.visible_parts(all, triangles);
        surface
    }

    /// Whole triangles that cross only these voxels, and the parts of other triangles in them.
    fn visible_parts(&self, all: &TrianglePieces, triangles: &[[Vec3; 3]]) -> Vec<[Vec3; 3]> {
        let is_visible = |piece: &&Piece| self.cells.contains(piece.cell.map(|c| c as usize));
        let mut is_whole = vec![true; triangles.len()];
        all.pieces.iter().filter(|p| !is_visible(p)).for_each(|p| is_whole[p.triangle as usize] = false);
        let mut visible: Vec<_> =
            triangles.iter().zip(&is_whole).filter(|(_, whole)| **whole).map(|(t, _)| *t).collect();
        for piece in all.pieces.iter().filter(|p| !is_whole[p.triangle as usize]).filter(is_visible) {
            let corners = &all.points[piece.first as usize..piece.end as usize];
            visible.extend((2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]));
        }
        visible
    }

    /// Points whose convex hull contains the content of a voxel.
    pub fn points(&self, voxel: usize) -> &[Vec3] {
        let v = &self.voxels[voxel];
        &self.points[v.first as usize..v.end as usize]
    }

    fn push(&mut self, all: &TrianglePieces, pieces: &[Piece], lattice: Lattice, outside: u32) {
        let first = self.points.len();
        for piece in pieces {
            self.points.extend_from_slice(&all.points[piece.first as usize..piece.end as usize]);
        }
        if self.points.len() - first > MAX_POINTS {
            let bounds = Aabb::from_points(self.points.drain(first..));
            let corner = |i: usize, axis: usize| if i >> axis & 1 == 1 { bounds.max[axis] } else { bounds.min[axis] };
            self.points.extend((0..8).map(|i| Vec3::new(corner(i, 0), corner(i, 1), corner(i, 2))));
        }
        for corner in 0..8 {
            let offset = [0, 1, 2].map(|axis| corner >> axis & 1);
            if outside & around_corner(offset) == 0 {
                let cell = pieces[0].cell;
                self.points.push(lattice.corner([0, 1, 2].map(|axis| cell[axis] + offset[axis])));
            }
        }
        let of_first = &all.points[pieces[0].first as usize..pieces[0].end as usize];
        let anchor = of_first.iter().fold(Vec3::ZERO, |sum, &p| sum + p) * (1.0 / of_first.len() as f64);
        let (first, end) = (first as u32, self.points.len() as u32);
        self.voxels.push(SurfaceVoxel { first, end, triangle: pieces[0].triangle, anchor, outside });
    }
}

/// The eight voxels at a corner of a voxel, as bits of its neighbourhood.
fn around_corner([x, y, z]: [u32; 3]) -> u32 {
    let in_plane = 0b011_011 << x << (3 * y);
    (in_plane | in_plane << 9) << (9 * z)
}

/// Position of a voxel on a curve through all voxels (Morton, 1966).
fn curve_key(cell: [u32; 3]) -> u64 {
    (0..3).map(|axis| interleaved(cell[axis].into()) << axis).fold(0, |key, part| key | part)
}

/// The lowest 21 bits with two zeros between them.
fn interleaved(v: u64) -> u64 {
    let v = v & 0x1f_ffff;
    let v = (v | v << 32) & 0x001f_0000_0000_ffff;
    let v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    let v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    let v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}
