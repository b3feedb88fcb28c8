//! What ended the last tests of segments: where many segments fail, most touch what others touched.

use super::workspace::NodeObstacle;

/// Number of pairs. More are found again more often, but each costs every segment that is free.
const MOST: usize = 4;

/// Nodes of links and obstacles that touched on segments, the latest first.
#[derive(Debug, Clone, Default)]
pub(crate) struct RecentTouches {
    pairs: Vec<NodeObstacle>,
}

impl RecentTouches {
    pub fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Adds a pair that touched, in place of the one that touched longest ago.
    pub fn add(&mut self, pair: NodeObstacle) {
        self.pairs.truncate(MOST - 1);
        self.pairs.insert(0, pair);
    }

    /// The pair at a place, if there is one.
    #[inline]
    pub fn get(&self, place: usize) -> Option<NodeObstacle> {
        self.pairs.get(place).copied()
    }

    /// Notes that the pair at a place touched again.
    pub fn touched_again(&mut self, place: usize) {
        self.pairs[..=place].rotate_right(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_pairs_come_first_and_the_others_are_forgotten() {
        let mut recent = RecentTouches::default();
        let nodes = |recent: &RecentTouches| recent.pairs.iter().map(|pair| pair.node).collect::<Vec<_>>();
        (0..5).for_each(|node| recent.add(NodeObstacle { body: 0, node, obstacle: 7 }));
        assert_eq!(nodes(&recent), [4, 3, 2, 1]);
        recent.touched_again(2);
        assert_eq!(nodes(&recent), [2, 4, 3, 1]);
        assert_eq!(recent.get(1).map(|pair| pair.node), Some(4));
        assert!(recent.get(4).is_none());
        recent.clear();
        assert!(recent.get(0).is_none());
    }
}
