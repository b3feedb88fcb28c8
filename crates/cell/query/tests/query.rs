//! Results of `query` against brute force: every pair and every solid, at its pose.

use std::fmt::Write as _;

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{Shape, collides, separation};
use elbowroom_query::{BLOCK, Level, QueryKind, QueryRecord, QueryRow, QueryStates, evaluate};
use elbowroom_query::{MotionRecord, Query, QueryPairs, evaluate_motions};
use elbowroom_robot::RobotId;
use elbowroom_robot::collision_pairs;
use elbowroom_robot::{Collider, GeometryId};
use elbowroom_spatial::Pose;
use proptest::prelude::*;

/// Two arms of three joints with a tool, a table and a ball.
const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.left]
dh = [{ d = 300, alpha = 90, min = -180, max = 180, speed = 90 }, { a = 400, min = -90, max = 170, speed = 90 }, { a = 300, min = -150, max = 150, speed = 90 }]
links = [{ capsule = { from = [0, -200, 0], to = [0, 0, 0], radius = 70 } }, { box = { at = [-200, 0, 0], size = [400, 80, 100] } }, [{ cylinder = { from = [-280, 0, 0], to = [0, 0, 0], radius = 40 } }, { sphere = { at = [-150, 0, 0], radius = 60 } }]]
start = [0, 90, 0]
[robot.left.tool]
tcp = { at = [100, 0, 0] }
box = { at = [50, 0, 0], size = [100, 60, 60] }
[robot.right]
dh = [{ d = 300, alpha = 90, min = -180, max = 180, speed = 90 }, { a = 400, min = -90, max = 170, speed = 90 }]
links = [[], { capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 60 } }]
base = { at = [700, 100, 0], rpy = [0, 0, 180] }
start = [0, 90]
[object.table]
shape = "box"
at = [300, -500, 100]
size = [400, 300, 200]
[object.ball]
shape = "sphere"
at = [350, 350, 500]
radius = 90
"#;

/// Per pair the smallest distance of its solids; 0 if two of them collide.
fn naive(model: &QueryModel, q: &[Vec<f64>]) -> Vec<(GeometryId, GeometryId, f64)> {
    let robots: Vec<_> = model.robots.iter().map(|r| &r.robot).collect();
    let mut states: Vec<ChainState> = robots.iter().map(|r| ChainState::new(&r.chain)).collect();
    for ((state, robot), q) in states.iter_mut().zip(&robots).zip(q) {
        state.q.copy_from_slice(q);
        robot.chain.forward(state);
    }
    let solids = |m: GeometryId| -> Vec<(Shape, Pose)> {
        match m {
            GeometryId::Object(o) => vec![(model.objects[o.0].shape.clone(), model.objects[o.0].in_world)],
            GeometryId::Link { robot, link } => {
                let r = &model.robots[robot.0];
                let link_in_world = r.base_in_world * states[robot.0].link_in_root(link);
                let place = |b: &Collider| (b.shape.clone(), link_in_world * b.in_link);
                r.robot.colliders[link.0].iter().map(place).collect()
            }
        }
    };
    let least = |a: GeometryId, b: GeometryId| {
        let mut least = f64::INFINITY;
        for (shape_a, a_in_world) in solids(a) {
            for (shape_b, b_in_world) in solids(b) {
                if collides(&shape_a, &a_in_world, &shape_b, &b_in_world) {
                    return 0.0;
                }
                least = least.min(separation(&shape_a, &a_in_world, &shape_b, &b_in_world).distance);
            }
        }
        least
    };
    collision_pairs(&robots, model.objects.len()).into_iter().map(|(a, b)| (a, b, least(a, b))).collect()
}

fn rows(
    model: &QueryModel,
    states: &QueryStates,
    kind: QueryKind,
    level: Level,
    proofs: OutOfReachProofs,
) -> Vec<QueryRow> {
    let mut all = Vec::new();
    let scene = model.scene(proofs).unwrap();
    evaluate(&scene, states, kind, level, &mut |block| {
        all.extend_from_slice(block);
        true
    })
    .unwrap();
    all
}

fn csv(states: &[Vec<f64>]) -> String {
    let mut text = String::from("right.joint_2,left.joint_1,left.joint_3,right.joint_1,left.joint_2\n");
    for s in states {
        writeln!(text, "{:?},{:?},{:?},{:?},{:?}", s[4], s[0], s[2], s[3], s[1]).unwrap();
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn results_agree_with_a_test_of_all_pairs(
        values in prop::collection::vec(prop::collection::vec(-2.8..2.8_f64, 5), 1..24),
        tolerance in 0.0..0.3_f64,
    ) {
        let model = QueryModel::of_cell(&Cell::parse("c.toml", CELL).unwrap());
        let states = QueryStates::parse("s.csv".as_ref(), &csv(&values), &model).unwrap();
        prop_assert_eq!(states.len(), values.len());
        let proofs = if values.len() % 2 == 0 { OutOfReachProofs::Compute } else { OutOfReachProofs::Omit };
        let query = |a, l| rows(&model, &states, a, l, proofs);
        let distances = query(QueryKind::Distance, Level::Auto);
        let collisions = query(QueryKind::Collision, Level::Auto);
        let near = query(QueryKind::Tolerance(tolerance), Level::Auto);
        for (i, s) in values.iter().enumerate() {
            let q = [s[..3].to_vec(), s[3..].to_vec()];
            let all = naive(&model, &q);
            let least = all.iter().map(|p| p.2).fold(f64::INFINITY, f64::min);
            let (d, c, t) = (&distances[i], &collisions[i], &near[i]);
            prop_assert_eq!((d.index, c.index, t.index), (i, i, i));
            prop_assert!((d.distance_m.unwrap() - least).abs() < 1e-9, "{} {least}", d.distance_m.unwrap());
            prop_assert_eq!((d.collides, c.collides), (least <= 0.0, least <= 0.0));
            if (least - tolerance).abs() > 1e-9 {
                prop_assert_eq!(t.collides, least <= tolerance);
            }
            prop_assert_eq!(c.distance_m, c.collides.then_some(0.0));
            let of_pair = |row: &QueryRow| {
                let (a, b) = row.pair.unwrap();
                all.iter().find(|p| (p.0, p.1) == (a, b)).unwrap().2
            };
            prop_assert!((of_pair(d) - least).abs() < 1e-9, "the reported pair is the nearest");
            prop_assert!(!c.collides || of_pair(c) <= 0.0);
            if least > 0.0 {
                let (on_a, on_b) = d.witness.unwrap();
                prop_assert!((on_a.distance(on_b) - least).abs() < 1e-7);
            }
        }
        // Coarse levels are conservative.
        for level in [Level::L1, Level::L2, Level::Capsule, Level::Hull] {
            for (coarse, exact) in query(QueryKind::Distance, level).iter().zip(&distances) {
                prop_assert!(coarse.distance_m.unwrap() <= exact.distance_m.unwrap() + 1e-9, "{level}");
            }
            for (coarse, exact) in query(QueryKind::Collision, level).iter().zip(&collisions) {
                prop_assert!(coarse.collides || !exact.collides, "{level}");
            }
        }
        prop_assert_eq!(
            query(QueryKind::Distance, Level::L3).iter().map(|r| r.distance_m).collect::<Vec<_>>(),
            distances.iter().map(|r| r.distance_m).collect::<Vec<_>>()
        );
    }
}

#[test]
fn a_row_depends_only_on_its_block() {
    let model = QueryModel::of_cell(&Cell::parse("c.toml", CELL).unwrap());
    let spread = |i: usize, k: usize| ((i * 7919 + k * 104_729) % 5600) as f64 / 1000.0 - 2.8;
    let values: Vec<Vec<f64>> = (0..3 * BLOCK).map(|i| (0..5).map(|k| spread(i, k)).collect()).collect();
    let states = |v: &[Vec<f64>]| QueryStates::parse("s.csv".as_ref(), &csv(v), &model).unwrap();
    for kind in [QueryKind::Collision, QueryKind::Distance, QueryKind::Tolerance(0.1)] {
        let all = rows(&model, &states(&values), kind, Level::Auto, OutOfReachProofs::Compute);
        let third = rows(&model, &states(&values[2 * BLOCK..]), kind, Level::Auto, OutOfReachProofs::Compute);
        for (one, other) in all[2 * BLOCK..].iter().zip(&third) {
            assert_eq!(QueryRow { index: 0, ..*one }, QueryRow { index: 0, ..*other });
        }
        assert_eq!(all.iter().map(|r| r.index).collect::<Vec<_>>(), (0..3 * BLOCK).collect::<Vec<_>>());
    }
}

#[test]
fn evaluation_ends_where_the_receiver_stops() {
    let model = QueryModel::of_cell(&Cell::parse("c.toml", CELL).unwrap());
    let states = QueryStates::parse("s.csv".as_ref(), &csv(&vec![vec![0.5; 5]; 20 * BLOCK]), &model).unwrap();
    let mut blocks = 0;
    let scene = model.scene(OutOfReachProofs::Omit).unwrap();
    evaluate(&scene, &states, QueryKind::Collision, Level::Auto, &mut |_| {
        blocks += 1;
        blocks < 2
    })
    .unwrap();
    assert_eq!(blocks, 2);
}

#[test]
fn a_robot_without_columns_stays_at_its_start() {
    let model = QueryModel::of_cell(&Cell::parse("c.toml", CELL).unwrap());
    let text = "left.joint_2,left.joint_1,left.joint_3\n0.1,0.2,0.3\n";
    let states = QueryStates::parse("s.csv".as_ref(), text, &model).unwrap();
    let q: Vec<&[f64]> = states.of(0).map(|s| s.1).collect();
    assert_eq!(q[0], [0.2, 0.1, 0.3]);
    assert_eq!(q[1], model.robots[1].start);
    assert!(states.warnings[0].message.contains("robot `right`"));
    assert_eq!(
        QueryStates::start(&model).of(0).map(|s| s.1.to_vec()).collect::<Vec<_>>(),
        [model.robots[0].start.clone(), model.robots[1].start.clone()]
    );
}

#[test]
fn names_are_those_of_the_cell() {
    let model = QueryModel::of_cell(&Cell::parse("c.toml", CELL).unwrap());
    // The left arm is over the ball.
    let text = "left.joint_1,left.joint_2,left.joint_3\n0.785,0.35,0\n";
    let states = QueryStates::parse("s.csv".as_ref(), text, &model).unwrap();
    let row = rows(&model, &states, QueryKind::Collision, Level::Auto, OutOfReachProofs::Omit)[0];
    let written = QueryRecord::of(&row, &model);
    assert_eq!((written.pair.a.as_deref(), written.pair.b.as_deref()), (Some("left/link_3"), Some("ball")));
    let link = model.robots[0].robot.chain.link("link_3").unwrap();
    let geometry = GeometryId::Link { robot: RobotId(0), link };
    assert_eq!(model.geometry_name(geometry), "left/link_3");
    assert!(written.csv().starts_with("0,1,0.0,left/link_3,ball,"), "{}", written.csv());
}

/// Motions against dense samples of both sides of the first contact.
#[test]
fn motions_are_free_until_their_first_contact() {
    let cell = Cell::parse("cell.toml", CELL).unwrap();
    let model = QueryModel::of_cell(&cell);
    let mut text = String::from("left.joint_1,left.joint_2,left.joint_3,right.joint_1,right.joint_2\n");
    let mut random = elbowroom_testkit::random::Random(11);
    let mut all = Vec::new();
    for _ in 0..60 {
        let q: Vec<f64> = (0..5).map(|_| random.between(-1.5, 1.5)).collect();
        let _ = writeln!(text, "{}", q.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        all.push(q);
    }
    let states = QueryStates::parse("q.csv".as_ref(), &text, &model).unwrap();
    let scene = model.scene(OutOfReachProofs::Compute).unwrap();
    let (pairs, start) = (QueryPairs::all(), model.start_state(&scene).unwrap());
    let query = Query { is_timed: true, ..Query::new(QueryKind::Time, &pairs, &start) };
    let mut rows = Vec::new();
    let effort = evaluate_motions(&scene, &states, &query, &mut |block| {
        rows.extend_from_slice(block);
        true
    });
    assert_eq!((rows.len(), effort.unwrap().times_s.len()), (59, 59));
    let at = |index: usize, share: f64| -> f64 {
        let q: Vec<f64> = all[index].iter().zip(&all[index + 1]).map(|(a, b)| a + (b - a) * share).collect();
        let pairs = naive(&model, &[q[..3].to_vec(), q[3..].to_vec()]);
        pairs.iter().map(|p| p.2).fold(f64::INFINITY, f64::min)
    };
    let (mut hits, mut free) = (0, 0);
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row.index, index);
        let record = MotionRecord::of(row, &model);
        assert_eq!(record.csv().split(',').count(), MotionRecord::HEADER.split(',').count());
        assert_eq!((record.collides == 1, record.certain), (row.hit.is_some(), 1));
        // A motion that starts in contact has no free part.
        for n in 0..if record.free_share > 0.0 { 40 } else { 0 } {
            let share = record.free_share * f64::from(n) / 40.0;
            assert!(at(index, share) > 0.0, "motion {index} at {share}: {record:?}");
        }
        if row.hit.is_some() {
            assert!(at(index, record.free_share) <= 1.01e-4, "motion {index}: {record:?}");
            hits += 1;
        } else {
            assert!(record.free_share == 1.0 && at(index, 1.0) > 0.0);
            free += 1;
        }
    }
    assert!(hits > 5 && free > 5, "{hits} and {free}");
}
