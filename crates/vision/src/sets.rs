//! Sets that grow together.

/// Disjoint sets of numbers (union-find); a set is known by its smallest member, its root.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sets {
    /// Each member's parent, a root's own number; other values for what is in no set.
    pub parent: Vec<u32>,
}

impl Sets {
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            self.parent[i as usize] = self.parent[self.parent[i as usize] as usize];
            i = self.parent[i as usize];
        }
        i
    }

    pub fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
