//! Exclusion and progress under random schedules of faults, with simulated arms.
//!
//! `ELBOWROOM_SCHEDULES=100000` runs that many schedules, `ELBOWROOM_SCHEDULES=500..501` that one.

#![allow(clippy::print_stdout, reason = "figures of a test")]

use std::ops::Range;

use crate::common::{Findings, PlantedFault, World};

const LENGTH_MS: u64 = 20_000;

fn schedule(seed: u64, planted: PlantedFault) -> Findings {
    let robots = 2 + (seed % 3) as usize;
    World::new(robots, 1 + seed, planted).run(LENGTH_MS)
}

/// The findings that must not occur.
fn wrong(findings: &Findings) -> [u64; 3] {
    [findings.double_occupancies, findings.stuck, findings.unresolved_deadlocks]
}

fn run(seeds: Range<u64>) -> Findings {
    let mut all = Findings::default();
    for seed in seeds.clone() {
        let findings = schedule(seed, PlantedFault::None);
        if wrong(&findings) != [0; 3] {
            println!("seed {seed}: {findings:?}");
        }
        all.add(&findings);
    }
    println!("schedules {seeds:?} of {LENGTH_MS} ms: {all:?}");
    all
}

/// The seeds to run: `ELBOWROOM_SCHEDULES` is their number or range (`20000..30000`).
fn seeds(default: u64) -> Range<u64> {
    let text = std::env::var("ELBOWROOM_SCHEDULES").unwrap_or_default();
    let (from, to) = text.split_once("..").unwrap_or(("0", &text));
    from.parse().unwrap_or(0)..to.parse().unwrap_or(default)
}

#[test]
fn no_region_is_ever_shared_and_nobody_is_stuck() {
    let seeds = seeds(300);
    let are_many = seeds.clone().count() >= 100;
    let findings = run(seeds);
    assert_eq!(wrong(&findings), [0; 3]);
    let happened =
        [findings.passages, findings.clears, findings.restarts, findings.second_arbiters, findings.switched_off];
    assert!(!are_many || happened.iter().all(|n| *n > 0), "{findings:?}");
}

#[test]
fn planted_faults_are_found() {
    for planted in [PlantedFault::EndlessValidity, PlantedFault::UnilateralRelease] {
        let first = (0..1_000).find(|seed| schedule(*seed, planted).double_occupancies > 0);
        println!("{planted:?} is noticed in schedule {first:?}");
        assert!(first.is_some(), "{planted:?} is not noticed");
    }
}
