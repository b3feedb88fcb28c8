//! A binary tree of axis-aligned boxes over the triangles of a mesh.

use elbowroom_spatial::{Aabb, Vec3};

/// Triangles in one leaf at most.
const LEAF: usize = 2;

/// One box of the tree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub aabb: Aabb,
    /// Inner: index of the right child (the left one follows the node). Leaf: first triangle in `order`.
    pub link: u32,
    /// Number of triangles in a leaf; 0 for an inner node.
    pub count: u32,
}

/// Nodes in depth-first order.
#[derive(Debug, Clone)]
pub(crate) struct Bvh {
    pub nodes: Vec<Node>,
    pub order: Vec<u32>,
}

impl Bvh {
    /// Splits at the median of the longest axis of the centroids: depth at most ⌈log2 n⌉.
    pub fn build(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let boxes: Vec<Aabb> = triangles.iter().map(|t| Aabb::from_points(t.map(|i| vertices[i as usize]))).collect();
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = Vec::with_capacity(triangles.len() * 2 / LEAF);
        split(&boxes, &mut order, 0, &mut nodes);
        Self { nodes, order }
    }

    /// The children of an inner node.
    #[inline]
    pub fn children(&self, node: usize) -> (usize, usize) {
        (node + 1, self.nodes[node].link as usize)
    }

    /// The triangles of a leaf; empty for an inner node.
    #[inline]
    pub fn leaf(&self, node: usize) -> &[u32] {
        let n = &self.nodes[node];
        let first = if n.count == 0 { 0 } else { n.link as usize };
        &self.order[first..first + n.count as usize]
    }
}

fn split(boxes: &[Aabb], order: &mut [u32], offset: usize, nodes: &mut Vec<Node>) {
    let aabb = order.iter().fold(Aabb::EMPTY, |b, &i| b.union(&boxes[i as usize]));
    let me = nodes.len();
    nodes.push(Node { aabb, link: offset as u32, count: order.len() as u32 });
    if order.len() <= LEAF {
        return;
    }
    let spread = Aabb::from_points(order.iter().map(|&i| boxes[i as usize].center())).extent();
    let axis = (0..3).fold(0, |best, k| if spread[k] > spread[best] { k } else { best });
    let half = order.len() / 2;
    let key = |i: &u32| boxes[*i as usize].center()[axis];
    order.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    let (left, right) = order.split_at_mut(half);
    split(boxes, left, offset, nodes);
    nodes[me].link = nodes.len() as u32;
    nodes[me].count = 0;
    split(boxes, right, offset + half, nodes);
}
