//! All errors of links and joints that do not form a chain, with their messages.

use elbowroom_kinematics::{Chain, ChainError, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_spatial::{Pose, Vec3};

fn joint(name: &str, parent: usize, child: usize) -> Joint {
    Joint {
        name: name.into(),
        kind: JointKind::Revolute,
        parent: LinkId(parent),
        child: LinkId(child),
        origin: Pose::from_translation(Vec3::Z),
        axis: Vec3::Z,
        limits: Limits::symmetric(1.0),
        mimic: None,
    }
}

#[allow(clippy::unnecessary_wraps)] // as the field wants it
fn mimic(of: usize, multiplier: f64, offset: f64) -> Option<Mimic> {
    Some(Mimic { joint: JointId(of), multiplier, offset })
}

fn build(links: &[&str], joints: Vec<Joint>) -> Result<Chain, ChainError> {
    Chain::new("test", links.iter().map(|&l| l.to_owned()).collect(), joints)
}

fn message(links: &[&str], joints: Vec<Joint>) -> String {
    build(links, joints).unwrap_err().to_string()
}

#[test]
fn no_links_and_one_link() {
    assert_eq!(build(&[], vec![]).unwrap_err(), ChainError::NoLinks);
    let lone = build(&["only"], vec![]).unwrap();
    assert_eq!((lone.dof(), lone.tip(), lone.root()), (0, LinkId(0), LinkId(0)));
    assert!(lone.path(LinkId(0)).is_empty());
}

#[test]
fn names_used_twice() {
    assert!(message(&["a", "b", "a"], vec![]).contains("`a`"));
    assert!(message(&["a", "b", "c"], vec![joint("j", 0, 1), joint("j", 1, 2)]).contains("`j`"));
}

#[test]
fn two_roots_are_both_named() {
    let e = build(&["a", "b", "c"], vec![joint("j", 0, 1)]).unwrap_err();
    assert_eq!(e, ChainError::ManyRoots { roots: vec!["a".into(), "c".into()] });
}

#[test]
fn cycles_with_and_without_a_root() {
    let all = vec![joint("x", 0, 1), joint("y", 1, 0)];
    assert!(matches!(build(&["a", "b"], all), Err(ChainError::Cycle { .. })));
    let beside = vec![joint("x", 1, 2), joint("y", 2, 1)];
    assert!(matches!(build(&["a", "b", "c"], beside), Err(ChainError::Cycle { .. })));
    assert!(matches!(build(&["a", "b"], vec![joint("self", 1, 1)]), Err(ChainError::Cycle { .. })));
}

#[test]
fn two_parents_and_unknown_links() {
    let text = message(&["a", "b", "c"], vec![joint("x", 0, 2), joint("y", 1, 2)]);
    assert!(text.contains("`c`") && text.contains("`x`") && text.contains("`y`"), "{text}");
    let text = message(&["a", "b"], vec![joint("x", 0, 7)]);
    assert!(text.contains("link 7") && text.contains("child") && text.contains("0 to 1"), "{text}");
    assert!(message(&["a", "b"], vec![joint("x", 9, 1)]).contains("parent"));
}

#[test]
fn axes_origins_and_limits_must_be_valid() {
    for axis in [Vec3::ZERO, Vec3::new(f64::NAN, 0.0, 1.0), Vec3::new(f64::INFINITY, 0.0, 0.0)] {
        let bad = Joint { axis, ..joint("x", 0, 1) };
        assert!(matches!(build(&["a", "b"], vec![bad]), Err(ChainError::BadAxis { .. })), "{axis:?}");
        let fixed = Joint { axis, kind: JointKind::Fixed, ..joint("x", 0, 1) };
        assert!(build(&["a", "b"], vec![fixed]).is_ok(), "files write 0 0 0 on fixed joints");
    }
    let bad = Joint { origin: Pose::from_translation(Vec3::splat(f64::NAN)), ..joint("x", 0, 1) };
    assert!(matches!(build(&["a", "b"], vec![bad]), Err(ChainError::BadOrigin { .. })));
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    for (lower, upper) in [(1.0, -1.0), (nan, 1.0), (0.0, nan), (inf, inf), (-inf, -inf)] {
        let bad = Joint { limits: Limits::range(lower, upper), ..joint("x", 0, 1) };
        assert!(matches!(build(&["a", "b"], vec![bad]), Err(ChainError::BadLimits { .. })), "{lower} {upper}");
    }
    let locked = Joint { limits: Limits::range(0.0, 0.0), ..joint("x", 0, 1) };
    assert!(build(&["a", "b"], vec![locked]).is_ok());
    let endless = Joint { kind: JointKind::Continuous, limits: Limits::range(0.0, 0.0), ..joint("x", 0, 1) };
    assert_eq!(build(&["a", "b"], vec![endless]).unwrap().upper(), [inf]);
}

#[test]
fn mimics_of_nothing_of_fixed_joints_and_of_each_other() {
    let links = ["a", "b", "c", "d"];
    let with = |m: [Option<Mimic>; 3]| -> Vec<Joint> {
        m.into_iter().enumerate().map(|(i, mimic)| Joint { mimic, ..joint(&format!("j{i}"), i, i + 1) }).collect()
    };
    assert!(matches!(build(&links, with([mimic(9, 1.0, 0.0), None, None])), Err(ChainError::UnknownMimic { .. })));
    assert!(matches!(build(&links, with([mimic(0, 1.0, 0.0), None, None])), Err(ChainError::MimicCycle { .. })));
    let ring = with([mimic(1, 1.0, 0.0), mimic(2, 1.0, 0.0), mimic(0, 1.0, 0.0)]);
    assert!(matches!(build(&links, ring), Err(ChainError::MimicCycle { .. })));
    // The mimic leads into a cycle without being part of it.
    let lasso = with([mimic(1, 1.0, 0.0), mimic(2, 1.0, 0.0), mimic(1, 1.0, 0.0)]);
    assert!(matches!(build(&links, lasso), Err(ChainError::MimicCycle { .. })));
    assert!(matches!(build(&links, with([None, mimic(0, f64::NAN, 0.0), None])), Err(ChainError::BadMimic { .. })));
    let mut onto_fixed = with([None, mimic(0, 1.0, 0.0), None]);
    onto_fixed[0].kind = JointKind::Fixed;
    assert!(matches!(build(&links, onto_fixed), Err(ChainError::MimicOfFixed { .. })));
}

#[test]
fn a_mimic_of_a_mimic_follows_the_independent_joint() {
    let joints = vec![
        Joint { mimic: mimic(1, 2.0, 0.1), ..joint("follower", 1, 2) },
        Joint { mimic: mimic(2, -3.0, 0.2), ..joint("middle", 2, 3) },
        joint("free", 0, 1),
    ];
    let chain = build(&["a", "b", "c", "d"], joints).unwrap();
    assert_eq!((chain.dof(), chain.active_joints()), (1, &[JointId(2)][..]));
    let source = chain.mimic_source(JointId(0)).unwrap();
    assert_eq!((source.joint, source.multiplier), (JointId(2), -6.0));
    assert!((source.offset - 0.5).abs() < 1e-15); // 2·0.2 + 0.1
    assert!((chain.joint_value(JointId(0), &[0.4]) - (2.0 * (-3.0 * 0.4 + 0.2) + 0.1)).abs() < 1e-15);
    assert_eq!(chain.mimic_source(JointId(2)), None);
    assert!(chain.joint_value(JointId(0), &[]).is_nan());
}

#[test]
fn the_tip_is_the_leaf_with_most_joints_that_are_no_mimics() {
    // root ─ a ─ b(mimic) ─ c(mimic)   and   root ─ d ─ e: the shorter branch has more non-mimic joints.
    let joints = vec![
        joint("a", 0, 1),
        Joint { mimic: mimic(0, 1.0, 0.0), ..joint("b", 1, 2) },
        Joint { mimic: mimic(0, 1.0, 0.0), ..joint("c", 2, 3) },
        joint("d", 0, 4),
        joint("e", 4, 5),
    ];
    let chain = build(&["root", "la", "lb", "lc", "ld", "le"], joints).unwrap();
    assert_eq!(chain.tip(), chain.link("le").unwrap());
    assert_eq!(chain.leaves(), [LinkId(3), LinkId(5)]);
    assert_eq!(chain.path(LinkId(5)), [JointId(3), JointId(4)]);
    assert_eq!((chain.q_index(JointId(3)), chain.q_index(JointId(1))), (Some(1), None));
}
