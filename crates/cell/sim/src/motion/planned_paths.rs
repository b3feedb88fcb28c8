//! The paths of a cell's planned moves, each computed once.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

use elbowroom_cell::trajectory::Playback;
use elbowroom_cell::{Cell, ProgramBody, StepAction};
use elbowroom_formats::FormatError;
use elbowroom_kinematics::LinkId;
use elbowroom_robot::RobotId;

use super::planned_parts::PlannedParts;

/// The paths of a cell's planned moves. A search takes seconds: `check`, a run, and the run without the monitor beside it use one
/// of these, and each path is searched once.
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
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub struct PlannedPaths<'a> {
    cell: &'a Cell,
    known: RefCell<Vec<(PathOrigin<'a>, SearchedPath)>>,
    progress: Box<dyn Fn(PathSearch) + 'a>,
}

/// A path, or why there is none.
type SearchedPath = Result<Arc<Playback>, FormatError>;

/// A search that begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathSearch {
    /// Which one, from 1.
    pub number: usize,
    /// How many moves the programs plan: more than there are searches where moves are equal, fewer where a move begins in several
    /// ways.
    pub of: usize,
}

/// All that a path depends on in a cell: the step, joint values at its begin, the tools, and where parts are.
#[derive(PartialEq)]
pub(super) struct PathOrigin<'a> {
    pub robot: RobotId,
    pub step: usize,
    pub from: Vec<f64>,
    pub flange: LinkId,
    /// Per tool of the robot whether it is mounted.
    pub mounted: Vec<bool>,
    pub parts: PlannedParts<'a>,
}

impl<'a> PlannedPaths<'a> {
    /// None yet.
    pub fn new(cell: &'a Cell) -> Self {
        Self { cell, known: RefCell::default(), progress: Box::new(|_| ()) }
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

    /// The path from an origin, or why there is none; searched where that is not known.
    pub(super) fn known_or(
        &self,
        origin: PathOrigin<'a>,
        search: impl FnOnce() -> Result<Playback, FormatError>,
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
}

impl fmt::Debug for PlannedPaths<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PlannedPaths").field("known", &self.known.borrow().len()).finish_non_exhaustive()
    }
}

/// The planned moves of all programs.
fn planned_moves(cell: &Cell) -> usize {
    let steps = cell.programs.iter().flatten().map(|program| match &program.body {
        ProgramBody::Steps(steps) => steps.as_slice(),
        ProgramBody::Trajectory(_) => &[],
    });
    steps.flatten().filter(|step| matches!(step.action, StepAction::Planned { .. })).count()
}
