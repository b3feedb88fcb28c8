//! Chains that are hard for tables: parallel, intersecting and coincident axes, quarter and half turns, and nearly
//! such.

use std::f64::consts::{FRAC_PI_2, PI};

use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::{RandomGeometry, SplitMix};

/// Rotations that make axes parallel, opposite, perpendicular, nearly such, or arbitrary; including gimbal lock.
pub fn awkward_rotation(random: &mut SplitMix) -> Rotation {
    let tiny = [0.0, 1e-15, 1e-12, 1e-10, 1e-8, 3.7e-6, 1e-4, 2e-3][random.below(8)];
    let quarter = |random: &mut SplitMix| FRAC_PI_2 * random.below(4) as f64;
    match random.below(6) {
        0 => Rotation::IDENTITY,
        1 => Rotation::from_rpy(quarter(random), quarter(random), quarter(random)),
        2 => Rotation::from_rpy(quarter(random) + tiny, quarter(random) - tiny, quarter(random) + tiny),
        3 => Rotation::from_rpy(tiny, -tiny, random.between(-PI, PI)),
        4 => Rotation::from_rpy(
            random.between(-PI, PI),
            [FRAC_PI_2, -FRAC_PI_2][random.below(2)],
            random.between(-PI, PI),
        ),
        _ => random.pose().rotation,
    }
}

pub fn awkward_offset(random: &mut SplitMix) -> Vec3 {
    let v = random.vector();
    match random.below(5) {
        0 => Vec3::ZERO,
        1 => Vec3::new(0.0, 0.0, v.z),
        2 => Vec3::new(v.x, 0.0, 0.0),
        3 => Vec3::new(v.x * 1e-13, v.y * 1e-9, v.z),
        _ => v,
    }
}

pub fn awkward_chain(random: &mut SplitMix) -> Chain {
    let n = random.below(8);
    let axes = [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::Y, random.vector()];
    let mut joints: Vec<Joint> = (0..n)
        .map(|i| Joint {
            name: format!("j{i}"),
            kind: [
                JointKind::Revolute,
                JointKind::Revolute,
                JointKind::Prismatic,
                JointKind::Continuous,
                JointKind::Fixed,
            ][random.below(5)],
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin: Pose::new(awkward_rotation(random), awkward_offset(random)),
            axis: axes[random.below(5)],
            limits: Limits::symmetric(PI),
            mimic: None,
        })
        .collect();
    if n > 1 && joints[0].kind != JointKind::Fixed {
        joints[n - 1].mimic = Some(Mimic { joint: JointId(0), multiplier: -0.5, offset: 0.3 });
    }
    Chain::new("awkward", (0..=n).map(|i| format!("l{i}")).collect(), joints).unwrap()
}
