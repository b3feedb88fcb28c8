//! The solver: what it answers is the minimum, by the conditions that only the minimum meets.

use elbowroom_avoidance::LeastSquares;
use proptest::prelude::*;

#[derive(Debug, Clone)]
struct Problem {
    wanted: Vec<f64>,
    bounds: Vec<(f64, f64)>,
    wishes: Vec<(Vec<f64>, f64, f64, bool)>,
}

fn problem() -> impl Strategy<Value = Problem> {
    (1usize..9).prop_flat_map(|n| {
        let coefficient = prop_oneof![4 => -2.0..2.0_f64, 1 => Just(0.0)];
        let weight = prop_oneof![Just(0.0), Just(1.0), Just(100.0), Just(1e6)];
        let wish = (prop::collection::vec(coefficient, n), -2.0..2.0_f64, weight, any::<bool>());
        let bound = (-1.5..1.0_f64, 0.0..2.0_f64).prop_map(|(low, width)| (low, low + width));
        (prop::collection::vec(-2.0..2.0_f64, n), prop::collection::vec(bound, n), prop::collection::vec(wish, 0..20))
            .prop_map(|(wanted, bounds, wishes)| Problem { wanted, bounds, wishes })
    })
}

fn solve(p: &Problem, start: f64) -> Vec<f64> {
    let n = p.wanted.len();
    let mut least = LeastSquares::new(n, p.wishes.len());
    least.wanted.copy_from_slice(&p.wanted);
    for (j, (low, high)) in p.bounds.iter().enumerate() {
        (least.lower[j], least.upper[j]) = (*low, *high);
    }
    for (a, b, weight, at_least) in &p.wishes {
        let wish = least.wish().unwrap();
        wish.a.copy_from_slice(a);
        (wish.b, wish.weight, wish.at_least) = (*b, *weight, *at_least);
    }
    let mut x = vec![start; n];
    assert!(least.solve(&mut x));
    x
}

fn gradient(p: &Problem, x: &[f64]) -> Vec<f64> {
    let mut g: Vec<f64> = x.iter().zip(&p.wanted).map(|(x, t)| x - t).collect();
    for (a, b, weight, at_least) in &p.wishes {
        let miss = a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b;
        let miss = if *at_least { miss.min(0.0) } else { miss };
        g.iter_mut().zip(a).for_each(|(g, a)| *g += weight * miss * a);
    }
    g
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_answer_is_the_minimum(p in problem()) {
        let x = solve(&p, 0.0);
        let g = gradient(&p, &x);
        let scale = p.wishes.iter().map(|w| w.2).fold(1.0, f64::max);
        for ((x, (low, high)), g) in x.iter().zip(&p.bounds).zip(&g) {
            prop_assert!(x >= low && x <= high);
            // Karush, Kuhn, Tucker: the slope leads out of the bounds, or is none.
            let slope = if low == high { 0.0 } else if *x <= *low { g.min(0.0) } else if *x >= *high { g.max(0.0) } else { *g };
            prop_assert!(slope.abs() <= 2e-10 * scale, "slope {slope} at {x} in [{low}, {high}]");
        }
    }

    #[test]
    fn the_start_does_not_matter(p in problem()) {
        let (a, b) = (solve(&p, -3.0), solve(&p, 3.0));
        for (a, b) in a.iter().zip(&b) {
            prop_assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
    }
}

#[test]
fn bounds_that_cross_meet_in_the_middle_and_nonsense_is_told() {
    let mut least = LeastSquares::new(1, 1);
    (least.lower[0], least.upper[0], least.wanted[0]) = (1.0, 0.0, 9.0);
    let mut x = [0.0];
    assert!(least.solve(&mut x));
    assert_eq!(x, [0.5]);
    least.wanted[0] = f64::NAN;
    (least.lower[0], least.upper[0]) = (0.0, 1.0);
    assert!(!least.solve(&mut x));
    assert!(least.wish().is_some() && least.wish().is_none());
    least.clear();
    assert!(least.wish().is_some());
}
