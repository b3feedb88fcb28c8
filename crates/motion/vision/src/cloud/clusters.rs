//! Clustering of voxels: union-find over the 26 neighbours.

use super::voxel_grid::VoxelGrid;
use crate::disjoint_sets::DisjointSets;

/// Clusters of voxels; memory is reused.
#[derive(Debug, Clone, Default)]
pub(super) struct Clusters {
    sets: DisjointSets,
    /// Voxels, cluster by cluster.
    pub(super) members: Vec<u32>,
    /// End of each cluster in `members`.
    ends: Vec<u32>,
    cluster_of: Vec<u32>,
    sizes: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Clusters {
    /// Clusters voxels with at least `min_points` points; drops clusters of fewer than `min_voxels` voxels. Clusters
    /// are in the order of their first voxels.
    pub(super) fn find(&mut self, voxels: &VoxelGrid, min_points: u32, min_voxels: u32) {
        self.sets.parent.clear();
        let is_occupied = |voxel: usize| voxels.list[voxel].points >= min_points;
        self.sets.parent.extend((0..voxels.list.len()).map(|i| if is_occupied(i) { i as u32 } else { NONE }));
        for voxel in 0..voxels.list.len() {
            if is_occupied(voxel) {
                voxels.neighbours(voxel, |other| {
                    if is_occupied(other) {
                        self.sets.union(voxel as u32, other as u32);
                    }
                });
            }
        }
        self.list(min_voxels);
    }

    /// Counts the voxels of each cluster, keeps the large clusters, and lists their voxels (counting sort).
    fn list(&mut self, min_voxels: u32) {
        let n = self.sets.parent.len();
        self.sizes.clear();
        self.sizes.resize(n, 0);
        self.cluster_of.clear();
        self.cluster_of.resize(n, NONE);
        for i in 0..n as u32 {
            if self.sets.parent[i as usize] != NONE {
                let root = self.sets.find(i);
                self.sizes[root as usize] += 1;
            }
        }
        self.ends.clear();
        let mut start = 0;
        for i in 0..n {
            if self.sizes[i] >= min_voxels.max(1) {
                self.cluster_of[i] = self.ends.len() as u32;
                self.ends.push(start);
                start += self.sizes[i];
            }
        }
        self.members.clear();
        self.members.resize(start as usize, 0);
        for i in 0..n as u32 {
            if self.sets.parent[i as usize] != NONE {
                let root = self.sets.find(i) as usize;
                if self.cluster_of[root] != NONE {
                    let end = &mut self.ends[self.cluster_of[root] as usize];
                    self.members[*end as usize] = i;
                    *end += 1;
                }
            }
        }
    }

    /// Iterates over the clusters, each given by its voxels.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.ends.len()).map(|c| {
            let from = if c == 0 { 0 } else { self.ends[c - 1] };
            &self.members[from as usize..self.ends[c] as usize]
        })
    }
}
