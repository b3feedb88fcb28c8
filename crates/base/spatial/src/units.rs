//! Units of files, converted once when a file is read.
//!
//! ```
//! use elbowroom_spatial::units::{deg, mm, AngleUnit, LengthUnit};
//! assert_eq!(mm(250.0), 0.25);
//! assert_eq!(deg(180.0), std::f64::consts::PI);
//! assert_eq!(LengthUnit::parse("mm"), Some(LengthUnit::Millimetre));
//! assert_eq!(AngleUnit::Degree.to_radians(90.0), std::f64::consts::FRAC_PI_2);
//! ```

/// Converts millimetres to metres.
pub fn mm(v: f64) -> f64 {
    LengthUnit::Millimetre.to_metres(v)
}

/// Converts degrees to radians.
pub fn deg(v: f64) -> f64 {
    AngleUnit::Degree.to_radians(v)
}

/// A unit of length that a file may be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthUnit {
    /// Metre, m.
    #[default]
    Metre,
    /// Centimetre, cm.
    Centimetre,
    /// Millimetre, mm.
    Millimetre,
    /// Inch, 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// Parses a symbol: `m`, `cm`, `mm`, `in`.
    pub fn parse(symbol: &str) -> Option<Self> {
        Some(match symbol {
            "m" => Self::Metre,
            "cm" => Self::Centimetre,
            "mm" => Self::Millimetre,
            "in" => Self::Inch,
            _ => return None,
        })
    }

    /// The symbol of the unit.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Inch => "in",
        }
    }

    /// Converts to metres. Division keeps round numbers round: 700 mm is exactly 0.7.
    pub fn to_metres(self, v: f64) -> f64 {
        match self {
            Self::Metre => v,
            Self::Centimetre => v / 100.0,
            Self::Millimetre => v / 1000.0,
            Self::Inch => v * 25.4 / 1000.0,
        }
    }
}

/// A unit of angle that a file may be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AngleUnit {
    /// Radian, rad.
    #[default]
    Radian,
    /// Degree, deg.
    Degree,
}

impl AngleUnit {
    /// Parses a symbol: `rad`, `deg`.
    pub fn parse(symbol: &str) -> Option<Self> {
        Some(match symbol {
            "rad" => Self::Radian,
            "deg" => Self::Degree,
            _ => return None,
        })
    }

    /// The symbol of the unit.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Radian => "rad",
            Self::Degree => "deg",
        }
    }

    /// Converts to radians.
    pub fn to_radians(self, v: f64) -> f64 {
        match self {
            Self::Radian => v,
            Self::Degree => v.to_radians(),
        }
    }
}
