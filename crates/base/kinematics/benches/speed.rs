//! Times of forward kinematics: `cargo bench -p elbowroom-kinematics --bench speed`.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::f64::consts::FRAC_PI_2;
use std::hint::black_box;
use std::time::Instant;

use common::RandomGeometry;
use elbowroom_kinematics::dh::ClassicalRow;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointKind, Limits, LinkId};
use elbowroom_spatial::{Pose, Vec3};

/// Six revolute axes as in most URDF files, along z, y, y, x, y, x, and a fixed flange.
fn urdf_like() -> Chain {
    let axes = [Vec3::Z, Vec3::Y, Vec3::Y, Vec3::X, Vec3::Y, Vec3::X, Vec3::Z];
    let offsets = [(0.0, 0.45), (0.15, 0.0), (0.0, 0.6), (0.0, 0.1), (0.6, 0.0), (0.0, 0.0), (0.1, 0.0)]
        .map(|(x, z)| Vec3::new(x, 0.0, z));
    let joints = (0..7).map(|i| Joint {
        name: format!("joint_{}", i + 1),
        kind: if i < 6 { JointKind::Revolute } else { JointKind::Fixed },
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(offsets[i]),
        axis: axes[i],
        limits: Limits::symmetric(3.0),
        mimic: None,
    });
    Chain::new("arm", (0..8).map(|i| format!("link_{i}")).collect(), joints.collect()).expect("a sound chain")
}

fn by_table() -> Chain {
    let table = [
        (0.300, FRAC_PI_2, 0.600, 0.0),
        (0.700, 0.0, 0.0, FRAC_PI_2),
        (0.185, FRAC_PI_2, 0.0, 0.0),
        (0.0, -FRAC_PI_2, 0.624, 0.0),
        (0.0, FRAC_PI_2, 0.0, 0.0),
        (0.0, 0.0, 0.120, 0.0),
    ];
    let rows: Vec<_> = table
        .into_iter()
        .enumerate()
        .map(|(i, (a, alpha, d, theta))| ClassicalRow {
            joint: format!("joint_{}", i + 1),
            kind: JointKind::Revolute,
            a,
            alpha,
            d,
            theta,
            limits: Limits::symmetric(3.1),
        })
        .collect();
    Chain::from_dh("table", &rows).expect("a sound table")
}

fn nanoseconds(mut work: impl FnMut(usize)) -> f64 {
    let rounds = 20_000;
    (0..7)
        .map(|_| {
            let start = Instant::now();
            (0..rounds).for_each(&mut work);
            start.elapsed().as_secs_f64() * 1e9 / rounds as f64
        })
        .fold(f64::INFINITY, f64::min)
}

fn report(label: &str, chain: &Chain) {
    let n = chain.dof();
    let mut state = ChainState::new(chain);
    let vary = |state: &mut ChainState, i: usize| {
        for k in 0..n {
            state.q[k] = 0.3 * k as f64 + 1e-6 * i as f64;
            state.qd[k] = 0.1;
            state.qdd[k] = 0.2;
        }
    };
    let forward = nanoseconds(|i| {
        vary(&mut state, i);
        chain.forward(black_box(&mut state));
    });
    let motion = nanoseconds(|i| {
        vary(&mut state, i);
        chain.forward_motion(black_box(&mut state));
    });
    let (tip, mut columns) = (chain.tip(), vec![[0.0; 6]; n]);
    let jacobian = nanoseconds(|_| chain.jacobian(black_box(&state), tip, Vec3::Z, &mut columns));
    common::SplitMix(1).state(chain, &mut state.q);
    chain.forward(&mut state);
    let target = state.link_in_root(tip);
    let mut solver = IkSolver::new(chain, tip, Pose::IDENTITY, IkOptions::default());
    let near: Vec<f64> = state.q.iter().map(|v| v + 1e-3).collect();
    let mut q = near.clone();
    let refine = nanoseconds(|_| {
        q.copy_from_slice(&near);
        black_box(solver.refine(&target, &mut q));
    });
    let (links, joints) = (chain.links().len(), chain.joints().len());
    println!(
        "{label:<42}{links:>3} links {joints:>3} joints {forward:>7.0} {motion:>7.0} {jacobian:>7.0} {refine:>7.0}"
    );
}

fn main() {
    println!("nanoseconds (best of seven): forward, forward_motion, jacobian of the tip, refine from 1e-3 rad away");
    report("as in a URDF", &urdf_like());
    report("by DH table", &by_table());
    for (name, path) in common::robots() {
        report(&name, &common::load(&path));
    }
}
