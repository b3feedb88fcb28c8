//! The range of one joint, divided into cells.

use std::f64::consts::TAU;

/// Largest number of cells of one axis: ends of intervals are 16-bit.
const MAX_AXIS_CELLS: usize = 1 << 15;

/// A joint's range in cells of equal width: cell `i` is centred on `min + (i + 1/2)·step` and contains all joint values
/// within half a step of its centre.
///
/// ```
/// use elbowroom_cspace::GridAxis;
/// let base = GridAxis::from_degrees("base", -170.0, 170.0, 2.0)?;
/// assert_eq!(base.count(), 170);
/// assert!((base.center(0) - (-169.0_f64).to_radians()).abs() < 1e-12);
/// assert_eq!(base.cell(-170.0_f64.to_radians()), Some(0));
/// assert_eq!(base.cell(3.1), None);
/// # Ok::<(), elbowroom_cspace::GridAxisError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GridAxis {
    joint: String,
    min: f64,
    max: f64,
    step: f64,
    count: usize,
}

/// Why a joint cannot be divided into cells.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GridAxisError {
    /// A limit or the step is NaN or infinite.
    #[error("joint `{joint}`: {what} is {value}: a joint of the map needs finite limits and a finite step")]
    NotFinite {
        /// Name of the joint.
        joint: String,
        /// The parameter.
        what: AxisParameter,
        /// Value of the parameter, radians.
        value: f64,
    },
    /// The upper limit is not above the lower limit.
    #[error("joint `{joint}`: its range is {min} to {max} rad: the upper limit must be above the lower one")]
    Empty {
        /// Name of the joint.
        joint: String,
        /// Lower limit, radians.
        min: f64,
        /// Upper limit, radians.
        max: f64,
    },
    /// The step is not positive.
    #[error("joint `{joint}`: the step is {step} rad: it must be above 0")]
    Step {
        /// Name of the joint.
        joint: String,
        /// The step, radians.
        step: f64,
    },
    /// The axis would have too many cells.
    #[error(
        "joint `{joint}`: a step of {step} rad gives {count:.0} cells, more than {MAX_AXIS_CELLS}: make the step larger"
    )]
    TooMany {
        /// Name of the joint.
        joint: String,
        /// The step, radians.
        step: f64,
        /// Number of cells that the axis would have.
        count: f64,
    },
}

/// A parameter of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisParameter {
    /// Lower limit.
    Min,
    /// Upper limit.
    Max,
    /// Width of a cell.
    Step,
}

impl std::fmt::Display for AxisParameter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Min => "min",
            Self::Max => "max",
            Self::Step => "step",
        })
    }
}

impl GridAxis {
    /// Divides `min..max` into cells of width `step`, all in radians. The last cell may extend beyond `max`: every
    /// joint value within the limits has a cell.
    ///
    /// # Errors
    /// The limits or the step are not finite, the range is empty, the step is not positive, or there are more than
    /// 32,768 cells.
    pub fn new(joint: impl Into<String>, min: f64, max: f64, step: f64) -> Result<Self, GridAxisError> {
        let joint = joint.into();
        let parameters = [(AxisParameter::Min, min), (AxisParameter::Max, max), (AxisParameter::Step, step)];
        for (what, value) in parameters {
            if !value.is_finite() {
                return Err(GridAxisError::NotFinite { joint, what, value });
            }
        }
        if max <= min {
            return Err(GridAxisError::Empty { joint, min, max });
        }
        if step <= 0.0 {
            return Err(GridAxisError::Step { joint, step });
        }
        // If the range is a whole number of steps up to rounding, no cell is added at its end.
        let count = ((max - min) / step - 1e-9).ceil().max(1.0);
        if count > MAX_AXIS_CELLS as f64 {
            return Err(GridAxisError::TooMany { joint, step, count });
        }
        Ok(Self { joint, min, max, step, count: count as usize })
    }

    /// Like [`GridAxis::new`], in degrees.
    ///
    /// # Errors
    /// The errors of [`GridAxis::new`].
    pub fn from_degrees(joint: impl Into<String>, min: f64, max: f64, step: f64) -> Result<Self, GridAxisError> {
        Self::new(joint, min.to_radians(), max.to_radians(), step.to_radians())
    }

    /// Name of the joint.
    pub fn joint(&self) -> &str {
        &self.joint
    }

    /// Lower limit, radians.
    pub fn min(&self) -> f64 {
        self.min
    }

    /// Upper limit, radians.
    pub fn max(&self) -> f64 {
        self.max
    }

    /// Width of a cell, 2·δθ, radians.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Centre of a cell, radians.
    pub fn center(&self, cell: usize) -> f64 {
        self.min + (cell as f64 + 0.5) * self.step
    }

    /// Lower border of a cell, radians; `border(count)` is the upper border of the last cell.
    pub fn border(&self, cell: usize) -> f64 {
        self.min + cell as f64 * self.step
    }

    /// The cell of a joint value; `None` outside the limits and for NaN. Values are not reduced by whole turns.
    pub fn cell(&self, value: f64) -> Option<usize> {
        let slack = 1e-9 * self.step;
        if !(value >= self.min - slack && value <= self.max + slack) {
            return None;
        }
        Some((((value - self.min) / self.step).max(0.0) as usize).min(self.count - 1))
    }

    /// Numbers of full turns by which an angle of −π..π can be shifted onto the axis.
    pub(crate) fn full_turns(&self) -> std::ops::RangeInclusive<i32> {
        ((self.min / TAU - 0.5).floor() as i32)..=((self.border(self.count) / TAU + 0.5).ceil() as i32)
    }

    /// Cells that `lo..=hi` (radians, not reduced by whole turns) touches, borders included.
    pub(crate) fn cells_touching(&self, lo: f64, hi: f64) -> Option<(usize, usize)> {
        let slack = 1e-9;
        let first = ((lo - self.min) / self.step - slack).floor().max(0.0);
        let last = ((hi - self.min) / self.step + slack).floor().min(self.count as f64 - 1.0);
        (first <= last).then_some((first as usize, last as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_that_is_no_multiple_is_covered() {
        let axis = GridAxis::new("a", 0.0, 1.0, 0.3).unwrap();
        assert_eq!(axis.count(), 4);
        assert_eq!(axis.cell(1.0), Some(3));
        assert_eq!(GridAxis::from_degrees("a", -120.0, 150.0, 2.0).unwrap().count(), 135);
    }

    #[test]
    fn bad_axes_are_refused_with_a_reason() {
        assert!(matches!(
            GridAxis::new("a", f64::NEG_INFINITY, 1.0, 0.1),
            Err(GridAxisError::NotFinite { what: AxisParameter::Min, .. })
        ));
        assert!(matches!(GridAxis::new("a", 1.0, 1.0, 0.1), Err(GridAxisError::Empty { .. })));
        assert!(matches!(GridAxis::new("a", 0.0, 1.0, 0.0), Err(GridAxisError::Step { .. })));
        assert!(matches!(GridAxis::new("a", 0.0, 1.0, f64::NAN), Err(GridAxisError::NotFinite { .. })));
        assert!(matches!(GridAxis::new("a", 0.0, 1.0, 1e-6), Err(GridAxisError::TooMany { .. })));
    }

    #[test]
    fn a_value_outside_or_nan_has_no_cell() {
        let axis = GridAxis::new("a", 0.0, 1.0, 0.1).unwrap();
        assert_eq!((axis.cell(-0.01), axis.cell(1.01), axis.cell(f64::NAN)), (None, None, None));
    }
}
