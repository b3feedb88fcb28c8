//! The loop: sense, correct, check, command.

use std::time::Instant;

use elbowroom_planner::{Connect, Fence, RouteOptions};
use elbowroom_scene::{Scene, SceneError, SweepOptions};

use crate::calm::Calm;
use crate::joint::{self, JointLimit, astray, brake, headway, share, slowing, stop_s};
use crate::proof::{Course, Proof};
use crate::sense::Senses;
use crate::way::{Moving, NONE_S, Way};
use crate::{
    Advice, Around, AvoidanceError, Doing, Manner, Other, PathKind, Reaction, Reference, Reflex, ReflexSettings, Rules,
    Task, Threat, TickTimes, VelocityBounds,
};

/// Below this override nothing is commanded but a stop.
const NO_OVERRIDE: f64 = 1e-6;
/// Less than this share of the wanted motion is no headway; nor is the last of it, in seconds of joint motion.
const HEADWAY: f64 = 0.15;
const NEARLY_S: f64 = 2e-3;
/// Slower than this share of its speed the robot counts as standing.
const STANDS: f64 = 5e-3;
/// Near something the pull back to the path falls with the distance, in this time, s: a steeper one would tug at evasion.
const SOFT_S: f64 = 0.15;
/// A correction of less than this size is not told as evading, nor one that was longer ago, s.
const EVADING: f64 = 0.02;
const EVADING_S: f64 = 0.1;
/// An obstacle slower than this stands, m/s.
const OBSTACLE_STANDS_M_S: f64 = 0.01;

/// How the loop behaves beyond a single look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoiderSettings {
    /// Of the single look.
    pub reflex: ReflexSettings,
    /// Share of the joints' top speeds on the way back.
    pub return_share: f64,
    /// A path that need not be kept is gone on with while the robot is off it by no more than this, in seconds of joint
    /// motion at full speed.
    pub stray_s: f64,
    /// A joint does not turn back twice within this time, s.
    pub quiet_s: f64,
    /// After so long without headway another way is asked for, s.
    pub patience_s: f64,
}

impl Default for AvoiderSettings {
    /// Half the speed back, 0.4 s astray, 0.25 s between reversals, 0.6 s of patience.
    fn default() -> Self {
        Self { reflex: ReflexSettings::default(), return_share: 0.5, stray_s: 0.4, quiet_s: 0.25, patience_s: 0.6 }
    }
}

/// What there is to do if nothing comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    /// On the path.
    Path,
    /// Along a proven way.
    Way,
    /// Off the path: stand, until there is a proven way.
    Stop,
    /// Off the path, and something is near: pulled back to it.
    Back,
}

fn manner(mode: Mode, reference: &Reference<'_>) -> Manner {
    match (mode, reference.path) {
        (Mode::Way, _) => Manner::Proven,
        (Mode::Back | Mode::Stop, _) => Manner::Back,
        (Mode::Path, PathKind::Continuous) => Manner::Holding,
        // Where it stands, things may stand near.
        (Mode::Path, PathKind::PointToPoint) if reference.qd.iter().all(|v| *v == 0.0) => Manner::Holding,
        (Mode::Path, PathKind::PointToPoint) => Manner::Underway,
    }
}

/// Keeps one robot of a scene out of the way of what moves, and brings it back (S4.11).
///
/// The path is the caller's: each tick it says where the path wants the robot, at the rate that the last advice allowed;
/// where nothing is near the command is exactly that. See the crate's documentation for a whole loop.
#[derive(Debug)]
pub struct Avoider<'s> {
    senses: Senses<'s>,
    reflex: Reflex,
    limits: Vec<JointLimit>,
    settings: AvoiderSettings,
    bounds: VelocityBounds,
    calm: Calm,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    wanted: Vec<f64>,
    next: Vec<f64>,
    intent: Vec<f64>,
    braked: Vec<f64>,
    way: Way,
    proof: Proof,
    /// The fastest that each joint can be commanded next, and how long that and a stop take to matter, s.
    fastest: Vec<f64>,
    ahead_s: f64,
    columns: Vec<[f64; 6]>,
    standing_s: f64,
    /// Off the path and nothing comes for so long, s.
    lost_s: f64,
    /// Share of the wanted velocity that was left.
    headway: f64,
    /// Since the rules last asked for something, s.
    evaded_s: f64,
    following: bool,
}

impl<'s> Avoider<'s> {
    /// For a robot of a scene that stands at `q`. `limits` has one entry per independent joint.
    ///
    /// # Errors
    /// No such robot, wrong joint values, limits that no joint can have, or not one per joint.
    pub fn new(
        scene: &'s Scene,
        robot: usize,
        q: &[f64],
        limits: &[JointLimit],
        rules: Rules,
        settings: AvoiderSettings,
    ) -> Result<Self, AvoidanceError> {
        let count = scene.robots().len();
        let chain = &scene.robots().get(robot).ok_or(SceneError::NoSuchRobot { index: robot, count })?.robot.chain;
        let mut senses = Senses::new(scene, robot);
        senses.place(q, &Around::default())?;
        let n = chain.dof();
        if limits.len() != n {
            return Err(AvoidanceError::Limits { given: limits.len(), joints: n });
        }
        if let Some((joint, what)) = limits.iter().enumerate().find_map(|(j, l)| Some((j, l.wrong()?))) {
            return Err(AvoidanceError::Limit { joint, what });
        }
        let limits = limits.to_vec();
        let speeds: Vec<f64> = limits.iter().map(|l| l.speed).collect();
        // A gap must not close faster than a stop takes.
        let mut settings = settings;
        settings.reflex.closing_s = settings.reflex.closing_s.max(stop_s(&limits, &speeds));
        Ok(Self {
            reflex: Reflex::new(chain, &speeds, rules, settings.reflex),
            proof: Proof::new(scene),
            senses,
            bounds: VelocityBounds { now: vec![[0.0; 2]; n], soon: vec![[0.0; 2]; n] },
            calm: Calm::new(n, settings.quiet_s),
            settings,
            limits,
            q: q.to_vec(),
            qd: vec![0.0; n],
            qdd: vec![0.0; n],
            wanted: vec![0.0; n],
            next: vec![0.0; n],
            intent: vec![0.0; n],
            braked: vec![0.0; n],
            fastest: vec![0.0; n],
            columns: vec![[0.0; 6]; n],
            ahead_s: 0.0,
            way: Way::default(),
            standing_s: 0.0,
            lost_s: 0.0,
            headway: 1.0,
            evaded_s: f64::INFINITY,
            following: true,
        })
    }

    /// The commanded joint values, rad or m.
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// The commanded joint velocities, rad/s or m/s.
    pub fn qd(&self) -> &[f64] {
        &self.qd
    }

    /// The commanded joint accelerations, rad/s² or m/s².
    pub fn qdd(&self) -> &[f64] {
        &self.qdd
    }

    /// The joint velocities that it would have at override 1, rad/s or m/s: for a monitor that knows directions.
    pub fn intent(&self) -> &[f64] {
        &self.intent
    }

    /// The rules it reacts by.
    pub fn rules(&self) -> &Rules {
        self.reflex.rules()
    }

    /// True where it is slow enough for a way to begin.
    pub fn stands(&self) -> bool {
        share(&self.qd, &self.limits) < STANDS
    }

    /// True while a planned way is gone.
    pub fn has_way(&self) -> bool {
        !self.way.is_empty()
    }

    /// One tick of `dt` seconds. `around` is what is seen now; `reference` where the path wants to be after the tick;
    /// `speed_override` (0 to 1) what a monitor allows, which scales all motion last.
    ///
    /// # Errors
    /// Poses, motions or joint values that are not finite or not there, a tick without time. The robot is to be stopped
    /// then: the next tick takes it as standing where it was commanded last, and leads it back.
    pub fn tick(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        around: &Around<'_>,
        speed_override: f64,
    ) -> Result<Advice, AvoidanceError> {
        let advice = self.try_tick(dt, reference, around, speed_override);
        if advice.is_err() {
            self.way.clear();
            self.following = false;
            self.qd.fill(0.0);
            self.qdd.fill(0.0);
        }
        advice
    }

    fn try_tick(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        around: &Around<'_>,
        speed_override: f64,
    ) -> Result<Advice, AvoidanceError> {
        self.check_call(dt, reference)?;
        let begin = Instant::now();
        self.senses.place(&self.q, around)?;
        for (fastest, (v, limit)) in self.fastest.iter_mut().zip(self.qd.iter().zip(&self.limits)) {
            *fastest = (v.abs() + limit.stop * dt).min(limit.speed);
        }
        self.ahead_s = 2.0 * dt + 0.5 * stop_s(&self.limits, &self.fastest);
        self.senses.look(around, self.reflex.rules().reach_m(), self.fixed_reach(), self.ahead_s);
        let sensed = Instant::now();
        let allowed = if speed_override >= NO_OVERRIDE { speed_override.min(1.0) } else { 0.0 };
        joint::fill(&mut self.bounds, &self.limits, &self.q, &self.qd, dt);
        let mode = self.mode();
        let (reaction, mut exactly) = self.correct(dt, reference, allowed, mode);
        let corrected = Instant::now();
        let mut braked = false;
        // A way was proven with all that stood: what has moved since may stand on it.
        let on_way = mode == Mode::Way;
        if !exactly && !self.can_stop(dt, around, on_way) {
            braked = true;
            self.way.clear();
            if mode == Mode::Path {
                // The path is known to be free, and is slowed down on.
                self.along_path(dt, reference);
                exactly = true;
            } else {
                brake(&self.limits, &self.bounds.soon, &self.qd, dt, &mut self.next);
            }
        } else if !exactly {
            braked = self.check(dt, around);
        }
        let checked = Instant::now();
        self.command(dt, exactly.then_some(reference.q));
        let times = TickTimes { sense: sensed - begin, correct: corrected - sensed, check: checked - corrected };
        Ok(self.advice(dt, reference, allowed, Advice { reaction, braked, times, ..Advice::default() }))
    }

    /// Plans a way from where the robot stands to `goal`, around everything as it stands now, proven free, and goes it from the
    /// next tick on, until something comes. The clearance is kept where the ends of the way have it
    /// ([`Connect::plan_out`]). Takes as long as planning takes: a controller does it beside its loop.
    ///
    /// # Errors
    /// The robot moves, or as [`Connect::plan_out`].
    pub fn plan_to(&mut self, goal: &[f64], options: &RouteOptions) -> Result<(), AvoidanceError> {
        self.plan_within(goal, options, None)
    }

    /// As [`plan_to`](Self::plan_to), on a way that stays out of something else, too ([`Connect::fenced`]): regions, for which a
    /// monitor would stop it.
    ///
    /// # Errors
    /// The robot moves, or as [`Connect::plan_out`].
    pub fn plan_within(
        &mut self,
        goal: &[f64],
        options: &RouteOptions,
        fence: Option<&mut dyn Fence>,
    ) -> Result<(), AvoidanceError> {
        if !self.stands() {
            return Err(AvoidanceError::Underway);
        }
        let limits = self.limits.iter().map(|l| (l.lower, l.upper));
        let mut connect = Connect::new(self.senses.scene, self.senses.robot)?.within(limits);
        if let Some(fence) = fence {
            connect = connect.fenced(fence);
        }
        self.senses.state.set_q(self.senses.scene, self.senses.robot, &self.q)?;
        let route = connect.plan_out(&self.senses.state, goal, options)?;
        self.way = Way::new(route.waypoints);
        self.standing_s = 0.0;
        self.lost_s = 0.0;
        self.following = false;
        Ok(())
    }

    fn check_call(&self, dt: f64, reference: &Reference<'_>) -> Result<(), AvoidanceError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(AvoidanceError::Period(dt));
        }
        let joints = self.q.len();
        let sound = |v: &[f64]| v.len() == joints && v.iter().all(|v| v.is_finite());
        if sound(reference.q) && sound(reference.qd) {
            return Ok(());
        }
        Err(AvoidanceError::Reference { given: reference.q.len().min(reference.qd.len()), joints })
    }

    /// How near what is known must be to matter: what a stop takes from the fastest that the next command can be, or from
    /// half again the evasion speed in the reflex's own time.
    fn fixed_reach(&self) -> f64 {
        let s = &self.settings.reflex;
        let nearby = s.fixed_clearance_m + 1.5 * s.closing_s * s.speed_m_s;
        nearby.max(self.senses.levers[self.senses.robot].farthest(&self.fastest, self.ahead_s))
    }

    /// Fills `next` with the velocity to command; true where it is exactly the path's.
    fn correct(&mut self, dt: f64, reference: &Reference<'_>, allowed: f64, mode: Mode) -> (Reaction, bool) {
        self.want(dt, reference, allowed, mode);
        if allowed == 0.0 {
            self.intent.fill(0.0);
            // A path that is followed brings itself to a stop.
            match mode {
                Mode::Path => self.along_path(dt, reference),
                _ => brake(&self.limits, &self.bounds.soon, &self.qd, dt, &mut self.next),
            }
            return (Reaction::default(), mode == Mode::Path);
        }
        self.calm.hold(&mut self.bounds);
        for (now, soon) in self.bounds.now.iter_mut().zip(&self.bounds.soon) {
            // All but limits is scaled last.
            *now = now.map(|v| (v / allowed).clamp(soon[0], soon[1]));
        }
        let Senses { scene, robot, chains, threats, .. } = &self.senses;
        let (chain, state) = (&scene.robots()[*robot].robot.chain, &chains[*robot]);
        let task = Task { wanted: &self.wanted, bounds: &self.bounds, manner: manner(mode, reference) };
        let reaction = self.reflex.react(chain, state, &task, threats, &mut self.next);
        self.headway = headway(&self.next, &self.wanted, &self.limits);
        self.intent.copy_from_slice(&self.next);
        // The bounds were widened by the override, and what is lowered last must keep them, too.
        joint::fill(&mut self.bounds, &self.limits, &self.q, &self.qd, dt);
        self.calm.hold(&mut self.bounds);
        for (v, [low, high]) in self.next.iter_mut().zip(&self.bounds.now) {
            *v = (*v * allowed).clamp(*low, *high);
        }
        let held = self.stuck() && self.headway < HEADWAY && reaction.overrun_m_s <= 0.0;
        match mode {
            _ if reaction.asked && !held => self.way.clear(),
            Mode::Path if !held => self.along_path(dt, reference),
            Mode::Way => self.next.iter_mut().zip(&self.wanted).for_each(|(v, w)| *v = w * allowed),
            Mode::Stop => brake(&self.limits, &self.bounds.soon, &self.qd, dt, &mut self.next),
            // Trapped: to stand is better than to creep.
            _ if held => brake(&self.limits, &self.bounds.soon, &self.qd, dt, &mut self.next),
            _ => {}
        }
        (reaction, mode == Mode::Path && !reaction.asked && !held)
    }

    /// What there is to do if nothing comes.
    fn mode(&self) -> Mode {
        if !self.way.is_empty() {
            return Mode::Way;
        }
        if self.following {
            return Mode::Path;
        }
        // A way back that is proven is worth a short wait.
        let waits = self.evaded_s >= EVADING_S && self.lost_s < self.settings.patience_s;
        if waits { Mode::Stop } else { Mode::Back }
    }

    /// Fills `next` with what leads to where the path wants to be.
    fn along_path(&mut self, dt: f64, reference: &Reference<'_>) {
        for ((v, to), from) in self.next.iter_mut().zip(reference.q).zip(&self.q) {
            *v = (to - from) / dt;
        }
    }

    /// Fills `wanted`: along the path, along a way, or back to the path, at override 1.
    fn want(&mut self, dt: f64, reference: &Reference<'_>, allowed: f64, mode: Mode) {
        let scale = allowed.max(NO_OVERRIDE);
        match mode {
            Mode::Path => {
                for ((v, to), from) in self.wanted.iter_mut().zip(reference.q).zip(&self.q) {
                    *v = (to - from) / (dt * scale);
                }
            }
            Mode::Stop => self.wanted.fill(0.0),
            Mode::Way => {
                let most = self.settings.return_share * allowed;
                let now = Moving { q: &self.q, qd: &self.qd, limits: &self.limits };
                self.way.follow(dt, most, &now, &self.calm, &mut self.wanted);
                self.wanted.iter_mut().for_each(|v| *v /= scale);
            }
            Mode::Back => self.pull(dt, reference),
        }
    }

    /// Back to the path, as straight as what is near lets it.
    fn pull(&mut self, dt: f64, reference: &Reference<'_>) {
        let left_s = astray(reference.q, &self.q, &self.limits);
        let rise_s = self.limits.iter().map(|l| l.speed / l.acceleration).fold(0.0, f64::max);
        let soft = if self.evaded_s < EVADING_S { left_s / SOFT_S } else { f64::INFINITY };
        let speed = slowing(left_s, rise_s).min(self.settings.return_share).min(soft);
        let rate = if left_s > 0.0 { (speed / left_s).min(1.0 / dt) } else { 0.0 };
        for ((v, to), from) in self.wanted.iter_mut().zip(reference.q).zip(&self.q) {
            *v = (to - from) * rate;
        }
    }

    /// No collision falls between two commands: replaces `next` by braking where that is hit later.
    fn check(&mut self, dt: f64, around: &Around<'_>) -> bool {
        let loose = |t: &Threat| matches!(t.other, Other::Loose { .. });
        let Self { proof, senses, limits, bounds, q, next, braked, .. } = self;
        let mut hit = |qd: &[f64]| proof.first_hit(senses, &Course { q, qd, limits, seconds: dt }, around, loose);
        let Some(first) = hit(next) else { return false };
        brake(limits, &bounds.soon, &self.qd, dt, braked);
        let better = hit(braked).unwrap_or(f64::INFINITY) > first;
        if better {
            next.copy_from_slice(braked);
        }
        better
    }

    /// Whether the command, and a stop right after it, run free of what does not come by itself. As long as each command does,
    /// there is always a stop that does, as far as things stand: that of the command before. A way was proven with all that
    /// is fixed: as long as it is kept to, what can have moved since is what counts.
    fn can_stop(&mut self, dt: f64, around: &Around<'_>, on_way: bool) -> bool {
        let ahead_s = 2.0 * dt + 0.5 * stop_s(&self.limits, &self.next);
        // What is touched by intent, a part that is being placed, holds nothing up: only its gap may not close.
        let apart = |t: &Threat| t.distance_m > SweepOptions::default().tolerance_m;
        let left_way = self.way.is_empty();
        let counts = |t: &Threat| match t.other {
            Other::Own(_) | Other::Fixed => !on_way || left_way,
            Other::Moving { .. } => true,
            Other::Loose { .. } => on_way,
        };
        let course = Course { q: &self.q, qd: &self.next, limits: &self.limits, seconds: ahead_s };
        self.proof.first_hit(&mut self.senses, &course, around, |t| counts(t) && apart(t)).is_none()
    }

    /// Takes `next` as the command; the values that the path has are taken as they are.
    fn command(&mut self, dt: f64, exactly: Option<&[f64]>) {
        for j in 0..self.q.len() {
            let limit = &self.limits[j];
            let beyond = self.q[j] + self.next[j] * dt;
            let held = beyond.clamp(limit.lower, limit.upper);
            // What a limit holds back does not move so fast.
            let v = if held == beyond { self.next[j] } else { (held - self.q[j]) / dt };
            self.qdd[j] = (v - self.qd[j]) / dt;
            self.qd[j] = v;
            self.q[j] = exactly.map_or(held, |q| q[j]);
        }
        self.calm.note(&self.qd, self.limits.iter().map(|l| l.speed), dt);
    }

    fn advice(&mut self, dt: f64, reference: &Reference<'_>, allowed: f64, mut advice: Advice) -> Advice {
        advice.astray_s = astray(reference.q, &self.q, &self.limits);
        self.following = self.way.is_empty() && advice.astray_s <= NONE_S;
        let loose = self.senses.threats.iter().find(|t| matches!(t.other, Other::Loose { .. }));
        advice.nearest_m = loose.map_or(f64::INFINITY, |t| t.distance_m);
        let governing = advice.reaction.governing.and_then(|g| self.senses.threats.get(g));
        advice.governed_by =
            governing.and_then(|t| if let Other::Loose { key, .. } = t.other { Some(key) } else { None });
        let stands = self.stands();
        let wants = advice.astray_s > NEARLY_S || (self.following && reference.qd.iter().any(|v| *v != 0.0));
        let held = wants && allowed > 0.0 && (self.headway < HEADWAY || (self.following && stands));
        self.standing_s = if held { self.standing_s + dt } else { 0.0 };
        self.evaded_s = if advice.reaction.size > EVADING { 0.0 } else { self.evaded_s + dt };
        let lost = !self.following && self.way.is_empty() && self.evaded_s >= EVADING_S && allowed > 0.0;
        self.lost_s = if lost && stands {
            self.lost_s + dt
        } else if lost {
            self.lost_s
        } else {
            0.0
        };
        advice.wants_way = self.way.is_empty() && stands && (self.lost_s > 0.0 || self.stuck());
        advice.rate = if advice.braked && self.following { 0.0 } else { self.rate(reference, advice.astray_s) };
        advice.doing = if allowed == 0.0 {
            Doing::Halted
        } else if held && stands && self.standing_s > 0.1 {
            Doing::Waiting
        } else if !self.way.is_empty() {
            Doing::Rounding
        } else if self.following {
            Doing::Following
        } else if self.evaded_s < EVADING_S || advice.reaction.asked {
            Doing::Evading
        } else {
            Doing::Returning
        };
        advice
    }

    /// No headway for long, and what is in the way does not move.
    fn stuck(&self) -> bool {
        let moves = |t: &Threat| t.velocity().length() > OBSTACLE_STANDS_M_S;
        self.standing_s >= self.settings.patience_s && !self.senses.threats.iter().any(moves)
    }

    /// How fast the path may go on.
    fn rate(&mut self, reference: &Reference<'_>, astray_s: f64) -> f64 {
        if !self.way.is_empty() {
            return 0.0;
        }
        let ahead: f64 = reference
            .qd
            .iter()
            .zip(reference.q.iter().zip(&self.q))
            .zip(&self.limits)
            .map(|((v, (to, from)), l)| v * (from - to) / (l.speed * l.speed))
            .sum();
        match reference.path {
            PathKind::Continuous if astray_s > NONE_S => 0.0,
            PathKind::Continuous => self.slowed(reference),
            // The robot is ahead of its path: the nearest point of the path lies farther on.
            PathKind::PointToPoint if astray_s > NONE_S && ahead > 0.0 => 1.0,
            PathKind::PointToPoint => (1.0 - astray_s / self.settings.stray_s).max(0.0),
        }
    }

    /// The share of the path's speed at which gaps close half as fast as they may.
    fn slowed(&mut self, reference: &Reference<'_>) -> f64 {
        let chain = &self.senses.scene.robots()[self.senses.robot].robot.chain;
        let state = &self.senses.chains[self.senses.robot];
        let s = &self.settings.reflex;
        let mut rate: f64 = 1.0;
        let columns = &mut self.columns;
        for threat in self.senses.threats.iter().filter(|t| matches!(t.other, Other::Loose { .. })) {
            let in_link = state.link_in_root(threat.link).inverse().transform_point(threat.on_link);
            chain.jacobian(state, threat.link, in_link, columns);
            let along = |c: &[f64; 6]| c[0] * threat.away.x + c[1] * threat.away.y + c[2] * threat.away.z;
            let closing: f64 = -columns.iter().zip(reference.qd).map(|(c, v)| along(c) * v).sum::<f64>();
            if closing > 0.0 {
                let may = 0.5 * (threat.distance_m - s.clearance_m) / s.closing_s
                    - threat.away.dot(threat.velocity()).max(0.0);
                rate = rate.min((may / closing).max(0.0));
            }
        }
        rate
    }
}
