//! One look: from a wanted joint velocity and what is near to the velocity that evades.
//!
//! Each near pair gives two rows of a weighted least-squares problem in the joint velocities ([`LeastSquares`]):
//! - **evade** (what moves, or is not known): the collision point goes in the direction that the fuzzy rules ask for, at
//!   least as fast as they ask for, `u·J·q̇ ≥ size·V`;
//! - **keep clear** (everything): the gap closes no faster than a stop allows, `ḋ ≥ −(d − d_min)/τ` (Faverjon and Tournassoud
//!   1987, "A local based approach for path planning of manipulators with a high number of degrees of freedom").
//!
//! What these leave open follows the wanted velocity: joint motion beyond the task is the least, in the norm of the joints'
//! top speeds, and the null space is the task's.

use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::Vec3;

use crate::least::LeastSquares;
use crate::side::{Coming, Sides};
use crate::{Other, Rules, Threat};

/// Threats that are looked at: the nearest ones.
pub(crate) const MOST_THREATS: usize = 48;
/// Weight of an evasion of size 1 beside the task's 1.
const EVADE: f64 = 100.0;
/// Weight of what may not be: a wanted full speed pushes through by a millionth of the evasion speed.
const KEEP: f64 = 1e6;
/// Slower than this nothing has a direction, m/s.
const STILL_M_S: f64 = 0.02;
/// Coming at this speed something is fled from in full even by an arm that holds its path, m/s.
const COMES_M_S: f64 = 0.05;

/// How the robot evades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReflexSettings {
    /// Speed of the collision point for a correction of size 1, m/s.
    pub speed_m_s: f64,
    /// Distance that is kept to what moves or is not known, m.
    pub clearance_m: f64,
    /// Distance below which the robot, off its path, comes no nearer to what was planned for, m.
    pub fixed_clearance_m: f64,
    /// Time constant in which a gap may close, s: no shorter than a stop takes.
    pub closing_s: f64,
}

impl Default for ReflexSettings {
    /// 1 m/s; 50 mm and 20 mm; 0.2 s.
    fn default() -> Self {
        Self { speed_m_s: 1.0, clearance_m: 0.05, fixed_clearance_m: 0.02, closing_s: 0.2 }
    }
}

/// What the wanted velocity is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Manner {
    /// A path that may be left: what it approaches comes as fast as the two together.
    Underway,
    /// The pull back to a path: how hard it pulls says nothing about what comes.
    Back,
    /// A path to be kept: fled from is only what comes by itself. For the rest slowing down is the answer, and the
    /// caller's.
    Holding,
    /// A way that was proven with all that stands where it stands: only what moves counts.
    Proven,
}

/// Bounds of the joint velocities, rad/s or m/s.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityBounds {
    /// Of the next command: speed, acceleration and limits of the joints.
    pub now: Vec<[f64; 2]>,
    /// Of the near future: without the acceleration.
    pub soon: Vec<[f64; 2]>,
}

/// What the robot would do if nothing were near.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// Joint velocities, rad/s or m/s.
    pub wanted: &'a [f64],
    /// What the joints can do.
    pub bounds: &'a VelocityBounds,
    /// What it is for.
    pub manner: Manner,
}

/// What an evasion was about.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reaction {
    /// Largest size that the rules asked for, 0 to 1.
    pub size: f64,
    /// Number of the threat that asked for it.
    pub governing: Option<usize>,
    /// How much of what keeps clear could not be kept, m/s: above 0 something comes faster than the robot can leave.
    pub overrun_m_s: f64,
    /// Whether the wanted velocity does not meet all that is asked for what moves or is not known.
    pub asked: bool,
}

/// The reaction of one robot. Does not allocate after it has been made.
#[derive(Debug, Clone)]
pub struct Reflex {
    rules: Rules,
    settings: ReflexSettings,
    /// Top speed per joint, rad/s or m/s.
    speeds: Vec<f64>,
    least: LeastSquares,
    sides: Sides,
    columns: Vec<[f64; 6]>,
    other_columns: Vec<[f64; 6]>,
    /// Velocity of the collision point per joint at its top speed, m/s.
    point: Vec<Vec3>,
    scaled: Vec<f64>,
}

impl Reflex {
    /// For a chain whose joints go at most so fast (rad/s or m/s, one number above 0 per independent joint).
    pub fn new(chain: &Chain, speeds: &[f64], rules: Rules, settings: ReflexSettings) -> Self {
        let n = chain.dof();
        let mut speeds = speeds.to_vec();
        speeds.resize(n, 1.0);
        Self {
            rules,
            settings,
            speeds,
            least: LeastSquares::new(n, 2 * MOST_THREATS),
            sides: Sides::default(),
            columns: vec![[0.0; 6]; n],
            other_columns: vec![[0.0; 6]; n],
            point: vec![Vec3::ZERO; n],
            scaled: vec![0.0; n],
        }
    }

    /// The rules.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// The settings.
    pub fn settings(&self) -> &ReflexSettings {
        &self.settings
    }

    /// Turns the wanted joint velocity into one that evades, in `out`. `state` holds the poses of the links at this moment;
    /// of more than 48 threats the first 48 count, so they should come nearest first.
    pub fn react(
        &mut self,
        chain: &Chain,
        state: &ChainState,
        task: &Task<'_>,
        threats: &[Threat],
        out: &mut [f64],
    ) -> Reaction {
        let Task { wanted, bounds, .. } = *task;
        self.sides.next();
        self.least.clear();
        for (j, speed) in self.speeds.iter().enumerate() {
            self.least.wanted[j] = wanted[j] / speed;
            self.least.lower[j] = bounds.now[j][0] / speed;
            self.least.upper[j] = bounds.now[j][1] / speed;
            self.scaled[j] = self.least.wanted[j];
        }
        let mut reaction = Reaction::default();
        for (number, threat) in threats.iter().enumerate().take(MOST_THREATS) {
            if task.manner == Manner::Proven && threat.velocity().length() <= STILL_M_S {
                continue;
            }
            self.measure(chain, state, threat);
            let first = self.least.wishes().len();
            self.keep_clear(threat);
            let size = self.evade(threat, task);
            let counts = match threat.other {
                Other::Loose { .. } => true,
                // A path was made with it in mind.
                Other::Moving { .. } => matches!(task.manner, Manner::Proven | Manner::Back),
                Other::Own(_) | Other::Fixed => false,
            };
            if counts {
                let missed = |w: &crate::Wish| !(w.weight == 0.0 || w.miss(&self.scaled) == 0.0);
                reaction.asked |= self.least.wishes()[first..].iter().any(missed);
            }
            if size > reaction.size {
                (reaction.size, reaction.governing) = (size, Some(number));
            }
        }
        if !self.least.solve(&mut self.scaled) {
            // Nothing that can be trusted: as slow as the joints can be.
            out.iter_mut().zip(&bounds.now).for_each(|(v, [low, high])| *v = 0.0_f64.clamp(*low, *high));
            return Reaction { asked: true, ..reaction };
        }
        for (j, speed) in self.speeds.iter().enumerate() {
            out[j] = self.scaled[j] * speed;
        }
        reaction.overrun_m_s = self.overrun();
        reaction
    }

    /// The collision point's velocity per joint, relative to the robot's own link where that is on the other side.
    fn measure(&mut self, chain: &Chain, state: &ChainState, threat: &Threat) {
        point_columns(chain, state, threat.link, threat.on_link, &mut self.columns);
        if let Other::Own(link) = threat.other {
            point_columns(chain, state, link, threat.on_other, &mut self.other_columns);
        } else {
            self.other_columns.fill([0.0; 6]);
        }
        for (j, point) in self.point.iter_mut().enumerate() {
            let (a, b) = (&self.columns[j], &self.other_columns[j]);
            *point = Vec3::new(a[0] - b[0], a[1] - b[1], a[2] - b[2]) * self.speeds[j];
        }
    }

    fn keep_clear(&mut self, threat: &Threat) {
        let s = &self.settings;
        let least_m = if matches!(threat.other, Other::Loose { .. }) { s.clearance_m } else { s.fixed_clearance_m };
        let room = threat.distance_m - least_m;
        // What does not come is not backed away from: there may be no room on the other side.
        let comes = matches!(threat.other, Other::Loose { .. });
        let closing = if comes { room } else { room.max(0.0) } / s.closing_s;
        let b = (threat.away.dot(threat.velocity()) - closing) / s.speed_m_s;
        Self::add(&mut self.least, &self.point, threat.away, b, KEEP, s.speed_m_s);
    }

    /// Adds what the rules ask for and returns the size.
    fn evade(&mut self, threat: &Threat, task: &Task<'_>) -> f64 {
        let Task { wanted, bounds, manner } = *task;
        let Other::Loose { velocity, centre, radius_m, key } = threat.other else { return 0.0 };
        let along_task = self.point.iter().zip(wanted).zip(&self.speeds).map(|((p, w), s)| *p * (w / s));
        let own = along_task.fold(Vec3::ZERO, |sum, v| sum + v);
        let relative = if manner == Manner::Underway { velocity - own } else { velocity };
        let mut correction = self.rules.correction(threat.distance_m, threat.away.dot(relative));
        if manner == Manner::Holding {
            correction.size *= (threat.away.dot(velocity) / COMES_M_S).clamp(0.0, 1.0);
        }
        if correction.size <= 0.0 {
            return 0.0;
        }
        let mut direction = threat.away;
        // Its own way is steadier than the one that it has as seen from an arm that moves.
        let way = if velocity.length() > STILL_M_S { velocity } else { relative };
        if let Some(along) = way.try_normalize().filter(|_| way.length() > STILL_M_S) {
            let offset = threat.on_link - centre;
            let miss = offset - along * offset.dot(along);
            let clear_m = radius_m + self.settings.clearance_m;
            let side = self.side(&Coming { along, miss, clear_m, key }, bounds);
            let (s, c) = correction.direction_rad.sin_cos();
            direction = (threat.away * c + side * s).try_normalize().unwrap_or(side);
        }
        let (size, speed) = (correction.size, self.settings.speed_m_s);
        Self::add(&mut self.least, &self.point, direction, size, EVADE * size, speed);
        size
    }

    fn side(&mut self, coming: &Coming, bounds: &VelocityBounds) -> Vec3 {
        let (point, speeds) = (&self.point, &self.speeds);
        let fastest = |side: Vec3| {
            let each = point.iter().zip(&bounds.soon).zip(speeds).map(|((p, [low, high]), s)| {
                let along = p.dot(side) / s;
                (along * low).max(along * high)
            });
            each.sum::<f64>()
        };
        let effort = |side: Vec3| {
            let square: f64 = point.iter().map(|p| p.dot(side).powi(2)).sum();
            1.0 / square.sqrt().max(1e-3)
        };
        self.sides.choose(coming, fastest, effort)
    }

    fn add(least: &mut LeastSquares, point: &[Vec3], direction: Vec3, b: f64, weight: f64, unit: f64) {
        let Some(wish) = least.wish() else { return };
        for (a, p) in wish.a.iter_mut().zip(point) {
            *a = p.dot(direction) / unit;
        }
        (wish.b, wish.weight, wish.at_least) = (b, weight, true);
    }

    fn overrun(&self) -> f64 {
        let kept = self.least.wishes().iter().filter(|w| w.weight >= KEEP);
        kept.map(|w| -w.miss(&self.scaled)).fold(0.0, f64::max) * self.settings.speed_m_s
    }
}

fn point_columns(chain: &Chain, state: &ChainState, link: LinkId, point_in_root: Vec3, out: &mut [[f64; 6]]) {
    let in_link = state.link_in_root(link).inverse().transform_point(point_in_root);
    chain.jacobian(state, link, in_link, out);
}
