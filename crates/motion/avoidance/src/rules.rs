//! The rules of avoidance: size and direction of a correction from distance and approach speed.

use crate::fuzzy::{Controller, FuzzyError, Surface};

/// The default rules, as text to copy and change.
pub const DEFAULT_RULES: &str = include_str!("default.toml");

/// A fuzzy controller with the inputs `proximity` (m) and `speed` (of approach, m/s) and the outputs `size` (fraction
/// of the evasion speed, 0 to 1) and `direction` (degrees: 0 away from the obstacle, 90 perpendicular to its motion).
///
/// ```
/// use elbowroom_avoidance::Rules;
/// let rules = Rules::default();
/// let far = rules.correction(0.9, 0.0);
/// let near = rules.correction(0.05, 0.3);
/// assert!(far.size == 0.0 && near.size > 0.8);
/// assert!(near.direction_rad < 0.3, "a very near and slow obstacle is evaded straight away from it");
/// assert!(rules.correction(0.45, 1.5).direction_rad > 1.4, "a fast obstacle at a distance is evaded sideways");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rules {
    controller: Controller,
}

/// The correction that the rules request.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Correction {
    /// Fraction of the evasion speed, 0 to 1.
    pub size: f64,
    /// 0: away from the obstacle; π/2: perpendicular to its motion, rad.
    pub direction_rad: f64,
}

/// Size below which the correction is 0, because the sampled centre of gravity is not exact.
const MIN_SIZE: f64 = 1e-3;

impl Rules {
    /// Reads rules in the form of [`DEFAULT_RULES`].
    ///
    /// # Errors
    /// [`FuzzyError`] with the line: the text is invalid, or its inputs, outputs or ranges differ from those of
    /// avoidance.
    pub fn from_toml(text: &str) -> Result<Self, FuzzyError> {
        let controller = Controller::from_toml(text)?;
        let names = |list: &[crate::fuzzy::Variable]| list.iter().map(|v| v.name.clone()).collect::<Vec<_>>();
        let (inputs, outputs) = (names(controller.inputs()), names(controller.outputs()));
        if inputs != ["proximity", "speed"] || outputs != ["size", "direction"] {
            return Err(FuzzyError::new(
                format!("the inputs are {} and the outputs {}", inputs.join(", "), outputs.join(", ")),
                "[input.proximity], [input.speed], [output.size], [output.direction], in this order",
            ));
        }
        let [size, direction] = [0, 1].map(|i| controller.outputs()[i].range);
        let [proximity, speed] = [0, 1].map(|i| controller.inputs()[i].range);
        if proximity[0] != 0.0 || speed[0] != 0.0 || size != [0.0, 1.0] || direction[0] < 0.0 || direction[1] > 90.0 {
            return Err(FuzzyError::new(
                "a range is not what avoidance needs",
                "proximity and speed from 0, size in [0, 1], direction within [0, 90]",
            ));
        }
        Ok(Self { controller })
    }

    /// The fuzzy controller.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The size and the direction of the correction as surfaces, with `steps` values of each input, at least 2.
    pub fn surfaces(&self, steps: usize) -> Vec<Surface> {
        let surface =
            |(output, unit)| Surface::of(&self.controller, output, steps).map(|s| s.with_units(["m", "m/s", unit]));
        [(0, ""), (1, "deg")].into_iter().filter_map(surface).collect()
    }

    /// Distance (m) beyond which proximity has no effect.
    pub fn reach_m(&self) -> f64 {
        self.controller.inputs()[0].range[1]
    }

    /// The correction for a distance (m) and a speed of approach (m/s; negative counts as 0). NaN counts as contact or
    /// as the largest speed.
    pub fn correction(&self, distance_m: f64, approach_m_s: f64) -> Correction {
        let max_speed = self.controller.inputs()[1].range[1];
        let speed = if approach_m_s.is_nan() { max_speed } else { approach_m_s };
        let mut out = [0.0; 2];
        self.controller.infer(&[distance_m, speed], &mut out);
        let size = if out[0] < MIN_SIZE { 0.0 } else { out[0] };
        Correction { size, direction_rad: out[1].to_radians() }
    }
}

impl Default for Rules {
    /// [`DEFAULT_RULES`].
    fn default() -> Self {
        Self::from_toml(DEFAULT_RULES).expect("the default rules are valid: a test reads them")
    }
}
