//! Layers, changes, snapshots.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::common::{RandomGeometry, Xorshift, fill, grid};
use elbowroom_cspace::{CellChanges, CellIndex, ConvexObstacle, JointMap, OccupancyBitmap, PlanarArm};
use elbowroom_spatial::{Pose, Vec3};

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

fn random_obstacle(random: &mut Xorshift) -> ConvexObstacle {
    let at = Vec3::new(random.between(-1.8, 1.8), random.between(-1.8, 1.8), random.between(-0.3, 2.2));
    if random.index(2) == 0 {
        return ConvexObstacle::sphere(at, random.between(0.0, 0.5)).unwrap();
    }
    let rpy = random.vector(3.0);
    let pose = Pose::from_xyz_rpy([at.x, at.y, at.z], [rpy.x, rpy.y, rpy.z]);
    ConvexObstacle::cuboid(pose, random.vector(0.5).abs()).unwrap()
}

/// The occupancy of some obstacles, built from scratch.
fn rebuilt(map: &JointMap, fixed: &[ConvexObstacle], obstacles: &[(usize, ConvexObstacle)]) -> OccupancyBitmap {
    let mut occupancy = OccupancyBitmap::new(map.grid().shape());
    let mut cells: Vec<CellIndex> =
        fixed.iter().flat_map(|o| fill(&ARM, map.grid(), o).iter().collect::<Vec<_>>()).collect();
    cells.extend(obstacles.iter().flat_map(|(_, o)| fill(&ARM, map.grid(), o).iter().collect::<Vec<_>>()));
    let rows = map.grid().shape()[1] as u32;
    for [i, j, k] in cells {
        occupancy.block(elbowroom_cspace::RowSpan { row: u32::from(i) * rows + u32::from(j), first: k, last: k });
    }
    occupancy
}

/// Applies changes to a copy of the previous occupancy, and checks the previous state of each cell.
fn apply(before: &OccupancyBitmap, changes: &CellChanges) -> Vec<CellIndex> {
    let mut cells: std::collections::BTreeSet<CellIndex> = before.iter().collect();
    for (cell, blocked) in changes.iter() {
        assert_eq!(before.is_blocked(cell), !blocked, "{cell:?} did not change");
        if blocked {
            cells.insert(cell)
        } else {
            cells.remove(&cell)
        };
    }
    cells.into_iter().collect()
}

#[test]
fn updates_agree_with_rebuilding_the_map() {
    let mut random = Xorshift(3);
    let mut map = JointMap::new(ARM, &grid(5.0)).unwrap();
    let fixed = [random_obstacle(&mut random)];
    map.set_fixed(&fixed);
    let mut present: Vec<(usize, ConvexObstacle)> = Vec::new();
    for step in 0..60 {
        let before = map.occupancy().clone();
        let name = random.index(4);
        present.retain(|(other, _)| *other != name);
        let changes = if random.index(4) == 0 {
            map.remove_obstacle(&name.to_string()).cloned().unwrap_or_default()
        } else {
            let obstacle = random_obstacle(&mut random);
            present.push((name, obstacle.clone()));
            map.set_obstacle(&name.to_string(), &obstacle).clone()
        };
        assert!(*map.occupancy() == rebuilt(&map, &fixed, &present), "step {step}");
        assert_eq!(apply(&before, &changes), map.occupancy().iter().collect::<Vec<_>>(), "step {step}");
        let counted = CellChanges::between(&before, map.occupancy());
        assert_eq!((counted.blocked(), counted.freed()), (changes.blocked(), changes.freed()));
    }
}

#[test]
fn readers_on_other_threads_get_complete_states_only() {
    let mut map = JointMap::new(ARM, &grid(5.0)).unwrap();
    let (here, there) = (Vec3::new(1.2, 0.3, 0.9), Vec3::new(1.2, -0.9, 1.1));
    let balls = [here, there].map(|at| ConvexObstacle::sphere(at, 0.2).unwrap());
    let states = balls.each_ref().map(|ball| fill(&ARM, map.grid(), ball));
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            let (mut reader, states, done) = (map.reader(), &states, &done);
            scope.spawn(move || {
                while !done.load(Ordering::Acquire) {
                    let before = reader.current().clone();
                    let changes = reader.refresh();
                    let after = reader.current();
                    let known = after.version() == 0 || states.iter().any(|state| state == after.occupancy());
                    assert!(known && after.version() >= before.version());
                    assert_eq!(changes.blocked() + before.blocked(), changes.freed() + after.blocked());
                }
            });
        }
        for i in 0..300 {
            map.set_obstacle("ball", &balls[i % 2]);
            map.publish();
        }
        done.store(true, Ordering::Release);
    });
}

#[test]
fn outside_the_limits_is_blocked() {
    let map = JointMap::new(ARM, &grid(5.0)).unwrap();
    assert!(!map.is_blocked([0.0, 0.0, 0.0]));
    assert!(map.is_blocked([3.1, 0.0, 0.0]) && map.is_blocked([0.0, f64::NAN, 0.0]));
}
