//! Cubes that touch to clusters: union-find over the 26 neighbours.

use super::voxels::Voxels;
use crate::sets::Sets;

/// Clusters of cubes; memory is reused.
#[derive(Debug, Clone, Default)]
pub(super) struct Clusters {
    sets: Sets,
    /// Cubes, cluster by cluster.
    pub(super) members: Vec<u32>,
    /// Where each cluster ends in `members`.
    pub(super) ends: Vec<u32>,
    cluster_of: Vec<u32>,
    sizes: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Clusters {
    /// Clusters cubes with at least `least_points` points; clusters of fewer than `least_voxels` cubes are left out. In
    /// the order in which their first cubes were met.
    pub(super) fn find(&mut self, voxels: &Voxels, least_points: u32, least_voxels: u32) {
        self.sets.parent.clear();
        let counts = |place: usize| voxels.list[place].points >= least_points;
        self.sets.parent.extend((0..voxels.list.len()).map(|i| if counts(i) { i as u32 } else { NONE }));
        for place in 0..voxels.list.len() {
            if counts(place) {
                voxels.neighbours(place, |other| {
                    if counts(other) {
                        self.sets.unite(place as u32, other as u32);
                    }
                });
            }
        }
        self.list(least_voxels);
    }

    /// Counts, keeps the large ones, and lists their cubes (counting sort).
    fn list(&mut self, least_voxels: u32) {
        let n = self.sets.parent.len();
        self.sizes.clear();
        self.sizes.resize(n, 0);
        self.cluster_of.clear();
        self.cluster_of.resize(n, NONE);
        for i in 0..n as u32 {
            if self.sets.parent[i as usize] != NONE {
                let root = self.sets.root(i);
                self.sizes[root as usize] += 1;
            }
        }
        self.ends.clear();
        let mut start = 0;
        for i in 0..n {
            if self.sizes[i] >= least_voxels.max(1) {
                self.cluster_of[i] = self.ends.len() as u32;
                self.ends.push(start);
                start += self.sizes[i];
            }
        }
        self.members.clear();
        self.members.resize(start as usize, 0);
        for i in 0..n as u32 {
            if self.sets.parent[i as usize] != NONE {
                let root = self.sets.root(i) as usize;
                if self.cluster_of[root] != NONE {
                    let end = &mut self.ends[self.cluster_of[root] as usize];
                    self.members[*end as usize] = i;
                    *end += 1;
                }
            }
        }
    }

    /// The cubes of each cluster.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.ends.len()).map(|c| {
            let from = if c == 0 { 0 } else { self.ends[c - 1] };
            &self.members[from as usize..self.ends[c] as usize]
        })
    }
}
