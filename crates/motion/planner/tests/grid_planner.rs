//! Paths compared with exhaustive search.

use crate::common::{
    Random, block, blocked_point, connected, free_cell, grid, grid_optimum, random_configuration, random_occupancy,
};
use elbowroom_cspace::{OccupancyBitmap, RowSpan};
use elbowroom_planner::{GridPlanner, GridPlannerError, GridPlannerSettings, PathEnd};

const DEFAULT: GridPlannerSettings = GridPlannerSettings::DEFAULT;

fn random_shape(random: &mut Random) -> [usize; 3] {
    [1 + random.index(14), 1 + random.index(12), 1 + random.index(70)]
}

#[test]
fn there_is_a_path_exactly_where_exhaustive_search_finds_one() {
    let mut random = Random(17);
    let (mut found, mut none) = (0, 0);
    for _ in 0..1500 {
        let shape = random_shape(&mut random);
        let (grid, occupancy) = (grid(shape), random_occupancy(shape, &mut random));
        let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
        for _ in 0..3 {
            let Some(from) = free_cell(&occupancy, &mut random) else { break };
            let to = free_cell(&occupancy, &mut random).unwrap();
            let (start, goal) =
                (random_configuration(&grid, from, &mut random), random_configuration(&grid, to, &mut random));
            // On a border, rounding may select the neighbouring cell.
            if grid.cell(start) != Some(from) || grid.cell(goal) != Some(to) {
                continue;
            }
            match planner.plan(start, goal, &DEFAULT) {
                Ok(path) => {
                    assert!(connected(&occupancy, from, to));
                    assert_eq!((path.waypoints[0], *path.waypoints.last().unwrap()), (start, goal));
                    assert_eq!(blocked_point(&grid, &occupancy, &path.waypoints, 1000), None, "{path:?}");
                    found += 1;
                }
                Err(e) => {
                    assert_eq!(e, GridPlannerError::NoPath);
                    assert!(!connected(&occupancy, from, to), "{from:?} {to:?}");
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
    // The exhaustive search takes nearly all of the time.
    let rounds: u32 = elbowroom_testkit::extent::amount(30, 150);
    for round in 0..rounds as usize {
        let shape = [14 + random.index(20), 14 + random.index(20), 14 + random.index(60)];
        let (grid, occupancy) = (grid(shape), random_occupancy(shape, &mut random));
        let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
        let weights = weights[round % 2];
        for _ in 0..4 {
            let Some((from, to)) = free_cell(&occupancy, &mut random).zip(free_cell(&occupancy, &mut random)) else {
                break;
            };
            let Some(optimum) = grid_optimum(&occupancy, weights.map(|w| w * 0.1), from, to) else { continue };
            if optimum == 0.0 {
                continue;
            }
            let settings = GridPlannerSettings { weights, ..DEFAULT };
            let ratio = planner.plan(grid.center(from), grid.center(to), &settings).unwrap().length_rad / optimum;
            (sum, worst, count) = (sum + ratio, worst.max(ratio), count + 1);
        }
    }
    let mean = sum / f64::from(count);
    println!("{count} paths: {mean:.4} of the grid optimum in the mean, {worst:.3} at worst");
    assert!(count > 2 * rounds && mean < 1.03 && worst < 2.5, "{mean} {worst}");
}

/// A wall across axis 1 with a hole of one cell.
fn wall(shape: [usize; 3], at: u16, hole: Option<(u16, u16)>) -> OccupancyBitmap {
    let mut occupancy = OccupancyBitmap::new(shape);
    for i in 0..shape[0] as u16 {
        for k in 0..shape[2] as u16 {
            if hole != Some((i, k)) {
                block(&mut occupancy, [i, at, k]);
            }
        }
    }
    occupancy
}

#[test]
fn a_passage_of_one_cell_is_found_wherever_it_is() {
    let shape = [12, 12, 70];
    let grid = grid(shape);
    let (start, goal) = (grid.center([2, 1, 3]), grid.center([9, 10, 60]));
    for at in [3, 4, 5, 6, 7] {
        for hole in [(0, 0), (11, 69), (5, 31), (4, 64), (3, 63)] {
            let occupancy = wall(shape, at, Some(hole));
            let path = GridPlanner::new(&grid, &occupancy).unwrap().plan(start, goal, &DEFAULT).unwrap();
            assert_eq!(blocked_point(&grid, &occupancy, &path.waypoints, 3000), None);
        }
        let closed = GridPlanner::new(&grid, &wall(shape, at, None)).unwrap().plan(start, goal, &DEFAULT);
        assert_eq!(closed, Err(GridPlannerError::NoPath));
    }
}

#[test]
fn opening_and_closing_a_hole_updates_the_graph() {
    let shape = [12, 12, 70];
    let grid = grid(shape);
    let (start, goal) = (grid.center([2, 1, 3]), grid.center([9, 10, 60]));
    let (closed, open) = (wall(shape, 5, None), wall(shape, 5, Some((7, 20))));
    let mut planner = GridPlanner::new(&grid, &closed).unwrap();
    for _ in 0..3 {
        assert_eq!(planner.update(&open).unwrap().freed(), 1);
        assert!(planner.plan(start, goal, &DEFAULT).is_ok());
        assert_eq!(planner.update(&closed).unwrap().blocked(), 1);
        assert_eq!(planner.plan(start, goal, &DEFAULT), Err(GridPlannerError::NoPath));
    }
}

#[test]
fn cells_that_meet_at_an_edge_only_are_not_connected() {
    let grid = grid([2, 2, 1]);
    let mut occupancy = OccupancyBitmap::new([2, 2, 1]);
    block(&mut occupancy, [0, 1, 0]);
    block(&mut occupancy, [1, 0, 0]);
    let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
    assert_eq!(planner.plan(grid.center([0, 0, 0]), grid.center([1, 1, 0]), &DEFAULT), Err(GridPlannerError::NoPath));
}

#[test]
fn empty_and_full_maps() {
    let grid = grid([5, 6, 67]);
    let mut planner = GridPlanner::new(&grid, &OccupancyBitmap::new(grid.shape())).unwrap();
    let (start, goal) = (grid.center([0, 0, 0]), grid.center([4, 5, 66]));
    let path = planner.plan(start, goal, &DEFAULT).unwrap();
    assert_eq!(path.waypoints, [start, goal]);
    assert_eq!(planner.plan(start, start, &DEFAULT).unwrap().length_rad, 0.0);
    let mut full = OccupancyBitmap::new(grid.shape());
    (0..30).for_each(|row| full.block(RowSpan { row, first: 0, last: 66 }));
    planner.update(&full).unwrap();
    let anywhere = GridPlannerSettings { max_end_shift_rad: 100.0, ..DEFAULT };
    assert_eq!(
        planner.plan(start, goal, &anywhere),
        Err(GridPlannerError::Blocked { end: PathEnd::Start, radius_rad: 100.0 })
    );
}

#[test]
fn a_blocked_end_is_moved_to_the_nearest_connected_free_cell() {
    let grid = grid([20, 5, 5]);
    let mut occupancy = OccupancyBitmap::new(grid.shape());
    for i in 8..12 {
        for row in 0..5 {
            occupancy.block(RowSpan { row: i * 5 + row, first: 0, last: 4 });
        }
    }
    let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
    let (start, goal) = (grid.center([2, 2, 2]), grid.center([10, 2, 2]));
    let error = planner.plan(start, goal, &DEFAULT).unwrap_err();
    assert_eq!(error, GridPlannerError::Blocked { end: PathEnd::Goal, radius_rad: 0.0 });
    // [12, 2, 2] is nearer but on the other side.
    let path = planner.plan(start, goal, &GridPlannerSettings { max_end_shift_rad: 0.35, ..DEFAULT }).unwrap();
    assert!((path.goal_moved_rad - 0.3).abs() < 1e-9 && path.start_moved_rad == 0.0);
    assert_eq!(grid.cell(*path.waypoints.last().unwrap()), Some([7, 2, 2]));
    let back = planner.plan(goal, start, &GridPlannerSettings { max_end_shift_rad: 0.35, ..DEFAULT }).unwrap();
    assert!((back.start_moved_rad - 0.3).abs() < 1e-9);
    assert_eq!(grid.cell(back.waypoints[0]), Some([7, 2, 2]));
}

#[test]
fn invalid_input_is_rejected() {
    let grid = grid([5, 5, 5]);
    let mut planner = GridPlanner::new(&grid, &OccupancyBitmap::new(grid.shape())).unwrap();
    let good = grid.center([1, 1, 1]);
    let outside = planner.plan(good, [good[0], f64::NAN, 0.0], &DEFAULT);
    assert!(matches!(outside, Err(GridPlannerError::Outside { end: PathEnd::Goal, joint: 1, .. })), "{outside:?}");
    assert!(matches!(
        planner.plan([9.0, 0.0, 0.0], good, &DEFAULT),
        Err(GridPlannerError::Outside { end: PathEnd::Start, .. })
    ));
    let weights = GridPlannerSettings { weights: [1.0, 0.0, 1.0], ..DEFAULT };
    assert!(matches!(planner.plan(good, good, &weights), Err(GridPlannerError::InvalidSetting { .. })));
    let shift = GridPlannerSettings { max_end_shift_rad: f64::NAN, ..DEFAULT };
    assert!(matches!(planner.plan(good, good, &shift), Err(GridPlannerError::InvalidSetting { .. })));
    assert!(matches!(planner.update(&OccupancyBitmap::new([5, 5, 6])), Err(GridPlannerError::Shape { .. })));
}
