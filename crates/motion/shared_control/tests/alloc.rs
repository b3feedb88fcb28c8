//! Test that steps of a navigator do not allocate.
//!
//! It runs without the test harness, whose threads allocate too: the counter is for the whole process.
mod common;

use common::{ball, block, point, relief};
use elbowroom_shared_control::{NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::random::SplitMix;

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let plate = ProtectedSurface::new(block(Vec3::new(0.3, 0.3, 1e-4)), Pose::from_translation(Vec3::Z * 0.06));
    let surfaces = vec![ProtectedSurface::new(relief(24), Pose::IDENTITY).unwrap(), plate.unwrap()];
    let start = Pose::from_translation(Vec3::Z * 0.03);
    let settings = NavigatorSettings { speed_m_s: 2.0, ..Default::default() };
    let mut navigator = SurfaceNavigator::new(ball(0.01, 3), surfaces, start, settings).unwrap();
    let mut random = SplitMix(1);
    let mut in_contact = 0;
    for _ in 0..300 {
        let desired = Pose::from_translation(point(&mut random, 0.1) - Vec3::Z * 0.05);
        let counter = AllocationCounter::start();
        for _ in 0..20 {
            in_contact += usize::from(navigator.step(&desired, 1e-3).active_rows > 0);
        }
        assert_eq!(counter.changes(), 0);
    }
    assert!(in_contact > 500, "{in_contact} of 6000 steps in contact");
}
