//! `elbowroom query`: collision, distance or tolerance, one row per state.

use std::path::Path;

use elbowroom::cell::{Cell, OutOfReachProofs, PairFile, QueryModel};
use elbowroom::formats::robot::{self, LoadOptions};
use elbowroom::query::{
    ContactRecord, ContactRow, Level, LimitRecord, LimitRow, MotionRecord, MotionRow, Query, QueryChecker, QueryEffort,
    QueryKind, QueryPairs, QueryPairsError, QueryRecord, QueryRow, QueryStates, evaluate_contacts, evaluate_limits,
    evaluate_motions, evaluate_query,
};
use elbowroom::scene::{CheckerOptions, Scene, SceneState};
use elbowroom::spatial::units::LengthUnit;

use crate::args::QueryArgs;
use crate::carry;
use crate::output::{ExitStatus, Failure, note, print};
use crate::progress::Progress;
use crate::query_times::QueryTimes;
use crate::states;

/// A tolerance (m) above this value is probably in another unit.
const DOUBTFUL_TOLERANCE_M: f64 = 2.0;

/// From this number of states on, pairs that cannot reach each other are excluded first.
const MANY: usize = 1000;

pub(crate) fn query(args: &QueryArgs) -> Result<ExitStatus, Failure> {
    check_combination(args)?;
    let effort = &args.effort;
    let (mut model, cell) = query_model(args)?;
    if let Some(cell) = &cell {
        model.carried.extend(carry::attachments(cell, &args.carry)?);
    }
    if let Some(path) = &args.pairs {
        let rules = PairFile::read(path)?.rules(&model)?;
        model.add_rules(rules);
    }
    if model.is_single_robot {
        model.touching_at_rest().iter().for_each(|w| note(format_args!("warning: {w}")));
    }
    doubt(args.ask);
    let pairs = query_pairs(args, &mut model, cell.as_ref())?;
    let states = match &args.states {
        Some(path) => states::read(path, &model)?,
        None => QueryStates::start(&model),
    };
    if args.ask == QueryKind::Time && states.len() < 2 {
        let what = "--ask time is about the motion from each state to the next\n  write: --states FILE.csv with two rows or more";
        return Err(Failure::Wrong(what.to_owned()));
    }
    states.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let is_of_pairs = args.ask != QueryKind::Limits;
    let is_worth_it = is_of_pairs && !effort.no_matrix && (states.len() >= MANY || effort.times);
    let proofs = if is_worth_it { OutOfReachProofs::Compute } else { OutOfReachProofs::Omit };
    let scene = model.scene(proofs)?;
    let start = model.start_state(&scene)?;
    if is_of_pairs && has_no_pair(&scene, &start, &pairs) {
        note(format_args!("warning: {}: there is no pair that could meet", model.file.display()));
    }
    let mut writer = Writer::new(args, &model, states.len());
    writer.begin()?;
    let options = CheckerOptions {
        level: effort.level,
        start: effort.start,
        weights: !effort.no_weights,
        matrix: !effort.no_matrix,
    };
    let (kind, all_pairs_m, is_timed) = (args.ask, args.all_pairs, effort.times);
    let query = Query { kind, options, is_timed, pairs: &pairs, all_pairs_m, start: &start, threads: None };
    let effort = answer((&scene, &model), &states, &query, &mut writer)?;
    writer.end(effort)?;
    Ok(if args.ask == QueryKind::Collision && writer.counted > 0 {
        ExitStatus::NegativeResult
    } else {
        ExitStatus::Success
    })
}

/// Answers the states, and prints the rows.
fn answer(
    (scene, model): (&Scene, &QueryModel),
    states: &QueryStates,
    query: &Query<'_>,
    writer: &mut Writer<'_>,
) -> Result<QueryEffort, Failure> {
    let mut outcome = Ok(());
    let effort = match query.kind {
        QueryKind::Contacts => evaluate_contacts(scene, states, query, &mut |rows| {
            outcome = writer.rows(rows.iter().map(|row| WrittenRow::contact(row, model)));
            outcome.is_ok()
        })?,
        QueryKind::Time => evaluate_motions(scene, states, query, &mut |rows| {
            outcome = writer.rows(rows.iter().map(|row| WrittenRow::motion(row, model)));
            outcome.is_ok()
        })?,
        QueryKind::Limits => evaluate_limits(model, states, &mut |rows| {
            outcome = writer.rows(rows.iter().map(|row| WrittenRow::limits(row, model)));
            outcome.is_ok()
        })?,
        _ => evaluate_query(scene, states, query, &mut |rows| {
            outcome = writer.rows(rows.iter().map(|row| WrittenRow::state(row, model)));
            outcome.is_ok()
        })?,
    };
    outcome.map(|()| effort)
}

/// Refuses options that do not go together.
fn check_combination(args: &QueryArgs) -> Result<(), Failure> {
    if args.all_pairs.is_some() && args.ask != QueryKind::Distance {
        return Err(Failure::Wrong("--all-pairs lists distances\n  write: --ask distance --all-pairs 0.1".to_owned()));
    }
    let effort = &args.effort;
    if args.ask == QueryKind::Limits {
        return check_limits(args);
    }
    let is_exact = matches!(effort.level, Level::Auto | Level::L3);
    if !is_exact && matches!(args.ask, QueryKind::Point | QueryKind::Contacts) {
        let what = "points and contacts are those of the exact geometry\n  write: --level auto, or none";
        return Err(Failure::Wrong(what.to_owned()));
    }
    if !matches!(effort.start, Level::L1 | Level::L2 | Level::L3)
        || effort.start != Level::L1 && effort.level != Level::Auto
    {
        let what =
            format!("--start {}: is the first level of --level auto\n  write: --start L1, L2 or L3", effort.start);
        return Err(Failure::Wrong(what));
    }
    Ok(())
}

/// Refuses options about pairs in a question about joint limits.
fn check_limits(args: &QueryArgs) -> Result<(), Failure> {
    let effort = &args.effort;
    let about_pairs = [
        ("--pairs", args.pairs.is_some()),
        ("--between", args.between.is_some()),
        ("--no-self", args.no_self),
        ("--carry", !args.carry.is_empty()),
        ("--level", effort.level != Level::Auto),
        ("--start", effort.start != Level::L1),
        ("--no-matrix", effort.no_matrix),
        ("--no-weights", effort.no_weights),
        ("--times", effort.times),
    ];
    let Some((option, _)) = about_pairs.into_iter().find(|(_, is_given)| *is_given) else { return Ok(()) };
    Err(Failure::Wrong(format!(
        "{option} is about pairs of links and objects; --ask limits compares joint values with their limits\n  \
         write: --ask limits without {option}"
    )))
}

/// Warns that a tolerance may be in another unit.
fn doubt(ask: QueryKind) {
    if let QueryKind::Tolerance(metres) = ask
        && metres > DOUBTFUL_TOLERANCE_M
    {
        let meant = metres * 1e-3;
        note(format_args!(
            "warning: tolerance={metres} is {metres} m, more than robots keep: tolerance={meant} is {metres} mm"
        ));
    }
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
    !QueryChecker::new(scene, CheckerOptions::default(), pairs).has_pair(start)
}

/// Loads the model, and its cell if it comes from a cell file.
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
        return Ok((QueryModel::of_robot(urdf, loaded.robot), None));
    }
    // clap requires a cell or --urdf.
    let path = args.cell.as_deref().unwrap_or(Path::new(""));
    if args.joints.joints.is_some() || !args.joints.joint.is_empty() {
        let what =
            "--joints and --joint go with --urdf MODEL\n  write: joints = \"FILE\" beside `model` in the cell file";
        return Err(Failure::Wrong(what.to_owned()));
    }
    let is_model = |e: &str| path.extension().is_some_and(|x| x.eq_ignore_ascii_case(e));
    if ["urdf", "3ds", "glb", "gltf", "wrl", "wrz"].into_iter().any(is_model) {
        let path = path.display();
        return Err(Failure::Wrong(format!("{path}: is a robot, not a cell file\n  write: --urdf {path}")));
    }
    let cell = Cell::load(path)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    Ok((QueryModel::of_cell(&cell), Some(cell)))
}

/// A row to print.
struct WrittenRow {
    index: usize,
    /// Whether its state counts: as colliding, or as beyond limits.
    counts: bool,
    record: Record,
}

#[derive(serde::Serialize)]
#[serde(untagged)]
enum Record {
    State(Box<QueryRecord>),
    Contact(Box<ContactRecord>),
    Motion(Box<MotionRecord>),
    Limits(Box<LimitRecord>),
}

impl WrittenRow {
    fn state(row: &QueryRow, model: &QueryModel) -> Self {
        let record = Record::State(Box::new(QueryRecord::of(row, model)));
        Self { index: row.index, counts: row.collides, record }
    }

    fn contact(row: &ContactRow, model: &QueryModel) -> Self {
        Self { index: row.index, counts: true, record: Record::Contact(Box::new(ContactRecord::of(row, model))) }
    }

    fn motion(row: &MotionRow, model: &QueryModel) -> Self {
        let record = Record::Motion(Box::new(MotionRecord::of(row, model)));
        Self { index: row.index, counts: row.hit.is_some(), record }
    }

    fn limits(row: &LimitRow, model: &QueryModel) -> Self {
        let record = Record::Limits(Box::new(LimitRecord::of(row, model)));
        Self { index: row.index, counts: row.farthest.is_some(), record }
    }
}

impl Record {
    fn csv(&self) -> String {
        match self {
            Self::State(record) => record.csv(),
            Self::Contact(record) => record.csv(),
            Self::Motion(record) => record.csv(),
            Self::Limits(record) => record.csv(),
        }
    }
}

/// Prints rows in order, and the progress on a terminal.
struct Writer<'a> {
    args: &'a QueryArgs,
    model: &'a QueryModel,
    states: usize,
    /// States that have been answered.
    done: usize,
    is_first: bool,
    /// States that count: as colliding, or as beyond limits.
    counted: usize,
    /// Index of the last state that was counted.
    last_counted: Option<usize>,
    progress: Progress,
}

impl<'a> Writer<'a> {
    fn new(args: &'a QueryArgs, model: &'a QueryModel, states: usize) -> Self {
        let progress = Progress::of(states, "states");
        Self { args, model, states, done: 0, is_first: true, counted: 0, last_counted: None, progress }
    }

    fn begin(&self) -> Result<(), Failure> {
        if !self.args.json {
            let header = match self.args.ask {
                QueryKind::Contacts => ContactRecord::HEADER,
                QueryKind::Time => MotionRecord::HEADER,
                QueryKind::Limits => LimitRecord::HEADER,
                _ => QueryRecord::HEADER,
            };
            return print(&format!("{header}\n"));
        }
        let (ask, tolerance) = match self.args.ask {
            QueryKind::Collision => ("collision", None),
            QueryKind::Distance => ("distance", None),
            QueryKind::Tolerance(t) => ("tolerance", Some(t)),
            QueryKind::Point => ("point", None),
            QueryKind::Contacts => ("contacts", None),
            QueryKind::Time => ("time", None),
            QueryKind::Limits => ("limits", None),
        };
        let file = json(&self.model.file.display().to_string())?;
        let level = self.args.effort.level;
        let (ask, tolerance, states) = (json(&ask)?, json(&tolerance)?, self.states);
        print(&format!(
            "{{\n\"model\": {file},\n\"ask\": {ask},\n\"tolerance_m\": {tolerance},\n\"level\": \"{level}\",\n\
             \"states\": {states},\n\"rows\": [\n"
        ))
    }

    fn rows(&mut self, rows: impl Iterator<Item = WrittenRow>) -> Result<(), Failure> {
        let mut text = String::new();
        for row in rows {
            if self.args.json {
                text.push_str(if self.is_first { "" } else { ",\n" });
                self.is_first = false;
                text.push_str(&json(&row.record)?);
            } else {
                text.push_str(&row.record.csv());
                text.push('\n');
            }
            // Several contacts of one state count as one colliding state.
            let is_new = self.args.ask != QueryKind::Contacts || self.last_counted != Some(row.index);
            if row.counts && is_new {
                self.counted += 1;
                self.last_counted = Some(row.index);
            }
            self.done = row.index + 1;
        }
        let what = if self.args.ask == QueryKind::Limits { "beyond limits" } else { "in contact" };
        self.progress.count(self.done, &format!("{} {what}", self.counted));
        print(&text)
    }

    fn end(&self, effort: QueryEffort) -> Result<(), Failure> {
        self.progress.end();
        let times = self.args.effort.times.then(|| QueryTimes::of(effort));
        if self.args.json {
            let times = times.map_or(Ok(String::new()), |t| json(&t).map(|t| format!(",\n\"times\": {t}")))?;
            let count = if self.args.ask == QueryKind::Limits { "beyond" } else { "colliding" };
            return print(&format!("\n],\n\"{count}\": {}{times}\n}}\n", self.counted));
        }
        if let Some(times) = times {
            note(format_args!("{times}"));
        }
        Ok(())
    }
}

fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|e| Failure::Wrong(e.to_string()))
}
