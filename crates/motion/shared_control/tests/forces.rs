//! A virtual mass in fields: it moves as physics says, never makes energy, and does not chatter.

use elbowroom_shared_control::NavigatorError;
use elbowroom_shared_control::force::{
    BodySettings, FieldSample, ForceLaw, ForceProfile, ImpedancePort, ImpedanceSettings, VirtualBody,
};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::SplitMix;

use crate::common::point;

const FREE: BodySettings =
    BodySettings { mass_kg: 2.0, damping_n_s_m: 0.0, coupling_n_m: 800.0, jerk_m_s3: 1e9, largest_force_n: 1e9 };

/// Balls that repel: centre, radius and law.
struct World {
    balls: Vec<(Vec3, f64, ForceLaw)>,
}

impl World {
    fn random(random: &mut SplitMix) -> Self {
        let ball = |random: &mut SplitMix| {
            let field = if random.unit() < 0.5 { ForceProfile::Linear } else { ForceProfile::Khatib };
            let law = ForceLaw {
                field,
                damping_n_s_m: 200.0 * random.unit(),
                ..ForceLaw::spring(0.01 + 0.05 * random.unit(), 10f64.powf(1.0 + 4.0 * random.unit()))
            };
            (point(random, 0.1), 0.05 * random.unit(), law)
        };
        Self { balls: (0..3).map(|_| ball(random)).collect() }
    }

    fn sample(&self, at: Vec3, velocity: Vec3) -> FieldSample {
        let mut sum = FieldSample::default();
        for (centre, radius, law) in &self.balls {
            let out = at - *centre;
            let away = out.try_normalize().unwrap_or(Vec3::ZERO);
            sum.add(law, law.range_m, (out.length() - radius).max(0.0), away, velocity);
        }
        sum
    }

    /// By the formulas of the literature, the constant part near contact by its area.
    fn potential_j(&self, at: Vec3) -> f64 {
        let of = |(centre, radius, law): &(Vec3, f64, ForceLaw)| {
            let (d, r, k) = ((at.distance(*centre) - radius).max(0.0), law.range_m, law.stiffness_n_m);
            if d >= r {
                return 0.0;
            }
            match law.field {
                ForceProfile::Linear => 0.5 * k * (r - d) * (r - d),
                ForceProfile::Khatib => {
                    let (eta, c) = (k * r.powi(4) / 8.0, d.max(r / 8.0));
                    let largest = eta * (8.0 / r - 1.0 / r) * 64.0 / (r * r);
                    0.5 * eta * (1.0 / c - 1.0 / r).powi(2) + largest * (r / 8.0 - d).max(0.0)
                }
            }
        };
        self.balls.iter().map(of).sum()
    }
}

/// What is stored and what was put in, counted beside the body.
#[derive(Default)]
struct Observer {
    put_in_j: f64,
    turned_over_j: f64,
}

impl Observer {
    fn work(&mut self, energy_j: f64) {
        self.put_in_j += energy_j;
        self.turned_over_j += energy_j.abs();
    }
}

#[test]
fn no_interaction_makes_energy() {
    let mut random = SplitMix(7);
    let mut dissipated = 0.0;
    for case in 0..100_000 {
        let settings = BodySettings {
            mass_kg: 10f64.powf(2.0 * random.unit() - 1.0),
            damping_n_s_m: if random.unit() < 0.3 { 0.0 } else { 100.0 * random.unit() },
            coupling_n_m: 10f64.powf(1.0 + 3.0 * random.unit()),
            jerk_m_s3: 10f64.powf(1.0 + 4.0 * random.unit()),
            largest_force_n: 1e9,
        };
        let mut body = VirtualBody::new(settings).unwrap();
        let mut world = World::random(&mut random);
        let mut at = point(&mut random, 0.15);
        let spring = |hand: Option<Vec3>, at: Vec3| {
            hand.map_or(0.0, |h| 0.5 * settings.coupling_n_m * (h - at).length_squared())
        };
        let mut observer = Observer::default();
        let (mut hand, mut potential_j, mut lost_before) = (None, 0.0, 0.0);
        for _ in 0..12 {
            let dt_s = 10f64.powf(-4.0 + 2.0 * random.unit());
            let now = (random.unit() < 0.9).then(|| point(&mut random, 0.15));
            if random.unit() < 0.3 {
                let moved = point(&mut random, 0.02);
                world.balls[0].0 += moved;
            }
            let sample = world.sample(at, body.velocity());
            assert!((sample.potential_j - world.potential_j(at)).abs() <= 1e-12 * (1.0 + sample.potential_j));
            observer.work(world.potential_j(at) - potential_j);
            // A spring that is released gives its energy to nobody.
            observer.work(if now.is_some() { spring(now, at) - spring(hand, at) } else { 0.0 });
            hand = now;
            let velocity = body.begin(at, hand, &sample, dt_s);
            // Surfaces and the arm stop the tool at any share of its way.
            let share = if random.unit() < 0.2 { random.unit() } else { 1.0 };
            let (velocity, to) = (velocity * share, at + velocity * (share * dt_s));
            if body.end(to, velocity, world.potential_j(to)) {
                at = to;
            } else {
                body.stand();
            }
            potential_j = world.potential_j(at);
            let stored_j = 0.5 * settings.mass_kg * body.velocity().length_squared() + spring(hand, at) + potential_j;
            let made_j = stored_j - observer.put_in_j;
            assert!(made_j <= 1e-9 * observer.turned_over_j, "case {case}: {made_j} J of {} J", observer.turned_over_j);
            assert!(body.dissipated_j() >= lost_before - 1e-9 * observer.turned_over_j, "case {case}");
            lost_before = body.dissipated_j();
        }
        dissipated += lost_before;
    }
    assert!(dissipated > 1.0, "{dissipated} J in all");
}

#[test]
fn a_free_mass_swings_like_a_damped_oscillator() {
    let settings = BodySettings { damping_n_s_m: 8.0, ..FREE };
    let mut body = VirtualBody::new(settings).unwrap();
    let (mut at, dt_s) = (Vec3::X * 0.02, 1e-5);
    let hand = Vec3::ZERO;
    let (decay, omega) = (8.0 / 4.0, (800.0 / 2.0 - 4.0_f64).sqrt());
    for k in 1..=50_000 {
        let velocity = body.begin(at, Some(hand), &FieldSample::default(), dt_s);
        let to = at + velocity * dt_s;
        assert!(body.end(to, velocity, 0.0));
        at = to;
        let t = f64::from(k) * dt_s;
        let expected = 0.02 * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin());
        assert!((at.x - expected).abs() < 1e-4, "{} instead of {expected} at {t} s", at.x);
    }
}

#[test]
fn a_hand_that_pushes_is_balanced_by_the_field_without_chatter() {
    let law = ForceLaw::spring(0.01, 20_000.0);
    let mut body = VirtualBody::new(BodySettings::default()).unwrap();
    let (mut at, dt_s) = (Vec3::Z * 0.05, 1e-3);
    let (mut signs, mut last) = (0, 0.0);
    // A wall at z = 0; the hand presses to the border of the field, and trembles there.
    for k in 0..4000 {
        let tremble = 1e-5 * (f64::from(k) * 0.37).sin();
        let hand = Vec3::Z * if k < 2000 { 0.01 + tremble } else { -0.02 };
        let mut field = FieldSample::default();
        field.add(&law, law.range_m, at.z, Vec3::Z, body.velocity());
        let velocity = body.begin(at, Some(hand), &field, dt_s);
        let to = at + velocity * dt_s;
        assert!(body.end(to, velocity, law.potential_j(to.z, law.range_m)));
        let force = body.force_on_hand(to).z;
        if (1000..2000).contains(&k) && (force - last).signum() != last.signum() && (force - last).abs() > 0.1 {
            signs += 1;
        }
        (at, last) = (to, force);
    }
    assert_eq!(signs, 0);
    let (hand_n, field_n) = (body.force_on_hand(at).z, law.force_n(at.z, law.range_m));
    assert!((hand_n - field_n).abs() < 1e-3 && hand_n > 20.0, "{hand_n} N, {field_n} N");
}

#[test]
fn a_mass_speeds_up_within_its_jerk() {
    let settings = BodySettings { jerk_m_s3: 50.0, ..BodySettings::default() };
    let mut body = VirtualBody::new(settings).unwrap();
    let (mut at, mut before, mut largest) = (Vec3::ZERO, [Vec3::ZERO; 2], 0.0_f64);
    for _ in 0..300 {
        let velocity = body.begin(at, Some(Vec3::X * 0.3), &FieldSample::default(), 1e-3);
        at += velocity * 1e-3;
        assert!(body.end(at, velocity, 0.0));
        let (now, last) = (velocity - before[0], before[0] - before[1]);
        if velocity.length() > before[0].length() && now.length() > last.length() {
            largest = largest.max((now - last).length() * 1e6);
        }
        before = [velocity, before[0]];
    }
    assert!(largest < 50.0 * (1.0 + 1e-6) && largest > 40.0, "{largest} m/s³");
}

#[test]
fn a_mass_at_rest_moves_on_although_rounding_left_less_energy_than_there_was() {
    let mut body = VirtualBody::new(BodySettings::default()).unwrap();
    let law = ForceLaw::spring(0.02, 2_000.0);
    let mut field = FieldSample::default();
    field.add(&law, law.range_m, 0.005, Vec3::Y, Vec3::ZERO);
    body.begin(Vec3::ZERO, Some(Vec3::ZERO), &field, 2e-3);
    assert!(body.end(Vec3::ZERO, Vec3::ZERO, field.potential_j * (1.0 + 1e-14)));
    let velocity = body.begin(Vec3::ZERO, Some(Vec3::X * 0.01), &field, 2e-3);
    assert!(velocity.x > 0.0, "{velocity:?}");
}

#[test]
fn input_that_is_no_number_stops_the_mass() {
    let mut body = VirtualBody::new(BodySettings::default()).unwrap();
    let nan = Vec3::splat(f64::NAN);
    assert_eq!(body.begin(Vec3::ZERO, Some(nan), &FieldSample::default(), 1e-3), Vec3::ZERO);
    assert!(!body.end(nan, Vec3::ZERO, 0.0));
    assert!(!body.end(Vec3::ZERO, Vec3::ZERO, f64::NAN));
    body.stand();
    assert_eq!(body.begin(Vec3::ZERO, Some(Vec3::X), &FieldSample::default(), f64::NAN), Vec3::ZERO);
    body.stand();
    for (setting, name) in [
        (BodySettings { mass_kg: 0.0, ..FREE }, "mass_kg"),
        (BodySettings { damping_n_s_m: -1.0, ..FREE }, "damping_n_s_m"),
        (BodySettings { coupling_n_m: f64::NAN, ..FREE }, "coupling_n_m"),
    ] {
        let refused = VirtualBody::new(setting).err();
        assert!(matches!(refused, Some(NavigatorError::Setting { name: n, .. }) if n == name), "{refused:?}");
    }
}

/// A wall at z = 0: the tool stays above.
fn proxy(hand: Vec3) -> Vec3 {
    Vec3::new(hand.x, hand.y, hand.z.max(0.0))
}

#[test]
fn a_port_gives_no_more_than_it_took_and_its_tank() {
    let mut random = SplitMix(3);
    for case in 0..300 {
        let settings = ImpedanceSettings {
            stiffness_n_m: 10f64.powf(2.0 + 3.0 * random.unit()),
            damping_n_s_m: 50.0 * random.unit(),
            ..ImpedanceSettings::default()
        };
        let mut port = ImpedancePort::new(settings).unwrap();
        let (mut hand, mut held, mut taken_j) = (Vec3::Z * 0.01, Vec3::ZERO, 0.0);
        let mut velocity = Vec3::ZERO;
        for k in 0..2000 {
            if k % 7 == 0 {
                // The worst hand goes in slowly and comes out fast.
                velocity = point(&mut random, 0.5) + Vec3::Z * if hand.z < 0.0 { 0.3 } else { -0.1 };
            }
            let moved = velocity * 1e-3;
            taken_j -= held.dot(moved);
            hand += moved;
            held = port.step(proxy(hand), hand, Vec3::ZERO, 1e-3);
            assert!((port.energy_j() - taken_j).abs() < 1e-9);
            assert!(taken_j >= -settings.tank_j * (1.0 + 1e-9), "case {case}, step {k}: {taken_j} J");
        }
    }
}

#[test]
fn a_damped_device_needs_no_tank() {
    let mut random = SplitMix(4);
    let settings = ImpedanceSettings { stiffness_n_m: 20_000.0, tank_j: 10.0, ..ImpedanceSettings::default() };
    let mut port = ImpedancePort::new(settings).unwrap();
    let damping = port.least_device_damping(1e-3);
    assert!((damping - 10.0).abs() < 1e-12);
    let (mut hand, mut held, mut taken_j, mut undamped_j) = (Vec3::Z * 0.001, Vec3::ZERO, 0.0, 0.0_f64);
    let mut least_undamped = 0.0_f64;
    for k in 0..100_000 {
        let speed = 0.2 * (f64::from(k) * 0.9).sin() + 0.05 * (2.0 * random.unit() - 1.0);
        let velocity = Vec3::Z * (speed - 5.0 * hand.z);
        hand += velocity * 1e-3;
        undamped_j -= held.dot(velocity * 1e-3);
        taken_j += damping * velocity.length_squared() * 1e-3 - held.dot(velocity * 1e-3);
        assert!(taken_j >= -1e-9, "step {k}: {taken_j} J");
        least_undamped = least_undamped.min(undamped_j);
        held = port.step(proxy(hand), hand, Vec3::ZERO, 1e-3);
    }
    assert!(least_undamped < -0.01, "without damping the sampled wall makes energy: {least_undamped} J");
}

#[test]
fn a_port_without_usable_input_pushes_nobody() {
    let mut port = ImpedancePort::new(ImpedanceSettings::default()).unwrap();
    assert_eq!(port.step(Vec3::ZERO, Vec3::splat(f64::NAN), Vec3::ZERO, 1e-3), Vec3::ZERO);
    assert_eq!(port.step(Vec3::ZERO, Vec3::X, Vec3::ZERO, 0.0), Vec3::ZERO);
    assert!(ImpedancePort::new(ImpedanceSettings { tank_j: 0.0, ..ImpedanceSettings::default() }).is_err());
}
