//! Search for an escape before a hit.

use elbowroom_avoidance::{DynamicObstacles, ObservedObject, search_escape_tree};
use elbowroom_cell::{Cell, Drive, ObjectPath, OutOfReachProofs, QueryModel};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_sim::Recording;
use elbowroom_sim::run::evasion_limits;
use elbowroom_testkit::random::Random;

/// Times before a hit from which an escape is searched, s.
const EXPLAINED_S: [f64; 7] = [3.0, 2.5, 2.0, 1.5, 1.0, 0.75, 0.5];
/// Time after the hit for which an escape must stay free, s.
const AFTER_HIT_S: f64 = 1.5;

/// Searches an escape from the states of the robot before a hit, in space and time, and prints the result.
pub fn explain(
    cell: &Cell,
    object: ObjectId,
    path: &ObjectPath,
    run: &Recording,
    hit_s: f64,
    tries: usize,
) -> Result<(), Box<dyn std::error::Error>> {
    let robot = RobotId(0);
    let mut cell = cell.clone();
    cell.moving_objects.iter_mut().filter(|m| m.object == object).for_each(|m| m.drive = Drive::Path(path.clone()));
    let scene = QueryModel::of_cell(&cell).scene(OutOfReachProofs::Omit)?;
    let limits = evasion_limits(&cell, robot);
    let samples = &run.robots[0].samples;
    for before_s in EXPLAINED_S {
        let Some(at) = samples.iter().rposition(|s| s.t_s <= hit_s - before_s).filter(|n| *n > 0) else { continue };
        let (last, now) = (&samples[at - 1], &samples[at]);
        let qd: Vec<f64> = now.q.iter().zip(&last.q).map(|(a, b)| (a - b) / run.tick_s).collect();
        // The obstacle moves in a straight line, so its present motion is its true path.
        let seen = cell.moving_objects.iter().map(|m| ObservedObject {
            object: m.object,
            in_world: m.pose(now.t_s),
            motion: m.motion(now.t_s),
            known: m.object != object,
        });
        let objects: Vec<ObservedObject> = seen.collect();
        let obstacles = DynamicObstacles { objects: &objects, robots: &[] };
        let mut random = Random(1);
        let horizon_s = before_s + AFTER_HIT_S;
        let from = [&now.q[..], &qd[..]];
        let found = search_escape_tree(&scene, robot, &limits, from, &obstacles, horizon_s, tries, &mut || {
            random.between(0.0, 1.0)
        })?;
        let outcome = found.gap_m.map_or_else(|| "no escape".to_owned(), |gap| format!("an escape, gap {gap:.3} m"));
        println!(
            "  {before_s:.2} s before the hit: {outcome} after {} motions; longest without a hit {:.2} s of {horizon_s:.2} s",
            found.tries, found.longest_s
        );
    }
    Ok(())
}
