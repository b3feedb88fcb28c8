//! The search tree of one path end.

/// A tree of configurations; node 0 is the root.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    dof: usize,
    /// All values of all nodes.
    values: Vec<f64>,
    parents: Vec<u32>,
    /// Whether the edge to the parent is proven.
    proven: Vec<bool>,
    /// Whether some edge between the node and the root could not be proven.
    pruned: Vec<bool>,
}

impl Tree {
    pub fn new(root: &[f64]) -> Self {
        let values = root.to_vec();
        Self { dof: root.len(), values, parents: vec![0], proven: vec![true], pruned: vec![false] }
    }

    pub fn len(&self) -> usize {
        self.parents.len()
    }

    pub fn q(&self, node: usize) -> &[f64] {
        &self.values[node * self.dof..(node + 1) * self.dof]
    }

    pub fn add(&mut self, parent: usize, q: &[f64]) -> usize {
        self.values.extend_from_slice(q);
        self.parents.push(parent as u32);
        self.proven.push(false);
        self.pruned.push(false);
        self.parents.len() - 1
    }

    /// The node with the least weighted distance.
    pub fn nearest(&self, q: &[f64], weights: &[f64]) -> usize {
        let (mut best, mut least) = (0, f64::INFINITY);
        for (node, values) in self.values.chunks_exact(self.dof.max(1)).enumerate() {
            let mut far = 0.0;
            for ((x, y), w) in values.iter().zip(q).zip(weights) {
                far += ((x - y) * w).powi(2);
            }
            if far < least && !self.pruned[node] {
                (best, least) = (node, far);
            }
        }
        best
    }

    /// The nodes from `node` to the root.
    pub fn branch(&self, node: usize) -> Vec<usize> {
        let mut branch = vec![node];
        let mut at = node;
        while at != 0 {
            at = self.parents[at] as usize;
            branch.push(at);
        }
        branch
    }

    pub fn parent(&self, node: usize) -> usize {
        self.parents[node] as usize
    }

    pub fn is_proven(&self, node: usize) -> bool {
        self.proven[node]
    }

    pub fn mark_proven(&mut self, node: usize) {
        self.proven[node] = true;
    }

    /// Prunes a node and its subtree. Children have greater indices than their parents.
    pub fn prune(&mut self, node: usize) {
        self.pruned[node] = true;
        for n in node + 1..self.len() {
            self.pruned[n] |= self.pruned[self.parents[n] as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_of_a_pruned_branch_are_never_nearest() {
        let mut tree = Tree::new(&[0.0, 0.0]);
        let a = tree.add(0, &[1.0, 0.0]);
        let b = tree.add(a, &[2.0, 0.0]);
        let c = tree.add(0, &[0.0, 5.0]);
        assert_eq!(tree.nearest(&[2.2, 0.0], &[1.0, 1.0]), b);
        assert_eq!(tree.branch(b), [b, a, 0]);
        assert_eq!(tree.nearest(&[2.2, 4.0], &[0.1, 1.0]), c);
        tree.prune(a);
        assert_eq!(tree.nearest(&[2.2, 0.0], &[1.0, 1.0]), 0);
    }
}
