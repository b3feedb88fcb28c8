//! Memory that queries reuse, and the work of the last query.

use std::cell::RefCell;

use fearless_simd::Level as SimdLevel;

use super::mesh_features::MeshFeatures;
use super::node_pair::NodePairStack;
use super::triangle_batch::TriangleBatch;
use crate::lanes::detected_simd_level;

/// Work done by one query with a mesh. The first five numbers are for two meshes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct QueryStats {
    /// Pairs of nodes expanded.
    pub nodes: u32,
    /// Tests of one box against sixteen.
    pub boxes: u32,
    /// Pairs of leaves visited, each of up to eight triangles.
    pub leaves: u32,
    /// Pairs of triangles that f32 could not decide.
    pub triangles: u32,
    /// Batches of up to eight such pairs measured in f64.
    pub batches: u32,
    /// Triangles whose distance to a shape that is not a mesh was computed; for continuous witness points, once more per
    /// face of that shape. Contact points do not count.
    pub triangles_beside_solids: u32,
}

/// Memory that queries reuse, one per thread. It never allocates, and answers never depend on earlier queries.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(super) stack: NodePairStack,
    pub(super) batch: TriangleBatch,
    simd_level: Option<SimdLevel>,
    pub(super) stats: QueryStats,
    pub(super) closest_features: Option<MeshFeatures>,
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

impl Workspace {
    /// Creates a workspace for the best instruction set of this processor.
    pub const fn new() -> Self {
        Self {
            stack: NodePairStack::new(),
            batch: TriangleBatch::new(),
            simd_level: None,
            stats: QueryStats::ZERO,
            closest_features: None,
        }
    }

    /// Creates a workspace for a given instruction set.
    #[doc(hidden)]
    pub const fn with_simd_level(simd_level: SimdLevel) -> Self {
        Self { simd_level: Some(simd_level), ..Self::new() }
    }

    /// Work done by the last query with a mesh (distance, tolerance, collision).
    pub fn stats(&self) -> QueryStats {
        self.stats
    }

    /// The closest features of the last distance query on two meshes; `None` if they were beyond the limit.
    pub fn closest_features(&self) -> Option<MeshFeatures> {
        self.closest_features
    }

    /// Sets the work of a query that was not counted here.
    pub(crate) fn set_stats(&mut self, stats: QueryStats) {
        self.stats = stats;
    }

    pub(super) fn begin_query(&mut self) {
        self.stats = QueryStats::ZERO;
        self.closest_features = None;
    }

    #[inline]
    pub(super) fn simd_level(&self) -> SimdLevel {
        self.simd_level.unwrap_or_else(detected_simd_level)
    }
}

/// Runs a query with this thread's own workspace. It is static, so that not even the first use allocates.
pub(crate) fn with_thread_workspace<T>(query: impl FnOnce(&mut Workspace) -> T) -> T {
    thread_local! { static WORKSPACE: RefCell<Workspace> = const { RefCell::new(Workspace::new()) } }
    WORKSPACE.with_borrow_mut(query)
}

impl QueryStats {
    const ZERO: Self = Self { nodes: 0, boxes: 0, leaves: 0, triangles: 0, batches: 0, triangles_beside_solids: 0 };
}
