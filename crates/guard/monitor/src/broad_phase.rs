//! Broad phase: a bounding volume hierarchy over the static regions.

use elbowroom_spatial::Aabb;

/// Regions per leaf.
const LEAF: usize = 4;
/// Depth of a balanced tree over 2³² regions.
const DEPTH: usize = 34;

/// A static tree of axis-aligned boxes. A query visits the boxes that overlap a given box and never allocates.
#[derive(Debug, Default)]
pub(crate) struct RegionTree {
    nodes: Vec<Node>,
    regions: Vec<u32>,
    boxes: Vec<Aabb>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb,
    /// Inner node: index of the second child (the first child follows its parent). Leaf: index of the first region.
    at: u32,
    /// Number of regions; 0 for an inner node.
    count: u32,
}

impl RegionTree {
    /// Builds a tree over pairs of region index and box; all boxes must be finite.
    pub(crate) fn new(mut items: Vec<(u32, Aabb)>) -> Self {
        let mut tree = Self::default();
        if !items.is_empty() {
            tree.build(&mut items);
        }
        tree
    }

    fn build(&mut self, items: &mut [(u32, Aabb)]) {
        let bounds = items.iter().fold(Aabb::EMPTY, |b, (_, i)| b.union(i));
        let node = self.nodes.len();
        let (at, count) = (self.regions.len() as u32, items.len() as u32);
        self.nodes.push(Node { bounds, at, count });
        if items.len() <= LEAF {
            self.regions.extend(items.iter().map(|(r, _)| r));
            self.boxes.extend(items.iter().map(|(_, b)| b));
            return;
        }
        let centers = Aabb::from_points(items.iter().map(|(_, b)| b.center()));
        let extent = centers.extent();
        let axis = (0..3).max_by(|a, b| extent[*a].total_cmp(&extent[*b])).unwrap_or(0);
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |(i, a), (j, b)| {
            a.center()[axis].total_cmp(&b.center()[axis]).then(i.cmp(j))
        });
        let (first, second) = items.split_at_mut(middle);
        self.build(first);
        self.nodes[node].at = self.nodes.len() as u32;
        self.nodes[node].count = 0;
        self.build(second);
    }

    /// Calls `visit` for every region whose box overlaps `query`.
    #[inline]
    pub(crate) fn visit(&self, query: &Aabb, mut visit: impl FnMut(usize)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = [0_u32; DEPTH];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let index = stack[top];
            let node = &self.nodes[index as usize];
            if !node.bounds.overlaps(query) {
                continue;
            }
            if node.count == 0 {
                stack[top] = node.at;
                stack[top + 1] = index + 1;
                top += 2;
                continue;
            }
            for i in node.at as usize..(node.at + node.count) as usize {
                if self.boxes[i].overlaps(query) {
                    visit(self.regions[i] as usize);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Vec3;
    use proptest::prelude::*;

    fn boxes(n: usize) -> impl Strategy<Value = Vec<Aabb>> {
        let number = -1.0..1.0_f64;
        let cell = (number.clone(), number.clone(), number, 0.0..0.2_f64);
        let to_box = |(x, y, z, r)| Aabb::from_center(Vec3::new(x, y, z), Vec3::splat(r));
        proptest::collection::vec(cell.prop_map(to_box), 0..n)
    }

    proptest! {
        #[test]
        fn the_tree_agrees_with_a_linear_scan(items in boxes(200), query in boxes(8)) {
            let numbered = items.iter().enumerate().map(|(i, b)| (i as u32, *b)).collect();
            let tree = RegionTree::new(numbered);
            for q in query {
                let mut found = vec![];
                tree.visit(&q, |r| found.push(r));
                found.sort_unstable();
                let expected: Vec<usize> = (0..items.len()).filter(|i| items[*i].overlaps(&q)).collect();
                prop_assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn coincident_boxes_do_not_overflow_the_stack() {
        let b = Aabb::from_center(Vec3::ZERO, Vec3::splat(1.0));
        let tree = RegionTree::new((0..100_000).map(|i| (i, b)).collect());
        let mut count = 0;
        tree.visit(&b, |_| count += 1);
        assert_eq!(count, 100_000);
    }
}
