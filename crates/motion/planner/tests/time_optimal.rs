//! Time-optimal trajectories: limits checked by independent differentiation, durations by exhaustive search and closed
//! forms.

use elbowroom_kinematics::{JointLimits, TrajectoryRow};
use elbowroom_planner::{BlendedPath, TimeOptimalTrajectory, TimeParametrizationError};
use elbowroom_testkit::random::{split_mix, unit};
use proptest::prelude::*;

/// Excess over a limit that is accepted for rounding and for maxima between the planner's samples.
const EXCESS: f64 = 1.002;

fn equal_limits(joints: usize, [v, a, j]: [f64; 3]) -> Vec<JointLimits> {
    vec![JointLimits::new(v, a, j); joints]
}

/// Differentiates positions at equal steps once, twice and three times, only by differences: each difference is a mean
/// of the derivative.
fn check_limits(trajectory: &TimeOptimalTrajectory, limits: &[JointLimits], orders: usize) {
    let seconds = trajectory.seconds();
    // 1 kHz, or the step for 2,000 steps.
    let h = (seconds / 2000.0).min(1e-3).max(seconds / 2e5);
    let steps = (seconds / h).ceil() as usize + 3;
    let points: Vec<_> = (0..=steps).map(|n| trajectory.at(n as f64 * h)).collect();
    for joint in 0..limits.len() {
        let q: Vec<f64> = points.iter().map(|p| p.q[joint]).collect();
        let rounding = 8.0 * f64::EPSILON * q.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let JointLimits { velocity, acceleration, jerk, .. } = limits[joint];
        let mut differences = q;
        for (order, limit) in (1..=orders).zip([velocity, acceleration, jerk]) {
            differences = differences.windows(2).map(|w| (w[1] - w[0]) / h).collect();
            let most = limit * EXCESS + rounding * (2.0 / h).powf(order as f64);
            for (n, value) in differences.iter().enumerate() {
                assert!(value.abs() <= most, "order {order}, joint {joint}, step {n} of {steps}: {value} > {most}");
            }
        }
        for pair in points.windows(2) {
            let ([a, b], mean) = ([&pair[0], &pair[1]], 0.5 * (pair[0].dq[joint] + pair[1].dq[joint]));
            let most = EXCESS * limits[joint].acceleration * h + rounding / h;
            assert!(((b.q[joint] - a.q[joint]) / h - mean).abs() <= most, "velocity is not the derivative");
            if orders == 3 {
                let mean = 0.5 * (a.ddq[joint] + b.ddq[joint]);
                let most = EXCESS * limits[joint].jerk * h + rounding / h;
                assert!(((b.dq[joint] - a.dq[joint]) / h - mean).abs() <= most, "acceleration is not the derivative");
            }
        }
    }
}

fn check_ends(trajectory: &TimeOptimalTrajectory, waypoints: &[Vec<f64>]) {
    assert!(trajectory.seconds().is_finite());
    let (first, last) = (trajectory.at(0.0), trajectory.at(trajectory.seconds()));
    assert_eq!((&first.q, &last.q), (&waypoints[0], waypoints.last().unwrap()));
    assert!(first.dq.iter().chain(&last.dq).all(|v| *v == 0.0));
}

fn random_path(count: usize, joints: usize, state: &mut u64) -> Vec<Vec<f64>> {
    (0..count).map(|_| (0..joints).map(|_| 2.0 * unit(split_mix(state)) - 1.0).collect()).collect()
}

fn waypoints() -> impl Strategy<Value = Vec<Vec<f64>>> {
    let value = prop_oneof![-1.0..1.0, Just(0.0), Just(0.5), Just(0.5 + 1e-7), Just(1e-3)];
    (1_usize..8)
        .prop_flat_map(move |joints| prop::collection::vec(prop::collection::vec(value.clone(), joints), 1_usize..7))
}

/// Limits over several powers of ten.
fn limits() -> impl Strategy<Value = Vec<JointLimits>> {
    let power = |low: f64, high: f64| (low..high).prop_map(|x: f64| 10_f64.powf(x));
    let limits = (power(-1.0, 1.0), power(-0.5, 2.0), power(0.0, 4.0)).prop_map(|(v, a, j)| JointLimits::new(v, a, j));
    prop::collection::vec(limits, 8)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn trajectories_keep_the_limits(
        waypoints in waypoints(),
        limits in limits(),
        most in prop_oneof![Just(f64::INFINITY), Just(0.05), Just(1e-4), Just(0.0)],
    ) {
        let limits = &limits[..waypoints[0].len()];
        let path = BlendedPath::new(&waypoints, |blend| blend.distance() <= most).unwrap();
        let trajectory = path.time_optimal(limits).unwrap();
        check_ends(&trajectory, &waypoints);
        let fast = path.time_optimal_without_jerk_limit(limits).unwrap();
        check_ends(&fast, &waypoints);
        if trajectory.seconds() > 0.0 {
            check_limits(&trajectory, limits, 3);
            check_limits(&fast, limits, 2);
            prop_assert!(trajectory.seconds() > 0.9 * fast.seconds());
        }
        let aligned = trajectory.clone().aligned_to_ticks(0.008).unwrap();
        let samples = aligned.samples(0.008).unwrap();
        prop_assert!(aligned.seconds() >= trajectory.seconds() * (1.0 - 1e-9));
        prop_assert!(aligned.seconds() <= trajectory.seconds() + 0.008 * (path.stops() + 1) as f64 + 1e-9);
        prop_assert_eq!(samples.last().unwrap(), waypoints.last().unwrap());
        for w in samples.rows().windows(2) {
            let slow = |i: usize| (w[1].q[i] - w[0].q[i]).abs() <= limits[i].velocity * 0.008 * EXCESS + 1e-9;
            prop_assert!((0..limits.len()).all(slow));
        }
    }
}

/// Motion from rest to rest along a straight line: with the speed limit reached, or with not even the acceleration
/// limit reached.
#[test]
fn a_straight_line_takes_the_least_time() {
    for (far, seconds) in [(2.0, 2.0 + 0.25 + 0.1), (0.01, 4.0 * (0.01_f64 / 80.0).cbrt())] {
        let path = BlendedPath::new(&[vec![0.0, 0.0], vec![far, -0.3 * far]], |_| true).unwrap();
        let limits = equal_limits(2, [1.0, 4.0, 40.0]);
        let found = path.time_optimal(&limits).unwrap().seconds();
        assert!(found > seconds * (1.0 - 1e-6) && found < 1.02 * seconds, "{far}: {found} s, optimum {seconds}");
        let (fast, least) = (path.time_optimal_without_jerk_limit(&limits).unwrap().seconds(), far.min(0.25));
        let optimum = 2.0 * (least / 4.0).sqrt() + (far - least);
        assert!((fast / optimum - 1.0).abs() < 2e-3, "{far}: {fast} s, optimum {optimum}");
    }
}

/// A path element given by Bézier control points, differentiated by differences.
struct Curve {
    controls: Vec<Vec<f64>>,
    length: f64,
}

impl Curve {
    fn at(&self, s: f64, joint: usize) -> f64 {
        let mut values: Vec<f64> = self.controls.iter().map(|q| q[joint]).collect();
        while values.len() > 1 {
            values = values.windows(2).map(|w| w[0] + (w[1] - w[0]) * s / self.length).collect();
        }
        values[0]
    }

    /// First and second derivative.
    fn derivatives(&self, s: f64, joint: usize) -> [f64; 2] {
        let h = 1e-4 * self.length;
        let [a, b, c] = [s - h, s, s + h].map(|s| self.at(s, joint));
        [(c - a) / (2.0 * h), (c - 2.0 * b + a) / (h * h)]
    }
}

/// Least duration by dynamic programming over all pairs of squared speeds of neighbouring nodes.
fn exhaustive_seconds(curves: &[Curve], limits: &[JointLimits], nodes: usize, levels: usize) -> f64 {
    let joints = limits.len();
    let x_top = limits.iter().map(|l| l.velocity * l.velocity).fold(0.0, f64::max) * 2.0;
    // Levels are finer at low speed.
    let level = |n: usize| x_top * (n as f64 / (levels - 1) as f64).powi(2);
    let mut least = vec![f64::INFINITY; levels];
    least[0] = 0.0;
    for curve in curves {
        let h = curve.length / nodes as f64;
        for node in 0..nodes {
            let begin = node as f64 * h;
            let samples: Vec<(f64, Vec<[f64; 2]>)> = [0.0, 0.5, 1.0]
                .map(|share| (share, (0..joints).map(|i| curve.derivatives(begin + share * h, i)).collect()))
                .to_vec();
            let admissible = |x: f64, next: f64| {
                let u = 0.5 * (next - x) / h;
                samples.iter().all(|(share, joints)| {
                    let x = x + share * (next - x);
                    joints.iter().enumerate().all(|(i, [p, c])| {
                        p * p * x <= limits[i].velocity.powi(2) * 1.000_1
                            && (p * u + c * x).abs() <= limits[i].acceleration * 1.000_1
                    })
                })
            };
            let mut after = vec![f64::INFINITY; levels];
            for from in (0..levels).filter(|n| least[*n].is_finite()) {
                for to in 0..levels {
                    let seconds = least[from] + 2.0 * h / (level(from).sqrt() + level(to).sqrt());
                    if seconds < after[to] && admissible(level(from), level(to)) {
                        after[to] = seconds;
                    }
                }
            }
            least = after;
        }
    }
    least[0]
}

#[test]
fn no_search_finds_a_faster_motion_around_a_corner() {
    let mut state = 3;
    for case in 0..6 {
        let waypoints = random_path(3, 1 + case % 3 + 1, &mut state);
        let mut curves = Vec::new();
        let path = BlendedPath::new(&waypoints, |blend| {
            let [a, b, c, d, e] = blend.control_points();
            let straight = |a: &[f64], b: &[f64]| Curve {
                length: a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt(),
                controls: vec![a.to_vec(), b.to_vec()],
            };
            let (first, last) = (straight(&waypoints[0], &a), straight(&e, &waypoints[2]));
            curves = vec![first, Curve { controls: vec![a, b, c, d, e], length: 2.0 * blend.distance() }, last];
            true
        })
        .unwrap();
        let limits = equal_limits(waypoints[0].len(), [1.0, 3.0, 1e5]);
        let optimum = exhaustive_seconds(&curves, &limits, 12, 200);
        let found = path.time_optimal_without_jerk_limit(&limits).unwrap().seconds();
        assert!(found < 1.01 * optimum && found > 0.95 * optimum, "case {case}: {found} s, search {optimum} s");
        // A jerk that rises in 0.03 ms costs almost no time.
        let smooth = path.time_optimal(&limits).unwrap().seconds();
        assert!(smooth < 1.015 * optimum && smooth > 0.95 * optimum, "case {case}: {smooth} s, search {optimum} s");
    }
}

#[test]
fn a_path_backwards_takes_as_long() {
    let mut state = 11;
    for n in 0..60 {
        let mut waypoints = random_path(2 + n % 5, 1 + n % 7, &mut state);
        let limits = equal_limits(waypoints[0].len(), [1.0, 5.0, [20.0, 500.0][n % 2]]);
        let path = BlendedPath::new(&waypoints, |blend| blend.distance() < 0.2).unwrap();
        waypoints.reverse();
        let back = BlendedPath::new(&waypoints, |blend| blend.distance() < 0.2).unwrap();
        let [a, b] = [&path, &back].map(|p| p.time_optimal(&limits).unwrap());
        assert!((a.seconds() / b.seconds() - 1.0).abs() < 0.02, "path {n}: {} and {}", a.seconds(), b.seconds());
        let [a, b] = [&path, &back].map(|p| p.time_optimal_without_jerk_limit(&limits).unwrap().seconds());
        assert!((a / b - 1.0).abs() < 0.01, "path {n}: {a} and {b} without limits of jerk");
    }
}

#[test]
fn a_symmetric_path_has_a_symmetric_motion() {
    let waypoints = [vec![-1.0, 0.0], vec![-0.5, 0.5], vec![0.5, 0.5], vec![1.0, 0.0]];
    let path = BlendedPath::new(&waypoints, |blend| blend.distance() < 0.2).unwrap();
    let trajectory = path.time_optimal(&equal_limits(2, [1.0, 5.0, 50.0])).unwrap();
    for n in 0..=100 {
        let t = trajectory.seconds() * f64::from(n) / 100.0;
        let (a, b) = (trajectory.at(t), trajectory.at(trajectory.seconds() - t));
        assert!((a.q[0] + b.q[0]).abs() < 5e-3 && (a.q[1] - b.q[1]).abs() < 5e-3, "{:?} and {:?}", a.q, b.q);
    }
}

#[test]
fn units_of_time_do_not_matter() {
    let mut state = 5;
    let path = BlendedPath::new(&random_path(5, 4, &mut state), |_| true).unwrap();
    let seconds = |k: f64| path.time_optimal(&equal_limits(4, [k, 6.0 * k * k, 80.0 * k * k * k])).unwrap().seconds();
    for k in [1e-4, 0.1, 7.0, 1e5] {
        assert!((seconds(k) * k / seconds(1.0) - 1.0).abs() < 1e-6, "{k}");
    }
}

#[test]
fn larger_limits_are_not_slower() {
    let mut state = 23;
    for _ in 0..40 {
        let path = BlendedPath::new(&random_path(4, 3, &mut state), |_| true).unwrap();
        let seconds = |limits: [f64; 3]| path.time_optimal(&equal_limits(3, limits)).unwrap().seconds();
        let base = seconds([1.0, 4.0, 40.0]);
        for more in [[2.0, 4.0, 40.0], [1.0, 8.0, 40.0], [1.0, 4.0, 80.0]] {
            assert!(seconds(more) < 1.02 * base, "{more:?}: {} s, not {base}", seconds(more));
        }
        assert!(seconds([2.0, 8.0, 160.0]) < 0.8 * base);
    }
}

#[test]
fn corners_are_passed_without_a_rest_however_small_their_blends() {
    let mut state = 17;
    for most in [1.0, 1e-2, 1e-4, 1e-6] {
        let waypoints = random_path(5, 3, &mut state);
        let mut proposed = Vec::new();
        let path = BlendedPath::new(&waypoints, |blend| {
            proposed.push(blend.waypoint());
            blend.distance() <= most
        })
        .unwrap();
        assert_eq!((path.stops(), proposed.first(), proposed.last()), (0, Some(&1), Some(&3)));
        let limits = equal_limits(3, [1.0, 5.0, 100.0]);
        let trajectory = path.time_optimal(&limits).unwrap();
        check_limits(&trajectory, &limits, 3);
        let slowest = (100..=9900).map(|n| {
            let point = trajectory.at(trajectory.seconds() * f64::from(n) / 1e4);
            point.dq.iter().map(|v| v * v).sum::<f64>().sqrt()
        });
        assert!(slowest.fold(f64::INFINITY, f64::min) > 0.0);
    }
}

#[test]
fn it_rests_where_the_path_turns_back_and_where_no_blend_is_free() {
    let limits = equal_limits(2, [1.0, 5.0, 100.0]);
    let turning = [vec![0.0, 0.0], vec![1.0, 0.5], vec![0.2, 0.1]];
    let path = BlendedPath::new(&turning, |_| panic!("there is nothing to blend")).unwrap();
    let trajectory = path.time_optimal(&limits).unwrap();
    assert_eq!(trajectory.stops(), 1);
    check_limits(&trajectory, &limits, 3);
    let samples = trajectory.aligned_to_ticks(0.004).unwrap().samples(0.004).unwrap();
    assert!(samples.rows().iter().any(|row| (row.q[0] - 1.0).hypot(row.q[1] - 0.5) < 1e-9), "no row at the corner");
    // Almost 180 degrees.
    let nearly = [vec![0.0, 0.0], vec![1.0, 0.0], vec![0.0, 1e-3]];
    let path = BlendedPath::new(&nearly, |_| true).unwrap();
    assert_eq!(path.stops(), 0);
    check_limits(&path.time_optimal(&limits).unwrap(), &limits, 3);
    let corner = [vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 1.0]];
    let path = BlendedPath::new(&corner, |_| false).unwrap();
    assert_eq!(path.stops(), 1);
    check_limits(&path.time_optimal(&limits).unwrap(), &limits, 3);
}

#[test]
fn blends_stay_in_their_bounds() {
    let mut state = 29;
    for _ in 0..50 {
        let waypoints = random_path(3, 4, &mut state);
        let _ = BlendedPath::new(&waypoints, |blend| {
            for pieces in [1, 2, 5, 16] {
                let (points, deviation) = blend.polyline(pieces);
                for n in 0..=400 {
                    let share = f64::from(n) / 400.0;
                    let piece = ((share * pieces as f64) as usize).min(pieces - 1);
                    let within = share * pieces as f64 - piece as f64;
                    for (i, q) in blend.at(share).iter().enumerate() {
                        let chord = points[piece][i] + within * (points[piece + 1][i] - points[piece][i]);
                        assert!((q - chord).abs() <= deviation[i] * (1.0 + 1e-9) + 1e-12);
                    }
                }
                // The bound is tight: it is reached within a factor of 2 in the middle of an even number of pieces.
                if pieces == 16 {
                    let middle = blend.at(0.5 - 0.5 / 16.0);
                    let chord: Vec<f64> = (0..4).map(|i| 0.5 * (points[7][i] + points[8][i])).collect();
                    assert!((0..4).all(|i| (middle[i] - chord[i]).abs() >= 0.5 * deviation[i]));
                }
            }
            blend.distance() < 0.1
        });
    }
}

#[test]
fn degenerate_paths_and_extreme_limits() {
    let limits = equal_limits(2, [1.0, 5.0, 100.0]);
    for waypoints in [vec![vec![0.3, 0.4]], vec![vec![0.3, 0.4]; 5]] {
        let trajectory = BlendedPath::new(&waypoints, |_| true).unwrap().time_optimal(&limits).unwrap();
        assert_eq!((trajectory.seconds(), trajectory.at(1.0).q), (0.0, vec![0.3, 0.4]));
        assert_eq!(trajectory.samples(0.01).unwrap().rows(), [TrajectoryRow { t_s: 0.0, q: vec![0.3, 0.4] }]);
    }
    let corner = [vec![0.0, 0.0], vec![0.0, 0.0], vec![0.5, 0.0], vec![1.0, 0.0], vec![1.0, 1.0], vec![1.0, 1.0]];
    let path = BlendedPath::new(&corner, |_| true).unwrap();
    let mut state = 41;
    for _ in 0..2000 {
        let mut any = |least: f64, most: f64| 10_f64.powf(least + (most - least) * unit(split_mix(&mut state)));
        let mut joint = || JointLimits::new(any(-6.0, 6.0), any(-6.0, 8.0), any(-6.0, 10.0));
        let extreme = [joint(), joint()];
        for trajectory in
            [path.time_optimal(&extreme).unwrap(), path.time_optimal_without_jerk_limit(&extreme).unwrap()]
        {
            assert!(trajectory.seconds() > 0.0 && trajectory.seconds().is_finite());
            let middle = trajectory.at(0.37 * trajectory.seconds());
            assert!(middle.q.iter().chain(&middle.dq).chain(&middle.ddq).all(|x| x.is_finite()), "{extreme:?}");
        }
    }
    let tiny = BlendedPath::new(&[vec![0.0], vec![1e-8], vec![3e-8]], |_| true).unwrap();
    let limits = equal_limits(1, [1.0, 5.0, 100.0]);
    check_limits(&tiny.time_optimal(&limits).unwrap(), &limits, 2);
}

#[test]
fn invalid_input_is_rejected() {
    use TimeParametrizationError::{Count, Limit, Path, Period};
    let none: [Vec<f64>; 0] = [];
    assert!(matches!(BlendedPath::new(&none, |_| true), Err(Path)));
    for bad in [vec![f64::NAN, 0.0], vec![0.0], vec![f64::INFINITY, 0.0], vec![f64::MAX, f64::MAX]] {
        assert!(matches!(BlendedPath::new(&[vec![-1.0, -1.0], bad], |_| true), Err(Path)));
    }
    let path = BlendedPath::new(&[vec![0.0, 0.0], vec![1.0, 0.0]], |_| true).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let limits = [JointLimits::new(1.0, 1.0, 1.0), JointLimits::new(1.0, 1.0, bad)];
        assert!(matches!(path.time_optimal(&limits), Err(Limit { joint: 1, .. })));
    }
    assert!(matches!(path.time_optimal(&equal_limits(3, [1.0; 3])), Err(Count { .. })));
    assert!(matches!(path.time_optimal(&equal_limits(2, [1e-320, 1.0, 1.0])), Err(Limit { joint: 0, .. })));
    let trajectory = path.time_optimal(&equal_limits(2, [1.0; 3])).unwrap();
    assert!(matches!(trajectory.samples(f64::NAN), Err(Period(_))));
}
