//! The joints of a 3DS, glTF or VRML model: a small TOML file beside the model, or options of the command line.
//!
//! ```toml
//! # arm.joints.toml, read with arm.3ds
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
//! | `axis` | the axis of the node's track; required without a track | direction of rotation or translation |
//! | `in` | `"node"` | frame of `axis` and `at`: `node`, `parent` or `world`, at rest |
//! | `at` | the node's origin (pivot), or the track's centre | a point on the axis; it becomes the link's origin |
//! | `kind` | the kind of the track; else `revolute` with `min` and `max`, `continuous` without | or `prismatic`, `fixed` |
//! | `min`, `max` | the ends of the track | limits |
//! | `speed`, `acceleration` | unknown | limits |
//! | `name` | the node's name | name of the joint |
//! | `mimic` | none | `{ joint = "NAME", multiplier = 1, offset = 0 }` |

mod file;
mod option;
mod spec;
mod to_toml;
mod value;

use std::path::{Path, PathBuf};

use crate::{Diagnostic, input};

pub use spec::{AxisFrame, JointSpec};
pub(crate) use to_toml::key;
pub use to_toml::to_toml;

/// The default path of the joints file of a model: `arm.joints.toml` for `arm.3ds`.
///
/// ```
/// use elbowroom_formats::joints;
/// assert_eq!(joints::default_path("cell/arm.3ds".as_ref()), std::path::Path::new("cell/arm.joints.toml"));
/// ```
pub fn default_path(model: &Path) -> PathBuf {
    model.with_extension("joints.toml")
}

/// Reads a file of joints.
///
/// # Errors
/// [`Diagnostic`] with the line, if the file is not TOML or has unknown keys.
pub fn load(path: &Path) -> Result<Vec<JointSpec>, Diagnostic> {
    let bytes = input::read(path)?;
    let content = input::text(&bytes, path)?;
    parse(&content, path)
}

/// Parses a file of joints; `path` is named in messages.
///
/// # Errors
/// The errors of [`load`].
///
/// ```
/// use elbowroom_formats::joints;
/// let text = "units = { length = \"mm\", angle = \"deg\" }\n[joint.link_2]\naxis = \"y\"\nmin = -150\nmax = 20\n";
/// let specs = joints::parse(text, "arm.joints.toml".as_ref())?;
/// assert_eq!((specs[0].node.as_str(), specs[0].max), ("link_2", Some(20.0)));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn parse(content: &str, path: &Path) -> Result<Vec<JointSpec>, Diagnostic> {
    file::parse(content, path)
}

/// Parses a joint from the command line, in metres and degrees: `NODE: axis=y, min=-150, max=20`.
///
/// A vector is three numbers separated by spaces.
///
/// # Errors
/// [`Diagnostic`] with the text, for any other input.
///
/// ```
/// use elbowroom_formats::joints;
/// use elbowroom_spatial::Vec3;
/// let spec = joints::parse_option("link_2: axis=0 1 0, min=-150, max=20, speed=110, kind=revolute")?;
/// assert_eq!(spec.axis, Some(Vec3::Y));
/// assert!(joints::parse_option("link_2: axis=up").unwrap_err().to_string().contains("axis"));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn parse_option(option: &str) -> Result<JointSpec, Diagnostic> {
    option::parse(option)
}
