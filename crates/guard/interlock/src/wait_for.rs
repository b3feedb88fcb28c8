//! Robots that wait for each other.

use elbowroom_monitor::RobotSlot;

use crate::slot_record::SlotRecord;

/// Which robot waits for which, directly or by way of others.
#[derive(Debug)]
pub(crate) struct WaitGraph {
    /// `reaches[a][b]`: a waits for what b holds, or for a robot that does.
    reaches: Vec<Vec<bool>>,
}

impl WaitGraph {
    pub(crate) fn new(slots: &[SlotRecord], robots: usize) -> Self {
        let mut reaches = vec![vec![false; robots]; robots];
        for slot in slots {
            let Some(holder) = slot.holder else { continue };
            for waiting in slot.queue.iter().filter(|waiting| **waiting != holder.robot) {
                reaches[waiting.0][holder.robot.0] = true;
            }
        }
        for (via, from) in (0..robots).flat_map(|via| (0..robots).map(move |from| (via, from))) {
            if reaches[from][via] {
                for to in 0..robots {
                    reaches[from][to] |= reaches[via][to];
                }
            }
        }
        Self { reaches }
    }

    /// The robots that wait for each other, one group per circle or per circles with a robot in common.
    pub(crate) fn circles(&self) -> Vec<Vec<RobotSlot>> {
        let mut circles: Vec<Vec<RobotSlot>> = Vec::new();
        for robot in (0..self.reaches.len()).filter(|robot| self.reaches[*robot][*robot]) {
            let is_in = |circle: &&mut Vec<RobotSlot>| {
                circle.iter().all(|other| self.reaches[robot][other.0] && self.reaches[other.0][robot])
            };
            match circles.iter_mut().find(is_in) {
                Some(circle) => circle.push(RobotSlot(robot)),
                None => circles.push(vec![RobotSlot(robot)]),
            }
        }
        circles
    }

    /// Whether the robot would wait for one that waits for it, if it held this slot.
    pub(crate) fn would_close(&self, slot: &SlotRecord, robot: RobotSlot) -> bool {
        slot.queue.iter().any(|waiting| *waiting != robot && self.reaches[robot.0][waiting.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slot_record::Holder;

    fn slot(holder: Option<usize>, queue: &[usize]) -> SlotRecord {
        let holder = holder.map(|robot| Holder { robot: RobotSlot(robot), token: None });
        SlotRecord { holder, queue: queue.iter().map(|r| RobotSlot(*r)).collect(), ..SlotRecord::default() }
    }

    fn circles(slots: &[SlotRecord], robots: usize) -> Vec<Vec<usize>> {
        let circles = WaitGraph::new(slots, robots).circles();
        circles.into_iter().map(|circle| circle.into_iter().map(|robot| robot.0).collect()).collect()
    }

    #[test]
    fn circles_are_found_and_chains_are_none() {
        let chain = [slot(Some(0), &[1]), slot(Some(1), &[2]), slot(None, &[0])];
        assert!(circles(&chain, 3).is_empty());
        let circle = [slot(Some(0), &[1]), slot(Some(1), &[2]), slot(Some(2), &[0])];
        assert_eq!(circles(&circle, 3), [[0, 1, 2]]);
        // A robot outside waits for one of a circle.
        let tail = [slot(Some(1), &[0, 2]), slot(Some(2), &[1])];
        assert_eq!(circles(&tail, 3), [[1, 2]]);
        let two = [slot(Some(0), &[2]), slot(Some(2), &[0]), slot(Some(1), &[3]), slot(Some(3), &[1])];
        assert_eq!(circles(&two, 4), [[0, 2], [1, 3]]);
    }

    #[test]
    fn a_grant_that_would_close_a_circle_is_seen() {
        // Robot 0 waits for what 1 holds, which waits for the free slot.
        let slots = [slot(None, &[0, 1]), slot(Some(1), &[0])];
        let graph = WaitGraph::new(&slots, 2);
        assert!(graph.would_close(&slots[0], RobotSlot(0)) && !graph.would_close(&slots[0], RobotSlot(1)));
    }
}
