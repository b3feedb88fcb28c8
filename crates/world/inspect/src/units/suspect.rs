//! A suspected unit error.

use serde::Serialize;

/// The quantity of a suspected unit error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SuspectQuantity {
    /// Meshes, and other solids.
    Meshes,
    /// Origins of joints.
    Joints,
    /// Limits of a prismatic joint.
    Stroke,
    /// Limits of revolute joints.
    Limits,
}

/// A unit in a [`SuspectUnit`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum UnitLabel {
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
    /// Inches.
    #[serde(rename = "in")]
    Inch,
    /// Metres.
    #[serde(rename = "m")]
    Metre,
    /// Degrees.
    #[serde(rename = "deg")]
    Degree,
    /// Radians.
    #[serde(rename = "rad")]
    Radian,
    /// A scale that was applied to metres.
    #[serde(rename = "applied twice")]
    AppliedTwice,
}

impl UnitLabel {
    /// The symbol of the unit, as in JSON.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "in",
            Self::Metre => "m",
            Self::Degree => "deg",
            Self::Radian => "rad",
            Self::AppliedTwice => "applied twice",
        }
    }
}

/// A suspected unit error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuspectUnit {
    /// The suspect quantity: `meshes`, `joints` (their origins), `stroke` or `limits`.
    pub of: SuspectQuantity,
    /// The link, or the object of a mesh file; null if the suspicion is about the whole model.
    pub link: Option<String>,
    /// The joint; null if the suspicion is about all joints or about no joint.
    pub joint: Option<String>,
    /// Largest edge of the box of the link, or of the largest solid, as read, m; null for joints, strokes and limits.
    pub extent_m: Option<f64>,
    /// The reference, m: the longest distance through the chain; null for a mesh file and for limits.
    pub reference_m: Option<f64>,
    /// The likely unit of the numbers: `mm`, `cm`, `in` or `deg`, or `applied twice`.
    ///
    /// `applied twice` means that metres were scaled as if they were millimetres, centimetres or inches.
    pub looks_like: UnitLabel,
    /// The unit as which the numbers were read: `m`, `mm`, `cm`, `in` or `rad`.
    pub read_as: UnitLabel,
    /// The approximate factor by which the quantity is too large; below 1 if it is too small.
    pub factor: f64,
    /// The message for the user.
    pub reason: String,
}
