//! Exclusion and progress under random schedules of faults, with simulated arms. `ELBOWROOM_SCHEDULES=100000` runs that many.

#![allow(clippy::print_stdout, reason = "figures of a test")]

mod common;

use common::{Findings, PlantedFault, World};

const LENGTH_MS: u64 = 20_000;

fn schedule(seed: u64, planted: PlantedFault) -> Findings {
    let robots = 2 + (seed % 3) as usize;
    World::new(robots, 1 + seed, planted).run(LENGTH_MS)
}

/// What must not happen.
fn wrong(findings: &Findings) -> [u64; 3] {
    [findings.double_occupancies, findings.stuck, findings.unresolved_deadlocks]
}

fn run(schedules: u64) -> Findings {
    let mut all = Findings::default();
    for seed in 0..schedules {
        let findings = schedule(seed, PlantedFault::None);
        if wrong(&findings) != [0; 3] {
            println!("seed {seed}: {findings:?}");
        }
        all.add(&findings);
    }
    println!("{schedules} schedules of {LENGTH_MS} ms: {all:?}");
    all
}

fn schedules(default: u64) -> u64 {
    std::env::var("ELBOWROOM_SCHEDULES").ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

#[test]
fn no_region_is_ever_shared_and_nobody_is_stuck() {
    let findings = run(schedules(300));
    assert_eq!(wrong(&findings), [0; 3]);
    let happened =
        [findings.passages, findings.clears, findings.restarts, findings.second_arbiters, findings.switched_off];
    assert!(happened.iter().all(|n| *n > 0), "{findings:?}");
}

#[test]
fn planted_faults_are_found() {
    for planted in [PlantedFault::EndlessValidity, PlantedFault::UnilateralRelease] {
        let first = (0..1_000).find(|seed| schedule(*seed, planted).double_occupancies > 0);
        println!("{planted:?} is noticed in schedule {first:?}");
        assert!(first.is_some(), "{planted:?} is not noticed");
    }
}
