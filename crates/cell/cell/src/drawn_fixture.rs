//! A fixture that a person draws on an object, and its text in a cell file.

use std::path::Path;

use elbowroom_formats::Diagnostic;
use serde::Deserialize;
use toml_edit::Value;

use crate::Units;

/// Largest number of points of a drawn target.
pub const MOST_DRAWN_POINTS: usize = 1000;
/// Longest name of a drawn fixture.
const LONGEST_NAME: usize = 64;
/// Decimals of a length in metres: a tenth of a nanometre.
const DECIMALS: usize = 10;

/// A fixture as it is drawn: `[fixture.NAME]` with a target. Keys that are `None` have the default of the cell file, or, in
/// a fixture that exists, stay as they are.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnFixture {
    /// Its name: letters, digits, `_` and `-`.
    pub name: String,
    /// Name of the protected object.
    pub protects: String,
    /// What the tool is to reach.
    pub target: DrawnTarget,
    /// The tool: `ROBOT/TOOL`.
    pub tool: Option<String>,
    /// Width of the opening at its ground, metres.
    pub width_m: Option<f64>,
    /// Distance of the shield from the surface, metres.
    pub offset_m: Option<f64>,
    /// Depth of the opening, metres; a drill has its own.
    pub depth_m: Option<f64>,
    /// Angle between the wall of the opening and its axis, rad.
    pub flare_rad: Option<f64>,
    /// Largest error of the shield, metres.
    pub tolerance_m: Option<f64>,
}

/// A drawn target, in the world and in metres.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DrawnTarget {
    /// A line on the surface through points.
    Line(Vec<[f64; 3]>),
    /// The part of the surface inside a closed line through points.
    Area(Vec<[f64; 3]>),
    /// A hole.
    Drill {
        /// A point of the surface.
        at_m: [f64; 3],
        /// Direction into the object.
        axis: [f64; 3],
        /// Depth below the surface, metres.
        depth_m: f64,
    },
    /// The part of the surface around a point.
    FacesWithin {
        /// A point of the surface.
        at_m: [f64; 3],
        /// Distance from it, metres.
        radius_m: f64,
    },
}

impl DrawnFixture {
    /// Creates a fixture with a width (m) and the defaults of the cell file, without a tool.
    pub fn new(name: impl Into<String>, protects: impl Into<String>, target: DrawnTarget, width_m: f64) -> Self {
        Self {
            name: name.into(),
            protects: protects.into(),
            target,
            tool: None,
            width_m: Some(width_m),
            offset_m: None,
            depth_m: None,
            flare_rad: None,
            tolerance_m: None,
        }
    }

    /// Checks what the text of the cell file cannot tell: the name, the number of points, and that all numbers are finite.
    pub(crate) fn check(&self, file: &Path) -> Result<(), Diagnostic> {
        let wrong = |what: String, hint: &str| Err(Diagnostic::new(file, None, what).hint(hint));
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if self.name.is_empty() || self.name.len() > LONGEST_NAME || !self.name.chars().all(is_plain) {
            let shown: String = self.name.chars().take(LONGEST_NAME).collect();
            let hint = format!("up to {LONGEST_NAME} letters, digits, _ and -, such as cut or cut_2");
            return wrong(format!("{shown:?} cannot be the name of a drawn fixture"), &hint);
        }
        if let DrawnTarget::Line(points) | DrawnTarget::Area(points) = &self.target
            && points.len() > MOST_DRAWN_POINTS
        {
            let what = format!("the target has {} points, at most {MOST_DRAWN_POINTS} are drawn", points.len());
            return wrong(what, "fewer points: the line follows the surface between them");
        }
        if !self.numbers().all(f64::is_finite) {
            return wrong("a number of the target or its dimensions is not finite".into(), "finite numbers");
        }
        Ok(())
    }

    fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let of_target: Vec<f64> = match &self.target {
            DrawnTarget::Line(points) | DrawnTarget::Area(points) => points.concat(),
            DrawnTarget::Drill { at_m, axis, depth_m } => [&at_m[..], axis, &[*depth_m]].concat(),
            DrawnTarget::FacesWithin { at_m, radius_m } => [&at_m[..], &[*radius_m]].concat(),
        };
        let lengths = [self.width_m, self.offset_m, self.depth_m, self.flare_rad, self.tolerance_m];
        of_target.into_iter().chain(lengths.into_iter().flatten())
    }

    /// Whether the target has a depth of its own.
    pub(crate) fn is_drill(&self) -> bool {
        matches!(self.target, DrawnTarget::Drill { .. })
    }

    /// The keys that are written, with their values as TOML, in the units of the file.
    pub(crate) fn keys(&self, units: Units) -> Vec<(&'static str, String)> {
        let text = |t: &str| Value::from(t).to_string();
        let length = |metres: f64| exact_length(units, metres);
        let angle = |radians: f64| trimmed(radians / units.angle.to_radians(1.0), DECIMALS);
        // The depth of a drill is in its target.
        let depth_m = self.depth_m.filter(|_| !self.is_drill());
        let keys = [
            ("protects", Some(text(&self.protects))),
            ("target", Some(self.target.toml(units))),
            ("width", self.width_m.map(length)),
            ("offset", self.offset_m.map(length)),
            ("depth", depth_m.map(length)),
            ("flare", self.flare_rad.map(angle)),
            ("tolerance", self.tolerance_m.map(length)),
            ("tool", self.tool.as_deref().map(text)),
        ];
        keys.into_iter().filter_map(|(key, value)| value.map(|value| (key, value))).collect()
    }
}

impl DrawnTarget {
    fn toml(&self, units: Units) -> String {
        let point = |p: &[f64; 3]| format!("[{}]", p.map(|x| exact_length(units, x)).join(", "));
        // One point per line.
        let list = |points: &[[f64; 3]]| points.iter().fold(String::new(), |text, p| text + "\n    " + &point(p) + ",");
        match self {
            Self::Line(points) => format!("{{ line = [{}\n] }}", list(points)),
            Self::Area(points) => format!("{{ area = [{}\n] }}", list(points)),
            Self::Drill { at_m, axis, depth_m } => format!(
                "{{ drill = {{ at = {}, axis = [{}], depth = {} }} }}",
                point(at_m),
                axis.map(|x| trimmed(x, DECIMALS)).join(", "),
                exact_length(units, *depth_m)
            ),
            Self::FacesWithin { at_m, radius_m } => {
                let radius = exact_length(units, *radius_m);
                format!("{{ faces_within = {{ at = {}, radius = {radius} }} }}", point(at_m))
            }
        }
    }
}

/// A length as a number of the file, to a tenth of a nanometre.
fn exact_length(units: Units, metres: f64) -> String {
    let unit_m = units.length.to_metres(1.0);
    let decimals = DECIMALS.saturating_sub((-unit_m.log10()).round().max(0.0) as usize);
    trimmed(metres / unit_m, decimals)
}

/// A number with at most so many decimals.
fn trimmed(v: f64, decimals: usize) -> String {
    let text = format!("{v:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.to_owned() }
}
