//! Disjoint sets of numbers (union-find).

/// Disjoint sets; a set is represented by its smallest member, its root.
#[derive(Debug, Clone, Default)]
pub(crate) struct DisjointSets {
    /// Parent of each member; a root is its own parent. Numbers outside all sets have other values.
    pub parent: Vec<u32>,
}

impl DisjointSets {
    /// The root of the set of `i`, with path halving.
    pub fn find(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            self.parent[i as usize] = self.parent[self.parent[i as usize] as usize];
            i = self.parent[i as usize];
        }
        i
    }

    /// Unites the sets of `a` and `b`.
    pub fn union(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
