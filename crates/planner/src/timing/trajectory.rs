//! The motion as a function of time.

use super::blend::Blend;
use super::corner::triangle_is_free;
use super::leg::{Leg, greatest};
use super::limits::{Along, MotionError, MotionLimits};
use super::ramp::Ramp;
use crate::path::Path;
use crate::planner::Planner;

/// Waypoints nearer than this are one, rad.
const SAME: f64 = 1e-9;
/// So often a corner's triangle is made half as large before the motion stops at the corner.
const SMALLER: usize = 6;

/// Where the joints are at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Positions, rad.
    pub q: [f64; 3],
    /// Speeds, rad/s.
    pub qd: [f64; 3],
    /// Accelerations, rad/s².
    pub qdd: [f64; 3],
}

#[derive(Debug, Clone, Copy)]
enum Piece {
    Straight { from: [f64; 3], direction: [f64; 3], leg: Leg },
    Blend(Blend),
}

/// A path in time: starts and ends at rest; speed and acceleration are continuous, jerk is limited.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// When each piece begins, s.
    begins: Vec<f64>,
    pieces: Vec<Piece>,
    end: [f64; 3],
    seconds: f64,
    stops: usize,
}

/// A leg of the path before it is timed.
struct Stretch {
    from: [f64; 3],
    direction: [f64; 3],
    length: f64,
    limits: Along,
}

/// A corner between two legs (or an end, speed 0): how fast it is passed and how far from it the blend begins.
#[derive(Clone, Copy, Default)]
struct Corner {
    speed: f64,
    seconds: f64,
}

impl Corner {
    fn away(self) -> f64 {
        0.5 * self.speed * self.seconds
    }
}

impl Planner {
    /// Times a path within limits. Straight legs are kept; corners are rounded where the triangle that is cut off lies in
    /// free cells of the table, up to half of the shorter leg; elsewhere the motion stops at the corner.
    ///
    /// ```
    /// # use elbowroom_cspace::{Axis, Grid, Table};
    /// # use elbowroom_planner::{MotionLimits, Path, Planner};
    /// # let axis = |name| Axis::new(name, 0.0, 1.0, 0.05);
    /// # let grid = Grid::new([axis("a")?, axis("b")?, axis("c")?])?;
    /// # let planner = Planner::new(&grid, &Table::new(grid.shape()))?;
    /// # let waypoints = vec![[0.1, 0.1, 0.1], [0.9, 0.1, 0.1], [0.9, 0.9, 0.1]];
    /// # let path = Path { waypoints, length_rad: 1.6, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
    /// let limits = MotionLimits { velocity: [2.0; 3], acceleration: [10.0; 3], jerk: [200.0; 3] };
    /// let motion = planner.time(&path, &limits)?;
    /// assert_eq!((motion.at(0.0).q, motion.stops()), ([0.1, 0.1, 0.1], 0));
    /// assert_eq!(motion.at(motion.seconds()).q, [0.9, 0.9, 0.1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A limit that is not a finite number above 0; a path without waypoints.
    pub fn time(&self, path: &Path, limits: &MotionLimits) -> Result<Trajectory, MotionError> {
        limits.validate()?;
        let Some(&end) = path.waypoints.last() else { return Err(MotionError::Path) };
        if path.waypoints.iter().flatten().any(|x| !x.is_finite()) {
            return Err(MotionError::Path);
        }
        let stretches = stretches(&path.waypoints, limits);
        let mut corners = vec![Corner::default(); stretches.len() + 1];
        for n in 1..stretches.len() {
            corners[n] = self.corner([&stretches[n - 1], &stretches[n]], limits);
        }
        slow_down(&stretches, &mut corners, limits);
        Ok(assemble(&stretches, &corners, end))
    }

    /// The fastest that a corner can be passed.
    fn corner(&self, [a, b]: [&Stretch; 2], limits: &MotionLimits) -> Corner {
        let directions = [a.direction, b.direction];
        let top = a.limits.speed.min(b.limits.speed);
        let mut away = 0.5 * a.length.min(b.length);
        for _ in 0..SMALLER {
            let ends = [along(b.from, a.direction, -away), b.from, along(b.from, b.direction, away)];
            if triangle_is_free(&self.table, ends.map(|q| self.space.point(q))) {
                let seconds = |speed: f64| Blend::seconds(speed, directions, limits);
                let speed = greatest(0.0, top, |speed| 0.5 * speed * seconds(speed) <= away);
                return Corner { speed, seconds: seconds(speed) };
            }
            away *= 0.5;
        }
        Corner::default()
    }
}

fn along(from: [f64; 3], direction: [f64; 3], far: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| from[i] + direction[i] * far)
}

fn stretches(waypoints: &[[f64; 3]], limits: &MotionLimits) -> Vec<Stretch> {
    let mut found = Vec::with_capacity(waypoints.len());
    let Some(&(mut from)) = waypoints.first() else { return found };
    for &to in &waypoints[1..] {
        let way = [0, 1, 2].map(|i| to[i] - from[i]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > SAME {
            let direction = way.map(|x| x / length);
            found.push(Stretch { from, direction, length, limits: limits.along(direction) });
            from = to;
        }
    }
    found
}

/// Makes corners slower until each leg is long enough for the change of speed on it: forth, then back.
fn slow_down(stretches: &[Stretch], corners: &mut [Corner], limits: &MotionLimits) {
    let fits = |leg: &Stretch, a: Corner, b: Corner| {
        Ramp::new(a.speed, b.speed, leg.limits).distance() <= leg.length - a.away() - b.away()
    };
    let slower = |n: usize, speed: f64| {
        let directions = [stretches[n - 1].direction, stretches[n].direction];
        Corner { speed, seconds: Blend::seconds(speed, directions, limits) }
    };
    for n in 0..stretches.len().saturating_sub(1) {
        let (a, b) = (corners[n], corners[n + 1]);
        if b.speed > a.speed {
            let speed = greatest(a.speed, b.speed, |speed| fits(&stretches[n], a, slower(n + 1, speed)));
            corners[n + 1] = if speed < b.speed { slower(n + 1, speed) } else { b };
        }
    }
    for n in (1..stretches.len()).rev() {
        let (a, b) = (corners[n], corners[n + 1]);
        if a.speed > b.speed {
            let speed = greatest(b.speed, a.speed, |speed| fits(&stretches[n], slower(n, speed), b));
            corners[n] = if speed < a.speed { slower(n, speed) } else { a };
        }
    }
}

fn assemble(stretches: &[Stretch], corners: &[Corner], end: [f64; 3]) -> Trajectory {
    let (mut begins, mut pieces, mut now, mut stops) = (Vec::new(), Vec::new(), 0.0, 0);
    let mut add = |piece: Piece, seconds: f64| {
        begins.push(now);
        pieces.push(piece);
        now += seconds;
    };
    for (n, s) in stretches.iter().enumerate() {
        let (a, b) = (corners[n], corners[n + 1]);
        if n > 0 && a.seconds > 0.0 && a.speed > 0.0 {
            let before = stretches[n - 1].direction;
            let [before_v, after_v] = [before, s.direction].map(|u| u.map(|x| x * a.speed));
            let from = along(s.from, before, -a.away());
            add(Piece::Blend(Blend { from, before: before_v, after: after_v, seconds: a.seconds }), a.seconds);
        }
        stops += usize::from(n > 0 && a.speed == 0.0);
        let from = along(s.from, s.direction, a.away());
        let leg = Leg::new((s.length - a.away() - b.away()).max(0.0), a.speed, b.speed, s.limits);
        add(Piece::Straight { from, direction: s.direction, leg }, leg.seconds());
    }
    Trajectory { begins, pieces, end, seconds: now, stops }
}

impl Trajectory {
    /// How long it takes, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Corners at which it stops.
    pub fn stops(&self) -> usize {
        self.stops
    }

    /// Where the joints are `t` seconds after the start; before it at the start, afterwards (and for NaN) at the end.
    pub fn at(&self, t: f64) -> State {
        let rest = |q| State { q, qd: [0.0; 3], qdd: [0.0; 3] };
        if !(t < self.seconds) {
            return rest(self.end);
        }
        let n = self.begins.partition_point(|&begin| begin <= t).saturating_sub(1);
        let since = (t - self.begins[n]).max(0.0);
        match self.pieces[n] {
            Piece::Straight { from, direction, leg } => {
                let [s, v, a] = leg.at(since);
                State { q: along(from, direction, s), qd: direction.map(|x| x * v), qdd: direction.map(|x| x * a) }
            }
            Piece::Blend(blend) => {
                let [q, qd, qdd] = blend.at(since);
                State { q, qd, qdd }
            }
        }
    }
}
