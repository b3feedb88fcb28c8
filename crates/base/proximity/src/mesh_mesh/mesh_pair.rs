//! The two meshes of a query.

use fearless_simd::Level as SimdLevel;

use super::relative_placement::RelativePlacement;
use crate::TriMesh;

/// Two meshes, their relative placement, and the instruction set to use.
#[derive(Clone, Copy)]
pub(super) struct MeshPair<'a> {
    pub a: &'a TriMesh,
    pub b: &'a TriMesh,
    pub placement: &'a RelativePlacement,
    pub simd_level: SimdLevel,
}
