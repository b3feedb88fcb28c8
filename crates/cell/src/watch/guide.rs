//! Moves the arm: along its path, around what has come between, or not at all.

use std::sync::Arc;

use elbowroom_cspace::{Grid, Reader};
use elbowroom_planner::{End, How, Path, PlanError, PlanOptions, Planner, Progress, Standing};

use super::doing::{Doing, Reason};
use super::motion::{Ahead, Motion, distance};
use super::settings::{check, three};
use super::switch::{Bounds, reroute};
use super::times::Clock;
use super::{Exact, GuideError, GuideSettings, Outlook, Prism, Sighting, Step, WatchedArm};

/// Below this share of its speed an arm counts as standing.
const STANDS: f64 = 1e-3;
/// The exact check may leave the curve by so much, radians …
const CHORD_RAD: f64 = 1e-3;
/// … and keeps so far away in return, metres: three joints that are 1 mrad off together move no point of an arm that
/// reaches 2.8 m by more than √3 · 1 mrad · 2.8 m.
const CLEARANCE_M: f64 = 5e-3;

/// Moves one arm.
#[derive(Debug)]
pub struct Guide {
    arm: Arc<WatchedArm>,
    grid: Grid,
    reader: Reader,
    planner: Planner,
    exact: Option<Exact>,
    settings: GuideSettings,
    held: Vec<f64>,
    q: [f64; 3],
    goal: Option<[f64; 3]>,
    motion: Option<Motion>,
    /// The arm must not come farther along its way than this, rad.
    limit_rad: Option<f64>,
    reason: Option<Reason>,
    seen_s: Option<f64>,
    prisms: Vec<Prism>,
}

impl Guide {
    /// For an arm that stands at `q` (all joint values) and the map that a reader shows. With an [`Exact`] scene, each new
    /// path is checked in it before the arm goes, and an arm whose cell becomes blocked may get out of the way. What stands in
    /// the cell for good must be known to the map and to the scene.
    ///
    /// # Errors
    /// A grid that is not the map's, joint values outside of it, settings that are no use.
    pub fn new(
        arm: Arc<WatchedArm>,
        grid: &Grid,
        mut reader: Reader,
        exact: Option<Exact>,
        settings: GuideSettings,
        q: &[f64],
    ) -> Result<Self, GuideError> {
        check(&settings)?;
        let dof = arm.robot.chain.dof();
        if q.len() != dof {
            return Err(GuideError::Values { found: q.len(), dof });
        }
        let planner = Planner::new(grid, reader.latest().table())?;
        let planar = arm.to_planar(q);
        let guide = Self {
            grid: grid.clone(),
            reader,
            planner,
            exact,
            settings,
            held: q.to_vec(),
            q: planar,
            goal: None,
            motion: None,
            limit_rad: None,
            reason: None,
            seen_s: None,
            prisms: Vec::new(),
            arm,
        };
        guide.inside(planar)?;
        let at_rest = Path { waypoints: vec![planar], length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
        guide.planner.time(&at_rest, &guide.settings.limits)?;
        if let Some(retreat) = guide.settings.retreat {
            guide.inside(retreat)?;
        }
        Ok(guide)
    }

    /// Where the arm is, planar values, radians.
    pub fn planar(&self) -> [f64; 3] {
        self.q
    }

    /// The path that is followed, planar values; `None` where the arm stands without one. After a change on the way it
    /// begins a little behind where the arm was then.
    pub fn path(&self) -> Option<&Path> {
        self.motion.as_ref().map(|motion| &motion.path)
    }

    /// The planner, with the table that it plans on.
    pub fn planner(&self) -> &Planner {
        &self.planner
    }

    /// Gives the arm a goal (all joint values); a motion under way to another one ends first. The way is planned at the next
    /// [`Guide::look`].
    ///
    /// # Errors
    /// Another number of values than the robot has, a place outside of the map.
    pub fn go_to(&mut self, goal: &[f64]) -> Result<(), GuideError> {
        let dof = self.held.len();
        if goal.len() != dof {
            return Err(GuideError::Values { found: goal.len(), dof });
        }
        let goal = self.arm.to_planar(goal);
        self.inside(goal)?;
        if self.motion.is_some() {
            self.limit_rad = Some(f64::NEG_INFINITY);
        }
        self.reason = Some(Reason::Unplanned);
        self.goal = Some(goal);
        Ok(())
    }

    fn inside(&self, q: [f64; 3]) -> Result<(), GuideError> {
        let axes = self.grid.axes();
        match (0..3).find(|&i| axes[i].cell(q[i]).is_none()) {
            None => Ok(()),
            Some(joint) => {
                let (min, max) = (axes[joint].min(), axes[joint].max());
                Err(PlanError::Outside { end: End::Goal, joint, value: q[joint], min, max }.into())
            }
        }
    }

    /// Takes over what a frame told; looks along the rest of the path, goes around, or plans.
    pub fn look(&mut self, sighting: &Sighting) -> Outlook {
        let mut outlook = Outlook::default();
        if !sighting.is_clear() {
            return outlook;
        }
        self.seen_s = Some(sighting.stamp_s);
        self.prisms.clone_from(&sighting.prisms);
        let mut clock = Clock::start();
        let updated = self.planner.update(self.reader.latest().table());
        outlook.times.update = clock.lap();
        if let Err(error) = updated {
            // A reader of another map: nothing is known.
            self.seen_s = None;
            outlook.reason = Some(Reason::NoPath(error.to_string()));
            return outlook;
        }
        match self.motion.take() {
            Some(motion) => self.follow(motion, &mut outlook),
            None => self.set_out(&mut outlook),
        }
        self.reason.clone_from(&outlook.reason);
        outlook
    }

    /// There is a motion: is it still good?
    fn follow(&mut self, motion: Motion, outlook: &mut Outlook) {
        let mut clock = Clock::start();
        let is_recalled = self.limit_rad == Some(f64::NEG_INFINITY);
        let ahead = if is_recalled { Ahead::Lost } else { self.ahead(&motion) };
        outlook.times.standing = clock.lap();
        outlook.how = Some(How::Kept);
        let now_rad = motion.far_rad();
        self.limit_rad = match ahead {
            Ahead::Free => None,
            Ahead::Blocked { far_rad } => Some(far_rad - self.settings.short_rad),
            Ahead::Inside { out_s, then_far_rad } => {
                // It was not blocked when the arm went there: on, if that leads out and touches nothing.
                let is_proven = self.exact.is_some() && self.prove(&motion.points(out_s, CHORD_RAD)).is_ok();
                outlook.times.exact += clock.lap();
                if is_proven { then_far_rad.map(|far| far - self.settings.short_rad) } else { Some(now_rad) }
            }
            Ahead::Lost => Some(now_rad),
        };
        if self.limit_rad.is_none() {
            self.motion = Some(motion);
            return;
        }
        outlook.was_blocked = true;
        outlook.reason = Some(Reason::Blocked);
        let is_standing = motion.rate <= STANDS || distance(motion.state().qd, [0.0; 3]) < STANDS;
        if is_standing {
            self.motion = Some(motion);
            self.set_out(outlook);
            return;
        }
        let bounds = Bounds { limits: &self.settings.limits, options: &self.options(0.0), grid: &self.grid };
        let wanted = if is_recalled { None } else { Some(reroute(&mut self.planner, &motion, &bounds)) };
        let Some((found, [replan, timing])) = wanted else {
            self.motion = Some(motion);
            return;
        };
        (outlook.times.replan, outlook.times.timing) = (replan, timing);
        clock.lap();
        let proven = found.filter(|(next, _)| {
            let is_free = self.prove(&next.points(f64::INFINITY, CHORD_RAD)).is_ok();
            outlook.times.exact += clock.lap();
            is_free
        });
        match proven {
            Some((next, how)) => {
                (self.motion, self.limit_rad) = (Some(next), None);
                (outlook.how, outlook.in_motion, outlook.reason) = (Some(how), true, None);
            }
            None => self.motion = Some(motion),
        }
    }

    /// The curve is looked at from point to point, its straight legs cell by cell: what a leg no more than grazes counts.
    fn ahead(&self, motion: &Motion) -> Ahead {
        let seen = motion.ahead(self.planner.table(), &self.grid);
        let (Ahead::Free, Some(leg)) = (seen, motion.leg()) else { return seen };
        let here = Progress { leg, q: motion.state().q };
        match self.planner.standing(&motion.path, here, &PlanOptions::default()) {
            Ok(Standing::Clear) => Ahead::Free,
            Ok(Standing::Blocked { free_rad, .. }) => Ahead::Blocked { far_rad: motion.far_rad() + free_rad },
            Err(_) => Ahead::Lost,
        }
    }

    /// The arm stands: a way to the goal, or out of the way.
    fn set_out(&mut self, outlook: &mut Outlook) {
        let is_in_way = self.grid.cell(self.q).is_none_or(|cell| self.planner.table().is_blocked(cell));
        let retreat = self.settings.retreat.filter(|_| is_in_way);
        let goals = [self.goal.filter(|goal| distance(*goal, self.q) > 1e-9), retreat];
        for goal in goals.into_iter().flatten() {
            match self.way_to(goal, is_in_way, outlook) {
                Ok(motion) => {
                    (self.motion, self.limit_rad) = (Some(motion), None);
                    (outlook.how, outlook.reason) = (Some(How::Anew), None);
                    return;
                }
                Err(reason) => outlook.reason = Some(reason),
            }
        }
    }

    fn way_to(&mut self, goal: [f64; 3], is_in_way: bool, outlook: &mut Outlook) -> Result<Motion, Reason> {
        let mut clock = Clock::start();
        let may_escape = is_in_way && self.exact.is_some();
        let options = self.options(if may_escape { self.settings.escape_rad } else { 0.0 });
        let path = self.planner.plan(self.q, goal, &options);
        outlook.times.replan += clock.lap();
        let mut path = path.map_err(|e| Reason::NoPath(e.to_string()))?;
        if path.goal_moved_rad > 0.0 {
            return Err(Reason::NoPath("the goal is in a blocked cell".into()));
        }
        if path.start_moved_rad > 0.0 {
            path.waypoints.insert(0, self.q);
        }
        let limits = &self.settings.limits;
        let trajectory = self.planner.time(&path, limits).map_err(|e| Reason::NoPath(e.to_string()))?;
        outlook.times.timing += clock.lap();
        let motion = Motion::new(path, trajectory, 0.0, 1.0, &self.grid, limits);
        let proof = self.prove(&motion.points(f64::INFINITY, CHORD_RAD));
        outlook.times.exact += clock.lap();
        proof.map(|()| motion)
    }

    fn prove(&self, points: &[[f64; 3]]) -> Result<(), Reason> {
        self.exact.as_ref().map_or(Ok(()), |exact| exact.check(&self.prisms, &self.held, points, CLEARANCE_M))
    }

    fn options(&self, nearest_rad: f64) -> PlanOptions {
        PlanOptions { weights: self.settings.weights, nearest_rad }
    }

    /// Goes on for `dt` seconds until `now_s` (on the clock of the frames' stamps). A `dt` that is not finite or not above 0
    /// moves nothing: the arm counts as standing and goes on from rest. A picture stamped more than
    /// [`GuideSettings::stale_s`] after `now_s` counts as none.
    pub fn tick(&mut self, now_s: f64, dt: f64) -> Step {
        let age_s = self.seen_s.map_or(f64::INFINITY, |seen| now_s - seen);
        // Written so that an age that is no number counts as old.
        let stale = (!(age_s.abs() <= self.settings.stale_s)).then_some(Reason::NoPicture { age_s });
        let takes_time = dt.is_finite() && dt > 0.0;
        let halted = (!takes_time).then_some(Reason::NoTime { dt_s: dt }).or(stale);
        let Some(mut motion) = self.motion.take() else {
            let wants = self.goal.is_some_and(|goal| distance(goal, self.q) > 1e-9);
            let why = halted.or_else(|| self.reason.clone()).unwrap_or(Reason::Blocked);
            return self.step([0.0; 3], 0.0, if wants { Doing::Waiting(why) } else { Doing::Arrived });
        };
        if let (false, Some(why)) = (takes_time, &halted) {
            motion.rate = 0.0;
            self.motion = Some(motion);
            return self.step([0.0; 3], 0.0, Doing::Waiting(why.clone()));
        }
        let before = motion.rate;
        let wanted = if halted.is_some() { 0.0 } else { self.allowed(&motion, dt) };
        let accelerate = three(&self.settings.limits.acceleration);
        (motion.tau_s, motion.rate) = motion.after(dt, wanted, self.settings.stop, accelerate);
        let state = motion.state();
        self.q = state.q;
        let (rate, is_over) = (motion.rate, motion.is_over());
        let why = || halted.clone().or_else(|| self.reason.clone()).unwrap_or(Reason::Blocked);
        let doing = match () {
            () if is_over => Doing::Arrived,
            () if rate <= 0.0 => Doing::Waiting(why()),
            () if rate < before => Doing::Slowing(why()),
            () => Doing::Going,
        };
        let is_recalled = self.limit_rad == Some(f64::NEG_INFINITY);
        if is_over || is_recalled && rate <= 0.0 {
            self.limit_rad = None;
        } else {
            self.motion = Some(motion);
        }
        self.step(state.qd.map(|speed| speed * rate), rate, doing)
    }

    /// 1 where the arm can go on for a tick and still stop before its limit; its own rate where it cannot become faster; 0
    /// where it must brake.
    fn allowed(&self, motion: &Motion, dt: f64) -> f64 {
        let Some(limit_rad) = self.limit_rad else { return 1.0 };
        let limit_s = if limit_rad > 0.0 { motion.time_at(limit_rad) } else { 0.0 };
        let (stop, accelerate) = (self.settings.stop, three(&self.settings.limits.acceleration));
        let fits = |wanted: f64| {
            let (tau_s, rate) = motion.after(dt, wanted, stop, accelerate);
            motion.stops_at(tau_s, rate, stop, dt) <= limit_s
        };
        [1.0, motion.rate].into_iter().find(|&rate| fits(rate)).unwrap_or(0.0)
    }

    fn step(&self, qd: [f64; 3], rate: f64, doing: Doing) -> Step {
        Step { q: self.arm.to_joints(&self.held, self.q), qd, rate, doing }
    }
}
