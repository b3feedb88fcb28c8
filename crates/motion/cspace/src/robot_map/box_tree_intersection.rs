//! The cells that two maps of the same builder both block.

use super::box_tree::{BoxTree, CellRange, Node};

impl BoxTree {
    /// The cells that are blocked in both maps.
    ///
    /// # Panics
    /// The maps come from different builders.
    pub(crate) fn intersection(&self, other: &Self) -> Self {
        assert!(self.axes == other.axes, "maps of one builder have the same axes");
        // Nothing moves out of the way of an obstacle that touches what no axis moves.
        if matches!(&other.slabs[..], [(0, nodes)] if nodes[..] == [Node::Blocked]) {
            return self.clone();
        }
        if matches!(&self.slabs[..], [(0, nodes)] if nodes[..] == [Node::Blocked]) {
            return other.clone();
        }
        let is_alike = self.slabs.iter().map(|slab| slab.0).eq(other.slabs.iter().map(|slab| slab.0));
        assert!(is_alike, "maps of one builder are divided alike");
        let whole = CellRange::all(&self.axes);
        let slabs = self.slabs.iter().zip(&other.slabs).enumerate().map(|(i, ((first, a), (_, b)))| {
            let mut cells = whole;
            cells.first[0] = *first;
            cells.end[0] = self.slabs.get(i + 1).map_or(whole.end[0], |next| next.0);
            let mut nodes = Vec::new();
            intersect((a, 0), (b, 0), &cells, &mut nodes);
            (*first, nodes)
        });
        Self { axes: self.axes.clone(), slabs: slabs.collect() }
    }
}

/// Appends the common cells of two boxes, which contain `cells`.
fn intersect(a: (&[Node], usize), b: (&[Node], usize), cells: &CellRange, out: &mut Vec<Node>) {
    let (a, b) = (descend(a, cells), descend(b, cells));
    match (a.0[a.1], b.0[b.1]) {
        (Node::Free, _) | (_, Node::Free) => out.push(Node::Free),
        (Node::Blocked, Node::Blocked) => out.push(Node::Blocked),
        (Node::Split { axis, at, .. }, _) | (Node::Blocked, Node::Split { axis, at, .. }) => {
            let [left, right] = cells.split(usize::from(axis), at);
            let split = out.len();
            out.push(Node::Free);
            intersect(a, b, &left, out);
            let second = out.len();
            intersect(a, b, &right, out);
            let (first, last) = (out[split + 1], out[second]);
            if second == split + 2 && out.len() == second + 1 && first == last {
                // Two equal halves are one box.
                out.truncate(split);
                out.push(first);
            } else {
                out[split] = Node::Split { axis, at, right: second as u32 };
            }
        }
    }
}

/// The part of a box in which `cells` are: a leaf, or a split between them.
fn descend<'n>((nodes, mut node): (&'n [Node], usize), cells: &CellRange) -> (&'n [Node], usize) {
    while let Node::Split { axis, at, right } = nodes[node] {
        let axis = usize::from(axis);
        if cells.end[axis] <= at {
            node += 1;
        } else if cells.first[axis] >= at {
            node = right as usize;
        } else {
            break;
        }
    }
    (nodes, node)
}
