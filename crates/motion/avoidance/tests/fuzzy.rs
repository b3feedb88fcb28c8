//! Rules: inference compared with an oracle, properties of the default rules, and invalid texts.

use elbowroom_avoidance::fuzzy::{Controller, Rule, Set, Surface, Variable};
use elbowroom_avoidance::{DEFAULT_RULES, Rules};
use proptest::prelude::*;

/// Mamdani inference by its definition, integrated numerically.
fn oracle(controller: &Controller, inputs: &[f64], output: usize) -> f64 {
    let out = &controller.outputs()[output];
    let low = out.sets.iter().map(|s| s.1.corners()[0]).fold(out.range[0], f64::min);
    let high = out.sets.iter().map(|s| s.1.corners()[3]).fold(out.range[1], f64::max);
    let steps = 20_000;
    let (mut area, mut moment) = (0.0, 0.0);
    for i in 0..=steps {
        let x = low + (high - low) * f64::from(i) / f64::from(steps);
        let mut joined = 0.0_f64;
        for rule in controller.rules() {
            let mut strength = 1.0_f64;
            for &(variable, set) in &rule.conditions {
                let v = &controller.inputs()[variable];
                strength = strength.min(v.sets[set].1.degree(inputs[variable].clamp(v.range[0], v.range[1])));
            }
            for &(o, set) in &rule.conclusions {
                if o == output {
                    joined = joined.max(strength.min(out.sets[set].1.degree(x)));
                }
            }
        }
        area += joined;
        moment += joined * x;
    }
    (moment / area).clamp(out.range[0], out.range[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn inference_is_mamdani(distance in -0.2..1.3_f64, speed in -0.5..2.5_f64) {
        let rules = Rules::default();
        let mut out = [0.0; 2];
        rules.controller().infer(&[distance, speed], &mut out);
        for (number, (value, scale)) in out.iter().zip([1.0, 90.0]).enumerate() {
            let expected = oracle(rules.controller(), &[distance, speed], number);
            prop_assert!((value - expected).abs() < 6e-3 * scale, "output {number}: {value}, oracle {expected}");
        }
    }

    #[test]
    fn nearer_and_faster_never_gives_a_smaller_correction(d in 0.0..1.0_f64, s in 0.0..2.0_f64, dd in 0.0..0.5_f64, ds in 0.0..0.5_f64) {
        // Centres of gravity drop slightly between sets, so the property holds up to 4 % of the full size.
        let rules = Rules::default();
        let here = rules.correction(d, s).size;
        prop_assert!(rules.correction(d - dd, s).size >= here - 0.04);
        prop_assert!(rules.correction(d, s + ds).size >= here - 0.04);
    }

    #[test]
    fn small_changes_change_little(d in 0.0..1.0_f64, s in 0.0..2.0_f64) {
        let rules = Rules::default();
        let (a, b) = (rules.correction(d, s), rules.correction(d + 1e-4, s + 1e-4));
        prop_assert!((a.size - b.size).abs() < 0.01, "{a:?} {b:?}");
        prop_assert!((a.direction_rad - b.direction_rad).abs() < 0.03, "{a:?} {b:?}");
    }

    #[test]
    fn any_text_is_read_or_refused(cut in 0..DEFAULT_RULES.len(), letter in any::<char>()) {
        if DEFAULT_RULES.is_char_boundary(cut) {
            let mut text = DEFAULT_RULES.to_owned();
            text.insert(cut, letter);
            if let Err(e) = Rules::from_toml(&text) {
                prop_assert!(!e.message.is_empty() && !e.hint.is_empty());
            }
        }
    }
}

#[test]
fn nan_counts_as_contact_at_full_speed() {
    let rules = Rules::default();
    assert!(rules.correction(f64::NAN, 0.0).size > 0.3);
    assert!(rules.correction(0.45, f64::NAN).size > 0.8);
    assert_eq!(rules.correction(f64::INFINITY, 0.0).size, 0.0);
}

#[test]
fn text_round_trip() {
    let rules = Rules::default();
    let again = Rules::from_toml(&rules.controller().to_toml()).unwrap();
    assert_eq!(rules, again);
}

#[test]
fn the_surface_agrees_with_the_controller() {
    let rules = Rules::default();
    let surface = Surface::of(rules.controller(), 1, 11).unwrap();
    for (j, y) in surface.y.iter().enumerate() {
        for (i, x) in surface.x.iter().enumerate() {
            assert_eq!(surface.z[j][i].to_radians(), rules.correction(*x, *y).direction_rad);
        }
    }
    assert!(Surface::of(rules.controller(), 2, 11).is_none() && Surface::of(rules.controller(), 0, 1).is_none());
}

#[test]
fn errors_name_their_line() {
    let without_range = "[input.proximity]\nnear = [0, 0, 1, 1]\n";
    let wrong = |text: &str| Rules::from_toml(text).unwrap_err();
    assert_eq!(wrong(without_range).line, Some(1));
    assert!(wrong(without_range).hint.contains("range = [low, high]"));
    let falling = DEFAULT_RULES.replace("near = [0.06, 0.16, 0.24, 0.40]", "near = [0.06, 0.16, 0.14, 0.40]");
    let e = wrong(&falling);
    assert!(e.message.contains("`near`") && e.line == Some(8), "{e}");
    let unknown =
        DEFAULT_RULES.replace("if proximity is far and speed is stop", "if proximity is remote and speed is stop");
    let e = wrong(&unknown);
    assert!(e.message.contains("remote") && e.hint.contains("far") && e.line.is_some(), "{e}");
    let hole = DEFAULT_RULES.replace("far = [0.50, 0.75, 1, 1]", "far = [0.80, 0.9, 1, 1]");
    let e = wrong(&hole);
    assert!(e.message.contains("no rule says anything") && e.message.contains("proximity"), "{e}");
    let e = wrong(&DEFAULT_RULES.replace("[rules]", "[rule]"));
    assert!(e.message.contains("`rule`"), "{e}");
    let e = wrong(&DEFAULT_RULES.replace("proximity", "closeness"));
    assert!(e.message.contains("closeness"), "{e}");
    assert_eq!(wrong("[input").line, Some(1));
    assert!(wrong("").message.contains("inputs"));
}

#[test]
fn variables_are_checked() {
    let set = |c| Set::new(c).unwrap();
    let v = |name: &str, range, sets: &[[f64; 4]]| Variable {
        name: name.into(),
        range,
        sets: sets.iter().enumerate().map(|(i, c)| (format!("s{i}"), set(*c))).collect(),
    };
    let wide = [[0.0, 0.0, 1.0, 1.0]];
    let rule = Rule { conditions: vec![(0, 0)], conclusions: vec![(0, 0)] };
    let make = |i, o| Controller::new(vec![i], vec![o], vec![rule.clone()]);
    assert!(make(v("a", [0.0, 1.0], &wide), v("b", [0.0, 1.0], &wide)).is_ok());
    assert!(make(v("a", [1.0, 0.0], &wide), v("b", [0.0, 1.0], &wide)).is_err());
    assert!(make(v("a", [0.0, f64::NAN], &wide), v("b", [0.0, 1.0], &wide)).is_err());
    assert!(make(v("a", [0.0, 1.0], &[]), v("b", [0.0, 1.0], &wide)).is_err());
    let needle = make(v("a", [0.0, 1.0], &wide), v("b", [0.0, 1.0], &[[0.501, 0.5011, 0.5011, 0.502]]));
    assert!(needle.unwrap_err().message.contains("too narrow"));
    assert!(Set::new([0.0, f64::NAN, 1.0, 1.0]).is_none() && Set::new([1.0, 0.0, 1.0, 1.0]).is_none());
}
