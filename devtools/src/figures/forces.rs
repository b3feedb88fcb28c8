//! Figures of the forces that a guided tool feels: their curves are the functions of `shared_control::force`.

use elbowroom_cell::shared_control::force::{Aureole, BodySettings, FieldSample, ForceLaw, ForceProfile, VirtualBody};
use elbowroom_spatial::Vec3;

use super::curves::{curve, distance, over};
use super::svg::{Axis, Dash, Plot};

const MM: f64 = 1000.0;
/// Range and stiffness of the laws in the figures.
const SPRING: ForceLaw =
    ForceLaw { field: ForceProfile::Linear, range_m: 0.04, stiffness_n_m: 1000.0, damping_n_s_m: 0.0, aureole: None };

/// Force against distance.
pub fn laws() -> Plot {
    let force = |law: ForceLaw, speed: f64| move |d: f64| law.force_n(d / MM, law.range_at(speed));
    let khatib = ForceLaw { field: ForceProfile::Khatib, ..SPRING };
    let growing = ForceLaw { aureole: Some(Aureole { reaction_s: 0.05, deceleration_m_s2: 2.0 }), ..SPRING };
    let curves = vec![
        curve("repulsive", 0, Dash::Solid, over(0.0, 80.0, force(SPRING, 0.0))),
        curve("at 0.25 m/s, growing", 0, Dash::Dashed, over(0.0, 80.0, force(growing, 0.25))),
        curve("khatib", 1, Dash::Solid, over(4.0, 80.0, force(khatib, 0.0))),
    ];
    let y = Axis { title: "force F (N)", from: 0.0, to: 100.0, step: 20.0 };
    Plot { title: "Force against distance: k = 1000 N/m, r = 40 mm", x: distance(0.0, 80.0, 10.0), y, curves }
}

/// A hand that draws the tool to a wall: distance over time.
pub fn mass() -> Plot {
    let law = |damping_n_s_m: f64| ForceLaw { range_m: 0.02, stiffness_n_m: 2000.0, damping_n_s_m, ..SPRING };
    let body = BodySettings { damping_n_s_m: 10.0, ..BodySettings::default() };
    let curves = vec![
        curve("repulsive", 1, Dash::Solid, pressed(body, law(0.0))),
        curve("spring_damper", 2, Dash::Solid, pressed(body, law(50.0))),
        curve("repulsive, damped mass", 0, Dash::Solid, pressed(BodySettings::default(), law(0.0))),
    ];
    let x = Axis { title: "time t (ms)", from: 0.0, to: 1000.0, step: 200.0 };
    let y = Axis { title: "distance d (mm)", from: 0.0, to: 60.0, step: 10.0 };
    Plot { title: "A hand at a wall that repels the tool from 20 mm on", x, y, curves }
}

/// Distances (mm) over time (ms) of a mass that starts 50 mm before the wall.
fn pressed(body: BodySettings, law: ForceLaw) -> Vec<(f64, f64)> {
    let Ok(mut body) = VirtualBody::new(body) else { return Vec::new() };
    let mut at = Vec3::Z * 0.05;
    let mut points = vec![(0.0, at.z * MM)];
    for k in 1..=1000 {
        let mut field = FieldSample::default();
        field.add(&law, law.range_m, at.z, Vec3::Z, body.velocity());
        let velocity = body.begin(at, Some(Vec3::ZERO), &field, 1e-3);
        let to = at + velocity * 1e-3;
        if body.end(to, velocity, law.potential_j(to.z, law.range_m)) {
            at = to;
        } else {
            body.stand();
        }
        if k % 5 == 0 {
            points.push((f64::from(k), at.z * MM));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_tool_comes_to_rest_where_hand_and_wall_are_equally_strong() {
        // 800 d = 2000 (0.02 − d)
        let last = |plot: &Plot, curve: usize| plot.curves[curve].points.last().unwrap().1;
        let plot = mass();
        assert!((last(&plot, 2) - 14.286).abs() < 0.01, "{}", last(&plot, 2));
        assert!((last(&plot, 1) - 14.286).abs() < 1.0, "{}", last(&plot, 1));
    }
}
