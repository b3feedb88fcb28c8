//! A tick does not allocate once the number of pairs and the length of the sweeps have been reached before. Runs
//! without the test harness, whose threads allocate.

mod common;

use common::{Ball, DT, avoider, scene};
use elbowroom_avoidance::{DynamicObstacles, PathKind, Reference};
use elbowroom_robot::ObjectId;
use elbowroom_spatial::Vec3;
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let scene = scene();
    let lean = [0.0, 0.9, 0.6];
    let mut avoider = avoider(&scene, &lean);
    let reference = Reference { q: &lean, qd: &[0.0; 3], speed_share: 1.0, path: PathKind::PointToPoint };
    let from = Vec3::new(0.62, -1.5, 0.5);
    let ball = Ball { object: ObjectId(1), from, velocity: Vec3::new(0.0, 0.9, 0.0), stops_s: f64::INFINITY };
    let mut pass = || {
        let mut corrected = 0;
        for tick in 0..900 {
            let objects = [ball.observed(f64::from(tick) * DT)];
            let output =
                avoider.tick(DT, &reference, &DynamicObstacles { objects: &objects, robots: &[] }, 1.0).unwrap();
            corrected += usize::from(output.reaction.size > 0.0);
        }
        corrected
    };
    // Sweeps allocate if they are longer than all before.
    for _ in 0..3 {
        assert!(pass() > 100);
    }
    let counter = AllocationCounter::start();
    let corrected = pass();
    assert_eq!(counter.allocations(), 0);
    assert!(corrected > 100);
}
