//! The override laws, one function each (S1, eqs. 1-4 and beyond). `docs/laws.md` shows their plots.

/// Which laws a monitor obeys. The default is the paper's law alone: `v = v₀ · clamp(d / δ, 0, 1)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Laws {
    /// True: a volume whose gap to a region grows is not held back by it. Off by default because it needs the
    /// program's [`intent`](crate::Snapshot::intent) to release a robot that stands still.
    pub direction_aware: bool,
    /// Largest share of v₀ while a direction-aware robot leaves a region from inside.
    pub recovery: f64,
    /// Never faster than a stop before the border allows.
    pub stopping_distance: Option<Stopping>,
    /// Largest change of the override per second; 0 for unlimited. Faults and contact stop at once all the same.
    pub override_rate: f64,
    /// Input older than this (s) is override 0.
    pub stale_s: f64,
}

impl Default for Laws {
    fn default() -> Self {
        Self { direction_aware: false, recovery: 0.1, stopping_distance: None, override_rate: 0.0, stale_s: 0.02 }
    }
}

/// How a robot stops: for the stopping-distance law.
#[derive(Debug, Clone, PartialEq)]
pub struct Stopping {
    /// Time (s) from the monitor's answer to the first deceleration.
    pub reaction_s: f64,
    /// Deceleration that each joint can be trusted to reach, rad/s² or m/s².
    pub joint_deceleration: Vec<f64>,
}

/// The warning zone's law, `clamp(d / δ, 0, 1)` (S1, eqs. 1-3 in one line); with δ = 0 it is 0 inside and 1 outside.
///
/// ```
/// use elbowroom_monitor::laws::warning_factor;
/// assert_eq!(warning_factor(0.1, 0.2), 0.5);
/// assert_eq!(warning_factor(0.3, 0.2), 1.0);
/// assert_eq!(warning_factor(0.0, 0.2), 0.0);
/// ```
#[inline]
pub fn warning_factor(distance_m: f64, warning_m: f64) -> f64 {
    if distance_m >= warning_m && distance_m > 0.0 {
        return 1.0;
    }
    // A NaN distance compares false above and below: it must read as contact.
    if distance_m > 0.0 { distance_m / warning_m } else { 0.0 }
}

/// A speed zone's override: `slow_to` inside (never more than `programmed`), rising linearly to `programmed` at the
/// warning zone's outer border.
///
/// ```
/// use elbowroom_monitor::laws::speed_zone;
/// assert_eq!(speed_zone(0.0, 0.2, 0.3, 1.0), 0.3);
/// assert!((speed_zone(0.1, 0.2, 0.3, 1.0) - 0.65).abs() < 1e-15);
/// assert_eq!(speed_zone(0.0, 0.2, 0.3, 0.2), 0.2);
/// ```
#[inline]
pub fn speed_zone(distance_m: f64, warning_m: f64, slow_to: f64, programmed: f64) -> f64 {
    let inside = slow_to.min(programmed);
    inside + (programmed - inside) * warning_factor(distance_m, warning_m)
}

/// The largest override σ from which a stop still ends before the border (after the speed-and-separation idea of
/// ISO 13855: reaction distance plus braking distance).
///
/// At override σ the point closes at `σ·v`; it does so for the reaction time `t` and then brakes with the override
/// falling at `rate` per second, which takes `σ²·v / (2·rate)` more. The largest σ with
/// `σ·v·t + σ²·v / (2·rate) ≤ d` is `rate·(√(t² + 2d / (v·rate)) − t)`.
///
/// `closing_speed` is v at override 1 in m/s (not positive: no limit), `rate` in 1/s.
///
/// ```
/// use elbowroom_monitor::laws::stopping_factor;
/// let sigma = stopping_factor(0.1, 1.0, 2.0, 0.05);
/// assert!((sigma * 0.05 + sigma * sigma / 4.0 - 0.1).abs() < 1e-12);
/// assert_eq!(stopping_factor(0.1, -1.0, 2.0, 0.05), f64::INFINITY);
/// ```
#[inline]
pub fn stopping_factor(distance_m: f64, closing_speed: f64, rate: f64, reaction_s: f64) -> f64 {
    if closing_speed <= 0.0 {
        return f64::INFINITY;
    }
    let d = distance_m.max(0.0);
    let sigma = rate * ((reaction_s * reaction_s + 2.0 * d / (closing_speed * rate)).sqrt() - reaction_s);
    if sigma.is_nan() { 0.0 } else { sigma }
}

/// The largest override from which braking alone still ends within `distance_m`: `σ²·v / (2·rate) ≤ d`. For a robot
/// that obeys late, d is what is left once it obeys.
///
/// ```
/// use elbowroom_monitor::laws::braking_factor;
/// assert_eq!(braking_factor(0.1, 1.0, 5.0), 1.0);
/// assert_eq!(braking_factor(-0.1, 1.0, 5.0), 0.0);
/// ```
#[inline]
pub fn braking_factor(distance_m: f64, closing_speed: f64, rate: f64) -> f64 {
    if closing_speed <= 0.0 {
        return f64::INFINITY;
    }
    let sigma = (2.0 * rate * distance_m.max(0.0) / closing_speed).sqrt();
    if sigma.is_nan() { 0.0 } else { sigma }
}

/// Time (s, at override 1) until a gap of `distance_m` may be closed by something that closes at `closing_speed` (m/s,
/// negative for leaving) and whose points accelerate by no more than `acceleration` (m/s², in any direction):
/// the largest τ with `v·τ + a·τ²/2 ≤ d`.
///
/// ```
/// use elbowroom_monitor::laws::time_to_close;
/// assert_eq!(time_to_close(0.1, 2.0, 0.0), 0.05);
/// assert_eq!(time_to_close(0.1, -2.0, 0.0), f64::INFINITY);
/// let tau = time_to_close(0.1, -0.2, 3.0);
/// assert!((-0.2 * tau + 1.5 * tau * tau - 0.1).abs() < 1e-12);
/// ```
#[inline]
pub fn time_to_close(distance_m: f64, closing_speed: f64, acceleration: f64) -> f64 {
    let (d, v, a) = (distance_m.max(0.0), closing_speed, acceleration.max(0.0));
    if a < 1e-9 {
        return if v > 0.0 { d / v } else { f64::INFINITY };
    }
    let root = (v * v + 2.0 * a * d).sqrt();
    // Each form where it does not cancel.
    let time = if v > 0.0 { 2.0 * d / (v + root) } else { (root - v) / a };
    if time.is_nan() { 0.0 } else { time }
}

/// How fast the override can fall (1/s) when no joint may decelerate beyond its limit: `min aᵢ / |q̇ᵢ|` over the
/// joints, q̇ being the joint velocities at override 1.
///
/// ```
/// use elbowroom_monitor::laws::override_deceleration;
/// assert_eq!(override_deceleration(&[2.0, -1.0], &[10.0, 3.0]), 3.0);
/// ```
#[inline]
pub fn override_deceleration(intent: &[f64], joint_deceleration: &[f64]) -> f64 {
    intent
        .iter()
        .zip(joint_deceleration)
        .filter(|(v, _)| **v != 0.0)
        .fold(f64::INFINITY, |rate, (v, a)| rate.min(a / v.abs()))
}

/// [`override_deceleration`] along a program that accelerates by itself: what following it takes is not left for the
/// stop, `min (aᵢ − |q̈ᵢ|) / |q̇ᵢ|`, but at least a tenth of aᵢ is.
///
/// ```
/// use elbowroom_monitor::laws::deceleration_left;
/// assert_eq!(deceleration_left(&[2.0, -1.0], &[0.0, -1.0], &[10.0, 3.0]), 2.0);
/// ```
#[inline]
pub fn deceleration_left(velocity: &[f64], acceleration: &[f64], joint_deceleration: &[f64]) -> f64 {
    let moving = velocity.iter().zip(acceleration).zip(joint_deceleration).filter(|((v, _), _)| **v != 0.0);
    moving.fold(f64::INFINITY, |rate, ((v, q), a)| rate.min((a - q.abs()).max(0.1 * a) / v.abs()))
}

/// The override moved from `previous` towards `wanted` by at most `rate` per second; `rate` 0 is unlimited.
///
/// ```
/// use elbowroom_monitor::laws::rate_limited;
/// assert!((rate_limited(1.0, 0.0, 2.0, 0.01) - 0.98).abs() < 1e-15);
/// assert_eq!(rate_limited(1.0, 0.0, 0.0, 0.01), 0.0);
/// ```
#[inline]
pub fn rate_limited(previous: f64, wanted: f64, rate: f64, dt_s: f64) -> f64 {
    if rate <= 0.0 {
        return wanted;
    }
    let step = rate * dt_s;
    wanted.clamp(previous - step, previous + step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_zone_of_no_thickness_stops_at_contact_only() {
        assert_eq!(warning_factor(1e-12, 0.0), 1.0);
        assert_eq!(warning_factor(0.0, 0.0), 0.0);
    }

    #[test]
    fn nan_reads_as_contact() {
        assert_eq!(warning_factor(f64::NAN, 0.2), 0.0);
        assert_eq!(stopping_factor(f64::NAN, 1.0, 1.0, 0.1), 0.0);
    }

    #[test]
    fn no_joint_moving_means_an_immediate_stop() {
        assert_eq!(override_deceleration(&[0.0, 0.0], &[1.0, 1.0]), f64::INFINITY);
    }
}
