//! Values of joint properties.

use std::path::Path;

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::Vec3;

use super::spec::{AxisFrame, JointSpec};
use crate::Diagnostic;

type Result<T> = std::result::Result<T, Diagnostic>;

const KEYS: &str = "axis, in, at, kind, min, max, speed, acceleration, name, mimic";
const AXIS: &str = "axis = \"z\"   (x, y, z, -x, -y, -z, or a vector: [0, 0, 1])";
/// The value of a key, with its line.
pub(super) struct Value<'a> {
    pub(super) key: &'a str,
    pub(super) file: &'a Path,
    pub(super) line: Option<usize>,
    pub(super) data: Data,
}

pub(super) enum Data {
    Text(String),
    Number(f64),
    Numbers(Vec<f64>),
    Mimic(String, f64, f64),
    Other,
}

impl Value<'_> {
    fn error(&self, what: &str, write: &str) -> Diagnostic {
        Diagnostic::new(self.file, self.line, format!("`{}` {what}", self.key)).hint(write)
    }

    fn number(&self) -> Result<f64> {
        match self.data {
            Data::Number(n) if n.is_finite() => Ok(n),
            _ => Err(self.error("is not a finite number", &format!("{} = 90", self.key))),
        }
    }

    fn positive(&self) -> Result<f64> {
        self.number()
            .ok()
            .filter(|n| *n > 0.0)
            .ok_or_else(|| self.error("is not a number above 0", &format!("{} = 90", self.key)))
    }

    fn vector(&self, write: &str) -> Result<Vec3> {
        match &self.data {
            Data::Numbers(n) if n.len() == 3 && n.iter().all(|x| x.is_finite()) => Ok(Vec3::new(n[0], n[1], n[2])),
            _ => Err(self.error("is not three numbers", write)),
        }
    }

    fn axis(&self) -> Result<Vec3> {
        let named = match &self.data {
            Data::Text(text) => match text.as_str() {
                "x" | "+x" => Some(Vec3::X),
                "y" | "+y" => Some(Vec3::Y),
                "z" | "+z" => Some(Vec3::Z),
                "-x" => Some(-Vec3::X),
                "-y" => Some(-Vec3::Y),
                "-z" => Some(-Vec3::Z),
                "?" => return Err(self.error("is still to be filled in", AXIS)),
                _ => return Err(self.error(&format!("is \"{text}\", which is no axis"), AXIS)),
            },
            _ => None,
        };
        let axis = named.map_or_else(|| self.vector(AXIS), Ok)?;
        if axis.try_normalize().is_none() {
            return Err(self.error("has no direction", AXIS));
        }
        Ok(axis)
    }

    fn choice<T: Copy>(&self, choices: &[(&str, T)]) -> Result<T> {
        let known = choices.iter().map(|c| format!("\"{}\"", c.0)).collect::<Vec<_>>().join(" or ");
        let found = match &self.data {
            Data::Text(text) => choices.iter().find(|c| c.0 == text),
            _ => None,
        };
        found.map(|c| c.1).ok_or_else(|| self.error("is unknown", &format!("{} = {known}", self.key)))
    }

    fn text(&self) -> Result<String> {
        match &self.data {
            Data::Text(text) if !text.is_empty() => Ok(text.clone()),
            _ => Err(self.error("is not a text", &format!("{} = \"…\"", self.key))),
        }
    }
}

impl Value<'_> {
    /// Sets the property of a joint that the key names.
    pub(super) fn apply(&self, spec: &mut JointSpec) -> Result<()> {
        match self.key {
            "axis" => spec.axis = Some(self.axis()?),
            "at" => {
                let at = self.vector("at = [0, 0, 0.5]")?;
                spec.at = Some(Vec3::from(at.to_array().map(|x| spec.metres(x))));
            }
            "in" => {
                let frames = [("node", AxisFrame::Node), ("parent", AxisFrame::Parent), ("world", AxisFrame::World)];
                spec.frame = self.choice(&frames)?;
            }
            "kind" => {
                spec.kind = Some(self.choice(&[
                    ("revolute", JointKind::Revolute),
                    ("prismatic", JointKind::Prismatic),
                    ("continuous", JointKind::Continuous),
                    ("fixed", JointKind::Fixed),
                ])?);
            }
            "min" => spec.min = Some(self.number()?),
            "max" => spec.max = Some(self.number()?),
            "speed" => spec.speed = Some(self.positive()?),
            "acceleration" => spec.acceleration = Some(self.positive()?),
            "name" => spec.name = Some(self.text()?),
            "mimic" => match &self.data {
                Data::Mimic(joint, multiplier, offset) => spec.mimic = Some((joint.clone(), *multiplier, *offset)),
                _ => {
                    return Err(
                        self.error("names no joint", "mimic = { joint = \"NAME\", multiplier = 1, offset = 0 }")
                    );
                }
            },
            _ => return Err(self.error("is not known here", KEYS)),
        }
        Ok(())
    }
}
