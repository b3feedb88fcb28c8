//! Thickness of a warning zone for a robot with bounded deceleration and a delay.
//!
//! `docs/laws.md`, section 2, derives it. A robot that moves v·τ before it starts to brake stays outside while its
//! speed is at most its distance divided by τ. It exceeds the speed of the law only while it brakes. So the braking
//! from the last moment below that speed to rest is tested, from the full override and from fractions of it.

use std::f64::consts::E;

/// Fractions of the full override from which braking is tested.
const FRACTIONS: u32 = 128;
/// Relative reserve for the finite number of fractions and samples.
const MARGIN: f64 = 0.002;
/// Relative tolerance of comparisons.
const ROUNDING: f64 = 1e-9;

/// Response delay of a robot.
#[derive(Debug, Clone, Copy)]
pub(super) struct ResponseDelay {
    /// Upper bound of the time from entering the zone to the first deceleration: the reaction time and one tick, s.
    pub delay_s: f64,
    /// Period of the control tick, s.
    pub tick_s: f64,
}

impl ResponseDelay {
    /// Headway time (s): the distance divided by the speed must not fall below it.
    ///
    /// A controller changes the override linearly between ticks, not on the law's curve. That adds a little to the
    /// delay itself.
    pub fn headway_s(self) -> f64 {
        let ticks = self.tick_s / self.delay_s.max(self.tick_s);
        self.delay_s * (ticks * ticks / 8.0).exp()
    }
}

/// Braking of one point from the full override, along its program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Braking {
    /// Braking distance, m: from the fraction x of the full override the point moves at most x² times this.
    pub distance_m: f64,
    /// While braking, its speed is at most this times the square root of the remaining braking, m/s.
    pub speed_m_s: f64,
    /// Largest sum of the distance so far and the headway distance at the speed there, m.
    pub peak_m: f64,
}

/// Sufficient thickness (m) for one braking motion, at least `least_m`; `fastest_m_s` is the largest speed of the point
/// anywhere.
pub(super) fn thickness(least_m: f64, braking: &Braking, fastest_m_s: f64, response_delay: ResponseDelay) -> f64 {
    let fits = |zone: f64| is_sufficient(zone, braking, fastest_m_s, response_delay);
    if least_m > 0.0 && fits(least_m / (1.0 + MARGIN)) {
        return least_m;
    }
    let delay_m = fastest_m_s * response_delay.headway_s();
    // From this thickness on every fraction fits, for any braking motion.
    let (mut low, mut high) = (0.0, E * (delay_m + braking.distance_m.max(braking.peak_m)));
    for _ in 0..40 {
        let middle = f64::midpoint(low, high);
        if fits(middle) { high = middle } else { low = middle }
    }
    least_m.max(high * (1.0 + MARGIN))
}

fn is_sufficient(zone: f64, braking: &Braking, fastest_m_s: f64, response_delay: ResponseDelay) -> bool {
    let headway_s = response_delay.headway_s();
    let fraction = |i: u32| f64::from(i) / f64::from(FRACTIONS);
    let remaining = |i: u32| remaining_distance(fraction(i) * zone, fastest_m_s * response_delay.delay_s);
    let needed = |i: u32| needed(braking, fastest_m_s, headway_s, fraction(i));
    // Both values grow with the fraction, so a range fits if what remains at its first fraction covers what its last
    // one needs.
    let mut open = vec![(1, FRACTIONS)];
    let mut all_fit = zone * (1.0 + ROUNDING) >= E * fastest_m_s * headway_s;
    while all_fit && let Some((first, last)) = open.pop() {
        if first == last {
            all_fit = remaining(first) * (1.0 + ROUNDING) >= needed(first);
        } else if !(remaining(first) >= needed(last)) {
            let middle = first.midpoint(last);
            open.extend([(first, middle), (middle + 1, last)]);
        }
    }
    all_fit
}

/// The remaining distance (m) after the delay, in which the robot moves at most `delay_m` and its speed is at most its
/// distance over the delay.
fn remaining_distance(distance: f64, delay_m: f64) -> f64 {
    let times = distance / delay_m.max(f64::MIN_POSITIVE);
    if times >= 2.0 {
        distance - delay_m
    } else if times >= 1.0 {
        delay_m * (times - 2.0).exp()
    } else {
        distance / E
    }
}

/// Needed distance of a braking motion from the fraction x of the full override, m: the maximum of
/// `W·(x² − s²) + τ·min(v·x, V·s)` for s in [0, x].
fn needed(braking: &Braking, fastest_m_s: f64, headway_s: f64, x: f64) -> f64 {
    let (distance, steep, flat) = (braking.distance_m, braking.speed_m_s * headway_s, fastest_m_s * headway_s);
    if distance <= 0.0 {
        return (steep.min(flat) * x).min(braking.peak_m);
    }
    let top = steep / (2.0 * distance);
    let distance_m = if steep <= flat {
        if x >= top { distance * x * x + steep * top / 2.0 } else { steep * x }
    } else if x <= steep * top / flat {
        flat * x + distance * x * x * (1.0 - (flat / steep).powi(2))
    } else {
        distance * x * x + steep * top / 2.0
    };
    distance_m.min(braking.peak_m)
}

#[cfg(test)]
mod tests {
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    /// Thickness at constant speed, with a stopping distance of `distance_m`.
    fn steady(distance_m: f64, fastest_m_s: f64, response_delay: ResponseDelay) -> f64 {
        let delay_m = fastest_m_s * response_delay.headway_s();
        let peak_m =
            if delay_m <= 2.0 * distance_m { distance_m + delay_m * delay_m / (4.0 * distance_m) } else { delay_m };
        thickness(0.0, &Braking { distance_m, speed_m_s: fastest_m_s, peak_m }, fastest_m_s, response_delay)
    }

    #[test]
    fn at_constant_speed_the_thickness_is_the_documented_formula() {
        for reaction_s in [0.0, 0.01, 0.03, 0.06, 0.2] {
            let response_delay = ResponseDelay { delay_s: reaction_s + 0.002, tick_s: 0.002 };
            let (delay, headway) = (2.0 * response_delay.delay_s, 2.0 * response_delay.headway_s());
            let formula = (0.25 + delay + headway * headway / 1.0).max(E * headway);
            let computed = steady(0.25, 2.0, response_delay);
            assert!(
                computed >= formula && computed < 1.022 * formula,
                "{reaction_s} s: {computed} m, formula {formula} m"
            );
        }
    }

    #[test]
    fn a_stationary_robot_needs_no_thickness() {
        let response_delay = ResponseDelay { delay_s: 0.002, tick_s: 0.002 };
        assert_eq!(steady(0.0, 0.0, response_delay), 0.0);
    }

    #[test]
    fn a_zone_is_sufficient_if_every_fraction_fits() {
        let mut random = SplitMix(5);
        let mut counts = [0; 2];
        for _ in 0..4000 {
            let delay_s = random.between(0.001, 0.3);
            let response_delay = ResponseDelay { delay_s, tick_s: random.between(0.0005, 0.02) };
            let (distance_m, fastest_m_s) = (random.between(-0.05, 1.0).max(0.0), random.between(0.0, 3.0));
            let braking = Braking {
                distance_m,
                speed_m_s: fastest_m_s * random.between(0.2, 3.0),
                peak_m: distance_m * random.between(1.0, 3.0) + random.between(0.0, 0.5),
            };
            let least_m = E * fastest_m_s * response_delay.headway_s();
            let zone = least_m * random.between(0.98, 1.2) + random.between(0.0, 2.0 * distance_m);
            let fits = |i: u32| {
                let x = f64::from(i) / f64::from(FRACTIONS);
                let remaining = remaining_distance(x * zone, fastest_m_s * delay_s);
                remaining * (1.0 + ROUNDING) >= needed(&braking, fastest_m_s, response_delay.headway_s(), x)
            };
            let naive = zone * (1.0 + ROUNDING) >= least_m && (1..=FRACTIONS).all(fits);
            assert_eq!(is_sufficient(zone, &braking, fastest_m_s, response_delay), naive, "{zone} {braking:?}");
            counts[usize::from(naive)] += 1;
        }
        assert!(counts.iter().all(|&count| count > 500), "{counts:?}");
    }
}
