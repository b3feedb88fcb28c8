//! Exclusion and progress under random schedules of faults, with simulated arms. `ELBOWROOM_SCHEDULES=100000` runs that many.

#![allow(clippy::print_stdout, reason = "figures of a test")]

mod common;

use common::{Findings, PlantedFault, World};

const LENGTH_MS: u64 = 20_000;

fn schedule(seed: u64, planted: PlantedFault) -> Findings {
    let robots = 2 + (seed % 3) as usize;
    World::new(robots, 1 + seed, planted).run(LENGTH_MS)
}

fn run(schedules: u64) -> Findings {
    let mut all = Findings::default();
    for seed in 0..schedules {
        let findings = schedule(seed, PlantedFault::None);
        if findings.double_occupancies > 0 || findings.stuck > 0 {
            println!("seed {seed}: {findings:?}");
        }
        all.double_occupancies += findings.double_occupancies;
        all.stuck += findings.stuck;
        all.passages += findings.passages;
        all.clears += findings.clears;
        all.restarts += findings.restarts;
        all.longest_wait_ms = all.longest_wait_ms.max(findings.longest_wait_ms);
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
    assert_eq!((findings.double_occupancies, findings.stuck), (0, 0));
    assert!(findings.passages > 0 && findings.clears > 0 && findings.restarts > 0, "{findings:?}");
}

#[test]
fn planted_faults_are_found() {
    for planted in [PlantedFault::EndlessValidity, PlantedFault::TokensUnchecked, PlantedFault::UnilateralRelease] {
        let first = (0..5_000).find(|seed| schedule(*seed, planted).double_occupancies > 0);
        println!("{planted:?} is noticed in schedule {first:?}");
        assert!(first.is_some(), "{planted:?} is not noticed");
    }
}
