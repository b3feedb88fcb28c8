//! The contents of the tree: nodes of sixteen boxes and leaves of eight triangles, as structures of arrays.

/// Largest number of children of a node: the lanes of one SIMD test.
pub(crate) const ARITY: usize = 16;
/// Largest number of triangles of a leaf.
pub(crate) const LEAF_SIZE: usize = 8;

/// Up to sixteen children, structure of arrays, in units of the mesh's [`UnitFrame`](super::UnitFrame).
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub center: [[f32; ARITY]; 3],
    /// Half extents, rounded outwards.
    pub half: [[f32; ARITY]; 3],
    /// Slab normal, not longer than 1; `low` and `high` are the interval of the child along it, rounded outwards.
    pub normal: [[f32; ARITY]; 3],
    pub low: [f32; ARITY],
    pub high: [f32; ARITY],
    /// A point of the surface near the middle of the box.
    pub landmark: [[f32; ARITY]; 3],
}

impl Node {
    pub const EMPTY: Self = Self {
        center: [[0.0; ARITY]; 3],
        half: [[0.0; ARITY]; 3],
        normal: [[0.0; ARITY]; 3],
        low: [0.0; ARITY],
        high: [0.0; ARITY],
        landmark: [[0.0; ARITY]; 3],
    };
}

/// Eight triangles: `corner[k][axis][lane]`, in units of the mesh's [`UnitFrame`](super::UnitFrame), rounded to nearest.
#[derive(Debug, Clone)]
#[repr(C, align(32))]
pub(crate) struct Leaf {
    pub corner: [[[f32; LEAF_SIZE]; 3]; 3],
}
