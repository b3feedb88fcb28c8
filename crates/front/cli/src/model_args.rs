//! Arguments shared by several commands: how a model is read.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use elbowroom::spatial::units::LengthUnit;

/// The joints of a 3DS, GLB, glTF or VRML model.
#[derive(Debug, Args)]
pub(crate) struct JointArgs {
    /// The file with the joints of a 3DS, GLB, glTF or VRML model (docs/models.md); default: MODEL.joints.toml beside it
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) joints: Option<PathBuf>,
    /// One joint, in metres and degrees, such as `link_2: axis=y, min=-150, max=20, speed=110`; may be repeated
    #[arg(long, value_name = "NODE: axis=…")]
    pub(crate) joint: Vec<String>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Unit {
    M,
    Cm,
    Mm,
    In,
}

impl From<Unit> for LengthUnit {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::M => Self::Metre,
            Unit::Cm => Self::Centimetre,
            Unit::Mm => Self::Millimetre,
            Unit::In => Self::Inch,
        }
    }
}
