//! Test that steps of a virtual robot do not allocate, but where an arm searches for its joint values at another grasp, and
//! where pairs of a hand-over are met for the first time.
//!
//! It runs without the test harness, whose threads allocate too: the counter is for the whole process.
mod common;

use common::{DT_S, PER_ROW, Pair, desire_in_step, part_pose, straight};
use elbowroom_cooperation::CooperationSettings;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

/// Steps in which lists of pairs are made.
const FIRST_STEPS: usize = 12;

fn main() {
    let seen = |pair: Pair| pair.seen_from(Vec3::new(0.0, 1.5, 0.6), Vec3::new(0.0, 0.0, 0.45));
    let (aside, across) = (Vec3::Y * 0.05, Vec3::X * 0.28);
    for (pair, by, hand_overs) in [
        (Pair::new(2, 0.6).with_one_hand(), aside, 0),
        (Pair::new(3, 0.7).with_one_hand(), aside, 0),
        (Pair::new(2, 0.6), across, 1),
        (Pair::new(3, 0.7), across, 1),
        (seen(Pair::new(2, 0.6)), across, 1),
    ] {
        let carried = carry(&pair, by);
        assert_eq!(carried.hand_overs, hand_overs);
        assert!(carried.steps > 300, "{} steps", carried.steps);
        assert!(20 * carried.allocating < carried.steps, "{} of {} steps", carried.allocating, carried.steps);
    }
}

struct Carried {
    hand_overs: usize,
    steps: usize,
    /// Number of steps that allocated.
    allocating: usize,
}

/// Carries the bar along a straight line.
fn carry(pair: &Pair, by: Vec3) -> Carried {
    let mut robot = pair.robot(CooperationSettings::default());
    let start = part_pose(pair);
    let motion = straight(start, Pose::new(start.rotation, start.translation + by), 0.05);
    let overrides = vec![1.0; pair.members.len()];
    let mut carried = Carried { hand_overs: 0, steps: 0, allocating: 0 };
    for k in 0..PER_ROW * motion.len() + 500 {
        desire_in_step(&mut robot, &motion, k);
        let counter = AllocationCounter::start();
        let step = robot.step(DT_S, &overrides);
        let changes = counter.changes();
        carried.hand_overs += usize::from(step.handed_over.is_some());
        carried.steps += usize::from(k > FIRST_STEPS);
        carried.allocating += usize::from(k > FIRST_STEPS && changes > 0);
    }
    carried
}
