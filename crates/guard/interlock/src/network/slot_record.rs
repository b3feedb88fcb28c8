//! The arbiter's record of a slot.

use crate::{RobotSlot, Token, WaitForGraph};

/// The arbiter's record of one slot.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub(super) struct SlotRecord {
    pub(super) holder: Option<Holder>,
    /// Robots that wait, in the order of their requests.
    pub(super) queue: Vec<RobotSlot>,
    /// Robots that were found inside while another robot held the slot, until they are seen outside or cleared.
    pub(super) intruders: Vec<RobotSlot>,
    /// True if the holder is asked to give the slot up.
    pub(super) release_requested: bool,
}

/// The robot that holds a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Holder {
    pub(super) robot: RobotSlot,
    /// The grant. `None` if the robot's guard has started again and has not reported where the robot is, or if the robot
    /// is committed without a grant; then the slot is neither confirmed nor granted to others.
    pub(super) token: Option<Token>,
}

impl SlotRecord {
    pub(super) fn is_held_by(&self, robot: RobotSlot) -> bool {
        self.holder.is_some_and(|holder| holder.robot == robot)
    }

    /// The grant, if this robot holds it.
    pub(super) fn token_of(&self, robot: RobotSlot) -> Option<Token> {
        self.holder.filter(|holder| holder.robot == robot).and_then(|holder| holder.token)
    }

    /// Whether the robot would close a cycle by holding this slot: another waiting robot would wait for it, and it waits
    /// for that robot.
    pub(super) fn would_close_cycle(&self, graph: &WaitForGraph, robot: RobotSlot) -> bool {
        let reached = graph.reached_from(robot);
        self.queue.iter().any(|waiting| *waiting != robot && reached.contains(*waiting))
    }
}

/// Builds the wait-for graph: a robot waits for the holders of the slots in whose queues it is.
pub(super) fn wait_for_graph(slots: &[SlotRecord]) -> WaitForGraph {
    let mut graph = WaitForGraph::default();
    for slot in slots {
        let Some(holder) = slot.holder else { continue };
        for waiting in slot.queue.iter().filter(|waiting| **waiting != holder.robot) {
            graph.add(*waiting, holder.robot);
        }
    }
    graph
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grant_that_would_close_a_cycle_is_seen() {
        let slot = |holder: Option<usize>, queue: &[usize]| {
            let holder = holder.map(|robot| Holder { robot: RobotSlot(robot), token: None });
            SlotRecord { holder, queue: queue.iter().map(|r| RobotSlot(*r)).collect(), ..SlotRecord::default() }
        };
        // Robot 0 waits for a slot that robot 1 holds, and robot 1 waits for the free slot.
        let slots = [slot(None, &[0, 1]), slot(Some(1), &[0])];
        let graph = wait_for_graph(&slots);
        assert!(slots[0].would_close_cycle(&graph, RobotSlot(0)) && !slots[0].would_close_cycle(&graph, RobotSlot(1)));
    }
}
