//! The motion as a function of time.

use super::blend::Blend;
use super::leg::Leg;
use super::legs::{Corner, Legs, along};
use super::limits::MotionError;

/// Where the joints are at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Positions, rad.
    pub q: Vec<f64>,
    /// Speeds, rad/s.
    pub qd: Vec<f64>,
    /// Accelerations, rad/s².
    pub qdd: Vec<f64>,
}

/// A path in time: starts and ends at rest; speed and acceleration are continuous, jerk is limited.
#[derive(Debug, Clone)]
pub struct Trajectory {
    path: Legs,
    pieces: Vec<Piece>,
    seconds: f64,
}

#[derive(Debug, Clone)]
struct Piece {
    /// When it begins, s.
    begin: f64,
    /// The joints rest when it begins.
    rests: bool,
    /// Time in the piece per time that passes, at most 1.
    pace: f64,
    shape: Shape,
}

#[derive(Debug, Clone, Copy)]
enum Shape {
    /// Along leg `n`, from `away` after its corner.
    Straight { n: usize, away: f64, leg: Leg },
    /// Around the corner before leg `n`.
    Blend { n: usize, corner: Corner },
}

/// On what the motion is at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum On {
    /// Straight along a leg, counted from 0.
    Leg(usize),
    /// Around the corner before a leg.
    Corner(usize),
}

impl Trajectory {
    pub(super) fn assemble(path: Legs, corners: &[Corner]) -> Self {
        let (mut pieces, mut now) = (Vec::new(), 0.0);
        let mut add = |shape: Shape, rests: bool, seconds: f64| {
            pieces.push(Piece { begin: now, rests, pace: 1.0, shape });
            now += seconds;
        };
        for (n, s) in path.stretches.iter().enumerate() {
            let (a, b) = (corners[n], corners[n + 1]);
            if n > 0 && a.seconds > 0.0 && a.speed > 0.0 {
                add(Shape::Blend { n, corner: a }, false, a.seconds);
            }
            let leg = Leg::new((s.length - a.away() - b.away()).max(0.0), a.speed, b.speed, s.limits);
            add(Shape::Straight { n, away: a.away(), leg }, a.speed == 0.0, leg.seconds());
        }
        Self { path, pieces, seconds: now }
    }

    /// How long it takes, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Corners at which it stops.
    pub fn stops(&self) -> usize {
        self.pieces.iter().skip(1).filter(|p| p.rests).count()
    }

    /// Where the joints are `t` seconds after the start; before it at the start, afterwards (and for NaN) at the end.
    pub fn at(&self, t: f64) -> State {
        let joints = self.path.end.len();
        if self.pieces.is_empty() || !(t < self.seconds) {
            return State { q: self.path.end.clone(), qd: vec![0.0; joints], qdd: vec![0.0; joints] };
        }
        let piece = &self.pieces[self.piece(t)];
        let (since, pace) = ((t - piece.begin).max(0.0) * piece.pace, piece.pace);
        let scaled = |v: &[f64], factor: f64| v.iter().map(|x| x * factor).collect();
        match piece.shape {
            Shape::Straight { n, away, ref leg } => {
                let [s, v, a] = leg.at(since);
                let stretch = &self.path.stretches[n];
                State {
                    q: along(&stretch.from, &stretch.direction, away + s),
                    qd: scaled(&stretch.direction, v * pace),
                    qdd: scaled(&stretch.direction, a * pace * pace),
                }
            }
            Shape::Blend { n, corner } => {
                let (before, after) = (&self.path.stretches[n - 1].direction, &self.path.stretches[n].direction);
                let blend = Blend { before, after, speed: corner.speed, seconds: corner.seconds };
                let from = along(&self.path.stretches[n].from, before, -corner.away());
                let mut state = State { q: from, qd: vec![0.0; joints], qdd: vec![0.0; joints] };
                for i in 0..joints {
                    let [q, qd, qdd] = blend.at(since, i);
                    state.q[i] += q;
                    (state.qd[i], state.qdd[i]) = (qd * pace, qdd * pace * pace);
                }
                state
            }
        }
    }

    fn piece(&self, t: f64) -> usize {
        self.pieces.partition_point(|p| p.begin <= t).saturating_sub(1)
    }

    /// On what it is at an instant.
    pub(crate) fn on(&self, t: f64) -> Option<On> {
        self.pieces.get(self.piece(t)).map(|p| match p.shape {
            Shape::Straight { n, .. } => On::Leg(n),
            Shape::Blend { n, .. } => On::Corner(n),
        })
    }

    /// The same motion a little slower, so that it rests at whole multiples of a period (s) only: rows at these times then
    /// hold every corner at which it stops. Each stretch from rest to rest takes less than a period longer.
    ///
    /// # Errors
    /// A period that is not a finite number above 0.
    pub fn on_ticks(mut self, period: f64) -> Result<Self, MotionError> {
        if !(period.is_finite() && period > 0.0) {
            return Err(MotionError::Period(period));
        }
        let ends: Vec<f64> = self.pieces.iter().skip(1).map(|p| p.begin).chain([self.seconds]).collect();
        let mut ticks = 0.0;
        let mut from = 0;
        while from < self.pieces.len() {
            let rest = (from + 1..self.pieces.len()).find(|&n| self.pieces[n].rests).unwrap_or(self.pieces.len());
            let (begin, seconds) = (self.pieces[from].begin, ends[rest - 1] - self.pieces[from].begin);
            // A rounding above a whole number is that number.
            let takes = (seconds / period - 1e-9).ceil().max(1.0);
            let pace = (seconds / (takes * period)).min(1.0);
            for piece in &mut self.pieces[from..rest] {
                piece.begin = ticks * period + (piece.begin - begin) / pace;
                piece.pace = pace;
            }
            ticks += takes;
            from = rest;
        }
        self.seconds = ticks * period;
        Ok(self)
    }

    /// Times (s) and positions (rad) at every period from 0 to the end. Linear between them, no joint is faster than its
    /// limit.
    ///
    /// # Errors
    /// A period that is not a finite number above 0.
    pub fn rows(&self, period: f64) -> Result<Vec<(f64, Vec<f64>)>, MotionError> {
        if !(period.is_finite() && period > 0.0) {
            return Err(MotionError::Period(period));
        }
        // A rounding above a whole number is that number.
        let count = (self.seconds / period - 1e-9).ceil().max(0.0) as usize;
        let row = |k: usize| {
            (k as f64 * period, if k == count { self.path.end.clone() } else { self.at(k as f64 * period).q })
        };
        Ok((0..=count).map(row).collect())
    }
}
