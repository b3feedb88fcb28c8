//! Suspected unit errors of a model.
//!
//! Sizes of solids are compared with the chain that carries them, joint offsets and strokes with the size of a workshop,
//! and limits of revolute joints with full turns. The JSON entry and the message have one source.

mod factor;
mod lengths;
mod limits;
mod suspect;

use elbowroom_formats::mesh::{self, MeshFormat};
use elbowroom_robot::Robot;
use elbowroom_spatial::Vec3;

pub use suspect::{SuspectQuantity, SuspectUnit, UnitLabel};

/// Lists suspected unit errors of a robot. A suspicion is a hint, not a proof.
///
/// ```
/// use elbowroom_inspect::suspect_units;
/// use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// use elbowroom_robot::Robot;
/// use elbowroom_spatial::{Pose, Vec3};
/// let joint = |limit: f64| Joint {
///     name: "j".into(),
///     kind: JointKind::Revolute,
///     parent: LinkId(0),
///     child: LinkId(1),
///     origin: Pose::IDENTITY,
///     axis: Vec3::Z,
///     limits: Limits::symmetric(limit),
///     mimic: None,
/// };
/// let arm = |limit| Chain::new("arm", vec!["a".into(), "b".into()], vec![joint(limit)]).map(Robot::new);
/// assert!(suspect_units(&arm(3.1)?).is_empty());
/// assert_eq!(suspect_units(&arm(180.0)?)[0].looks_like.symbol(), "deg");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn suspect_units(robot: &Robot) -> Vec<SuspectUnit> {
    let mut suspects = limits::suspects(&robot.chain);
    suspects.extend(lengths::suspects(robot));
    suspects
}

/// The suspected unit error of an object of a mesh file. `format` is the format of the file, if known.
///
/// Without a chain, only the size of the object is available, which cannot distinguish small units.
pub(super) fn of_mesh(object: &str, extent_m: Vec3, format: Option<MeshFormat>) -> Option<SuspectUnit> {
    if format.is_some_and(MeshFormat::states_its_unit) {
        return None;
    }
    mesh::unit_warning(extent_m)?;
    let extent_m = extent_m.max_element();
    let large = extent_m > 1.0;
    let reason = if large {
        format!(
            "`{object}` is {extent_m:.4} m large and its file states no unit: looks like mm (or cm, or in)\n  write: --unit mm"
        )
    } else {
        format!("`{object}` is only {extent_m:.1e} m large: looks like a unit applied twice\n  write: --unit m")
    };
    Some(SuspectUnit {
        of: SuspectQuantity::Meshes,
        link: Some(object.to_owned()),
        joint: None,
        extent_m: Some(extent_m),
        reference_m: None,
        looks_like: if large { UnitLabel::Millimetre } else { UnitLabel::AppliedTwice },
        read_as: if large { UnitLabel::Metre } else { UnitLabel::Millimetre },
        factor: if large { 1000.0 } else { 0.001 },
        reason,
    })
}
