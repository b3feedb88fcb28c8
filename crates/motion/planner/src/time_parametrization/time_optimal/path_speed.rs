//! Speed along a path: on each piece, `s̈` is linear in the path position `s`, so that `s(t)` has a closed form.
//!
//! With `s̈ = b + c·(s − s₀)` the squared speed `x = ṡ²` is quadratic in s, `s⃛ = c·ṡ`, and `s(t)` is a combination of
//! sinh and cosh (c > 0) or sin and cos (c < 0) with ω = √|c|. Near rest the jerk is constant instead: `s = j·t³/6`.

/// Argument below which the series of sinh, atanh … are exact up to rounding.
const SERIES: f64 = 1e-3;

/// A piece of the motion along a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpeedPiece {
    /// Time and path position at the beginning.
    pub time: f64,
    pub position: f64,
    pub seconds: f64,
    pub law: SpeedLaw,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum SpeedLaw {
    /// `s̈ = b + c·(s − s₀)`, beginning with a speed.
    Linear { speed: f64, b: f64, c: f64 },
    /// Begins at rest, with a constant jerk.
    FromRest { jerk: f64 },
    /// Ends at rest after a length, with a constant jerk.
    ToRest { jerk: f64, length: f64 },
}

/// Path position and its first three derivatives by time.
pub(super) type PathState = [f64; 4];

impl SpeedLaw {
    /// A piece over a length from squared speed `x`, with `b` and `c`, to squared speed `end`; and its duration.
    pub fn linear(length: f64, x: f64, end: f64, b: f64, c: f64) -> (Self, f64) {
        let speed = x.max(0.0).sqrt();
        let mean = 0.5 * (speed + end.max(0.0).sqrt());
        let argument = 0.5 * c.abs().sqrt() * length / mean;
        let stretch = if argument < SERIES {
            1.0 + c.signum() * argument * argument / 3.0
        } else if c > 0.0 {
            argument.min(1.0 - f64::EPSILON).atanh() / argument
        } else {
            argument.atan() / argument
        };
        (Self::Linear { speed, b, c }, length / mean * stretch)
    }

    /// A piece from rest over a length to a speed, and its duration.
    pub fn from_rest(length: f64, speed: f64) -> (Self, f64) {
        let seconds = 3.0 * length / speed;
        (Self::FromRest { jerk: 6.0 * length / seconds.powi(3) }, seconds)
    }

    /// A piece from a speed over a length to rest, and its duration.
    pub fn to_rest(length: f64, speed: f64) -> (Self, f64) {
        let seconds = 3.0 * length / speed;
        (Self::ToRest { jerk: 6.0 * length / seconds.powi(3), length }, seconds)
    }
}

impl SpeedPiece {
    /// States at equal steps of the path position over a length, ends included.
    pub fn over<const N: usize>(&self, length: f64) -> [PathState; N] {
        std::array::from_fn(|n| {
            let share = n as f64 / (N - 1) as f64;
            match self.law {
                SpeedLaw::Linear { speed, b, c } => {
                    let offset = share * length;
                    let v = (speed * speed + offset * (2.0 * b + offset * c)).max(0.0).sqrt();
                    [self.position + offset, v, b + offset * c, c * v]
                }
                SpeedLaw::FromRest { .. } | SpeedLaw::ToRest { .. } => self.at(share * self.seconds),
            }
        })
    }

    /// State at a time since the beginning of the piece.
    pub fn at(&self, t: f64) -> PathState {
        let [s, v, a, j] = match self.law {
            SpeedLaw::Linear { speed, b, c } => {
                let [sine, versine] = sine_and_versine(c, t);
                let v = speed * (1.0 + c * versine) + b * sine;
                let s = speed * sine + b * versine;
                [s, v.max(0.0), b + c * s, c * v.max(0.0)]
            }
            SpeedLaw::FromRest { jerk } => [jerk * t * t * t / 6.0, 0.5 * jerk * t * t, jerk * t, jerk],
            SpeedLaw::ToRest { jerk, length } => {
                let left = (self.seconds - t).max(0.0);
                [length - jerk * left * left * left / 6.0, 0.5 * jerk * left * left, -jerk * left, jerk]
            }
        };
        [self.position + s, v, a, j]
    }
}

/// `sin(ωt)/ω` and `(1 − cos(ωt))/ω²` for c < 0, else their hyperbolic counterparts.
fn sine_and_versine(c: f64, t: f64) -> [f64; 2] {
    let omega = c.abs().sqrt();
    let half = 0.5 * omega * t;
    if half < SERIES {
        let square = c * t * t;
        return [t * (1.0 + square / 6.0), 0.5 * t * t * (1.0 + square / 12.0)];
    }
    let (whole, half) = if c > 0.0 { ((2.0 * half).sinh(), half.sinh()) } else { ((2.0 * half).sin(), half.sin()) };
    [whole / omega, 2.0 * half * half / c.abs()]
}
