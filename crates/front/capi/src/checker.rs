//! The changing part: joint values of one thread, and its checker.

use std::ffi::c_int;
use std::mem::MaybeUninit;

use elbowroom::kinematics::LinkId;
use elbowroom::query::{Level, QueryKind, QueryRow};
use elbowroom::robot::{GeometryId, RobotId};
use elbowroom::scene::{CheckerOptions, SceneState};

use crate::failure::{Failure, Status};
use crate::model::{ModelHandle, at};
use crate::raw::OwningChecker;
use crate::records::{Answer, LevelCode, PoseRecord};

/// The joint values of one thread with its checker: `elbowroom_checker` in C.
#[derive(Debug)]
pub struct StateChecker {
    checker: OwningChecker,
    state: SceneState,
    /// Whether a call panicked: then anything may be half done.
    is_poisoned: bool,
}

impl StateChecker {
    /// A checker of named pairs, or of all, with all robots at their start.
    pub(crate) fn new(model: &ModelHandle, level: Level, between: Option<&str>) -> Result<Self, Failure> {
        let model = &model.0;
        let options = CheckerOptions { level, ..CheckerOptions::default() };
        let mut checker = OwningChecker::new(model.clone(), options, model.pairs(between)?);
        // Named pairs that are never tested would always read as "free".
        if let Some(text) = between
            && !checker.has_pair(&model.start_state)
        {
            let what = format!(
                "`{text}` names no pair that could meet\n  write: links of different robots, links with a \
                                solid and more than one joint between them, or a link and an object"
            );
            return Err(Failure::invalid(what));
        }
        Ok(Self { checker, state: model.start_state.clone(), is_poisoned: false })
    }

    /// Runs a call. If it panics, every later call is refused.
    pub(crate) fn call(
        this: Option<&mut Self>,
        body: impl FnOnce(&mut Self) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let this = this.ok_or_else(|| Failure::null("checker"))?;
        if this.is_poisoned {
            let text = "a fault of the library left this checker in an unknown state\n  write: elbowroom_checker_free, then a new one";
            return Err(Failure { status: Status::Poisoned, text: text.to_owned() });
        }
        this.is_poisoned = true;
        let result = body(this);
        this.is_poisoned = false;
        result
    }

    /// Forgets what earlier answers taught; joint values stay.
    pub(crate) fn restart(&mut self) {
        self.checker.restart();
    }

    /// Moves a robot.
    pub(crate) fn set_q(&mut self, robot: usize, q: &[f64]) -> Result<(), Failure> {
        Ok(self.state.set_q(&self.checker.model().scene, RobotId(robot), q)?)
    }

    /// The pose of a link in the world.
    pub(crate) fn link_pose(&self, robot: usize, link: usize) -> Result<PoseRecord, Failure> {
        let model = self.checker.model();
        at("link", &model.robot(robot)?.links, link)?;
        let id = GeometryId::Link { robot: RobotId(robot), link: LinkId(link) };
        let pose = self.state.pose(&model.scene, id);
        pose.map(PoseRecord::of).ok_or_else(|| Failure::invalid(format!("robot {robot} has no link {link}")))
    }

    /// The answer for the present state.
    pub(crate) fn answer(&mut self, kind: QueryKind) -> Answer {
        let row = self.checker.row(&self.state, kind);
        self.answer_of(&row)
    }

    /// Writes an answer for each pair no farther apart than a distance, m, the nearest first, and returns how many there are.
    ///
    /// # Errors
    /// If the places are too few; the first answers are written nevertheless.
    pub(crate) fn answers_within(
        &mut self,
        margin_m: f64,
        places: &mut [MaybeUninit<Answer>],
        count: &mut MaybeUninit<usize>,
    ) -> Result<(), Failure> {
        let rows: Vec<QueryRow> = self.checker.rows_within(&self.state, margin_m).collect();
        for (place, row) in places.iter_mut().zip(&rows) {
            place.write(self.answer_of(row));
        }
        count.write(rows.len());
        if rows.len() > places.len() {
            let text = format!(
                "{} pairs do not fit into {} places\n  write: `capacity` {} or more",
                rows.len(),
                places.len(),
                rows.len()
            );
            return Err(Failure { status: Status::TooShort, text });
        }
        Ok(())
    }

    /// Numbers that are not finite are left out, as in the rows of the command.
    fn answer_of(&self, row: &QueryRow) -> Answer {
        let names = &self.checker.model().names;
        let finite = |v: f64| if v.is_finite() { v } else { f64::NAN };
        let mut answer = Answer {
            collides: c_int::from(row.collides),
            level: LevelCode::of(row.level) as c_int,
            distance_m: row.distance_m.map_or(f64::NAN, finite),
            ..Answer::UNKNOWN
        };
        if let Some((a, b)) = row.pair {
            (answer.a, answer.b) = (names.geometry(a), names.geometry(b));
        }
        if let Some((a, b)) = row.witness {
            (answer.point_a_m, answer.point_b_m) = (a.to_array().map(finite), b.to_array().map(finite));
        }
        answer
    }
}

/// A distance (m) from C.
pub(crate) fn metres(value: f64, name: &str) -> Result<f64, Failure> {
    // Written so that NaN fails.
    if value >= 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Failure::invalid(format!("`{name}` is {value}\n  write: a finite number of metres, 0 or more, as 0.02")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure::{guarded, last_text};

    const fn is_shared<T: Send + Sync>() {}
    const fn is_moved<T: Send>() {}
    // What the header promises about threads.
    const _: () = is_shared::<ModelHandle>();
    const _: () = is_moved::<StateChecker>();

    #[test]
    fn a_panic_is_a_status_and_poisons_the_checker() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("cell.toml");
        std::fs::write(&path, "version = 1\nunits = { length = \"m\", angle = \"rad\" }\n[robot.arm]\ndh = [{ a = 1, min = -3, max = 3, speed = 1 }]\n").unwrap();
        let model = ModelHandle::load_cell(path.to_str().unwrap(), None).unwrap();
        let mut checker = StateChecker::new(&model, Level::Auto, None).unwrap();
        let status = guarded(|| StateChecker::call(Some(&mut checker), |_| panic!("on purpose")));
        assert_eq!(status, Status::Panic);
        assert!(last_text().contains("fault of the library: on purpose"), "{}", last_text());
        let again = guarded(|| StateChecker::call(Some(&mut checker), |_| Ok(())));
        assert_eq!(again, Status::Poisoned);
        // The model is whole, and a new checker works.
        let mut other = StateChecker::new(&model, Level::Auto, None).unwrap();
        assert_eq!(guarded(|| StateChecker::call(Some(&mut other), |c| c.set_q(0, &[0.5]))), Status::Ok);
        assert_eq!(guarded(|| StateChecker::call(Some(&mut other), |c| c.set_q(0, &[f64::NAN]))), Status::InvalidValue);
    }
}
