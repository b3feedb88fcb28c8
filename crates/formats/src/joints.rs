//! Which nodes of a model move, and how: a small TOML file beside a 3DS or glTF model, or the command line.
//!
//! ```toml
//! # arm.joints.toml, found beside arm.3ds by itself
//! units = { length = "mm", angle = "deg" }
//!
//! [joint.link_2]       # the node that moves
//! axis = "y"           # x y z -x -y -z or [x, y, z]
//! min = -150
//! max = 20
//! speed = 110          # per second
//! ```
//!
//! | key | default | meaning |
//! | --- | --- | --- |
//! | `axis` | that of the node's track; needed where it has none | direction that it turns about or slides along |
//! | `in` | `"node"` | frame of `axis` and `at`: `node`, `parent` or `world`, at rest |
//! | `at` | the node's origin (pivot), or the track's centre | a point on the axis; it becomes the link's origin |
//! | `kind` | the track's; else `revolute` with `min` and `max`, `continuous` without | or `prismatic`, `fixed` |
//! | `min`, `max` | the ends of the track | limits |
//! | `speed`, `acceleration` | unknown | fastest |
//! | `name` | the node's | of the joint |
//! | `mimic` | none | `{ joint = "NAME", multiplier = 1, offset = 0 }`: follows another joint |

mod text;
mod write;

use std::path::{Path, PathBuf};

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use crate::{FormatError, source};

pub(crate) use write::key;
pub use write::to_toml;

/// What the user says of one node.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpec {
    /// The file, or the option, that says it.
    pub file: PathBuf,
    /// Its line.
    pub line: Option<usize>,
    /// The node that moves.
    pub node: String,
    /// The joint's name.
    pub name: Option<String>,
    /// How it moves.
    pub kind: Option<JointKind>,
    /// Direction in [`JointSpec::frame`], of any length but 0.
    pub axis: Option<Vec3>,
    /// A point on the axis in [`JointSpec::frame`], m.
    pub at: Option<Vec3>,
    /// Where axis and point are given.
    pub frame: AxisFrame,
    /// Limits in the units given: see [`JointSpec::si`].
    pub min: Option<f64>,
    /// Limits in the units given.
    pub max: Option<f64>,
    /// Per second, in the units given.
    pub speed: Option<f64>,
    /// Per second squared, in the units given.
    pub acceleration: Option<f64>,
    /// Name of the joint that it follows, multiplier, and offset in the units given.
    pub mimic: Option<(String, f64, f64)>,
    length: LengthUnit,
    angle: AngleUnit,
}

/// The frame in which an axis is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AxisFrame {
    /// That of the node itself at rest.
    #[default]
    Node,
    /// That of the node's parent.
    Parent,
    /// That of the model.
    World,
}

impl JointSpec {
    /// A number of this joint in m or rad.
    pub fn si(&self, kind: JointKind, value: f64) -> f64 {
        if kind == JointKind::Prismatic { self.length.to_metres(value) } else { self.angle.to_radians(value) }
    }

    pub(crate) fn error(&self, what: impl Into<String>) -> FormatError {
        FormatError::new(&self.file, self.line, what)
    }
}

/// Where the file of joints of a model is looked for: `arm.joints.toml` for `arm.3ds`.
///
/// ```
/// use elbowroom_formats::joints;
/// assert_eq!(joints::beside("cell/arm.3ds".as_ref()), std::path::Path::new("cell/arm.joints.toml"));
/// ```
pub fn beside(model: &Path) -> PathBuf {
    model.with_extension("joints.toml")
}

/// Reads a file of joints.
///
/// # Errors
/// A file that is not TOML or says something else; the line is named.
pub fn load(path: &Path) -> Result<Vec<JointSpec>, FormatError> {
    let bytes = source::read(path)?;
    let content = source::text(&bytes, path)?;
    parse(&content, path)
}

/// Parses a file of joints; `file` is named in messages.
///
/// # Errors
/// As [`load`].
///
/// ```
/// use elbowroom_formats::joints;
/// let text = "units = { length = \"mm\", angle = \"deg\" }\n[joint.link_2]\naxis = \"y\"\nmin = -150\nmax = 20\n";
/// let specs = joints::parse(text, "arm.joints.toml".as_ref())?;
/// assert_eq!((specs[0].node.as_str(), specs[0].max), ("link_2", Some(20.0)));
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn parse(content: &str, file: &Path) -> Result<Vec<JointSpec>, FormatError> {
    text::file(content, file)
}

/// Parses a joint as it is given on the command line, in metres and degrees: `NODE: axis=y, min=-150, max=20`.
/// A vector is three numbers with spaces between them.
///
/// # Errors
/// Anything else; the text is named.
///
/// ```
/// use elbowroom_formats::joints;
/// use elbowroom_spatial::Vec3;
/// let spec = joints::parse_option("link_2: axis=0 1 0, min=-150, max=20, speed=110, kind=revolute")?;
/// assert_eq!(spec.axis, Some(Vec3::Y));
/// assert!(joints::parse_option("link_2: axis=up").unwrap_err().to_string().contains("axis"));
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn parse_option(option: &str) -> Result<JointSpec, FormatError> {
    text::option(option)
}
