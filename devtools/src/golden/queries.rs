//! Queries of random states of every robot and cell of the data, by the functions that the command `query` uses.

use std::fmt::Write as _;
use std::path::Path;

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_query::{Level, PairColumns, QueryKind, QueryRecord, QueryStates, evaluate};

use super::digest::Digest;
use super::hashed_group::HashedGroup;
use super::part::Part;
use super::progress::Progress;
use crate::cross_validation::world::{self, Files};

/// Queries of each state: collision, distance, and whether anything is within 20 mm.
const KINDS: [QueryKind; 3] = [QueryKind::Collision, QueryKind::Distance, QueryKind::Tolerance(0.02)];

/// Hashes this many rows, evenly distributed over the robots: half of them of the robot alone, half with two objects
/// beside it.
pub fn groups(root: &Path, data: &Path, rows: usize) -> Result<Vec<HashedGroup>, String> {
    let robots = world::find(data);
    let mut progress = Progress::new(Part::Queries, robots.len());
    let mut groups = Vec::new();
    for (i, files) in robots.iter().enumerate() {
        let share = rows / robots.len() + usize::from(i < rows % robots.len());
        groups.extend(of_robot(root, files, share)?);
        progress.done(i + 1, &files.name);
    }
    Ok(groups)
}

fn of_robot(root: &Path, files: &Files, rows: usize) -> Result<Vec<HashedGroup>, String> {
    let robot = world::load(files, true)?;
    let states = world::states(&robot, rows);
    let (alone, with_objects) = states.split_at(rows.div_ceil(2));
    let mut model = QueryModel::of_robot(&files.urdf, robot);
    let mut groups = Vec::new();
    if !alone.is_empty() {
        groups.push(HashedGroup::new(&files.name, digest(&model, alone)?, alone.len()));
    }
    if !with_objects.is_empty() {
        let scene = model.scene(OutOfReachProofs::Omit).map_err(|e| e.to_string())?;
        model.objects = world::objects(root, &scene)?;
        let name = format!("{}+objects", files.name);
        groups.push(HashedGroup::new(&name, digest(&model, with_objects)?, with_objects.len()));
    }
    Ok(groups)
}

/// Hashes all rows of the first kind, then all of the next.
pub fn digest(model: &QueryModel, states: &[Vec<f64>]) -> Result<Digest, String> {
    let states = QueryStates::parse(&model.file, &table(model, states), model).map_err(|e| e.to_string())?;
    let scene = model.scene(OutOfReachProofs::Compute).map_err(|e| e.to_string())?;
    let mut digest = Digest::default();
    for kind in KINDS {
        let mut add = |rows: &[_]| {
            for row in rows {
                add_record(&mut digest, &QueryRecord::of(row, model));
            }
            true
        };
        evaluate(&scene, &states, kind, Level::Auto, &mut add).map_err(|e| e.to_string())?;
    }
    Ok(digest)
}

/// Formats the states as a file of `query --states`.
fn table(model: &QueryModel, states: &[Vec<f64>]) -> String {
    let chain = &model.robots[0].robot.chain;
    let names: Vec<&str> = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str()).collect();
    let mut table = names.join(",");
    for state in states {
        for (i, value) in state.iter().enumerate() {
            let _ = write!(table, "{}{value:?}", if i == 0 { '\n' } else { ',' });
        }
    }
    table
}

/// Adds the contents of a row, except for the level of its answer.
fn add_record(digest: &mut Digest, record: &QueryRecord) {
    digest.whole(record.index);
    digest.flag(record.collides == 1);
    digest.some_number(record.distance_m);
    let PairColumns { a, b, ax, ay, az, bx, by, bz } = &record.pair;
    for name in [a, b] {
        digest.text(name.as_deref().unwrap_or_default());
    }
    for coordinate in [ax, ay, az, bx, by, bz] {
        digest.some_number(*coordinate);
    }
}
