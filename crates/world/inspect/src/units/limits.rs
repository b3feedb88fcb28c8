//! Unit errors of the limits of revolute joints: degrees instead of radians.

use elbowroom_kinematics::{Chain, Joint, JointKind};

use super::{SuspectQuantity, SuspectUnit, UnitLabel};

/// Limit above which a joint is suspect, rad: three turns. The widest ranges of real arms are two turns.
const WIDE_RAD: f64 = 6.0 * std::f64::consts::PI;

/// Suspects all wide joints if most joints are wide; otherwise the wide joints whose limits are round in degrees.
pub(super) fn suspects(chain: &Chain) -> Vec<SuspectUnit> {
    let bounded = |j: &&Joint| j.kind == JointKind::Revolute && j.mimic.is_none() && farthest(j).is_finite();
    let turning: Vec<&Joint> = chain.joints().iter().filter(bounded).collect();
    let wide: Vec<&Joint> = turning.iter().copied().filter(|j| farthest(j) > WIDE_RAD).collect();
    if 2 * wide.len() > turning.len() {
        let widest = wide.iter().map(|j| farthest(j)).fold(0.0, f64::max);
        let (count, all) = (wide.len(), turning.len());
        let joint = if let [only] = wide[..] { Some(only.name.clone()) } else { None };
        let what = format!("{count} of {all} joints have limits beyond three turns, up to {widest:.4} rad");
        return vec![suspect(joint, &what)];
    }
    let round = wide.into_iter().filter(|j| [j.limits.lower, j.limits.upper].into_iter().all(is_round));
    round
        .map(|j| {
            suspect(Some(j.name.clone()), &format!("the joint `{}` has limits up to {:.4} rad", j.name, farthest(j)))
        })
        .collect()
}

fn farthest(joint: &Joint) -> f64 {
    joint.limits.lower.abs().max(joint.limits.upper.abs())
}

/// True for a multiple of half a degree, if the value is in degrees.
fn is_round(limit: f64) -> bool {
    (2.0 * limit - (2.0 * limit).round()).abs() < 1e-9
}

fn suspect(joint: Option<String>, what: &str) -> SuspectUnit {
    let reason = format!(
        "{what}: the limits look like degrees (deg), read as radians\n  write: <limit lower=\"…\" upper=\"…\"/> in radians: \
         degrees times 0.0174533"
    );
    SuspectUnit {
        of: SuspectQuantity::Limits,
        link: None,
        joint,
        extent_m: None,
        reference_m: None,
        looks_like: UnitLabel::Degree,
        read_as: UnitLabel::Radian,
        factor: 180.0 / std::f64::consts::PI,
        reason,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_kinematics::{Limits, LinkId};
    use elbowroom_spatial::{Pose, Vec3};

    /// The number in the file divided by the factor is the intended number.
    #[test]
    fn the_factor_leads_from_degrees_to_radians() {
        let joint = Joint {
            name: "j".into(),
            kind: JointKind::Revolute,
            parent: LinkId(0),
            child: LinkId(1),
            origin: Pose::IDENTITY,
            axis: Vec3::Z,
            limits: Limits::symmetric(180.0),
            mimic: None,
        };
        let chain = Chain::new("arm", vec!["a".into(), "b".into()], vec![joint]).unwrap();
        let [suspect] = &suspects(&chain)[..] else { panic!("one joint") };
        assert!((180.0 / suspect.factor - std::f64::consts::PI).abs() < 1e-12, "{}", suspect.factor);
        assert!(suspect.reason.contains("times 0.0174533"), "{}", suspect.reason);
    }
}
