//! Equal answers on every instruction set: a hash over states, edges and uncertain pairs.

use crate::common::{Random, RandomGeometry, obstacle_set, obstacles};
use elbowroom_spatial::Pose;
use elbowroom_testkit::hash::Fnv;
use elbowroom_validity::{CoveredRobot, NotCertain, ValidityChecker};
use fearless_simd::Level as SimdLevel;

/// Expected hash. It changes if an answer changes: only on purpose, with the covers or the division of edges.
const EXPECTED: u64 = 0xd0e2_e60b_a8bb_4f3d;

/// The instruction sets of this processor.
pub fn simd_levels() -> Vec<SimdLevel> {
    let mut levels = vec![SimdLevel::new()];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(levels[0].as_sse2().map(SimdLevel::Sse2));
        levels.extend(levels[0].as_sse4_2().map(SimdLevel::Sse4_2));
        levels.extend(levels[0].as_avx2().map(SimdLevel::Avx2));
    }
    levels
}

#[test]
fn every_instruction_set_gives_the_same_answers() {
    let levels = simd_levels();
    let mut hashes = vec![Fnv::default(); levels.len()];
    let mut random = Random(2024);
    for round in 0..2 {
        let joints = 3 + random.index(5);
        let robot = random.robot(joints);
        let solids = obstacles(&mut random, [4, 20][round % 2], 1.2);
        let set = obstacle_set(&solids);
        let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
        let dof = robot.chain.dof();
        let q: Vec<f64> = (0..64).flat_map(|_| random.q(&robot.chain)).collect();
        let near: Vec<f64> = q.iter().map(|v| v * 0.9).collect();
        for (&level, hash) in levels.iter().zip(&mut hashes) {
            let mut checker = ValidityChecker::new(&covered, &set).with_simd_level(level);
            let mut answers = Vec::new();
            checker.states(&q, &mut answers).unwrap();
            for &answer in &answers {
                hash.add(answer as u64);
            }
            let mut pairs = Vec::new();
            // A fused sum in software takes a hundred times as long.
            for (i, (from, to)) in q.chunks(dof).zip(near.chunks(dof)).enumerate().step_by(2) {
                hash.add(u64::from(checker.edge_is_free(from, to).unwrap()));
                if i % 16 == 0 {
                    checker.uncertain_pairs(from, to, &mut pairs).unwrap();
                    for pair in &pairs {
                        let (a, b) = match *pair {
                            NotCertain::Links(a, b) => (a.0, 1000 + b.0),
                            NotCertain::Obstacle(a, b) => (a.0, b),
                        };
                        hash.add(a as u64);
                        hash.add(b as u64);
                    }
                }
            }
        }
    }
    for (level, hash) in levels.iter().zip(&hashes) {
        assert_eq!(hash.0, EXPECTED, "{level:?}: {:#x}", hash.0);
    }
}
