//! Point clouds and very many obstacles: answers compared with plain distances.

use crate::common::{Random, RandomGeometry, single_joint};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits, LinkId};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_validity::{CoveredLinkId, CoveredRobot, ObstacleSet, Validity, ValidityChecker};

const RADIUS_M: f64 = 0.06;

/// Three turning joints and a ball on each link.
fn arm() -> Robot {
    let axes = [Vec3::Z, Vec3::Y, Vec3::Y];
    let joints = (0..3).map(|i| {
        let origin = Pose::from_translation(Vec3::Z * if i == 0 { 0.1 } else { 0.35 });
        let joint = single_joint(i, JointKind::Revolute, origin, axes[i]);
        elbowroom_kinematics::Joint { limits: Limits::symmetric(2.0), ..joint }
    });
    let links = (0..4).map(|i| format!("link {i}")).collect();
    let mut robot = Robot::new(Chain::new("arm", links, joints.collect()).unwrap());
    for link in 1..4 {
        let in_link = Pose::from_translation(Vec3::Z * 0.3);
        robot.colliders[link].push(Collider {
            name: String::new(),
            shape: Shape::Sphere(Sphere { radius: RADIUS_M }),
            in_link,
        });
    }
    robot
}

/// Smallest gap between the arm's balls and points with a radius, m.
fn gap(chain: &Chain, q: &[f64], points: &[Vec3], radius: f64) -> f64 {
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(q);
    chain.forward(&mut state);
    let centres = [1, 2, 3].map(|l| state.link_in_root(LinkId(l)).transform_point(Vec3::Z * 0.3));
    let distances = points.iter().flat_map(|p| centres.map(|c| c.distance(*p)));
    distances.fold(f64::INFINITY, f64::min) - RADIUS_M - radius
}

#[test]
fn ten_thousand_points_are_where_they_are() {
    let (robot, mut random) = (arm(), Random(6));
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let mut counts = [0; 3];
    for radius in [0.0, 0.005, 0.02] {
        let points: Vec<Vec3> =
            (0..10_000).map(|_| random.vec3(1.2)).filter(|p| radius == 0.0 || p.x.hypot(p.y) > 0.45).collect();
        let mut set = ObstacleSet::default();
        let begin = std::time::Instant::now();
        assert_eq!((set.add_points(&points, radius), set.len()), (0, 1));
        let mut checker = ValidityChecker::new(&covered, &set);
        println!("{} points taken in within {:?}", points.len(), begin.elapsed());
        for _ in 0..400 {
            let q = random.q(&robot.chain);
            let gap = gap(&robot.chain, &q, &points, radius);
            // All solids are balls, so only rounding causes uncertain answers.
            let answer = checker.state(&q).unwrap();
            let expected = if gap > 0.0 { Validity::Free } else { Validity::Hit };
            assert!(answer == expected || gap.abs() < 1e-4, "{answer:?}, but the gap is {gap}");
            assert!(answer == expected || answer == Validity::Uncertain, "{answer:?}, but the gap is {gap}");
            counts[answer as usize] += 1;
            let to: Vec<f64> = q.iter().map(|v| v + 0.2).collect();
            if checker.edge_is_free(&q, &to).unwrap() {
                for i in 0..=40 {
                    let q: Vec<f64> = q.iter().map(|v| v + 0.2 * f64::from(i) / 40.0).collect();
                    assert!(self::gap(&robot.chain, &q, &points, radius) > 0.0);
                }
            }
        }
    }
    println!("free, hit, uncertain: {counts:?}");
    assert!(counts[0] > 50 && counts[1] > 50, "{counts:?}");
}

#[test]
fn a_point_without_numbers_makes_all_uncertain() {
    let covered = CoveredRobot::new(&arm(), Pose::IDENTITY).unwrap();
    for (point, radius) in [(Vec3::X * f64::NAN, 0.1), (Vec3::X * f64::INFINITY, 0.1), (Vec3::X * 9.0, f64::NAN)] {
        let mut set = ObstacleSet::default();
        set.add_points(&[Vec3::X * 9.0, point], radius);
        let mut checker = ValidityChecker::new(&covered, &set);
        assert_eq!(checker.state(&[0.0; 3]), Ok(Validity::Uncertain));
        assert_eq!(checker.edge_is_free(&[0.0; 3], &[0.1; 3]), Ok(false));
    }
    let mut set = ObstacleSet::default();
    set.add_points(&[], 0.1);
    assert_eq!(ValidityChecker::new(&covered, &set).state(&[0.0; 3]), Ok(Validity::Free));
}

#[test]
fn a_million_obstacles() {
    let (robot, mut random) = (arm(), Random(12));
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let mut set = ObstacleSet::default();
    // A shell outside the reach, and one separate ball in front.
    let points: Vec<Vec3> = (0..1_000_000)
        .map(|_| random.vec3(1.0).try_normalize().unwrap_or(Vec3::Z) * random.between(1.4, 3.0))
        .collect();
    for p in points {
        set.add_shape(&Shape::Sphere(Sphere { radius: 0.003 }), &Pose::from_translation(p), 0.0);
    }
    let in_front = Vec3::new(0.64, 0.0, 0.47);
    let last = set.add_shape(&Shape::Sphere(Sphere { radius: 0.1 }), &Pose::from_translation(in_front), 0.0);
    assert_eq!(set.len(), 1_000_001);
    let mut checker = ValidityChecker::new(&covered, &set);
    // Straight up, nothing is near. Towards the ball, the arm hits it, unless the pair is skipped.
    let forward = [0.0, 1.4, 0.3];
    assert_eq!(checker.state(&[0.0; 3]), Ok(Validity::Free));
    assert_eq!(checker.state(&forward), Ok(Validity::Hit));
    assert_eq!(checker.edge_is_free(&[0.0; 3], &forward), Ok(false));
    for body in 0..covered.covered_links().len() {
        checker.skip(CoveredLinkId(body), last);
    }
    assert_eq!(checker.state(&forward), Ok(Validity::Free));
    assert_eq!(checker.edge_is_free(&[0.0; 3], &forward), Ok(true));
}
