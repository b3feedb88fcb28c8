//! Replanning against planning from the start.

use crate::common::{Random, block, blocked_point, connected, free_cell, grid, random_occupancy};
use elbowroom_cspace::{OccupancyBitmap, RowSpan};
use elbowroom_planner::{GridPlanner, GridPlannerError, GridPlannerSettings, PathProgress, PathStatus, ReplanKind};

const DEFAULT: GridPlannerSettings = GridPlannerSettings::DEFAULT;

/// A random position on a path.
fn random_progress(waypoints: &[[f64; 3]], random: &mut Random) -> PathProgress {
    let segment = random.index(waypoints.len().max(2) - 1);
    let t = if random.index(3) == 0 { 0.0 } else { random.unit() };
    let to = waypoints.get(segment + 1).unwrap_or(&waypoints[segment]);
    PathProgress { segment, q: [0, 1, 2].map(|i| waypoints[segment][i] + (to[i] - waypoints[segment][i]) * t) }
}

/// The occupancy with one more box of cells, about a cell or anywhere.
fn with_random_box(occupancy: &OccupancyBitmap, about: Option<[u16; 3]>, random: &mut Random) -> OccupancyBitmap {
    let mut occupancy = occupancy.clone();
    let shape = occupancy.shape();
    let at = about.unwrap_or_else(|| shape.map(|n| random.index(n) as u16)).map(usize::from);
    let half = [random.index(4), random.index(4), random.index(5)];
    for i in at[0].saturating_sub(half[0])..=(at[0] + half[0]).min(shape[0] - 1) {
        for j in at[1].saturating_sub(half[1])..=(at[1] + half[1]).min(shape[1] - 1) {
            let (first, last) = (at[2].saturating_sub(half[2]) as u16, (at[2] + half[2]) as u16);
            occupancy.block(RowSpan { row: (i * shape[1] + j) as u32, first, last });
        }
    }
    occupancy
}

#[test]
fn replanning_succeeds_where_planning_does() {
    let mut random = Random(23);
    let (mut kept, mut repaired, mut replanned, mut none) = (0, 0, 0, 0);
    for _ in 0..600 {
        let shape = [16 + random.index(10), 12 + random.index(10), 20 + random.index(60)];
        let (grid, occupancy) = (grid(shape), random_occupancy(shape, &mut random));
        let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
        let Some((from, to)) = free_cell(&occupancy, &mut random).zip(free_cell(&occupancy, &mut random)) else {
            continue;
        };
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &DEFAULT) else { continue };
        let here = random_progress(&path.waypoints, &mut random);
        let about = (random.index(4) > 0).then(|| grid.cell(random_progress(&path.waypoints, &mut random).q).unwrap());
        let changed = with_random_box(&occupancy, about, &mut random);
        planner.update(&changed).unwrap();
        let status = planner.path_status(&path, here, &DEFAULT).unwrap();
        let answer = planner.replan(&path, here, &DEFAULT);
        let fresh = GridPlanner::new(&grid, &changed).unwrap().plan(here.q, grid.center(to), &DEFAULT);
        let Ok((rest, kind)) = answer else {
            assert_eq!(answer.unwrap_err(), fresh.unwrap_err());
            none += 1;
            continue;
        };
        let fresh = fresh.expect("planning finds a path where replanning does");
        assert_eq!((rest.waypoints[0], *rest.waypoints.last().unwrap()), (here.q, grid.center(to)));
        assert_eq!(blocked_point(&grid, &changed, &rest.waypoints, 1000), None, "{kind:?}");
        assert!(rest.length_rad > 0.6 * fresh.length_rad, "the planned path is a poor reference");
        assert_eq!(kind == ReplanKind::Kept, status == PathStatus::Clear);
        match kind {
            ReplanKind::Kept => kept += 1,
            ReplanKind::Repaired => repaired += 1,
            ReplanKind::Replanned => replanned += 1,
        }
    }
    println!("{kept} kept, {repaired} repaired, {replanned} replanned, {none} not connected any more");
    assert!(kept > 20 && repaired > 100 && none > 20);
}

#[test]
fn the_free_part_of_a_path_agrees_with_dense_sampling() {
    let mut random = Random(29);
    let mut blocked = 0;
    for _ in 0..300 {
        let shape = [20, 14, 40];
        let (grid, occupancy) = (grid(shape), random_occupancy(shape, &mut random));
        let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
        let Some((from, to)) = free_cell(&occupancy, &mut random).zip(free_cell(&occupancy, &mut random)) else {
            continue;
        };
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &DEFAULT) else { continue };
        let about = grid.cell(random_progress(&path.waypoints, &mut random).q);
        let changed = with_random_box(&occupancy, about, &mut random);
        planner.update(&changed).unwrap();
        let here = PathProgress { segment: 0, q: path.waypoints[0] };
        let PathStatus::Blocked { segment, free_until, weighted_free_rad } =
            planner.path_status(&path, here, &DEFAULT).unwrap()
        else {
            continue;
        };
        blocked += 1;
        let mut free: Vec<[f64; 3]> = path.waypoints[..=segment].to_vec();
        free.push(free_until);
        let length: f64 =
            free.windows(2).map(|w| (0..3).map(|i| (w[0][i] - w[1][i]).powi(2)).sum::<f64>().sqrt()).sum();
        assert!((length - weighted_free_rad).abs() < 1e-6);
        if weighted_free_rad > 0.0 {
            assert_eq!(blocked_point(&grid, &changed, &free, 2000), None);
        }
    }
    assert!(blocked > 100, "{blocked}");
}

#[test]
fn an_arm_in_a_blocked_cell_is_reported() {
    let grid = grid([10, 10, 10]);
    let occupancy = OccupancyBitmap::new(grid.shape());
    let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
    let path = planner.plan(grid.center([1, 1, 1]), grid.center([8, 8, 8]), &DEFAULT).unwrap();
    let mut blocked_start = occupancy.clone();
    block(&mut blocked_start, [1, 1, 1]);
    planner.update(&blocked_start).unwrap();
    let here = PathProgress { segment: 0, q: path.waypoints[0] };
    let status = planner.path_status(&path, here, &DEFAULT).unwrap();
    assert!(matches!(status, PathStatus::Blocked { weighted_free_rad: 0.0, .. }), "{status:?}");
    assert!(matches!(planner.replan(&path, here, &DEFAULT), Err(GridPlannerError::Blocked { .. })));
    let moved = GridPlannerSettings { max_end_shift_rad: 0.2, ..DEFAULT };
    let (out, kind) = planner.replan(&path, here, &moved).unwrap();
    assert!(kind == ReplanKind::Replanned && out.start_moved_rad > 0.0);
    assert!(connected(&blocked_start, grid.cell(out.waypoints[0]).unwrap(), [8, 8, 8]));
}
