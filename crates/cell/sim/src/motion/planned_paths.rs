//! The paths of a cell's planned moves, each computed once.

use std::borrow::Cow;
use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

use elbowroom_cell::trajectory::Playback;
use elbowroom_cell::{Cell, CellRobot, ProgramBody, StepAction};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::LinkId;
use elbowroom_query::plan::PathQuery;
use elbowroom_robot::RobotId;

use super::planned_parts::PlannedParts;

/// The paths of a cell's planned moves, each searched once.
///
/// A search takes seconds. `check`, a run, and the same run without the monitor share one `PlannedPaths`.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_sim::{PlannedPaths, RunOptions, check, run::simulate_observed};
/// let cell = Cell::parse("arm.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }]
/// links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [program.arm]
/// steps = [{ move = "planned", to = [90] }]
/// "#)?;
/// let searches = std::cell::Cell::new(0);
/// let paths = PlannedPaths::new(&cell).with_progress(|search| searches.set(search.number));
/// check::overruns(&paths)?;
/// let by_check = searches.get(); // the move, and once more from where it ends: programs may be repeated
/// simulate_observed(&paths, &RunOptions::default(), &mut |_| (), None)?;
/// assert_eq!((by_check, searches.get()), (2, 2));
/// # Ok::<(), elbowroom_diagnostic::Diagnostic>(())
/// ```
pub struct PlannedPaths<'a> {
    cell: &'a Cell,
    known: RefCell<Vec<(PathOrigin<'a>, SearchedPath)>>,
    queries: RefCell<Vec<ToolingQuery<'a>>>,
    progress: Box<dyn Fn(PathSearch) + 'a>,
}

/// A path, or the error of its search.
type SearchedPath = Result<Arc<Playback>, Diagnostic>;

/// The tools of a robot that changes them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tooling {
    pub robot: RobotId,
    pub flange: LinkId,
    /// Whether each tool is mounted.
    pub mounted: Vec<bool>,
}

impl Tooling {
    pub fn of(id: RobotId, robot: &CellRobot) -> Self {
        let mounted = robot.payload.tools.iter().map(|tool| tool.mounted).collect();
        Self { robot: id, flange: robot.flange, mounted }
    }
}

/// The query of the cell in which a robot has these tools. Robots that do not change their tools share the one with `None`.
type ToolingQuery<'a> = (Option<Tooling>, PathQuery<Cow<'a, Cell>>);

/// A search that starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathSearch {
    /// Number of the search, from 1.
    pub number: usize,
    /// Estimate of the number of searches: the number of planned moves in the programs.
    ///
    /// Equal moves are searched once; a move with several starts is searched several times.
    pub of: usize,
}

/// Everything in a cell that a path depends on: the step, the joint values at its start, the tools, and the places of
/// parts.
#[derive(PartialEq)]
pub(super) struct PathOrigin<'a> {
    pub tooling: Tooling,
    pub step: usize,
    pub from: Vec<f64>,
    pub parts: PlannedParts<'a>,
}

impl<'a> PlannedPaths<'a> {
    /// Creates an empty set of paths.
    pub fn new(cell: &'a Cell) -> Self {
        Self { cell, known: RefCell::default(), queries: RefCell::default(), progress: Box::new(|_| ()) }
    }

    /// Calls `progress` before each search.
    #[must_use]
    pub fn with_progress(self, progress: impl Fn(PathSearch) + 'a) -> Self {
        Self { progress: Box::new(progress), ..self }
    }

    /// The cell.
    pub fn cell(&self) -> &'a Cell {
        self.cell
    }

    /// Returns the path from an origin, or the error of its search. Searches a path that is not yet known.
    pub(super) fn known_or(
        &self,
        origin: PathOrigin<'a>,
        search: impl FnOnce() -> Result<Playback, Diagnostic>,
    ) -> SearchedPath {
        let known = self.known.borrow().iter().find(|(known, _)| *known == origin).map(|(_, path)| path.clone());
        if let Some(path) = known {
            return path;
        }
        let number = self.known.borrow().len() + 1;
        (self.progress)(PathSearch { number, of: planned_moves(self.cell).max(number) });
        let path = search().map(Arc::new);
        self.known.borrow_mut().push((origin, path.clone()));
        path
    }

    /// Asks the query of the cell in which a robot has the tools that it has now.
    pub(super) fn ask<T>(
        &self,
        id: RobotId,
        robot: &CellRobot,
        ask: impl FnOnce(&mut PathQuery<Cow<'a, Cell>>) -> Result<T, Diagnostic>,
    ) -> Result<T, Diagnostic> {
        let tooling = (!robot.payload.tools.is_empty()).then(|| Tooling::of(id, robot));
        let mut queries = self.queries.borrow_mut();
        if let Some((_, query)) = queries.iter_mut().find(|(known, _)| *known == tooling) {
            return ask(query);
        }
        let mut cell = Cow::Borrowed(self.cell);
        if tooling.is_some() {
            cell.to_mut().robots[id.0] = robot.clone();
        }
        let mut query = PathQuery::new(cell)?;
        let answer = ask(&mut query);
        queries.push((tooling, query));
        answer
    }
}

impl fmt::Debug for PlannedPaths<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PlannedPaths").field("known", &self.known.borrow().len()).finish_non_exhaustive()
    }
}

/// Number of planned moves in all programs.
fn planned_moves(cell: &Cell) -> usize {
    let steps = cell.robots.iter().filter_map(|robot| robot.program.as_ref()).map(|program| match &program.body {
        ProgramBody::Steps(steps) => steps.as_slice(),
        ProgramBody::Trajectory(_) => &[],
    });
    steps.flatten().filter(|step| matches!(step.action, StepAction::Planned { .. })).count()
}
