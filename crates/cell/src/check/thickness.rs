//! How thick a warning zone has to be for a robot that brakes with a bounded deceleration and obeys late.
//!
//! `docs/laws.md`, section 2, derives it. A robot that goes v·τ before it begins to obey stays out as long as its speed is
//! never more than its distance over τ. It goes faster than the law asks only while it brakes, so that each course from the
//! last moment at which it did not, to rest, is looked at: from the full override, and from every part of it.

use std::f64::consts::E;

/// Parts of the full override from which a course is looked at.
const PARTS: u32 = 128;
/// Relative; the parts and the samples of a program are finite.
const MARGIN: f64 = 0.002;
/// Relative; of comparisons.
const ROUNDING: f64 = 1e-9;

/// How late a robot obeys.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lateness {
    /// From coming into the zone to the first deceleration, at most: the reaction time and one tick, s.
    pub late_s: f64,
    /// Period of the control tick, s.
    pub tick_s: f64,
}

impl Lateness {
    /// Time (s) over which a distance has to last at the present speed. A controller brakes on a straight line from one answer
    /// to the next, not on the law's curve: that is worth a little more than the lateness itself.
    pub fn lasting_s(self) -> f64 {
        let ticks = self.tick_s / self.late_s.max(self.tick_s);
        self.late_s * (ticks * ticks / 8.0).exp()
    }
}

/// How one point brakes from the full override, by its program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Braking {
    /// From the part x of the full override it goes no farther than x² times this, m.
    pub way_m: f64,
    /// While it brakes it is no faster than this times the root of what is left of the braking, m/s.
    pub speed_m_s: f64,
    /// Largest sum of the way so far and of what has to be left at the speed that it has there, m.
    pub peak_m: f64,
}

/// The thickness (m) that is enough for one course, not below `least_m`; `fastest_m_s` is the largest speed of the point anywhere.
pub(super) fn thickness(least_m: f64, braking: &Braking, fastest_m_s: f64, lateness: Lateness) -> f64 {
    let fits = |zone: f64| enough(zone, braking, fastest_m_s, lateness);
    if least_m > 0.0 && fits(least_m / (1.0 + MARGIN)) {
        return least_m;
    }
    let late_m = fastest_m_s * lateness.lasting_s();
    // From there on every part fits, whatever the course.
    let (mut low, mut high) = (0.0, E * (late_m + braking.way_m.max(braking.peak_m)));
    for _ in 0..40 {
        let middle = f64::midpoint(low, high);
        if fits(middle) { high = middle } else { low = middle }
    }
    least_m.max(high * (1.0 + MARGIN))
}

fn enough(zone: f64, braking: &Braking, fastest_m_s: f64, lateness: Lateness) -> bool {
    let lasting_s = lateness.lasting_s();
    let part = |i: u32| f64::from(i) / f64::from(PARTS);
    let fits = |x: f64| {
        left(x * zone, fastest_m_s * lateness.late_s) * (1.0 + ROUNDING) >= needed(braking, fastest_m_s, lasting_s, x)
    };
    zone * (1.0 + ROUNDING) >= E * fastest_m_s * lasting_s && (1..=PARTS).map(part).all(fits)
}

/// What is left (m) of a distance after the lateness, in which the robot goes no farther than `late_m` and, over each moment,
/// no faster than its distance over the lateness.
fn left(distance: f64, late_m: f64) -> f64 {
    let times = distance / late_m.max(f64::MIN_POSITIVE);
    if times >= 2.0 {
        distance - late_m
    } else if times >= 1.0 {
        late_m * (times - 2.0).exp()
    } else {
        distance / E
    }
}

/// What a course from the part x of the full override needs, m: the largest of `W·(x² − s²) + τ·min(v·x, V·s)` for s from 0 to x.
fn needed(braking: &Braking, fastest_m_s: f64, lasting_s: f64, x: f64) -> f64 {
    let (way, steep, flat) = (braking.way_m, braking.speed_m_s * lasting_s, fastest_m_s * lasting_s);
    if way <= 0.0 {
        return (steep.min(flat) * x).min(braking.peak_m);
    }
    let top = steep / (2.0 * way);
    let course = if steep <= flat {
        if x >= top { way * x * x + steep * top / 2.0 } else { steep * x }
    } else if x <= steep * top / flat {
        flat * x + way * x * x * (1.0 - (flat / steep).powi(2))
    } else {
        way * x * x + steep * top / 2.0
    };
    course.min(braking.peak_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At constant speed, braking in `way_m`.
    fn steady(way_m: f64, fastest_m_s: f64, lateness: Lateness) -> f64 {
        let late_m = fastest_m_s * lateness.lasting_s();
        let peak_m = if late_m <= 2.0 * way_m { way_m + late_m * late_m / (4.0 * way_m) } else { late_m };
        thickness(0.0, &Braking { way_m, speed_m_s: fastest_m_s, peak_m }, fastest_m_s, lateness)
    }

    #[test]
    fn at_constant_speed_it_is_the_formula_of_the_docs() {
        for reaction_s in [0.0, 0.01, 0.03, 0.06, 0.2] {
            let lateness = Lateness { late_s: reaction_s + 0.002, tick_s: 0.002 };
            let (late, lasting) = (2.0 * lateness.late_s, 2.0 * lateness.lasting_s());
            let formula = (0.25 + late + lasting * lasting / 1.0).max(E * lasting);
            let named = steady(0.25, 2.0, lateness);
            assert!(named >= formula && named < 1.022 * formula, "{reaction_s} s: {named} m, formula {formula} m");
        }
    }

    #[test]
    fn a_robot_that_stands_needs_nothing() {
        let lateness = Lateness { late_s: 0.002, tick_s: 0.002 };
        assert_eq!(steady(0.0, 0.0, lateness), 0.0);
    }
}
