//! Replanning against planning anew.

mod common;

use common::{Random, block, blocked_point, free_cell, grid, joined, random_table};
use elbowroom_cspace::{Span, Table};
use elbowroom_planner::{How, PlanError, PlanOptions, Planner, Progress, Standing};

const PLAIN: PlanOptions = PlanOptions { weights: [1.0; 3], nearest_rad: 0.0 };

/// Somewhere on a path.
fn along(waypoints: &[[f64; 3]], random: &mut Random) -> Progress {
    let leg = random.below(waypoints.len().max(2) - 1);
    let t = if random.below(3) == 0 { 0.0 } else { random.unit() };
    let to = waypoints.get(leg + 1).unwrap_or(&waypoints[leg]);
    Progress { leg, q: [0, 1, 2].map(|i| waypoints[leg][i] + (to[i] - waypoints[leg][i]) * t) }
}

/// A box of cells about a place of the path, or anywhere.
fn disturbed(table: &Table, about: Option<[u16; 3]>, random: &mut Random) -> Table {
    let mut table = table.clone();
    let shape = table.shape();
    let at = about.unwrap_or_else(|| shape.map(|n| random.below(n) as u16)).map(usize::from);
    let half = [random.below(4), random.below(4), random.below(5)];
    for i in at[0].saturating_sub(half[0])..=(at[0] + half[0]).min(shape[0] - 1) {
        for j in at[1].saturating_sub(half[1])..=(at[1] + half[1]).min(shape[1] - 1) {
            let (first, last) = (at[2].saturating_sub(half[2]) as u16, (at[2] + half[2]) as u16);
            table.block(Span { row: (i * shape[1] + j) as u32, first, last });
        }
    }
    table
}

#[test]
fn replanning_succeeds_where_planning_anew_does() {
    let mut random = Random(23);
    let (mut kept, mut mended, mut anew, mut none) = (0, 0, 0, 0);
    for _ in 0..600 {
        let shape = [16 + random.below(10), 12 + random.below(10), 20 + random.below(60)];
        let (grid, table) = (grid(shape), random_table(shape, &mut random));
        let mut planner = Planner::new(&grid, &table).unwrap();
        let Some((from, to)) = free_cell(&table, &mut random).zip(free_cell(&table, &mut random)) else { continue };
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &PLAIN) else { continue };
        let here = along(&path.waypoints, &mut random);
        let about = (random.below(4) > 0).then(|| grid.cell(along(&path.waypoints, &mut random).q).unwrap());
        let changed = disturbed(&table, about, &mut random);
        planner.update(&changed).unwrap();
        let standing = planner.standing(&path, here, &PLAIN).unwrap();
        let answer = planner.replan(&path, here, &PLAIN);
        let fresh = Planner::new(&grid, &changed).unwrap().plan(here.q, grid.center(to), &PLAIN);
        let Ok((rest, how)) = answer else {
            assert_eq!(answer.unwrap_err(), fresh.unwrap_err());
            none += 1;
            continue;
        };
        let fresh = fresh.expect("planning anew finds what replanning does");
        assert_eq!((rest.waypoints[0], *rest.waypoints.last().unwrap()), (here.q, grid.center(to)));
        assert_eq!(blocked_point(&grid, &changed, &rest.waypoints, 1000), None, "{how:?}");
        assert!(rest.length_rad > 0.6 * fresh.length_rad, "planning anew is a poor measure");
        assert_eq!(how == How::Kept, standing == Standing::Clear);
        match how {
            How::Kept => kept += 1,
            How::Mended => mended += 1,
            How::Anew => anew += 1,
        }
    }
    println!("{kept} kept, {mended} mended, {anew} anew, {none} not joined any more");
    assert!(kept > 20 && mended > 100 && none > 20);
}

#[test]
fn what_may_still_be_driven_ends_where_dense_sampling_says() {
    let mut random = Random(29);
    let mut blocked = 0;
    for _ in 0..300 {
        let shape = [20, 14, 40];
        let (grid, table) = (grid(shape), random_table(shape, &mut random));
        let mut planner = Planner::new(&grid, &table).unwrap();
        let Some((from, to)) = free_cell(&table, &mut random).zip(free_cell(&table, &mut random)) else { continue };
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &PLAIN) else { continue };
        let about = grid.cell(along(&path.waypoints, &mut random).q);
        let changed = disturbed(&table, about, &mut random);
        planner.update(&changed).unwrap();
        let here = Progress { leg: 0, q: path.waypoints[0] };
        let Standing::Blocked { leg, free_until, free_rad } = planner.standing(&path, here, &PLAIN).unwrap() else {
            continue;
        };
        blocked += 1;
        let mut free: Vec<[f64; 3]> = path.waypoints[..=leg].to_vec();
        free.push(free_until);
        let length: f64 =
            free.windows(2).map(|w| (0..3).map(|i| (w[0][i] - w[1][i]).powi(2)).sum::<f64>().sqrt()).sum();
        assert!((length - free_rad).abs() < 1e-6);
        if free_rad > 0.0 {
            assert_eq!(blocked_point(&grid, &changed, &free, 2000), None);
        }
    }
    assert!(blocked > 100, "{blocked}");
}

#[test]
fn an_arm_that_is_caught_is_told_so() {
    let grid = grid([10, 10, 10]);
    let table = Table::new(grid.shape());
    let mut planner = Planner::new(&grid, &table).unwrap();
    let path = planner.plan(grid.center([1, 1, 1]), grid.center([8, 8, 8]), &PLAIN).unwrap();
    let mut caught = table.clone();
    block(&mut caught, [1, 1, 1]);
    planner.update(&caught).unwrap();
    let here = Progress { leg: 0, q: path.waypoints[0] };
    let standing = planner.standing(&path, here, &PLAIN).unwrap();
    assert!(matches!(standing, Standing::Blocked { free_rad: 0.0, .. }), "{standing:?}");
    assert!(matches!(planner.replan(&path, here, &PLAIN), Err(PlanError::Blocked { .. })));
    let escape = PlanOptions { nearest_rad: 0.2, ..PLAIN };
    let (out, how) = planner.replan(&path, here, &escape).unwrap();
    assert!(how == How::Anew && out.start_moved_rad > 0.0);
    assert!(joined(&caught, grid.cell(out.waypoints[0]).unwrap(), [8, 8, 8]));
}
