//! Pairs of a node and an obstacle: those still to visit, and what ended the last tests of segments.

/// Number of pairs that are remembered. More are found again more often, but each costs every segment that is free.
const MOST: usize = 4;

/// A node of a body and an obstacle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeObstacle {
    pub body: u32,
    pub node: u32,
    pub obstacle: u32,
}

/// Pairs of a node and an obstacle.
#[derive(Debug, Clone, Default)]
pub(crate) struct NodeObstacles {
    /// Nodes whose children are still to visit.
    pub open: Vec<NodeObstacle>,
    /// Pairs that touched on segments, the latest first: where many segments fail, most touch what others touched.
    recent: Vec<NodeObstacle>,
}

impl NodeObstacles {
    /// Forgets what touched.
    pub fn forget(&mut self) {
        self.recent.clear();
    }

    /// Remembers a pair that touched, in place of the one that touched longest ago.
    pub fn touched(&mut self, pair: NodeObstacle) {
        self.recent.truncate(MOST - 1);
        self.recent.insert(0, pair);
    }

    /// The remembered pair at a place, if there is one.
    #[inline]
    pub fn recent(&self, place: usize) -> Option<NodeObstacle> {
        self.recent.get(place).copied()
    }

    /// Notes that the pair at a place touched again.
    pub fn touched_again(&mut self, place: usize) {
        self.recent[..=place].rotate_right(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_pairs_come_first_and_the_others_are_forgotten() {
        let mut pairs = NodeObstacles::default();
        let nodes = |pairs: &NodeObstacles| pairs.recent.iter().map(|pair| pair.node).collect::<Vec<_>>();
        (0..5).for_each(|node| pairs.touched(NodeObstacle { body: 0, node, obstacle: 7 }));
        assert_eq!(nodes(&pairs), [4, 3, 2, 1]);
        pairs.touched_again(2);
        assert_eq!(nodes(&pairs), [2, 4, 3, 1]);
        assert_eq!(pairs.recent(1).map(|pair| pair.node), Some(4));
        assert!(pairs.recent(4).is_none());
        pairs.forget();
        assert!(pairs.recent(0).is_none());
    }
}
