//! Projection of a velocity onto its constraints, compared with trying every set of active rows.

use elbowroom_shared_control::{Contradiction, LinearConstraint, project_onto_constraints};
use elbowroom_spatial::Vec3;
use elbowroom_spatial::linalg::solve_spd;
use elbowroom_testkit::random::SplitMix;
use proptest::prelude::*;

/// The nearest admissible velocity among the projections onto the planes of up to three rows.
fn by_enumeration(desired: Vec3, rows: &[LinearConstraint]) -> Option<Vec3> {
    let longest = 1e3 * rows.iter().map(|r| r.least.abs()).fold(desired.length(), f64::max);
    let keeps = |v: &Vec3| v.length() < longest && rows.iter().all(|r| r.normal.dot(*v) >= r.least - 1e-9);
    let count = rows.len();
    let sets = (0..count).flat_map(|i| (i..count).flat_map(move |j| (j..count).map(move |k| [i, j, k])));
    let candidates = sets.filter_map(|set| onto_planes(desired, rows, set)).chain([desired]);
    candidates.filter(keeps).min_by(|a, b| a.distance(desired).total_cmp(&b.distance(desired)))
}

/// The nearest velocity in all planes of a set, by the normal equations.
fn onto_planes(desired: Vec3, rows: &[LinearConstraint], set: [usize; 3]) -> Option<Vec3> {
    let mut set = set.to_vec();
    set.dedup();
    let (mut gram, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for (i, &a) in set.iter().enumerate() {
        right[i] = rows[a].least - rows[a].normal.dot(desired);
        for (j, &b) in set.iter().enumerate() {
            gram[i][j] = rows[a].normal.dot(rows[b].normal);
        }
    }
    let factors = solve_spd(gram, right, set.len())?;
    Some(set.iter().zip(factors).fold(desired, |v, (&row, factor)| v + rows[row].normal * factor))
}

fn direction(random: &mut SplitMix) -> Vec3 {
    loop {
        if let Some(n) = Vec3::from(random.within(1.0)).try_normalize() {
            return n;
        }
    }
}

/// Random rows: some equal, opposite, nearly equal or in one plane.
fn rows(random: &mut SplitMix, count: usize, rest_is_free: bool) -> Vec<LinearConstraint> {
    let mut rows: Vec<LinearConstraint> = Vec::new();
    for _ in 0..count {
        let kind = if rows.is_empty() { 9 } else { random.below(10) };
        let other = if rows.is_empty() { Vec3::Z } else { rows[random.below(rows.len())].normal };
        let normal = match kind {
            0 => other,
            1 => -other,
            2 => (other + Vec3::from(random.within(1e-7))).try_normalize().unwrap(),
            3 => other.cross(direction(random)).try_normalize().unwrap_or(other),
            _ => direction(random),
        };
        let least = random.between(-0.2, if rest_is_free { 0.0 } else { 0.1 });
        rows.push(LinearConstraint { normal, least });
    }
    rows
}

#[test]
fn the_nearest_admissible_velocity_is_that_of_the_best_active_set() {
    let mut random = SplitMix(3);
    let mut contradictions = 0;
    for case in 0..20_000 {
        let count = 1 + random.below(9);
        let rows = rows(&mut random, count, case % 2 == 0);
        let desired = Vec3::from(random.within(0.3));
        match (project_onto_constraints(desired, &rows), by_enumeration(desired, &rows)) {
            (Ok((found, _)), Some(expected)) => {
                for row in &rows {
                    assert!(row.normal.dot(found) >= row.least - 1e-11, "{case}: {found:?} breaks {row:?}");
                }
                assert!(found.distance(desired) <= expected.distance(desired) + 1e-8, "{case}: {found:?} {expected:?}");
            }
            (Err(Contradiction), None) => contradictions += 1,
            (found, expected) => panic!("{case}: {found:?} instead of {expected:?} for {desired:?} {rows:?}"),
        }
    }
    assert!(contradictions > 500, "{contradictions} contradictions");
}

proptest! {
    /// What is tangential to the rows that decide is kept: the change is a sum of normals with positive factors.
    #[test]
    fn only_normals_of_tight_rows_change_the_velocity(seed: u64, count in 1_usize..40) {
        let mut random = SplitMix(seed);
        let rows = rows(&mut random, count, true);
        let desired = Vec3::from(random.within(0.3));
        let (found, active) = project_onto_constraints(desired, &rows).unwrap();
        prop_assert!(active <= 3);
        prop_assert!(found.length() <= desired.length() + 1e-12);
        let tight: Vec<_> = rows.iter().filter(|r| (r.normal.dot(found) - r.least).abs() < 1e-9).collect();
        let change = found - desired;
        // A direction that no tight normal opposes gains nothing from the change.
        for _ in 0..50 {
            let d = direction(&mut random);
            if tight.iter().all(|r| r.normal.dot(d) <= 0.0) {
                prop_assert!(change.dot(d) <= 1e-9, "{change:?} along {d:?}");
            }
        }
    }

    /// A small change of the desired velocity is a small change of the result: projections do not expand.
    #[test]
    fn the_result_is_continuous(seed: u64, count in 1_usize..40) {
        let mut random = SplitMix(seed);
        let rows = rows(&mut random, count, true);
        let (one, other) = (Vec3::from(random.within(0.3)), Vec3::from(random.within(0.3)));
        let (at_one, at_other) = (project_onto_constraints(one, &rows).unwrap().0, project_onto_constraints(other, &rows).unwrap().0);
        prop_assert!(at_one.distance(at_other) <= one.distance(other) + 1e-9);
    }
}

#[test]
fn numbers_that_are_not_finite_are_contradictions() {
    let row = LinearConstraint { normal: Vec3::Z, least: 0.0 };
    assert!(project_onto_constraints(Vec3::X * f64::NAN, &[row]).is_err());
    assert!(project_onto_constraints(Vec3::X, &[LinearConstraint { least: f64::INFINITY, ..row }]).is_err());
    assert!(project_onto_constraints(Vec3::X, &[LinearConstraint { normal: Vec3::X * f64::NAN, ..row }]).is_err());
}
