//! The solution satisfies the optimality conditions of the minimum.

use elbowroom_avoidance::LeastSquares;
use proptest::prelude::*;

#[derive(Debug, Clone)]
struct Problem {
    desired: Vec<f64>,
    bounds: Vec<(f64, f64)>,
    constraints: Vec<(Vec<f64>, f64, f64, bool)>,
}

fn problem() -> impl Strategy<Value = Problem> {
    (1usize..9).prop_flat_map(|n| {
        let coefficient = prop_oneof![4 => -2.0..2.0_f64, 1 => Just(0.0)];
        let weight = prop_oneof![Just(0.0), Just(1.0), Just(100.0), Just(1e6)];
        let constraint = (prop::collection::vec(coefficient, n), -2.0..2.0_f64, weight, any::<bool>());
        let bound = (-1.5..1.0_f64, 0.0..2.0_f64).prop_map(|(low, width)| (low, low + width));
        (
            prop::collection::vec(-2.0..2.0_f64, n),
            prop::collection::vec(bound, n),
            prop::collection::vec(constraint, 0..20),
        )
            .prop_map(|(desired, bounds, constraints)| Problem { desired, bounds, constraints })
    })
}

fn solve(p: &Problem, start: f64) -> Vec<f64> {
    let n = p.desired.len();
    let mut solver = LeastSquares::new(n, p.constraints.len());
    solver.desired.copy_from_slice(&p.desired);
    for (j, (low, high)) in p.bounds.iter().enumerate() {
        (solver.lower[j], solver.upper[j]) = (*low, *high);
    }
    for (a, b, weight, at_least) in &p.constraints {
        let constraint = solver.add_constraint().unwrap();
        constraint.a.copy_from_slice(a);
        (constraint.b, constraint.weight, constraint.at_least) = (*b, *weight, *at_least);
    }
    let mut x = vec![start; n];
    assert!(solver.solve(&mut x));
    x
}

fn gradient(p: &Problem, x: &[f64]) -> Vec<f64> {
    let mut g: Vec<f64> = x.iter().zip(&p.desired).map(|(x, t)| x - t).collect();
    for (a, b, weight, at_least) in &p.constraints {
        let residual = a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b;
        let residual = if *at_least { residual.min(0.0) } else { residual };
        g.iter_mut().zip(a).for_each(|(g, a)| *g += weight * residual * a);
    }
    g
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_solution_is_the_minimum(p in problem()) {
        let x = solve(&p, 0.0);
        let g = gradient(&p, &x);
        let scale = p.constraints.iter().map(|c| c.2).fold(1.0, f64::max);
        for ((x, (low, high)), g) in x.iter().zip(&p.bounds).zip(&g) {
            prop_assert!(x >= low && x <= high);
            // Karush-Kuhn-Tucker conditions: the gradient points out of the bounds, or is 0.
            let slope = if low == high { 0.0 } else if *x <= *low { g.min(0.0) } else if *x >= *high { g.max(0.0) } else { *g };
            prop_assert!(slope.abs() <= 2e-10 * scale, "slope {slope} at {x} in [{low}, {high}]");
        }
    }

    #[test]
    fn the_solution_does_not_depend_on_the_initial_guess(p in problem()) {
        let (a, b) = (solve(&p, -3.0), solve(&p, 3.0));
        for (a, b) in a.iter().zip(&b) {
            prop_assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
    }
}

#[test]
fn crossing_bounds_are_replaced_by_their_mean_and_invalid_numbers_are_reported() {
    let mut solver = LeastSquares::new(1, 1);
    (solver.lower[0], solver.upper[0], solver.desired[0]) = (1.0, 0.0, 9.0);
    let mut x = [0.0];
    assert!(solver.solve(&mut x));
    assert_eq!(x, [0.5]);
    solver.desired[0] = f64::NAN;
    (solver.lower[0], solver.upper[0]) = (0.0, 1.0);
    assert!(!solver.solve(&mut x));
    assert!(solver.add_constraint().is_some() && solver.add_constraint().is_none());
    solver.clear();
    assert!(solver.add_constraint().is_some());
}
