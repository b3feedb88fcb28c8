//! The same chain as direct and as modified Denavit-Hartenberg table, and as frames of Reichenbach and Kovačić 2003.
//!
//! Each product equals forward kinematics for any axes, and each form round-trips. `ELBOWROOM_LONG=1` tests 10⁵
//! chains.
#![allow(clippy::print_stdout)]

use crate::common;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::awkward::{awkward_chain, awkward_offset, awkward_rotation};
use crate::common::{SplitMix, robots};
use elbowroom_kinematics::dh::{
    ClassicalRow, DirectTable, GeneralizedRow, GeneralizedTable, ModifiedRow, ModifiedTable,
};
use elbowroom_kinematics::frames::{FrameAxis, FrameChain, JointMotion, LocalFrame};
use elbowroom_kinematics::{Chain, ChainError, ChainState, JointKind, Limits, LinkId};
use elbowroom_spatial::{Pose, Vec3};

type Matrix = [[f64; 4]; 4];

const UNIT: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn times(a: Matrix, b: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn along(i: usize, v: f64) -> Matrix {
    let mut m = UNIT;
    m[i][3] = v;
    m
}

/// A right-handed rotation about a coordinate axis.
fn about(axis: usize, t: f64) -> Matrix {
    let (s, c) = t.sin_cos();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = UNIT;
    (m[j][j], m[j][k], m[k][j], m[k][k]) = (c, -s, s, c);
    m
}

/// A rotation about any unit vector, by Rodrigues' formula.
fn about_vector(u: Vec3, t: f64) -> Matrix {
    let (s, c) = t.sin_cos();
    let cross = [[0.0, -u.z, u.y], [u.z, 0.0, -u.x], [-u.y, u.x, 0.0]];
    let mut m = UNIT;
    for i in 0..3 {
        for j in 0..3 {
            m[i][j] = c * UNIT[i][j] + s * cross[i][j] + (1.0 - c) * u[i] * u[j];
        }
    }
    m
}

/// The parts of a joint value that are added to an angle and to a length.
fn shares(kind: JointKind, q: f64) -> (f64, f64) {
    match kind {
        JointKind::Fixed => (0.0, 0.0),
        JointKind::Prismatic => (0.0, q),
        _ => (q, 0.0),
    }
}

/// The product of the rows, as 4×4 matrices.
fn generalized(rows: &[GeneralizedRow], value: &dyn Fn(&str) -> f64) -> Matrix {
    rows.iter().fold(UNIT, |at, r| {
        let (turn, slide) = shares(r.kind, r.joint.as_deref().map_or(0.0, value));
        [about(2, r.theta + turn), along(2, r.d + slide), along(0, r.a), along(1, r.b), about(0, r.alpha)]
            .into_iter()
            .fold(at, times)
    })
}

/// The product of Craig's rows, as 4×4 matrices.
fn modified(rows: &[ModifiedRow], value: &dyn Fn(&str) -> f64) -> Matrix {
    rows.iter().fold(UNIT, |at, r| {
        let (turn, slide) = shares(r.kind, r.joint.as_deref().map_or(0.0, value));
        [about(0, r.alpha), along(0, r.a), about(2, r.theta + turn), along(2, r.d + slide)].into_iter().fold(at, times)
    })
}

/// Equations 1 to 4 of Reichenbach and Kovačić 2003, as 4×4 matrices.
fn paper(frames: &[LocalFrame], value: &dyn Fn(&str) -> f64) -> Matrix {
    frames.iter().fold(UNIT, |at, frame| {
        let center = (0..3).map(|i| along(i, frame.centre[i])).fold(UNIT, times);
        let rotation = about_vector(frame.axis / frame.axis.length(), frame.angle);
        let fixed = times(times(at, center), rotation);
        let Some(motion) = &frame.motion else {
            return fixed;
        };
        let q = value(&motion.joint);
        let d = motion.displacement(q);
        assert!([d.alpha, d.beta, d.gamma, d.c.x, d.c.y, d.c.z].iter().filter(|v| **v != 0.0).count() <= 1);
        let c = (0..3).map(|i| along(i, d.c[i])).fold(UNIT, times);
        [c, about(2, d.alpha), about(1, d.beta), about(0, d.gamma)].into_iter().fold(fixed, times)
    })
}

fn difference(m: &Matrix, pose: Pose) -> f64 {
    let pairs = m.iter().take(3).flatten().zip(pose.to_rows().into_iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, |w, d| if d > w || d.is_nan() { d } else { w })
}

fn short(worst: [f64; 4]) -> String {
    worst.map(|w| format!("{w:.1e}")).join(" ")
}

/// All forms of the transform to one tip.
struct Forms {
    generalized: GeneralizedTable,
    direct: DirectTable,
    modified: ModifiedTable,
    frames: FrameChain,
    tool_in_tip: Pose,
}

impl Forms {
    fn of(chain: &Chain, tip: LinkId, tool_in_tip: Pose) -> Self {
        Self {
            generalized: GeneralizedTable::extract_to(chain, tip, tool_in_tip),
            direct: DirectTable::extract_to(chain, tip, tool_in_tip),
            modified: ModifiedTable::extract_to(chain, tip, tool_in_tip),
            frames: FrameChain::extract(chain, tip),
            tool_in_tip,
        }
    }

    /// Largest difference from forward kinematics: generalized, direct, modified, frames.
    fn worst(&self, chain: &Chain, tip: LinkId, random: &mut SplitMix, states: usize) -> [f64; 4] {
        let mut state = ChainState::new(chain);
        let mut worst = [0.0_f64; 4];
        for _ in 0..states {
            state.q.iter_mut().for_each(|v| *v = random.between(-PI, PI));
            chain.forward(&mut state);
            let value = |name: &str| chain.joint_value(chain.joint(name).unwrap(), &state.q);
            let tip_in_root = state.link_in_root(tip);
            let expected = tip_in_root * self.tool_in_tip;
            let found = [
                difference(&generalized(&self.generalized.rows, &value), expected),
                difference(&generalized(&self.direct.table.rows, &value), expected),
                difference(&modified(&self.modified.rows, &value), expected),
                difference(&paper(&self.frames.frames, &value), tip_in_root),
            ];
            // The products computed by the crate.
            let theirs = [self.direct.table.tip_in_root(value), self.modified.tip_in_root(value)];
            assert!(theirs.iter().all(|t| t.translation.distance(expected.translation) < 1e-9));
            assert!(self.frames.tip_in_root(value).translation.distance(tip_in_root.translation) < 1e-12);
            for (w, f) in worst.iter_mut().zip(found) {
                *w = if f.is_nan() { f } else { w.max(f) };
            }
        }
        worst
    }

    fn check_shape(&self, chain: &Chain, tip: LinkId) {
        assert_eq!(self.direct.frames.len(), self.direct.table.rows.len());
        let given = self.direct.frames.iter().filter(|n| !n.ends_with('*')).count();
        let path = chain.path(tip).len();
        assert!(given == path + 1 || given == path + 2, "{given} frames of {path} joints");
        let moving = chain.path(tip).into_iter().map(|j| &chain.joints()[j.0]).filter(|j| j.kind.moves());
        let names: Vec<&str> = moving.map(|j| j.name.as_str()).collect();
        let of = |joints: Vec<Option<&str>>| joints.into_iter().flatten().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(of(self.direct.table.rows.iter().map(|r| r.joint.as_deref()).collect()), names);
        assert_eq!(of(self.modified.rows.iter().map(|r| r.joint.as_deref()).collect()), names);
        for row in &self.direct.table.rows {
            assert!(row.a.abs() < 1e4 && row.d.abs() < 1e4, "no common normal a mile away: {row:?}");
        }
        for row in &self.modified.rows {
            assert!(row.a.abs() < 1e4 && row.d.abs() < 1e4, "no common normal a mile away: {row:?}");
        }
    }
}

fn chains(usual: usize) -> usize {
    elbowroom_testkit::extent::amount(usual, 100_000)
}

#[test]
fn awkward_chains_in_all_forms() {
    let mut random = SplitMix(2026);
    let (mut largest, mut auxiliary, mut with_b) = ([0.0_f64; 4], 0, 0);
    let count = chains(3000);
    for _ in 0..count {
        let chain = awkward_chain(&mut random);
        let tip = LinkId(random.below(chain.links().len()));
        let tool = if random.below(2) == 0 {
            Pose::IDENTITY
        } else {
            Pose::new(awkward_rotation(&mut random), awkward_offset(&mut random))
        };
        let forms = Forms::of(&chain, tip, tool);
        forms.check_shape(&chain, tip);
        let worst = forms.worst(&chain, tip, &mut random, 3);
        assert!(worst[..3].iter().all(|w| *w < 1e-9), "{worst:?} {:#?} {:#?}", forms.direct, chain.joints());
        assert!(worst[3] < 1e-12, "{worst:?} {:#?} {:#?}", forms.frames, chain.joints());
        assert!(forms.direct.table.residual < 1e-9 && forms.modified.residual < 1e-9);
        for (l, w) in largest.iter_mut().zip(worst) {
            *l = l.max(w);
        }
        auxiliary += forms.direct.frames.iter().filter(|n| n.ends_with('*')).count();
        with_b += forms.direct.table.rows.iter().filter(|r| r.b != 0.0).count();
    }
    assert!(auxiliary > 0 && with_b > 0);
    let [g, d, m, f] = largest;
    println!("{count} chains: generalized {g:.1e}, direct {d:.1e}, modified {m:.1e}, frames {f:.1e}");
    println!("direct: {auxiliary} auxiliary frames, {with_b} rows with b");
}

/// Converts rows of every convention to a chain, and the chain to rows of every convention: the product is always
/// the same.
#[test]
fn tables_to_chains_to_tables() {
    let mut random = SplitMix(5);
    for _ in 0..chains(1500) {
        let n = 1 + random.below(7);
        let angle = |random: &mut SplitMix| [0.0, FRAC_PI_2, -FRAC_PI_2, PI, random.between(-PI, PI)][random.below(5)];
        let length = |random: &mut SplitMix| random.between(-1.0, 1.0) * random.below(2) as f64;
        let kinds = [JointKind::Revolute, JointKind::Prismatic, JointKind::Continuous, JointKind::Fixed];
        let row = |i: usize, random: &mut SplitMix| {
            let kind = kinds[random.below(4)];
            let joint = (kind != JointKind::Fixed).then(|| format!("j{i}"));
            let [alpha, theta] = [0, 1].map(|_| angle(random));
            let [a, b, d] = [0, 1, 2].map(|_| length(random));
            GeneralizedRow { joint, kind, alpha, a, b, theta, d }
        };
        let rows: Vec<GeneralizedRow> = (0..n).map(|i| row(i, &mut random)).collect();
        let q: Vec<f64> = (0..n).map(|_| random.between(-PI, PI)).collect();
        let value = |name: &str| q[name[1..].parse::<usize>().unwrap()];

        let given = GeneralizedTable { rows: rows.clone(), residual: 0.0 };
        let product = generalized(&rows, &value);
        check_round(&given.to_chain("given").unwrap(), &product, &value);
        // The factors are the same, regrouped.
        let craig = ModifiedTable::from(&given);
        assert!(same(&product, &modified(&craig.rows, &value)) < 1e-14);
        assert!(same(&product, &generalized(&GeneralizedTable::from(&craig).rows, &value)) < 1e-14);

        let turned: Vec<ModifiedRow> = rows
            .iter()
            .map(|r| ModifiedRow {
                joint: r.joint.clone(),
                kind: r.kind,
                alpha: r.alpha,
                a: r.a,
                theta: r.theta,
                d: r.d,
            })
            .collect();
        let craig = ModifiedTable { rows: turned, residual: 0.0 };
        check_round(&craig.to_chain("craig").unwrap(), &modified(&craig.rows, &value), &value);
    }
}

fn same(a: &Matrix, b: &Matrix) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Checks that the chain equals the product, and so does everything that is extracted from it and converted to a
/// chain again.
fn check_round(chain: &Chain, product: &Matrix, value: &dyn Fn(&str) -> f64) {
    assert!(difference(product, tip_at(chain, value)) < 1e-12);
    let (generalized, modified) =
        (GeneralizedTable::extract(chain, chain.tip()), ModifiedTable::extract(chain, chain.tip()));
    let (direct, frames) = (DirectTable::extract(chain, chain.tip()), FrameChain::extract(chain, chain.tip()));
    for again in [
        generalized.to_chain("generalized").unwrap(),
        modified.to_chain("modified").unwrap(),
        direct.table.to_chain("direct").unwrap(),
        frames.to_chain("frames").unwrap(),
    ] {
        let worst = difference(product, tip_at(&again, value));
        assert!(worst < if again.name() == "frames" { 1e-12 } else { 1e-9 }, "{} {worst}", again.name());
    }
}

/// The pose of the last link.
fn tip_at(chain: &Chain, value: &dyn Fn(&str) -> f64) -> Pose {
    let mut state = ChainState::new(chain);
    for (v, id) in state.q.iter_mut().zip(chain.active_joints()) {
        *v = value(&chain.joints()[id.0].name);
    }
    chain.forward(&mut state);
    state.link_in_root(LinkId(chain.links().len() - 1))
}

#[test]
fn every_real_robot_in_all_forms() {
    let mut largest = [0.0_f64; 4];
    for (name, path) in robots() {
        let chain = common::load(&path);
        let mut random = SplitMix(11);
        for tip in chain.leaves() {
            let forms = Forms::of(&chain, tip, Pose::IDENTITY);
            forms.check_shape(&chain, tip);
            let worst = forms.worst(&chain, tip, &mut random, 100);
            assert!(worst[..3].iter().all(|w| *w < 1e-9) && worst[3] < 1e-12, "{name} {worst:?}");
            let limits = |chain: &Chain| (chain.lower(), chain.upper());
            let again = forms.frames.to_chain("again").unwrap();
            if chain.joints().iter().all(|j| j.mimic.is_none()) && chain.leaves().len() == 1 {
                assert_eq!(limits(&again), limits(&chain));
            }
            for (l, w) in largest.iter_mut().zip(worst) {
                *l = l.max(w);
            }
            if tip == chain.tip() {
                let auxiliary = forms.direct.frames.iter().filter(|n| n.ends_with('*')).count();
                let rows = (forms.generalized.rows.len(), forms.direct.frames.len(), forms.modified.rows.len());
                println!("{name:<42} rows {rows:?}, {auxiliary} auxiliary, worst {}", short(worst));
            }
        }
    }
    println!("worst of all: generalized, direct, modified, frames {}", short(largest));
}

/// A model with the axes and dimensions of a KR150: base, six joints, and a flange.
fn kr150() -> Chain {
    use elbowroom_kinematics::Joint;
    let axes = [-Vec3::Z, Vec3::Y, Vec3::Y, -Vec3::X, Vec3::Y, -Vec3::X];
    let offsets = [(0.0, 0.75), (0.35, 0.0), (1.25, 0.0), (0.0, -0.055), (1.1, 0.0), (0.23, 0.0)];
    let joints = axes.into_iter().zip(offsets).enumerate().map(|(i, (axis, (x, z)))| Joint {
        name: format!("joint_a{}", i + 1),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin: Pose::from_translation(Vec3::new(x, 0.0, z)),
        axis,
        limits: Limits::symmetric(3.0),
        mimic: None,
    });
    let links = ["base_link", "link_1", "link_2", "link_3", "link_4", "link_5", "link_6"].map(String::from);
    Chain::new("kr150", links.to_vec(), joints.collect()).unwrap()
}

/// Seven local frames, the base and six joints, are seven rows a, b, d, α, θ; the part that the last joint carries
/// follows.
#[test]
fn the_kr150_has_the_shape_of_table_1_of_s4() {
    let mut models = vec![("dimensions", kr150())];
    models.extend(common::robot("kuka_kr150_2").map(|chain| ("kuka_kr150_2", chain)));
    let mut shown = Vec::new();
    for (name, chain) in models {
        let direct = DirectTable::extract(&chain, chain.link("link_6").unwrap());
        println!("{name}, residual {:.1e}\n{direct}\n", direct.table.residual);
        shown.push(direct.to_string());
        let expected = ["base_link", "joint_a1", "joint_a2", "joint_a3", "joint_a4", "joint_a5", "joint_a6"];
        assert_eq!(direct.frames[..7], expected);
        // One row cannot describe the rotation between the link's own frame and its axis.
        assert_eq!(direct.frames[7..], ["link_6*", "link_6"]);
        assert!(direct.table.residual < 1e-12);
        let seven = &direct.table.rows[..7];
        // The first row is the base, all zeros, as in the paper; the second is the height of axis 1.
        let r = &seven[0];
        assert_eq!((r.a, r.b, r.d, r.alpha, r.theta), (0.0, 0.0, 0.0, 0.0, 0.0));
        assert!((seven[1].d - 0.75).abs() < 1e-12 && seven[1].a == 0.0 && seven[1].b == 0.0);
        // The lengths are the robot's, in any of a, b and d.
        for (row, length) in seven[1..].iter().zip([0.75, 0.35, 1.25, 0.055, 1.1, 0.23]) {
            assert!((Vec3::new(row.a, row.b, row.d).length() - length).abs() < 1e-12, "{row:?} {length}");
            let quarters = row.alpha / FRAC_PI_2;
            assert!((quarters - quarters.round()).abs() < 1e-12);
        }
        let joints: Vec<_> = seven.iter().filter_map(|r| r.joint.as_deref()).collect();
        assert_eq!(joints, ["joint_a1", "joint_a2", "joint_a3", "joint_a4", "joint_a5"]);
        assert_eq!(direct.table.rows[7].joint.as_deref(), Some("joint_a6"));
        // The paper's equations have seven frames, too.
        assert_eq!(FrameChain::extract(&chain, chain.link("link_6").unwrap()).frames.len(), 7);
    }
    assert!(shown.iter().all(|s| *s == shown[0]), "the same robot, the same table, whatever the file's rounding");
}

/// Craig's table of the PUMA 560 (1986, figure 3.21), with its lengths: α 0, −90, 0, −90, 90, −90.
#[test]
fn the_modified_table_of_a_known_robot_is_recovered() {
    let (a2, a3, d3, d4) = (0.4318, 0.0203, 0.1244, 0.4318);
    let table = [
        (0.0, 0.0, 0.0),
        (-FRAC_PI_2, 0.0, 0.0),
        (0.0, a2, d3),
        (-FRAC_PI_2, a3, d4),
        (FRAC_PI_2, 0.0, 0.0),
        (-FRAC_PI_2, 0.0, 0.0),
    ];
    let row = |(i, (alpha, a, d)): (usize, (f64, f64, f64))| ModifiedRow {
        joint: Some(format!("joint_{}", i + 1)),
        kind: JointKind::Revolute,
        alpha,
        a,
        theta: 0.0,
        d,
    };
    let given = ModifiedTable { rows: table.into_iter().enumerate().map(row).collect(), residual: 0.0 };
    let chain = given.to_chain("puma").unwrap();
    let found = ModifiedTable::extract(&chain, chain.tip());
    assert!(found.residual < 1e-14);
    assert_eq!(found.rows.len(), 6, "{found:#?}");
    for (f, g) in found.rows.iter().zip(&given.rows) {
        assert_eq!(f.joint, g.joint);
        assert!((f.a - g.a).abs() < 1e-12 && (f.d.abs() - g.d).abs() < 1e-12, "{f:?} {g:?}");
        assert!((f.alpha.abs() - g.alpha.abs()).abs() < 1e-12, "{f:?} {g:?}");
    }
    // The same robot in classical rows gives the same lengths.
    let classical: Vec<ClassicalRow> = (0..6)
        .map(|i| {
            let (alpha, a, _) = if i < 5 { table[i + 1] } else { (0.0, 0.0, 0.0) };
            let joint = format!("joint_{}", i + 1);
            let limits = Limits::symmetric(PI);
            ClassicalRow { joint, kind: JointKind::Revolute, a, alpha, d: table[i].2, theta: 0.0, limits }
        })
        .collect();
    let same = Chain::from_dh("puma", &classical).unwrap();
    assert!(difference(&modified(&given.rows, &|_| 0.3), tip_at(&same, &|_| 0.3)) < 1e-14);
}

#[test]
fn frames_of_a_model_make_a_chain_or_an_error() {
    let motion = |along, reversed| JointMotion {
        joint: "a1".into(),
        kind: JointKind::Revolute,
        along,
        reversed,
        limits: Limits::symmetric(2.0),
    };
    let turning = LocalFrame {
        axis: Vec3::new(0.0, 0.0, 2.0),
        angle: FRAC_PI_2,
        motion: Some(motion(FrameAxis::Y, true)),
        ..LocalFrame::fixed("arm", Vec3::Z)
    };
    let arm = FrameChain { frames: vec![turning.clone(), LocalFrame::fixed("hand", Vec3::X)] };
    let chain = arm.to_chain("arm").unwrap();
    assert_eq!(chain.links(), ["global", "arm", "hand"]);
    assert_eq!(chain.upper(), [2.0]);
    // Rotated by 90° about z, then by −0.5 about the new y: the hand at x = 1 rises by sin 0.5.
    let hand = arm.tip_in_root(|_| 0.5).translation;
    assert!(hand.distance(Vec3::new(0.0, 0.5_f64.cos(), 1.0 + 0.5_f64.sin())) < 1e-15);
    assert!(tip_at(&chain, &|_| 0.5).translation.distance(hand) < 1e-15);

    let lost = LocalFrame { axis: Vec3::ZERO, ..turning.clone() };
    assert!(lost.transform(0.0).rotation.rows()[0][0].is_nan());
    let made = FrameChain { frames: vec![lost] }.to_chain("lost");
    assert!(matches!(made, Err(ChainError::BadAxis { .. })), "{made:?}");
    let spoiled =
        FrameChain { frames: vec![LocalFrame { centre: Vec3::splat(f64::NAN), ..turning }] }.to_chain("spoiled");
    assert!(matches!(spoiled, Err(ChainError::BadOrigin { .. })), "{spoiled:?}");
}
