//! The wait-for graph of robots, and its cycles.

use crate::{RobotSet, RobotSlot};

/// The wait-for graph of the first 128 robots of a cell; a deadlock is a cycle in it. Never allocates.
///
/// The caller defines what waiting means: for a slot that another robot holds, or at a region that another robot
/// carries.
///
/// ```
/// use elbowroom_interlock::{RobotSlot, WaitForGraph};
/// let mut graph = WaitForGraph::default();
/// graph.add(RobotSlot(0), RobotSlot(1));
/// graph.add(RobotSlot(2), RobotSlot(0));
/// assert!(graph.cycle(RobotSlot(2)).is_empty());
/// graph.add(RobotSlot(1), RobotSlot(0));
/// assert_eq!(graph.cycle(RobotSlot(0)).iter().collect::<Vec<_>>(), [RobotSlot(0), RobotSlot(1)]);
/// ```
#[derive(Debug, Clone)]
pub struct WaitForGraph {
    /// The robots that each robot waits for directly.
    awaited: [RobotSet; RobotSet::CAPACITY],
}

impl Default for WaitForGraph {
    fn default() -> Self {
        Self { awaited: [RobotSet::default(); RobotSet::CAPACITY] }
    }
}

impl WaitForGraph {
    /// Records that one robot waits for another.
    pub fn add(&mut self, waiting: RobotSlot, awaited: RobotSlot) {
        if let Some(set) = self.awaited.get_mut(waiting.0) {
            set.insert(awaited);
        }
    }

    /// The robots that this one waits for, directly or through others; includes itself if it is in a cycle.
    pub fn reached_from(&self, robot: RobotSlot) -> RobotSet {
        let direct = |robot: RobotSlot| self.awaited.get(robot.0).copied().unwrap_or_default();
        let mut reached = direct(robot);
        let mut open = reached;
        while !open.is_empty() {
            let next = open.iter().map(direct).fold(RobotSet::default(), RobotSet::union);
            open = next.difference(reached);
            reached = reached.union(next);
        }
        reached
    }

    /// The robots that wait for this one and that it waits for, including itself; empty if it is in no cycle.
    pub fn cycle(&self, robot: RobotSlot) -> RobotSet {
        let reached = self.reached_from(robot);
        if !reached.contains(robot) {
            return RobotSet::default();
        }
        reached.iter().filter(|other| self.reached_from(*other).contains(robot)).collect()
    }

    /// The cycles, in the order of their first robots. Cycles that share a robot count as one.
    pub fn cycles(&self) -> impl Iterator<Item = RobotSet> {
        let mut seen = RobotSet::default();
        (0..RobotSet::CAPACITY).map(RobotSlot).filter_map(move |robot| {
            let cycle = if seen.contains(robot) { RobotSet::default() } else { self.cycle(robot) };
            seen = seen.union(cycle);
            (!cycle.is_empty()).then_some(cycle)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn graph(edges: &[(usize, usize)]) -> WaitForGraph {
        let mut graph = WaitForGraph::default();
        for (from, to) in edges {
            graph.add(RobotSlot(*from), RobotSlot(*to));
        }
        graph
    }

    fn cycles(edges: &[(usize, usize)]) -> Vec<Vec<usize>> {
        graph(edges).cycles().map(|cycle| cycle.iter().map(|robot| robot.0).collect()).collect()
    }

    #[test]
    fn cycles_are_found_and_chains_are_none() {
        assert!(cycles(&[(1, 0), (2, 1)]).is_empty());
        assert_eq!(cycles(&[(1, 0), (2, 1), (0, 2)]), [[0, 1, 2]]);
        // A robot outside a cycle waits for a robot in it.
        assert_eq!(cycles(&[(0, 1), (2, 1), (1, 2)]), [[1, 2]]);
        assert_eq!(cycles(&[(2, 0), (0, 2), (3, 1), (1, 3)]), [[0, 2], [1, 3]]);
        assert_eq!(cycles(&[(127, 5), (5, 127)]), [[5, 127]]);
    }

    #[test]
    fn a_robot_beyond_the_capacity_is_in_no_cycle() {
        assert!(cycles(&[(128, 0), (0, 128)]).is_empty());
        assert!(graph(&[]).cycle(RobotSlot(1000)).is_empty());
    }

    proptest! {
        /// Comparison with the closure by Warshall's algorithm.
        #[test]
        fn cycles_are_the_components_of_the_closure(edges in prop::collection::vec((0..9_usize, 0..9_usize), 0..14)) {
            let mut reaches = [[false; 9]; 9];
            for (from, to) in &edges {
                reaches[*from][*to] = true;
            }
            for (via, from, to) in (0..9).flat_map(|v| (0..9).flat_map(move |f| (0..9).map(move |t| (v, f, t)))) {
                reaches[from][to] |= reaches[from][via] && reaches[via][to];
            }
            let graph = graph(&edges);
            for robot in 0..9 {
                let cycle = graph.cycle(RobotSlot(robot));
                for other in 0..9 {
                    prop_assert_eq!(graph.reached_from(RobotSlot(robot)).contains(RobotSlot(other)), reaches[robot][other]);
                    let expected = reaches[robot][robot] && reaches[robot][other] && reaches[other][robot];
                    prop_assert_eq!(cycle.contains(RobotSlot(other)), expected);
                }
            }
            let listed: Vec<usize> = graph.cycles().flat_map(|cycle| cycle.iter().map(|robot| robot.0).collect::<Vec<_>>()).collect();
            let mut sorted = listed.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..9).filter(|robot| reaches[*robot][*robot]).collect::<Vec<_>>());
        }
    }
}
