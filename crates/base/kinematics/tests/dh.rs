//! Denavit-Hartenberg tables: their product equals the chain for any axes, and rows are classical if possible.
#![allow(clippy::print_stdout)]

use crate::common;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::awkward::{awkward_chain, awkward_offset, awkward_rotation};
use crate::common::{SplitMix, robots};
use elbowroom_kinematics::dh::{ClassicalRow, GeneralizedRow, GeneralizedTable};
use elbowroom_kinematics::{Chain, ChainState, JointKind, Limits, LinkId};
use elbowroom_spatial::Pose;

/// The oracle: the product of the rows, written out as 4×4 matrices.
fn product(rows: &[GeneralizedRow], mut value: impl FnMut(&str) -> f64) -> [[f64; 4]; 4] {
    type M = [[f64; 4]; 4];
    let times =
        |a: M, b: M| -> M { std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum())) };
    let unit: M = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    let rz = |t: f64| -> M {
        let (s, c) = t.sin_cos();
        [[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
    };
    let rx = |t: f64| -> M {
        let (s, c) = t.sin_cos();
        [[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0], [0.0, 0.0, 0.0, 1.0]]
    };
    let along = |i: usize, v: f64| -> M {
        let mut m = unit;
        m[i][3] = v;
        m
    };
    rows.iter().fold(unit, |at, row| {
        let q = row.joint.as_deref().map_or(0.0, &mut value);
        let (theta, d) = match row.kind {
            JointKind::Fixed => (row.theta, row.d),
            JointKind::Prismatic => (row.theta, row.d + q),
            _ => (row.theta + q, row.d),
        };
        [rz(theta), along(2, d), along(0, row.a), along(1, row.b), rx(row.alpha)].into_iter().fold(at, times)
    })
}

fn worst(chain: &Chain, table: &GeneralizedTable, tip: LinkId, random: &mut SplitMix, states: usize) -> f64 {
    let mut state = ChainState::new(chain);
    let mut worst: f64 = 0.0;
    for _ in 0..states {
        for v in &mut state.q {
            *v = random.between(-PI, PI);
        }
        chain.forward(&mut state);
        let got = product(&table.rows, |name| chain.joint_value(chain.joint(name).unwrap(), &state.q));
        let expected = state.link_in_root(tip).to_rows();
        for (g, e) in got.iter().take(3).flatten().zip(expected.iter().flatten()) {
            assert!(g.is_finite());
            worst = worst.max((g - e).abs());
        }
    }
    worst
}

#[test]
fn awkward_chains() {
    let mut random = SplitMix(42);
    let (mut largest, mut with_b, mut auxiliary) = (0.0_f64, 0, 0);
    for _ in 0..elbowroom_testkit::extent::amount(20_000, 100_000) {
        let chain = awkward_chain(&mut random);
        let table = GeneralizedTable::extract(&chain, chain.tip());
        let residual = worst(&chain, &table, chain.tip(), &mut random, 3);
        assert!(residual < 1e-9, "{residual} {table:#?} {:#?}", chain.joints());
        assert!(table.residual < 1e-9, "{}", table.residual);
        largest = largest.max(residual);
        with_b += table.rows.iter().filter(|r| r.b != 0.0).count();
        auxiliary += table.rows.iter().filter(|r| r.joint.is_none()).count();
        // The table has one row per moving joint, in order, with the joint's name.
        let names: Vec<_> = table.rows.iter().filter_map(|r| r.joint.clone()).collect();
        let moving = chain.path(chain.tip()).into_iter().map(|j| &chain.joints()[j.0]);
        let expected: Vec<_> = moving.filter(|j| j.kind != JointKind::Fixed).map(|j| j.name.clone()).collect();
        assert_eq!(names, expected);
        for row in &table.rows {
            assert!(row.a.abs() < 1e4 && row.d.abs() < 1e4, "no common normal a mile away: {row:?}");
        }
    }
    assert!(with_b > 0 && auxiliary > 0);
    println!("largest residual {largest:.1e}, {with_b} rows with b, {auxiliary} rows without joint");
}

/// If no axes are nearly parallel, b is needed only in the row that ends at the tip.
#[test]
fn classical_where_classical_suffices() {
    let mut random = SplitMix(1);
    for _ in 0..2000 {
        let n = 1 + random.below(7);
        let angle = |random: &mut SplitMix| [FRAC_PI_2, -FRAC_PI_2, 0.0, PI, random.between(0.1, 3.0)][random.below(5)];
        let rows: Vec<ClassicalRow> = (0..n)
            .map(|i| ClassicalRow {
                joint: format!("j{i}"),
                kind: if random.below(5) == 0 { JointKind::Prismatic } else { JointKind::Revolute },
                a: random.between(0.0, 1.0) * random.below(2) as f64,
                alpha: angle(&mut random),
                d: random.between(-1.0, 1.0) * random.below(2) as f64,
                theta: angle(&mut random),
                limits: Limits::symmetric(PI),
            })
            .collect();
        let chain = Chain::from_dh("classical", &rows).unwrap();
        let table = GeneralizedTable::extract(&chain, chain.tip());
        assert!(table.rows.iter().all(|r| r.b.abs() < 1e-9), "{rows:#?} {table:#?}");
        assert!(table.residual < 1e-12, "{}", table.residual);
        assert_eq!(table.rows.len(), n, "a row per joint and none beside: {rows:#?} {table:#?}");
    }
}

#[test]
fn a_chain_from_classical_rows_is_their_product() {
    let mut random = SplitMix(9);
    for _ in 0..500 {
        let rows: Vec<ClassicalRow> = (0..6)
            .map(|i| ClassicalRow {
                joint: format!("joint_{}", i + 1),
                kind: [JointKind::Revolute, JointKind::Prismatic, JointKind::Continuous][random.below(3)],
                a: random.between(-1.0, 1.0),
                alpha: random.between(-PI, PI),
                d: random.between(-1.0, 1.0),
                theta: random.between(-PI, PI),
                limits: Limits::symmetric(2.0),
            })
            .collect();
        let chain = Chain::from_dh("six", &rows).unwrap();
        assert_eq!(chain.dof(), 6);
        assert_eq!(chain.links()[chain.tip().0], "link_6");
        let given = GeneralizedTable { rows: rows.iter().map(GeneralizedRow::from).collect(), residual: 0.0 };
        assert!(worst(&chain, &given, chain.tip(), &mut random, 3) < 1e-13);
        // The frame of every row is a link, too.
        let middle = GeneralizedTable { rows: given.rows[..3].to_vec(), residual: 0.0 };
        assert!(worst(&chain, &middle, chain.link("link_3").unwrap(), &mut random, 3) < 1e-13);
    }
}

/// The Denavit-Hartenberg table of the KUKA KR125, with α = ±π/2 and offsets of θ: its lengths are recovered.
#[test]
fn the_table_of_a_known_robot_is_recovered() {
    let table = [
        (0.410, -FRAC_PI_2, 0.865, 0.0),
        (1.000, 0.0, 0.0, 0.0),
        (0.045, FRAC_PI_2, 0.0, -FRAC_PI_2),
        (0.0, -FRAC_PI_2, -1.000, 0.0),
        (0.0, FRAC_PI_2, 0.0, 0.0),
        (0.0, PI, -0.210, PI),
    ];
    let row = |(i, (a, alpha, d, theta)): (usize, (f64, f64, f64, f64))| ClassicalRow {
        joint: format!("a{}", i + 1),
        kind: JointKind::Revolute,
        a,
        alpha,
        d,
        theta,
        limits: Limits::symmetric(3.0),
    };
    let rows: Vec<_> = table.into_iter().enumerate().map(row).collect();
    let chain = Chain::from_dh("kr125", &rows).unwrap();
    let found = GeneralizedTable::extract(&chain, chain.tip());
    assert!(found.residual < 1e-14);
    assert_eq!(found.rows.len(), 6);
    for (found, given) in found.rows.iter().zip(&rows) {
        assert!((found.a - given.a).abs() < 1e-12 && (found.d.abs() - given.d.abs()).abs() < 1e-12, "{found:?}");
        assert!(found.b == 0.0 && (found.alpha.abs() - given.alpha.abs()).abs() < 1e-12, "{found:?} {given:?}");
    }
}

#[test]
fn tables_round_trip_to_chains() {
    let mut random = SplitMix(77);
    for _ in 0..500 {
        let chain = awkward_chain(&mut random);
        let table = GeneralizedTable::extract(&chain, chain.tip());
        let again = table.to_chain("again").unwrap();
        let (mut a, mut b) = (ChainState::new(&chain), ChainState::new(&again));
        for v in &mut a.q {
            *v = random.between(-PI, PI);
        }
        for (value, id) in b.q.iter_mut().zip(again.active_joints()) {
            *value = chain.joint_value(chain.joint(&again.joints()[id.0].name).unwrap(), &a.q);
        }
        chain.forward(&mut a);
        again.forward(&mut b);
        let (p, q) = (a.link_in_root(chain.tip()), b.link_in_root(again.tip()));
        assert!(p.translation.distance(q.translation) < 1e-9);
        assert!((p.rotation.inverse() * q.rotation).angle() < 1e-9);
    }
}

#[test]
fn a_point_on_a_surface_can_be_the_end_of_the_table() {
    let mut random = SplitMix(13);
    for _ in 0..500 {
        let chain = awkward_chain(&mut random);
        let tool_in_tip = Pose::new(awkward_rotation(&mut random), awkward_offset(&mut random));
        let table = GeneralizedTable::extract_to(&chain, chain.tip(), tool_in_tip);
        assert!(table.residual < 1e-9);
        let mut state = ChainState::new(&chain);
        for v in &mut state.q {
            *v = random.between(-PI, PI);
        }
        chain.forward(&mut state);
        let value = |name: &str| chain.joint_value(chain.joint(name).unwrap(), &state.q);
        let (got, expected) = (table.tip_in_root(value), state.link_in_root(chain.tip()) * tool_in_tip);
        assert!(got.translation.distance(expected.translation) < 1e-9);
        assert!((got.rotation.inverse() * expected.rotation).angle() < 1e-9);
    }
}

#[test]
fn every_real_robot_has_a_table() {
    for (name, path) in robots() {
        let chain = common::load(&path);
        let mut random = SplitMix(5);
        for tip in chain.leaves() {
            let table = GeneralizedTable::extract(&chain, tip);
            let residual = worst(&chain, &table, tip, &mut random, 200);
            assert!(residual < 1e-9 && table.residual < 1e-9, "{name} {residual}");
            if tip == chain.tip() {
                let b = table.rows.iter().filter(|r| r.b != 0.0).count();
                let without = table.rows.iter().filter(|r| r.joint.is_none()).count();
                println!(
                    "{name:<42} {:>2} rows, {without} without joint, {b} with b, residual {residual:.1e}",
                    table.rows.len()
                );
            }
        }
    }
}
