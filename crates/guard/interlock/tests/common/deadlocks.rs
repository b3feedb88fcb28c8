//! Resolvable deadlocks: robots wait for each other in a cycle, and one of them can stop outside the slots that it
//! holds.

use elbowroom_interlock::{Arbiter, RobotSlot, SlotId};

use super::arm::{Arm, REGIONS};

/// Time within which a resolvable cycle must be resolved if nothing fails meanwhile.
const RESOLVED_WITHIN_MS: u64 = 300;
/// Interval between two searches for cycles.
const LOOK_MS: u64 = 10;

/// Watches one arbiter.
#[derive(Debug, Default)]
pub struct DeadlockWatch {
    robots: Vec<usize>,
    since_ms: u64,
}

impl DeadlockWatch {
    /// True once for each cycle that lasts too long.
    pub fn is_unresolved(&mut self, arbiter: &Arbiter, arms: &[Arm], ms: u64) -> bool {
        if !ms.is_multiple_of(LOOK_MS) {
            return false;
        }
        let robots = resolvable_circle(arbiter, arms);
        if robots.is_empty() || robots != self.robots {
            *self = Self { robots, since_ms: ms };
        }
        !self.robots.is_empty() && ms == self.since_ms + RESOLVED_WITHIN_MS
    }
}

/// The robots of cycles in which one robot can stop outside the slots that the others need; empty without such
/// cycles.
fn resolvable_circle(arbiter: &Arbiter, arms: &[Arm]) -> Vec<usize> {
    let waits = |robot: usize, slot: usize| arbiter.queue(SlotId(slot)).contains(&RobotSlot(robot));
    let holder = |slot: usize| arbiter.holder(SlotId(slot)).map(|robot| robot.0);
    // reaches[a][b]: a waits for a slot that b holds, directly or through other robots.
    let n = arms.len();
    let mut reaches = vec![vec![false; n]; n];
    for (robot, row) in reaches.iter_mut().enumerate() {
        for slot in (0..REGIONS).filter(|slot| waits(robot, *slot)) {
            holder(slot).filter(|h| *h != robot).into_iter().for_each(|h| row[h] = true);
        }
    }
    for (via, from, to) in (0..n * n * n).map(|i| (i / n / n, i / n % n, i % n)) {
        reaches[from][to] |= reaches[from][via] && reaches[via][to];
    }
    let can_yield = |robot: usize| {
        let held = (0..REGIONS).filter(|slot| holder(*slot) == Some(robot));
        let mut needed = held.filter(|slot| (0..n).any(|other| waits(other, *slot) && reaches[robot][other]));
        needed.any(|slot| arms[robot].can_stay_out(SlotId(slot)))
    };
    let circle: Vec<usize> = (0..n).filter(|robot| reaches[*robot][*robot]).collect();
    if circle.iter().any(|robot| can_yield(*robot)) { circle } else { Vec::new() }
}
