//! Units suspected wrong: solids against the chain that carries them, joints and strokes against a workshop, limits against
//! turns. One decision gives the entry in the JSON and the sentence for people.

mod factor;
mod lengths;
mod limits;

use elbowroom_formats::mesh::{self, Format};
use elbowroom_scene::Robot;
use elbowroom_spatial::Vec3;
use serde::Serialize;

/// A doubt about a unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitDoubt {
    /// What is in doubt: `meshes`, `joints` (their origins), `stroke` or `limits`.
    pub of: &'static str,
    /// The link, or the object of a mesh file; null where all of the model is meant.
    pub link: Option<String>,
    /// The joint; null where all are meant, or none.
    pub joint: Option<String>,
    /// Largest edge of the box of the link, or of the largest solid, as read, m; null for joints.
    pub extent_m: Option<f64>,
    /// What it was compared with, m: the longest way through the chain; null for a mesh file and for limits.
    pub reference_m: Option<f64>,
    /// The unit that the numbers look like: `mm`, `cm`, `in` or `deg`; `applied twice` where metres were scaled as if they
    /// were millimetres, centimetres or inches.
    pub looks_like: &'static str,
    /// The unit that they were read as: `m`, `mm`, `cm`, `in` or `rad`.
    pub read_as: &'static str,
    /// How many times too large it is by that, about; below 1 where it is too small.
    pub factor: f64,
    /// In words.
    pub reason: String,
}

/// What of a robot looks like a wrong unit. Empty where nothing does: a doubt is a hint for people, no proof.
///
/// ```
/// use elbowroom_cell::inspect::unit_doubts;
/// use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// use elbowroom_scene::Robot;
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
/// assert!(unit_doubts(&arm(3.1)?).is_empty());
/// assert_eq!(unit_doubts(&arm(180.0)?)[0].looks_like, "deg");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn unit_doubts(robot: &Robot) -> Vec<UnitDoubt> {
    let mut doubts = limits::doubts(&robot.chain);
    doubts.extend(lengths::doubts(robot));
    doubts
}

/// `format` is that of the file where it can be told. Without a chain the size of the thing alone must do, which cannot tell
/// one small unit from another.
pub(super) fn of_mesh(object: &str, extent_m: Vec3, format: Option<Format>) -> Option<UnitDoubt> {
    if format.is_some_and(Format::states_its_unit) {
        return None;
    }
    mesh::units_suspicion(extent_m)?;
    let extent_m = extent_m.max_element();
    let large = extent_m > 1.0;
    let reason = if large {
        format!(
            "`{object}` is {extent_m:.4} m large and its file states no unit: looks like mm (or cm, or in)\n  write: --unit mm"
        )
    } else {
        format!("`{object}` is only {extent_m:.1e} m large: looks like a unit applied twice\n  write: --unit m")
    };
    Some(UnitDoubt {
        of: "meshes",
        link: Some(object.to_owned()),
        joint: None,
        extent_m: Some(extent_m),
        reference_m: None,
        looks_like: if large { "mm" } else { "applied twice" },
        read_as: if large { "m" } else { "mm" },
        factor: if large { 1000.0 } else { 0.001 },
        reason,
    })
}
