//! Shoulder, elbow and wrist of six axes with a spherical wrist.

use std::collections::HashSet;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::{RandomGeometry, SplitMix, disguised_wrist_arm};
use elbowroom_kinematics::dh::ClassicalRow;
use elbowroom_kinematics::inverse::{ArmConfiguration, Elbow, IkOptions, IkSolver, Shoulder, Wrist};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits};
use elbowroom_spatial::{Pose, Vec3};

fn solver(chain: &Chain) -> IkSolver {
    IkSolver::new(chain, chain.tip(), Pose::IDENTITY, IkOptions::default())
}

fn forward(chain: &Chain, q: &[f64]) -> ChainState {
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(q);
    chain.forward(&mut state);
    state
}

/// An arm with its shoulder 0.3 m ahead of axis 1, an upper arm of 0.7 m that is upright at zero, and a level
/// forearm.
fn arm() -> Chain {
    let rows = [
        (0.300, FRAC_PI_2, 0.600, 0.0),
        (0.700, 0.0, 0.0, FRAC_PI_2),
        (0.0, FRAC_PI_2, 0.0, 0.0),
        (0.0, -FRAC_PI_2, 0.624, 0.0),
        (0.0, FRAC_PI_2, 0.0, 0.0),
        (0.0, 0.0, 0.120, 0.0),
    ];
    let row = |(i, (a, alpha, d, theta)): (usize, (f64, f64, f64, f64))| ClassicalRow {
        joint: format!("joint_{}", i + 1),
        kind: JointKind::Revolute,
        a,
        alpha,
        d,
        theta,
        limits: Limits::symmetric(PI),
    };
    Chain::from_dh("arm", &rows.into_iter().enumerate().map(row).collect::<Vec<_>>()).unwrap()
}

#[test]
fn postures_known_by_sight() {
    let chain = arm();
    let solver = solver(&chain);
    let at = |q: [f64; 6]| solver.configuration(&q).unwrap().to_string();
    for turned in [-3.0, -1.0, 0.0, 2.5] {
        assert_eq!(at([turned, 0.0, 0.0, 0.0, 0.4, 0.0]), "front up no_flip");
        assert_eq!(at([turned, 0.0, 0.0, 0.0, -0.4, 0.0]), "front up flip");
        // The upper arm leans forward, and the forearm rises.
        assert_eq!(at([turned, -2.0, 1.9, 0.0, 0.4, 0.0]), "front down no_flip");
        // The upper arm leans back; the forearm is bent up from it, or hangs over to the back.
        assert_eq!(at([turned, 0.9, 1.5, 0.0, 0.4, 0.0]), "back down no_flip");
        assert_eq!(at([turned, 0.9, 2.2, 0.0, 0.4, 3.0]), "back up no_flip");
    }
    assert_eq!(solver.configuration(&[0.0; 5]), None);
    assert_eq!(solver.configuration(&[f64::NAN; 6]), None);
}

#[test]
fn the_geometry_of_the_links_says_the_same() {
    let chain = arm();
    let mut solver = solver(&chain);
    let mut random = SplitMix(3);
    let (mut q, mut seen) = (vec![0.0; 6], HashSet::new());
    for _ in 0..500 {
        random.state(&chain, &mut q);
        let target = forward(&chain, &q).link_in_root(chain.tip());
        for answer in solver.solve_all(&target, &[0.0; 6]) {
            let state = forward(&chain, &answer);
            let at = |row: &str| state.link_in_root(chain.link(row).unwrap()).translation;
            let ahead = Vec3::new(answer[0].cos(), answer[0].sin(), 0.0);
            let (shoulder, elbow, wrist) = (at("link_1"), at("link_2"), at("link_4"));
            let flat = |p: Vec3| (p.dot(ahead), p.z);
            let (s, e, w) = (flat(shoulder), flat(elbow), flat(wrist));
            let configuration = solver.configuration(&answer).unwrap();
            assert_eq!(configuration.shoulder == Shoulder::Front, w.0 >= 0.0);
            if w.0 > s.0 {
                // In front, compare with the height of the line at the elbow.
                let line = s.1 + (w.1 - s.1) * (e.0 - s.0) / (w.0 - s.0);
                assert_eq!(configuration.elbow == Elbow::Up, e.1 >= line, "{answer:?}");
            }
            assert_eq!(configuration.wrist == Wrist::NoFlip, answer[4].sin() >= 0.0);
            seen.insert(configuration);
        }
    }
    assert_eq!(seen.len(), 8);
}

#[test]
fn every_solution_has_a_name_of_its_own_in_any_frames() {
    let mut random = SplitMix(5);
    let mut all_eight = 0;
    for _ in 0..200 {
        let chain = disguised_wrist_arm(&mut random, PI);
        let mut solver = solver(&chain);
        for _ in 0..5 {
            let mut q = vec![0.0; 6];
            random.state(&chain, &mut q);
            let target = forward(&chain, &q).link_in_root(chain.tip());
            let all = solver.solve_all(&target, &q);
            let names: HashSet<ArmConfiguration> = all.iter().map(|q| solver.configuration(q).unwrap()).collect();
            assert_eq!(names.len(), all.len(), "{q:?} {all:?}");
            all_eight += usize::from(names.len() == 8);
        }
    }
    assert!(all_eight > 100, "{all_eight}");
}

#[test]
fn other_arms_have_no_names() {
    let rows: Vec<ClassicalRow> = (0..3)
        .map(|i| ClassicalRow {
            joint: format!("j{i}"),
            kind: JointKind::Revolute,
            a: 0.4,
            alpha: 0.0,
            d: 0.0,
            theta: 0.0,
            limits: Limits::symmetric(3.0),
        })
        .collect();
    let chain = Chain::from_dh("planar", &rows).unwrap();
    assert_eq!(solver(&chain).configuration(&[0.1; 3]), None);
}
