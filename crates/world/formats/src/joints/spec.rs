//! The specification of a joint.

use std::path::{Path, PathBuf};

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use crate::Diagnostic;

/// The joint that the user specifies for one node.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpec {
    /// The file or option that specifies the joint.
    pub file: PathBuf,
    /// Line in the file.
    pub line: Option<usize>,
    /// Name of the node that moves.
    pub node: String,
    /// Name of the joint.
    pub name: Option<String>,
    /// Kind of the joint.
    pub kind: Option<JointKind>,
    /// Direction of the axis in [`JointSpec::frame`], of any length except 0.
    pub axis: Option<Vec3>,
    /// A point on the axis in [`JointSpec::frame`], m.
    pub at: Option<Vec3>,
    /// The frame of `axis` and `at`.
    pub frame: AxisFrame,
    /// Lower limit in the given units; [`JointSpec::si`] converts it.
    pub min: Option<f64>,
    /// Upper limit in the given units.
    pub max: Option<f64>,
    /// Largest speed, per second, in the given units.
    pub speed: Option<f64>,
    /// Largest acceleration, per second squared, in the given units.
    pub acceleration: Option<f64>,
    /// Source joint of a mimic joint, multiplier, and offset in the given units.
    pub mimic: Option<(String, f64, f64)>,
    units: JointUnits,
}

/// The units of a joint's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct JointUnits {
    pub(super) length: LengthUnit,
    pub(super) angle: AngleUnit,
}

/// The frame of a given axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AxisFrame {
    /// The rest frame of the node itself.
    #[default]
    Node,
    /// The frame of the node's parent.
    Parent,
    /// The frame of the model.
    World,
}

impl JointSpec {
    /// Converts a number of this joint to m or rad.
    pub fn si(&self, kind: JointKind, value: f64) -> f64 {
        if kind == JointKind::Prismatic {
            self.units.length.to_metres(value)
        } else {
            self.units.angle.to_radians(value)
        }
    }

    /// Creates a specification that names only the node.
    pub(super) fn new(node: &str, file: &Path, line: Option<usize>, units: JointUnits) -> Self {
        Self {
            file: file.to_owned(),
            line,
            node: node.to_owned(),
            name: None,
            kind: None,
            axis: None,
            at: None,
            frame: AxisFrame::Node,
            min: None,
            max: None,
            speed: None,
            acceleration: None,
            mimic: None,
            units,
        }
    }

    /// Converts a length of this joint to metres.
    pub(super) fn metres(&self, length: f64) -> f64 {
        self.units.length.to_metres(length)
    }

    /// Refuses limits in the wrong order.
    pub(super) fn check(&self) -> Result<(), Diagnostic> {
        if let (Some(min), Some(max)) = (self.min, self.max)
            && min > max
        {
            let what = format!("`{}` has min = {min} above max = {max}", self.node);
            return Err(self.error(what).hint(format!("min = {max}, max = {min}")));
        }
        Ok(())
    }

    pub(crate) fn error(&self, what: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(&self.file, self.line, what)
    }
}
