//! Contents of the figures.

use elbowroom_monitor::laws::{rate_limited, speed_zone, warning_factor};
use elbowroom_monitor::{Laws, StoppingSettings};

use super::curves::{curve, distance, over};
use super::forces;
use super::rail::{Rail, TICK_S};
use super::svg::{Axis, Curve, Dash, Plot};

/// Millimetres per metre.
const MM: f64 = 1000.0;
/// Warning zone of most figures, m.
const ZONE_M: f64 = 0.25;

/// Every figure with its file's name.
pub fn all() -> Result<Vec<(&'static str, Plot)>, String> {
    Ok(vec![
        ("warning", warning()),
        ("feedback", feedback()),
        ("approach", approach()),
        ("overrun", overrun()),
        ("zone-needed", zone_needed()),
        ("minimum", minimum()),
        ("speed-zone", speed_zones()),
        ("release", release()?),
        ("recovery", recovery()?),
        ("hysteresis", hysteresis()?),
        ("stopping", stopping()),
        ("rate", rate()),
        ("forces", forces::laws()),
        ("virtual-mass", forces::mass()),
    ])
}

fn warning() -> Plot {
    let law = |zone: f64, v0: f64| move |d: f64| 100.0 * v0 * warning_factor(d / MM, zone);
    let curves = vec![
        curve("δ = 100 mm", 0, Dash::Solid, over(0.0, 600.0, law(0.1, 1.0))),
        curve("δ = 250 mm", 1, Dash::Solid, over(0.0, 600.0, law(0.25, 1.0))),
        curve("δ = 500 mm", 2, Dash::Solid, over(0.0, 600.0, law(0.5, 1.0))),
        curve("δ = 250 mm, v₀ = 50 %", 1, Dash::Dashed, over(0.0, 600.0, law(0.25, 0.5))),
    ];
    Plot { title: "The warning law", x: distance(0.0, 600.0, 100.0), y: override_axis(), curves }
}

/// A robot that keeps its distance: the law gets the programmed override, or its own last answer.
fn feedback() -> Plot {
    let mut curves = Vec::new();
    for (colour, share) in [(0, 0.9), (1, 0.5)] {
        let factor = warning_factor(share * ZONE_M, ZONE_M);
        let fed_back = std::iter::successors(Some(100.0 * factor), |v| Some(v * factor));
        let points = (0..50).map(|tick| f64::from(tick) * TICK_S * MM).zip(fed_back).collect();
        curves.push(curve(
            &format!("d = {share} δ, v₀ programmed"),
            colour,
            Dash::Solid,
            over(0.0, 100.0, |_| 100.0 * factor),
        ));
        curves.push(curve(&format!("d = {share} δ, v₀ fed back"), colour, Dash::Dashed, points));
    }
    let x = Axis { title: "time t (ms), ticks of 2 ms", from: 0.0, to: 100.0, step: 20.0 };
    Plot { title: "Why v₀ is the programmed override", x, y: override_axis(), curves }
}

/// A robot that obeys the override at once.
fn approach() -> Plot {
    let run = |speed: f64| {
        let mut d = 0.3;
        let step = |tick: u32| {
            let before = d;
            d -= speed * warning_factor(d, ZONE_M) * TICK_S;
            (f64::from(tick) * TICK_S, before * MM)
        };
        (0..=1000).map(step).step_by(5).collect::<Vec<_>>()
    };
    let curves = [0.25, 0.5, 1.0]
        .iter()
        .enumerate()
        .map(|(i, v)| curve(&format!("v = {v} m/s, δ/v = {} s", ZONE_M / v), i, Dash::Solid, run(*v)))
        .collect();
    let x = Axis { title: "time t (s)", from: 0.0, to: 2.0, step: 0.5 };
    let y = Axis { title: "distance d (mm)", from: 0.0, to: 300.0, step: 50.0 };
    Plot { title: "Approach under the warning law, δ = 250 mm", x, y, curves }
}

/// A robot that follows the warning law as well as its deceleration permits.
fn overrun() -> Plot {
    let speed = 1.0;
    let run = |deceleration: f64| {
        let dt = 1e-5;
        let (mut d, mut v) = (ZONE_M + 0.05, speed);
        let mut points = Vec::new();
        for step in 0..200_000 {
            if step % 500 == 0 || v == 0.0 {
                points.push((d * MM, v));
            }
            if v == 0.0 {
                break;
            }
            let wanted = speed * warning_factor(d, ZONE_M);
            v = wanted.max(v - deceleration * dt).max(0.0);
            d -= v * dt;
        }
        points
    };
    let cases = [
        (4.0, "v²/δ", Dash::Solid),
        (3.0, "¾ v²/δ", Dash::Solid),
        (2.0, "v²/2δ", Dash::Solid),
        (1.25, "too small", Dash::Dashed),
    ];
    let curves = cases
        .iter()
        .enumerate()
        .map(|(i, (a, what, dash))| curve(&format!("a = {a} m/s² ({what})"), i, *dash, run(*a)))
        .collect();
    let x = Axis { title: "distance d (mm), negative inside", from: -200.0, to: 300.0, step: 100.0 };
    let y = Axis { title: "speed (m/s)", from: 0.0, to: 1.2, step: 0.2 };
    Plot { title: "Bounded deceleration: v = 1 m/s, δ = 250 mm", x, y, curves }
}

fn zone_needed() -> Plot {
    let mut curves = Vec::new();
    for (colour, a) in [1.0, 2.0, 5.0, 10.0].into_iter().enumerate() {
        let points = over(0.0, 2.0, |v| v * v / (2.0 * a) * MM);
        curves.push(curve(&format!("a = {a} m/s², never inside"), colour, Dash::Solid, points));
    }
    let points = over(0.0, 2.0, |v| v * v / 5.0 * MM);
    curves.push(curve("a = 5 m/s², law obeyed", 2, Dash::Dashed, points));
    let x = Axis { title: "speed v at the programmed override (m/s)", from: 0.0, to: 2.0, step: 0.5 };
    let y = Axis { title: "least δ (mm)", from: 0.0, to: 1000.0, step: 200.0 };
    Plot { title: "How thick a warning zone must be", x, y, curves }
}

/// A straight line past two spheres whose warning zones overlap.
fn minimum() -> Plot {
    let ball = |(cx, cy): (f64, f64), radius: f64| {
        move |x: f64| 100.0 * warning_factor(((x / MM - cx).powi(2) + cy * cy).sqrt() - radius, ZONE_M)
    };
    let (first, second) = (ball((0.4, 0.3), 0.2), ball((0.75, 0.32), 0.12));
    let curves = vec![
        curve("first ball", 0, Dash::Dashed, over(0.0, 1200.0, first)),
        curve("second ball", 1, Dash::Dashed, over(0.0, 1200.0, second)),
        curve("minimum", 2, Dash::Solid, over(0.0, 1200.0, |x| first(x).min(second(x)))),
    ];
    let x = Axis { title: "distance along the line (mm)", from: 0.0, to: 1200.0, step: 200.0 };
    Plot { title: "Two regions: the smaller override counts", x, y: override_axis(), curves }
}

fn speed_zones() -> Plot {
    let zone = |slow_to: f64, v0: f64| move |d: f64| 100.0 * speed_zone(d / MM, ZONE_M, slow_to, v0);
    let curves = vec![
        curve("slow_to 30 %, v₀ = 100 %", 0, Dash::Solid, over(0.0, 400.0, zone(0.3, 1.0))),
        curve("slow_to 30 %, v₀ = 60 %", 1, Dash::Solid, over(0.0, 400.0, zone(0.3, 0.6))),
        curve("slow_to 30 %, v₀ = 20 %", 2, Dash::Solid, over(0.0, 400.0, zone(0.3, 0.2))),
        curve("forbidden, v₀ = 100 %", 3, Dash::Dotted, over(0.0, 400.0, |d| 100.0 * warning_factor(d / MM, ZONE_M))),
    ];
    Plot { title: "Speed zone, δ = 250 mm", x: distance(0.0, 400.0, 100.0), y: override_axis(), curves }
}

/// A program that moves towards the sphere, then back.
fn release() -> Result<Plot, String> {
    let run = |laws: Laws| {
        let mut rail = Rail::new(laws, ZONE_M, 0.001, 0.4)?;
        let mut points = Vec::new();
        while rail.time_s() <= 4.0 {
            let t = rail.time_s();
            points.push((t, 100.0 * rail.step(if t < 2.0 { 0.5 } else { -0.5 }).speed_override));
        }
        Ok::<_, String>(points.into_iter().step_by(4).collect::<Vec<_>>())
    };
    let curves = vec![
        curve("direction_aware = false", 0, Dash::Solid, run(Laws::default())?),
        curve("direction_aware = true", 1, Dash::Dashed, run(direction_aware())?),
    ];
    let x = Axis { title: "time t (s); the program turns round at 2 s", from: 0.0, to: 4.0, step: 1.0 };
    Ok(Plot { title: "Leaving a warning zone, v = 0.5 m/s, δ = 250 mm", x, y: override_axis(), curves })
}

/// A robot that starts 50 mm inside and moves out.
fn recovery() -> Result<Plot, String> {
    let run = |laws: Laws| {
        let mut rail = Rail::new(laws, ZONE_M, 0.001, -0.05)?;
        let mut points = Vec::new();
        while rail.time_s() <= 2.0 {
            points.push((rail.time_s(), 100.0 * rail.step(-0.5).speed_override));
        }
        Ok::<_, String>(points.into_iter().step_by(4).collect::<Vec<_>>())
    };
    let curves = vec![
        curve("direction_aware = false", 0, Dash::Solid, run(Laws::default())?),
        curve("recovery 10 % (default)", 1, Dash::Dashed, run(direction_aware())?),
        curve("recovery 25 %", 2, Dash::Dashed, run(Laws { recovery: 0.25, ..direction_aware() })?),
    ];
    let x = Axis { title: "time t (s)", from: 0.0, to: 2.0, step: 0.5 };
    Ok(Plot { title: "Leaving from 50 mm inside, v = 0.5 m/s", x, y: override_axis(), curves })
}

/// The output of a region's warning zone while the robot comes and goes.
fn hysteresis() -> Result<Plot, String> {
    // Slow enough that a tick moves the robot by 0.1 mm.
    let speed = 0.05;
    let mut rail = Rail::new(direction_aware(), ZONE_M, 0.005, 0.26)?;
    let mut sweep = |intent: f64, until: &dyn Fn(f64) -> bool| {
        let mut points = Vec::new();
        while !until(rail.distance_m) {
            let d = rail.distance_m * MM;
            points.push((d, f64::from(u8::from(rail.step(intent).outputs != 0))));
        }
        points
    };
    let approaching = sweep(speed, &|d| d < 0.242);
    let leaving = sweep(-speed, &|d| d > 0.26);
    let curves = vec![curve("approaching", 0, Dash::Solid, approaching), curve("leaving", 1, Dash::Dashed, leaving)];
    let y = Axis { title: "warning output (0 or 1)", from: 0.0, to: 1.0, step: 1.0 };
    Ok(Plot { title: "Hysteresis of outputs: δ = 250 mm, h = 5 mm", x: distance(240.0, 262.0, 5.0), y, curves })
}

fn stopping() -> Plot {
    let (deceleration, reaction_s) = (2.0, 0.05);
    let law = StoppingSettings {
        reaction_s,
        period_s: TICK_S,
        joint_deceleration: vec![deceleration],
        joint_acceleration: vec![deceleration],
    };
    let laws = Laws { stopping_distance: Some(law), ..Laws::default() };
    let allowed = |speed: f64| {
        let laws = laws.clone();
        move |d: f64| {
            Rail::new(laws.clone(), 0.0, 0.001, d / MM).map_or(0.0, |mut rail| 100.0 * rail.override_at_rest(speed))
        }
    };
    let mut curves: Vec<Curve> = [0.25, 0.5, 1.0, 2.0]
        .iter()
        .enumerate()
        .map(|(i, v)| curve(&format!("v = {v} m/s"), i, Dash::Solid, over(0.0, 600.0, allowed(*v))))
        .collect();
    curves.push(curve(
        "warning law, δ = 250 mm",
        4,
        Dash::Dotted,
        over(0.0, 600.0, |d| 100.0 * warning_factor(d / MM, ZONE_M)),
    ));
    let title = "Stopping distance: a = 2 m/s², reaction 50 ms";
    Plot { title, x: distance(0.0, 600.0, 100.0), y: override_axis(), curves }
}

fn rate() -> Plot {
    let wanted = |t: f64| if (0.2..0.8).contains(&t) { 0.2 } else { 1.0 };
    let run = |limit: f64| {
        let mut last = 1.0;
        let step = |tick: u32| {
            let t = f64::from(tick) * TICK_S;
            last = rate_limited(last, wanted(t), limit, TICK_S);
            (t, 100.0 * last)
        };
        (0..=700).map(step).step_by(2).collect::<Vec<_>>()
    };
    let curves = vec![
        curve("override_rate = 0 (no limit)", 0, Dash::Solid, run(0.0)),
        curve("override_rate = 5 /s", 1, Dash::Dashed, run(5.0)),
        curve("override_rate = 2 /s", 2, Dash::Dashed, run(2.0)),
    ];
    let x = Axis { title: "time t (s)", from: 0.0, to: 1.4, step: 0.2 };
    Plot { title: "Rate limit of the override", x, y: override_axis(), curves }
}

fn direction_aware() -> Laws {
    Laws { direction_aware: true, ..Laws::default() }
}

fn override_axis() -> Axis {
    Axis { title: "speed override (%)", from: 0.0, to: 100.0, step: 20.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the position at which the robot stops at the end of a curve of [`overrun`], mm.
    fn rest_mm(curve: usize) -> f64 {
        overrun().curves[curve].points.last().unwrap().0
    }

    #[test]
    fn the_overrun_is_what_the_document_says() {
        // v = 1 m/s, δ = 250 mm: v²/(2a) − δ for a = 1.25 m/s², just no overrun for a = v²/(2δ).
        assert!((rest_mm(3) + 150.0).abs() < 0.1, "{}", rest_mm(3));
        assert!(rest_mm(2).abs() < 0.1, "{}", rest_mm(2));
    }

    #[test]
    fn a_sufficient_deceleration_follows_the_law_and_stays_outside() {
        for (d, v) in &overrun().curves[0].points {
            assert!(*d > 0.0 && (v - warning_factor(d / MM, ZONE_M)).abs() < 1e-3, "{d} mm: {v} m/s");
        }
        // a = ¾ v²/δ: back on the law from d = δ·(2aδ/v² − 1) = 125 mm on, and faster before.
        let back = |d: f64, v: f64| (v - warning_factor(d / MM, ZONE_M)).abs() < 1e-3;
        let points = &overrun().curves[1].points;
        assert!(points.iter().filter(|(d, _)| *d < 120.0).all(|(d, v)| back(*d, *v)));
        assert!(points.iter().filter(|(d, _)| (150.0..230.0).contains(d)).all(|(d, v)| !back(*d, *v)));
    }

    #[test]
    fn a_released_robot_is_faster_and_a_held_one_leaves_as_it_came() {
        let plot = release().unwrap();
        let at = |curve: usize, t: f64| plot.curves[curve].points.iter().find(|(time, _)| *time >= t).unwrap().1;
        assert!((at(0, 1.0) - at(0, 3.0)).abs() < 1.0, "symmetrical: {} and {}", at(0, 1.0), at(0, 3.0));
        assert_eq!(at(1, 2.1), 100.0);
        assert!(at(0, 2.1) < 10.0);
    }
}
