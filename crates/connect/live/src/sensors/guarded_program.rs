//! A program that avoids what sensors see: its tick, and what the thread of the sensors says about its path.

use elbowroom_sim::HoldReason;
use elbowroom_sim::motion::ProgramClock;
use elbowroom_sim::replanning::{BlockedPath, LastSight, ProgramHold};

/// What is known of the path of a program.
#[derive(Debug, Clone, Default)]
pub(crate) struct PathCheck {
    /// The number of the path that was checked; `None` before the first one.
    pub path: Option<u64>,
    /// Where it is blocked.
    pub blocked: Option<BlockedPath>,
    /// What the sensors of the robot saw last.
    pub sights: Vec<LastSight>,
}

/// A program, shared by the controller that executes it and the thread that checks its path.
#[derive(Debug)]
pub(crate) struct GuardedProgram {
    pub clock: ProgramClock,
    /// `None` for a robot that no sensor guards.
    pub check: Option<PathCheck>,
    hold: ProgramHold,
}

impl GuardedProgram {
    pub fn new(clock: ProgramClock) -> Self {
        Self { clock, check: None, hold: ProgramHold::default() }
    }

    /// Whether the program must not move on now: its path is blocked ahead, a sensor is silent, or the path was not checked yet.
    /// Returns what to tell, too, if it has just become so.
    pub fn must_hold(&mut self, t_s: f64, reaction_s: f64, tick_s: f64) -> (bool, Option<String>) {
        let Some(check) = self.check.as_ref().filter(|_| self.clock.moving()) else { return (false, None) };
        let is_checked = check.path == Some(self.clock.path_number());
        let blocked = check.blocked.as_ref().filter(|_| is_checked);
        let silent = check.sights.iter().find(|last| last.is_stale(t_s)).map(|last| last.sensor.as_str());
        let before = self.hold.reason().cloned();
        let held = self.hold.update(t_s, &self.clock, (blocked, silent), (reaction_s, tick_s));
        let news = held.filter(|_| held != before.as_ref()).map(|(reason, by)| match reason {
            HoldReason::Obstacle => format!("waits: {by} is in its way"),
            HoldReason::Stale => format!("waits: the sensor {by} has sent nothing that can be used"),
        });
        (held.is_some() || !is_checked, news)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_cell::Cell;
    use elbowroom_robot::RobotId;
    use elbowroom_sim::motion::{PlannedPaths, plan};

    const TICK_S: f64 = 0.008;

    #[test]
    fn only_a_path_that_was_checked_and_a_fresh_sight_let_a_program_move() {
        let cell = Cell::parse(
            "rail.toml",
            "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n[robot.rail]\n\
             dh = [{ kind = \"prismatic\", min = 0, max = 2000, speed = 1000 }]\n[program.rail]\n\
             steps = [{ move = \"joint\", to = [100] }, { move = \"joint\", to = [0] }]\n",
        );
        let cell = cell.unwrap();
        let steps = plan(&PlannedPaths::new(&cell), RobotId(0), 1, &mut Vec::new()).unwrap();
        let mut program = GuardedProgram::new(ProgramClock::new(steps, cell.robots[0].limits.clone()));
        let holds = |program: &mut GuardedProgram, t_s: f64| program.must_hold(t_s, 0.0, TICK_S).0;
        assert!(!holds(&mut program, 0.0), "no sensor guards it");
        program.check = Some(PathCheck::default());
        assert!(holds(&mut program, 0.0), "nothing was checked");
        let sight = |taken_s| LastSight { sensor: "above".into(), taken_s, stale_s: 0.3 };
        let first = program.clock.path_number();
        let path = Some(first);
        program.check = Some(PathCheck { path, blocked: None, sights: vec![sight(None)] });
        assert!(holds(&mut program, 0.0), "nothing was seen yet");
        program.check = Some(PathCheck { path, blocked: None, sights: vec![sight(Some(1.0))] });
        assert!(!holds(&mut program, 1.2) && holds(&mut program, 1.4), "the sight is 0.2 and 0.4 s old");
        while program.clock.path_number() == first {
            program.clock.advance(TICK_S, 1.0);
        }
        assert!(holds(&mut program, 1.2), "the next step was not checked");
        let blocked = Some(BlockedPath { free_until_s: 0.0, by: "above#1".into() });
        program.check =
            Some(PathCheck { path: Some(program.clock.path_number()), blocked, sights: vec![sight(Some(1.0))] });
        let (holds, news) = program.must_hold(1.2, 0.0, TICK_S);
        assert!(holds && news.as_deref() == Some("waits: above#1 is in its way"), "{news:?}");
    }
}
