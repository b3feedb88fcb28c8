//! `elbowroom query`: collision, distance or tolerance, one row per state.

use std::path::Path;

use elbowroom::analysis::query::{
    Query, QueryKind, QueryPairs, QueryPairsError, QueryRecord, QueryRow, QueryStates, evaluate_query,
};
use elbowroom::cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom::formats::robot::{self, LoadOptions};
use elbowroom::scene::{Checker, CheckerOptions, Scene, SceneState};
use elbowroom::spatial::units::LengthUnit;

use crate::args::QueryArgs;
use crate::carry;
use crate::output::{ExitStatus, Failure, note, print};
use crate::progress::Progress;
use crate::states;

/// From this number of states on, pairs out of reach of each other are excluded first.
const MANY: usize = 1000;

pub(crate) fn query(args: &QueryArgs) -> Result<ExitStatus, Failure> {
    if args.all_pairs.is_some() && args.ask != QueryKind::Distance {
        return Err(Failure::Wrong("--all-pairs lists distances\n  write: --ask distance --all-pairs 0.1".to_owned()));
    }
    let (mut model, cell) = query_model(args)?;
    if let Some(cell) = &cell {
        model.carried.extend(carry::attachments(cell, &args.carry)?);
    }
    let pairs = query_pairs(args, &mut model, cell.as_ref())?;
    let states = match &args.states {
        Some(path) => states::read(path, &model)?,
        None => QueryStates::start(&model),
    };
    states.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let proofs = if states.len() >= MANY { OutOfReachProofs::Compute } else { OutOfReachProofs::Omit };
    let scene = model.scene(proofs)?;
    let start = model.start_state(&scene)?;
    if has_no_pair(&scene, &start, &pairs) {
        note(format_args!("warning: {}: there is no pair that could meet", model.file.display()));
    }
    let mut writer = Writer::new(args, &model, states.len());
    writer.begin()?;
    let mut outcome = Ok(());
    let query = Query { kind: args.ask, level: args.level, pairs: &pairs, all_pairs_m: args.all_pairs, start: &start };
    evaluate_query(&scene, &states, &query, &mut |rows| {
        outcome = writer.rows(rows);
        outcome.is_ok()
    })?;
    outcome?;
    writer.end()?;
    Ok(if args.ask == QueryKind::Collision && writer.colliding > 0 {
        ExitStatus::NegativeResult
    } else {
        ExitStatus::Success
    })
}

fn query_pairs(args: &QueryArgs, model: &mut QueryModel, cell: Option<&Cell>) -> Result<QueryPairs, Failure> {
    let Some(text) = &args.between else {
        return Ok(if args.no_self { QueryPairs::without_self(model) } else { QueryPairs::all() });
    };
    let wrong = |e: QueryPairsError| Failure::Wrong(format!("--between: {e}"));
    let pairs = QueryPairs::between(text, model, cell).map_err(wrong)?;
    if args.no_self { pairs.expect_without_self(model).map_err(wrong) } else { Ok(pairs) }
}

fn has_no_pair(scene: &Scene, start: &SceneState, pairs: &QueryPairs) -> bool {
    let mut checker = Checker::new(scene, CheckerOptions::default());
    pairs.sides().iter().all(|&[a, b]| checker.between(a, b).is_empty(start))
}

/// The model, and the cell where it is one.
fn query_model(args: &QueryArgs) -> Result<(QueryModel, Option<Cell>), Failure> {
    if let Some(urdf) = &args.urdf {
        let unit = args.unit.map(LengthUnit::from);
        let options = LoadOptions {
            srdf: args.srdf.clone(),
            load_visuals: false,
            unit,
            joints: args.joints.joints.clone(),
            joint: args.joints.joint.clone(),
        };
        let loaded = robot::load(urdf, &options)?;
        loaded.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
        let model = QueryModel::of_robot(urdf, loaded.robot);
        model.touching_at_rest().iter().for_each(|w| note(format_args!("warning: {w}")));
        return Ok((model, None));
    }
    // clap requires one of the two.
    let path = args.cell.as_deref().unwrap_or(Path::new(""));
    if args.joints.joints.is_some() || !args.joints.joint.is_empty() {
        let what =
            "--joints and --joint go with --urdf MODEL\n  write: joints = \"FILE\" beside `model` in the cell file";
        return Err(Failure::Wrong(what.to_owned()));
    }
    let is_model = |e: &str| path.extension().is_some_and(|x| x.eq_ignore_ascii_case(e));
    if ["urdf", "3ds", "glb", "gltf"].into_iter().any(is_model) {
        let path = path.display();
        return Err(Failure::Wrong(format!("{path}: is a robot, not a cell file\n  write: --urdf {path}")));
    }
    let cell = Cell::load(path)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    Ok((QueryModel::of_cell(&cell), Some(cell)))
}

/// Prints rows in order, and the progress on a terminal.
struct Writer<'a> {
    args: &'a QueryArgs,
    model: &'a QueryModel,
    states: usize,
    /// States that have been answered.
    done: usize,
    is_first: bool,
    colliding: usize,
    progress: Progress,
}

impl<'a> Writer<'a> {
    fn new(args: &'a QueryArgs, model: &'a QueryModel, states: usize) -> Self {
        let progress = Progress::of(states, "states");
        Self { args, model, states, done: 0, is_first: true, colliding: 0, progress }
    }

    fn begin(&self) -> Result<(), Failure> {
        if !self.args.json {
            return print(&format!("{}\n", QueryRecord::HEADER));
        }
        let (ask, tolerance) = match self.args.ask {
            QueryKind::Collision => ("collision", None),
            QueryKind::Distance => ("distance", None),
            QueryKind::Tolerance(t) => ("tolerance", Some(t)),
        };
        let file = json(&self.model.file.display().to_string())?;
        let level = self.args.level;
        let (ask, tolerance, states) = (json(&ask)?, json(&tolerance)?, self.states);
        print(&format!(
            "{{\n\"model\": {file},\n\"ask\": {ask},\n\"tolerance_m\": {tolerance},\n\"level\": \"{level}\",\n\
             \"states\": {states},\n\"rows\": [\n"
        ))
    }

    fn rows(&mut self, rows: &[QueryRow]) -> Result<(), Failure> {
        let mut text = String::new();
        for row in rows {
            let written = QueryRecord::of(row, self.model);
            if self.args.json {
                text.push_str(if self.is_first { "" } else { ",\n" });
                self.is_first = false;
                text.push_str(&json(&written)?);
            } else {
                text.push_str(&written.csv());
                text.push('\n');
            }
            self.done = row.index + 1;
            self.colliding += usize::from(row.collides);
        }
        self.progress.count(self.done, &format!("{} in contact", self.colliding));
        print(&text)
    }

    fn end(&self) -> Result<(), Failure> {
        self.progress.end();
        if self.args.json { print(&format!("\n],\n\"colliding\": {}\n}}\n", self.colliding)) } else { Ok(()) }
    }
}

fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|e| Failure::Wrong(e.to_string()))
}
