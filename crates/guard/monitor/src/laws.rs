//! The override laws, one function each (Romanelli 2011, eqs. 1-4 and beyond). `override_law.rs` applies them to the
//! pairs of volume and region of a tick; `docs/laws.md` shows their plots.

/// The laws of a monitor. The default is the law of Romanelli 2011 alone: `v = v₀ · clamp(d / δ, 0, 1)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Laws {
    /// If true, a region does not limit a volume whose distance from it increases. Off by default, because it needs the
    /// program's [`intent`](crate::Snapshot::intent) to release a stationary robot.
    pub direction_aware: bool,
    /// Largest fraction of v₀ while a robot leaves a region from inside; used by the direction-aware law.
    pub recovery: f64,
    /// The stopping-distance law, which limits the override so that a stop ends before the border; `None` if it is off.
    pub stopping_distance: Option<StoppingSettings>,
    /// Largest change of the override per second; 0 for unlimited. Faults and contact stop at once in any case.
    pub override_rate: f64,
    /// Age (s) beyond which input is stale; then the override is 0.
    pub stale_s: f64,
}

impl Default for Laws {
    fn default() -> Self {
        Self { direction_aware: false, recovery: 0.1, stopping_distance: None, override_rate: 0.0, stale_s: 0.02 }
    }
}

/// Assumptions of the stopping-distance law: how the robot stops, and how its programs accelerate.
///
/// The robot stops along its programmed path. Its **stop time** n is the longest time that any joint needs by
/// itself, `n = max |q̇ᵢ| / aᵢ` with `aᵢ` from [`StoppingSettings::joint_deceleration`]. While the robot runs faster
/// than the commanded override, n is assumed to fall by at least one second per second, whatever the program does
/// meanwhile. This starts at most [`StoppingSettings::reaction_s`] after the command.
#[derive(Debug, Clone, PartialEq)]
pub struct StoppingSettings {
    /// Longest time (s) from a commanded override to the first deceleration.
    pub reaction_s: f64,
    /// Longest time (s) between two commanded overrides. A controller that waits longer must stop by itself.
    pub period_s: f64,
    /// Guaranteed deceleration of each joint, rad/s² or m/s².
    pub joint_deceleration: Vec<f64>,
    /// Largest acceleration of each joint in any program at override 1, rad/s² or m/s². It bounds how fast a path can
    /// bend towards a region.
    pub joint_acceleration: Vec<f64>,
}

/// The law of the warning zone, `clamp(d / δ, 0, 1)` (Romanelli 2011, eqs. 1-3); with δ = 0 it is 0 inside and 1 outside.
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
    // A NaN distance compares false above and below: it counts as contact.
    if distance_m > 0.0 { distance_m / warning_m } else { 0.0 }
}

/// The override of a speed zone: `slow_to` inside, but at most `programmed`; it rises linearly to `programmed` at
/// the outer border of the warning zone.
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

/// The stop time (s) of these joint velocities: the longest time that any joint needs by itself to come to rest,
/// `max |q̇ᵢ| / aᵢ`.
///
/// ```
/// use elbowroom_monitor::laws::stop_time;
/// assert_eq!(stop_time(&[2.0, -1.0], &[10.0, 2.0]), 0.5);
/// ```
#[inline]
pub fn stop_time(velocity: &[f64], deceleration: &[f64]) -> f64 {
    velocity.iter().zip(deceleration).fold(0.0, |longest: f64, (v, a)| longest.max(v.abs() / a))
}

/// Upper bound of the program time (s, at override 1) that passes while a robot comes to rest from the override `sigma`.
///
/// `full_stop_s` is the stop time m of the program's own velocities. `growth` bounds the rate of change of m by
/// program time: `α = max Aᵢ / aᵢ` with the program's accelerations Aᵢ and the joints' decelerations aᵢ. While the
/// stop time `n = σ·m` falls by one second per second, `∫ m du = n²/2` over the program time u; with
/// `m(u) ≥ m − α·u` this gives `u ≤ (m/α) · (1 − √(1 − α·σ²))`. In every case `u ≤ σ²·m`: a stop takes at most n, at
/// an override of at most σ.
///
/// ```
/// use elbowroom_monitor::laws::stopping_program_time;
/// assert_eq!(stopping_program_time(1.0, 0.5, 0.0), 0.25); // no acceleration: half of the stop time
/// assert_eq!(stopping_program_time(1.0, 0.5, 4.0), 0.5); // the program may decelerate as fast as the robot brakes
/// ```
#[inline]
pub fn stopping_program_time(sigma: f64, full_stop_s: f64, growth: f64) -> f64 {
    let (square, product) = (sigma * sigma, growth * sigma * sigma);
    if product >= 1.0 {
        return square * full_stop_s;
    }
    // (1 − √(1 − y)) / y without cancellation.
    square * full_stop_s / (1.0 + (1.0 - product).sqrt())
}

/// The override changed from `previous` towards `requested` by at most `rate` per second; `rate` 0 is unlimited.
///
/// ```
/// use elbowroom_monitor::laws::rate_limited;
/// assert!((rate_limited(1.0, 0.0, 2.0, 0.01) - 0.98).abs() < 1e-15);
/// assert_eq!(rate_limited(1.0, 0.0, 0.0, 0.01), 0.0);
/// ```
#[inline]
pub fn rate_limited(previous: f64, requested: f64, rate: f64, dt_s: f64) -> f64 {
    if rate <= 0.0 {
        return requested;
    }
    let step = rate * dt_s;
    requested.clamp(previous - step, previous + step)
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
    fn nan_counts_as_contact() {
        assert_eq!(warning_factor(f64::NAN, 0.2), 0.0);
    }

    #[test]
    fn the_program_time_of_a_stop_is_continuous_and_grows_with_override_and_acceleration() {
        for growth in [0.0, 1e-12, 0.3, 1.0, 2.0, 50.0] {
            let time = |sigma: f64| stopping_program_time(sigma, 0.4, growth);
            for i in 0..1000 {
                let sigma = f64::from(i) / 1000.0;
                let (a, b) = (time(sigma), time(sigma + 0.001));
                assert!(a <= b && b - a < 0.03, "{growth} {sigma}: {a} {b}");
                assert!(a >= sigma * sigma * 0.2 - 1e-15 && a <= sigma * sigma * 0.4 + 1e-15);
            }
        }
    }
}
