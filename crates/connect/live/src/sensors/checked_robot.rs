//! A robot of a live cell whose path is checked against what sensors see.

use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::sync::{Arc, Mutex};

use elbowroom_cell::{Cell, Frames};
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;
use elbowroom_sim::replanning::{
    ExecutedMotion, ObjectPlaces, PathGuard, PerceivedObstacles, SearchRequest, SearchResult,
};

use super::guarded_program::GuardedProgram;
use super::joint_history::JointHistory;
use super::path_worker::SearchJob;
use super::robot_regions::RobotRegions;
use crate::locked::locked;
use crate::switch_requests::RegionSwitches;

/// What a check knows of the cell.
pub(super) struct CellView<'a> {
    pub cell: &'a Cell,
    pub joints: &'a JointHistory,
    pub objects: &'a Mutex<ObjectPlaces>,
    pub switches: &'a RegionSwitches,
    pub perceived: &'a PerceivedObstacles<'a>,
}

/// A robot whose path is checked.
pub(super) struct CheckedRobot {
    guard: PathGuard,
    program: Arc<Mutex<GuardedProgram>>,
    regions: RobotRegions,
    jobs: SyncSender<SearchJob>,
    results: Receiver<(SearchRequest, SearchResult)>,
    /// A search is under way.
    is_searching: bool,
}

/// The ends of the channels that belong to the thread that searches.
pub(super) type WorkerEnds = (Receiver<SearchJob>, Sender<(SearchRequest, SearchResult)>);

impl CheckedRobot {
    pub fn new(guard: PathGuard, program: Arc<Mutex<GuardedProgram>>, regions: RobotRegions) -> (Self, WorkerEnds) {
        let (jobs, of_worker) = mpsc::sync_channel(1);
        let (to_guard, results) = mpsc::channel();
        (Self { guard, program, regions, jobs, results, is_searching: false }, (of_worker, to_guard))
    }

    pub fn robot(&self) -> RobotId {
        self.guard.robot()
    }

    /// Puts the robot onto a path that was found at a time (s); returns whether it is on one.
    pub fn take_result(&mut self, t_s: f64) -> bool {
        let Ok((request, result)) = self.results.try_recv() else { return false };
        self.is_searching = false;
        let mut program = locked(&self.program);
        let program = &mut *program;
        let is_entered = result.new_path.as_ref().is_some_and(|new| new.enter(&mut program.clock));
        self.guard.end_search(t_s, &request, &result, is_entered);
        if let Some(check) = &mut program.check {
            if is_entered {
                // Proven free of what was seen when the search began; the next step checks it against what is seen by now.
                (check.path, check.blocked) = (Some(program.clock.path_number()), None);
            } else {
                let (path, blocked) = self.guard.checked();
                (check.path, check.blocked) = (path, blocked.cloned());
            }
        }
        is_entered
    }

    /// Checks the path if that is due at a time (s), passes the result to the controller, and has another path searched for.
    pub fn check(&mut self, t_s: f64, view: &CellView<'_>, has_news: bool) {
        let robot = self.robot();
        let (motion, objects) = {
            let program = locked(&self.program);
            if !self.guard.is_due(program.clock.path_number(), has_news) {
                return;
            }
            // Under one lock: a controller that grips changes both while it holds the program.
            (program.clock.executed_motion(), locked(view.objects).clone())
        };
        let active = self.regions.setup.regions.iter().map(|region| view.switches.is_on(*region)).collect::<Vec<_>>();
        let attached = view.joints.attached(robot);
        self.regions.update(&active, attached);
        let states = states_with(view, robot, &motion);
        let sources = || Frames::new(view.cell).sources(&self.regions.setup.sources, &states, t_s);
        let around = |seen| objects.surroundings(view.cell, &states, t_s, seen);
        let seen = || around(view.perceived.obstacles(robot).cloned().collect());
        self.guard.observe(t_s, &motion, view.perceived, seen, || self.regions.closed(sources()));
        let rests = motion.qd.iter().all(|v| *v == 0.0);
        let path = motion.path;
        if self.is_searching {
            self.guard.drop_search();
        } else if self.guard.is_search_due(t_s, path)
            && let Some(request) = self.guard.take_search(motion, around)
        {
            let job = SearchJob { request, sources: sources(), active, attached: attached.to_vec() };
            self.is_searching = self.jobs.try_send(job).is_ok();
        }
        // A robot that has not begun a blocked path waits for the result: its path would begin where the robot rests.
        self.publish(view, rests && self.is_searching);
    }

    /// Passes what was checked to the controller, with what the sensors saw last.
    fn publish(&self, view: &CellView<'_>, awaits_result: bool) {
        let (path, blocked) = self.guard.checked();
        let mut program = locked(&self.program);
        let Some(check) = &mut program.check else { return };
        check.sights.clear();
        check.sights.extend(view.perceived.last_sights(self.guard.robot()).cloned());
        if !awaits_result || check.path == path {
            (check.path, check.blocked) = (path, blocked.cloned());
        }
    }
}

/// The robots as they were heard last, and the one whose motion is checked as it moves now.
fn states_with(view: &CellView<'_>, robot: RobotId, motion: &ExecutedMotion) -> Vec<ChainState> {
    let mut states = view.joints.states().to_vec();
    let state = &mut states[robot.0];
    state.q.clone_from(&motion.q);
    state.qd.clone_from(&motion.qd);
    view.cell.robots[robot.0].robot.chain.forward_motion(state);
    states
}
