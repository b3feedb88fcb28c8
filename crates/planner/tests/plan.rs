//! Paths against exhaustive search.

mod common;

use common::{Random, block, blocked_point, free_cell, grid, grid_optimum, joined, random_table, somewhere};
use elbowroom_cspace::{Span, Table};
use elbowroom_planner::{End, PlanError, PlanOptions, Planner};

const PLAIN: PlanOptions = PlanOptions { weights: [1.0; 3], nearest_rad: 0.0 };

fn random_shape(random: &mut Random) -> [usize; 3] {
    [1 + random.below(14), 1 + random.below(12), 1 + random.below(70)]
}

#[test]
fn there_is_a_path_exactly_where_exhaustive_search_finds_one() {
    let mut random = Random(17);
    let (mut found, mut none) = (0, 0);
    for _ in 0..1500 {
        let shape = random_shape(&mut random);
        let (grid, table) = (grid(shape), random_table(shape, &mut random));
        let mut planner = Planner::new(&grid, &table).unwrap();
        for _ in 0..3 {
            let Some(from) = free_cell(&table, &mut random) else { break };
            let to = free_cell(&table, &mut random).unwrap();
            let (start, goal) = (somewhere(&grid, from, &mut random), somewhere(&grid, to, &mut random));
            // Somewhere on a border rounding may say the cell beside it.
            if grid.cell(start) != Some(from) || grid.cell(goal) != Some(to) {
                continue;
            }
            match planner.plan(start, goal, &PLAIN) {
                Ok(path) => {
                    assert!(joined(&table, from, to));
                    assert_eq!((path.waypoints[0], *path.waypoints.last().unwrap()), (start, goal));
                    assert_eq!(blocked_point(&grid, &table, &path.waypoints, 1000), None, "{path:?}");
                    found += 1;
                }
                Err(e) => {
                    assert_eq!(e, PlanError::NoPath);
                    assert!(!joined(&table, from, to), "{from:?} {to:?}");
                    none += 1;
                }
            }
        }
    }
    assert!(found > 1000 && none > 200, "{found} {none}");
}

#[test]
fn paths_are_hardly_longer_than_the_grid_optimum() {
    let mut random = Random(5);
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0);
    let weights = [[1.0; 3], [2.0, 1.0, 0.5]];
    for round in 0..150 {
        let shape = [14 + random.below(20), 14 + random.below(20), 14 + random.below(60)];
        let (grid, table) = (grid(shape), random_table(shape, &mut random));
        let mut planner = Planner::new(&grid, &table).unwrap();
        let weights = weights[round % 2];
        for _ in 0..4 {
            let Some((from, to)) = free_cell(&table, &mut random).zip(free_cell(&table, &mut random)) else { break };
            let Some(optimum) = grid_optimum(&table, weights.map(|w| w * 0.1), from, to) else { continue };
            if optimum == 0.0 {
                continue;
            }
            let options = PlanOptions { weights, ..PLAIN };
            let ratio = planner.plan(grid.center(from), grid.center(to), &options).unwrap().length_rad / optimum;
            (sum, worst, count) = (sum + ratio, worst.max(ratio), count + 1);
        }
    }
    let mean = sum / f64::from(count);
    println!("{count} paths: {mean:.4} of the grid optimum in the mean, {worst:.3} at worst");
    assert!(count > 300 && mean < 1.03 && worst < 2.5, "{mean} {worst}");
}

/// A wall across axis 1 with a hole of one cell.
fn wall(shape: [usize; 3], at: u16, hole: Option<(u16, u16)>) -> Table {
    let mut table = Table::new(shape);
    for i in 0..shape[0] as u16 {
        for k in 0..shape[2] as u16 {
            if hole != Some((i, k)) {
                block(&mut table, [i, at, k]);
            }
        }
    }
    table
}

#[test]
fn a_passage_of_one_cell_is_found_wherever_it_is() {
    let shape = [12, 12, 70];
    let grid = grid(shape);
    let (start, goal) = (grid.center([2, 1, 3]), grid.center([9, 10, 60]));
    for at in [3, 4, 5, 6, 7] {
        for hole in [(0, 0), (11, 69), (5, 31), (4, 64), (3, 63)] {
            let table = wall(shape, at, Some(hole));
            let path = Planner::new(&grid, &table).unwrap().plan(start, goal, &PLAIN).unwrap();
            assert_eq!(blocked_point(&grid, &table, &path.waypoints, 3000), None);
        }
        let shut = Planner::new(&grid, &wall(shape, at, None)).unwrap().plan(start, goal, &PLAIN);
        assert_eq!(shut, Err(PlanError::NoPath));
    }
}

#[test]
fn a_hole_that_opens_and_shuts_is_noticed() {
    let shape = [12, 12, 70];
    let grid = grid(shape);
    let (start, goal) = (grid.center([2, 1, 3]), grid.center([9, 10, 60]));
    let (shut, open) = (wall(shape, 5, None), wall(shape, 5, Some((7, 20))));
    let mut planner = Planner::new(&grid, &shut).unwrap();
    for _ in 0..3 {
        assert_eq!(planner.update(&open).unwrap().freed(), 1);
        assert!(planner.plan(start, goal, &PLAIN).is_ok());
        assert_eq!(planner.update(&shut).unwrap().blocked(), 1);
        assert_eq!(planner.plan(start, goal, &PLAIN), Err(PlanError::NoPath));
    }
}

#[test]
fn cells_that_meet_at_an_edge_only_are_not_joined() {
    let grid = grid([2, 2, 1]);
    let mut table = Table::new([2, 2, 1]);
    block(&mut table, [0, 1, 0]);
    block(&mut table, [1, 0, 0]);
    let mut planner = Planner::new(&grid, &table).unwrap();
    assert_eq!(planner.plan(grid.center([0, 0, 0]), grid.center([1, 1, 0]), &PLAIN), Err(PlanError::NoPath));
}

#[test]
fn empty_and_full_maps() {
    let grid = grid([5, 6, 67]);
    let mut planner = Planner::new(&grid, &Table::new(grid.shape())).unwrap();
    let (start, goal) = (grid.center([0, 0, 0]), grid.center([4, 5, 66]));
    let path = planner.plan(start, goal, &PLAIN).unwrap();
    assert_eq!(path.waypoints, [start, goal]);
    assert_eq!(planner.plan(start, start, &PLAIN).unwrap().length_rad, 0.0);
    let mut full = Table::new(grid.shape());
    (0..30).for_each(|row| full.block(Span { row, first: 0, last: 66 }));
    planner.update(&full).unwrap();
    let anywhere = PlanOptions { nearest_rad: 100.0, ..PLAIN };
    assert_eq!(planner.plan(start, goal, &anywhere), Err(PlanError::Blocked { end: End::Start, radius_rad: 100.0 }));
}

#[test]
fn a_blocked_end_is_moved_to_the_nearest_free_cell_that_is_joined() {
    let grid = grid([20, 5, 5]);
    let mut table = Table::new(grid.shape());
    for i in 8..12 {
        for row in 0..5 {
            table.block(Span { row: i * 5 + row, first: 0, last: 4 });
        }
    }
    let mut planner = Planner::new(&grid, &table).unwrap();
    let (start, goal) = (grid.center([2, 2, 2]), grid.center([10, 2, 2]));
    let error = planner.plan(start, goal, &PLAIN).unwrap_err();
    assert_eq!(error, PlanError::Blocked { end: End::Goal, radius_rad: 0.0 });
    // Nearer is [12, 2, 2], on the other side.
    let path = planner.plan(start, goal, &PlanOptions { nearest_rad: 0.35, ..PLAIN }).unwrap();
    assert!((path.goal_moved_rad - 0.3).abs() < 1e-9 && path.start_moved_rad == 0.0);
    assert_eq!(grid.cell(*path.waypoints.last().unwrap()), Some([7, 2, 2]));
    let back = planner.plan(goal, start, &PlanOptions { nearest_rad: 0.35, ..PLAIN }).unwrap();
    assert!((back.start_moved_rad - 0.3).abs() < 1e-9);
    assert_eq!(grid.cell(back.waypoints[0]), Some([7, 2, 2]));
}

#[test]
fn bad_input_is_refused() {
    let grid = grid([5, 5, 5]);
    let mut planner = Planner::new(&grid, &Table::new(grid.shape())).unwrap();
    let good = grid.center([1, 1, 1]);
    let outside = planner.plan(good, [good[0], f64::NAN, 0.0], &PLAIN);
    assert!(matches!(outside, Err(PlanError::Outside { end: End::Goal, joint: 1, .. })), "{outside:?}");
    assert!(matches!(planner.plan([9.0, 0.0, 0.0], good, &PLAIN), Err(PlanError::Outside { end: End::Start, .. })));
    let weights = PlanOptions { weights: [1.0, 0.0, 1.0], ..PLAIN };
    assert!(matches!(planner.plan(good, good, &weights), Err(PlanError::Option { .. })));
    let radius = PlanOptions { nearest_rad: f64::NAN, ..PLAIN };
    assert!(matches!(planner.plan(good, good, &radius), Err(PlanError::Option { .. })));
    assert!(matches!(planner.update(&Table::new([5, 5, 6])), Err(PlanError::Shape { .. })));
}
