//! Layers, changes, snapshots.

mod common;

use std::sync::atomic::{AtomicBool, Ordering};

use common::{Random, fill, grid};
use elbowroom_cspace::{Cell, Changes, JointMap, Obstacle, PlanarArm, Table};
use elbowroom_spatial::{Pose, Vec3};

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

fn random_obstacle(random: &mut Random) -> Obstacle {
    let at = Vec3::new(random.within(-1.8, 1.8), random.within(-1.8, 1.8), random.within(-0.3, 2.2));
    if random.below(2) == 0 {
        return Obstacle::sphere(at, random.within(0.0, 0.5)).unwrap();
    }
    let rpy = random.vector(3.0);
    let pose = Pose::from_xyz_rpy([at.x, at.y, at.z], [rpy.x, rpy.y, rpy.z]);
    Obstacle::cuboid(pose, random.vector(0.5).abs()).unwrap()
}

/// The table of some obstacles, made anew.
fn anew(map: &JointMap, fixed: &[Obstacle], obstacles: &[(usize, Obstacle)]) -> Table {
    let mut table = Table::new(map.grid().shape());
    let mut cells: Vec<Cell> =
        fixed.iter().flat_map(|o| fill(&ARM, map.grid(), o).iter().collect::<Vec<_>>()).collect();
    cells.extend(obstacles.iter().flat_map(|(_, o)| fill(&ARM, map.grid(), o).iter().collect::<Vec<_>>()));
    let rows = map.grid().shape()[1] as u32;
    for [i, j, k] in cells {
        table.block(elbowroom_cspace::Span { row: u32::from(i) * rows + u32::from(j), first: k, last: k });
    }
    table
}

/// Applies changes to a copy of the table before, checking that each cell was what it is said to have been.
fn apply(before: &Table, changes: &Changes) -> Vec<Cell> {
    let mut cells: std::collections::BTreeSet<Cell> = before.iter().collect();
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
fn obstacles_enter_move_and_leave_as_if_all_were_made_anew() {
    let mut random = Random(3);
    let mut map = JointMap::new(ARM, &grid(5.0)).unwrap();
    let fixed = [random_obstacle(&mut random)];
    map.set_fixed(&fixed);
    let mut there: Vec<(usize, Obstacle)> = Vec::new();
    for step in 0..60 {
        let before = map.table().clone();
        let name = random.below(4);
        there.retain(|(other, _)| *other != name);
        let changes = if random.below(4) == 0 {
            map.remove(&name.to_string()).cloned().unwrap_or_default()
        } else {
            let obstacle = random_obstacle(&mut random);
            there.push((name, obstacle.clone()));
            map.set(&name.to_string(), &obstacle).clone()
        };
        assert!(*map.table() == anew(&map, &fixed, &there), "step {step}");
        assert_eq!(apply(&before, &changes), map.table().iter().collect::<Vec<_>>(), "step {step}");
        let counted = Changes::between(&before, map.table());
        assert_eq!((counted.blocked(), counted.freed()), (changes.blocked(), changes.freed()));
    }
}

#[test]
fn readers_on_other_threads_see_whole_states_only() {
    let mut map = JointMap::new(ARM, &grid(5.0)).unwrap();
    let (here, there) = (Vec3::new(1.2, 0.3, 0.9), Vec3::new(1.2, -0.9, 1.1));
    let balls = [here, there].map(|at| Obstacle::sphere(at, 0.2).unwrap());
    let states = balls.each_ref().map(|ball| fill(&ARM, map.grid(), ball));
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            let (mut reader, states, done) = (map.reader(), &states, &done);
            scope.spawn(move || {
                while !done.load(Ordering::Acquire) {
                    let before = reader.seen().clone();
                    let changes = reader.refresh();
                    let now = reader.seen();
                    let known = now.version() == 0 || states.iter().any(|state| state == now.table());
                    assert!(known && now.version() >= before.version());
                    assert_eq!(changes.blocked() + before.blocked(), changes.freed() + now.blocked());
                }
            });
        }
        for i in 0..300 {
            map.set("ball", &balls[i % 2]);
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
