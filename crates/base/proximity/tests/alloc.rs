//! Test that queries of a control tick do not allocate.
//!
//! It runs without the test harness, whose threads allocate too: the counter is for the whole process.
mod common;

use std::hint::black_box;

use common::{RandomGeometry, SplitMix};
use elbowroom_proximity::{collides, penetration, project_point, separation, separation_within, within};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

const PRIMITIVES: [&str; 5] = ["sphere", "capsule", "cylinder", "box", "plane"];
const KINDS: [&str; 7] = ["sphere", "capsule", "cylinder", "box", "plane", "hull", "mesh"];

fn main() {
    let mut rng = SplitMix(31);
    let mut apart = 0;
    for (first, second) in KINDS.iter().flat_map(|a| KINDS.map(|b| (*a, b))) {
        for _ in 0..100 {
            let (a, b, pa, pb) = (rng.shape(first), rng.shape(second), rng.pose(1.0), rng.pose(1.0));
            let (p, limit) = (rng.vec(1.0), rng.between(0.0, 0.5));
            let counter = AllocationCounter::start();
            let s = separation(&a, &pa, &b, &pb);
            black_box(separation_within(&a, &pa, &b, &pb, limit));
            black_box((collides(&a, &pa, &b, &pb), within(&a, &pa, &b, &pb, limit), project_point(&a, &pa, p)));
            if PRIMITIVES.contains(&first) && PRIMITIVES.contains(&second) {
                black_box(penetration(&a, &pa, &b, &pb));
            }
            assert_eq!(counter.changes(), 0, "{first} {second}");
            apart += usize::from(s.distance > 0.0);
        }
    }
    assert!(apart > 1000 && apart < 4000, "{apart} of 4900 apart: too few of one kind");
}
