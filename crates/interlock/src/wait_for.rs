//! Robots that wait for each other.

use elbowroom_monitor::{RobotSlot, SlotId};

use crate::slot_record::SlotRecord;

/// One robot waits for a slot that another one holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wait {
    pub(crate) robot: RobotSlot,
    pub(crate) slot: SlotId,
    pub(crate) holder: RobotSlot,
}

/// A circle of waits, each for what the robot of the next one holds; `None` where there is none.
pub(crate) fn cycle(slots: &[SlotRecord], robots: usize) -> Option<Vec<Wait>> {
    (0..robots).find_map(|start| {
        let mut path = Vec::new();
        let mut seen = vec![false; robots];
        reaches(slots, RobotSlot(start), RobotSlot(start), &mut seen, &mut path).then_some(path)
    })
}

/// Whether waits lead from `robot` to `goal`; `path` has them then.
fn reaches(slots: &[SlotRecord], robot: RobotSlot, goal: RobotSlot, seen: &mut [bool], path: &mut Vec<Wait>) -> bool {
    for (s, slot) in slots.iter().enumerate() {
        let Some(holder) = slot.holder.map(|h| h.robot).filter(|h| *h != robot) else { continue };
        if !slot.queue.contains(&robot) || seen[holder.0] && holder != goal {
            continue;
        }
        path.push(Wait { robot, slot: SlotId(s), holder });
        seen[holder.0] = true;
        if holder == goal || reaches(slots, holder, goal, seen, path) {
            return true;
        }
        path.pop();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slot_record::Holder;

    fn slot(holder: Option<usize>, queue: &[usize]) -> SlotRecord {
        let holder = holder.map(|robot| Holder { robot: RobotSlot(robot), token: None });
        SlotRecord { holder, queue: queue.iter().map(|r| RobotSlot(*r)).collect(), ..SlotRecord::default() }
    }

    #[test]
    fn circles_are_found_and_chains_are_none() {
        let chain = [slot(Some(0), &[1]), slot(Some(1), &[2]), slot(None, &[0])];
        assert_eq!(cycle(&chain, 3), None);
        let circle = [slot(Some(0), &[1]), slot(Some(1), &[2]), slot(Some(2), &[0])];
        let waits = cycle(&circle, 3).unwrap();
        assert_eq!(waits.len(), 3);
        assert!(waits.windows(2).all(|w| w[0].holder == w[1].robot) && waits[2].holder == waits[0].robot);
        // A robot outside waits for one of a circle.
        let tail = [slot(Some(1), &[0, 2]), slot(Some(2), &[1])];
        assert_eq!(cycle(&tail, 3).unwrap().len(), 2);
    }
}
