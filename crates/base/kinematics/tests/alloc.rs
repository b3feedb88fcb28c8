//! Test that the calls of a control tick do not allocate.
//!
//! It runs without the test harness, whose threads allocate too: the counter is for the whole process.
mod common;

use common::{RandomGeometry, SplitMix};
use elbowroom_kinematics::dh::ClassicalRow;
use elbowroom_kinematics::inverse::{IkMethod, IkOptions, IkSolver};
use elbowroom_kinematics::surface_ik::{OrientedPoint, PointChain, SurfaceIkOptions};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn arm(wrist_offset: f64) -> Chain {
    let quarter = std::f64::consts::FRAC_PI_2;
    let table = [
        (0.3, quarter, 0.6, 0.0),
        (0.7, 0.0, 0.0, quarter),
        (0.185, quarter, 0.0, 0.0),
        (wrist_offset, -quarter, 0.624, 0.0),
        (0.0, quarter, 0.0, 0.0),
        (0.0, 0.0, 0.12, 0.0),
    ];
    let row = |(i, (a, alpha, d, theta)): (usize, (f64, f64, f64, f64))| ClassicalRow {
        joint: format!("joint_{i}"),
        kind: JointKind::Revolute,
        a,
        alpha,
        d,
        theta,
        limits: Limits::symmetric(3.0),
    };
    Chain::from_dh("arm", &table.into_iter().enumerate().map(row).collect::<Vec<_>>()).unwrap()
}

fn main() {
    for (wrist_offset, method) in [(0.0, IkMethod::SphericalWrist), (0.1, IkMethod::Numeric)] {
        let chain = arm(wrist_offset);
        let mut state = ChainState::new(&chain);
        let mut solver =
            IkSolver::new(&chain, chain.tip(), Pose::from_translation(Vec3::Z * 0.2), IkOptions::default());
        assert_eq!(solver.method(), method);
        let (tip, mut columns, mut q) = (chain.tip(), [[0.0; 6]; 6], vec![0.0; 6]);
        let mut random = SplitMix(5);
        let mut refined = 0;
        let mut point = PointChain::new(&chain, tip, Vec3::X, Some(Vec3::X), SurfaceIkOptions::default()).unwrap();
        let (mut three, mut five, mut reached) = ([[0.0; 3]; 6], [[0.0; 5]; 6], 0);
        let counter = AllocationCounter::start();
        for round in 0..1000 {
            random.state(&chain, &mut q);
            point.set_point(random.vector(), Some(Vec3::new(1.0, 2.0, 3.0))).unwrap();
            let mut there = point.place(&q);
            if round % 2 == 0 {
                there.normal_in_root = None;
            }
            point.jacobian(&q, &mut three);
            point.jacobian_with_normal(&q, &mut five).unwrap();
            random.state(&chain, &mut q);
            reached += usize::from(point.solve(&there, &mut q).is_ok());
            // The target is out of reach: all starts are used.
            let far = OrientedPoint { point_in_root: there.point_in_root + Vec3::Z * 9.0, ..there };
            assert!(point.solve(&far, &mut q).is_err());
            let _ = point.refine(&there, &mut q, 5);
            random.state(&chain, &mut state.q);
            random.state(&chain, &mut state.qd);
            chain.forward(&mut state);
            chain.forward_motion(&mut state);
            chain.jacobian(&state, tip, Vec3::X, &mut columns);
            q.copy_from_slice(&state.q);
            for v in &mut q {
                *v = (*v + random.between(-1e-3, 1e-3)).clamp(-3.0, 3.0);
            }
            let target = state.link_in_root(tip) * Pose::from_translation(Vec3::Z * 0.2);
            refined += usize::from(solver.refine(&target, &mut q));
        }
        assert_eq!(counter.changes(), 0);
        assert!(refined > 990 && reached > 990, "{refined} {reached}");
    }
}
