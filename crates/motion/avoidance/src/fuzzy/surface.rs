//! Control surfaces.

use super::Controller;

/// A control surface: an output over two inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Name of the first input.
    pub x_name: String,
    /// Name of the second input.
    pub y_name: String,
    /// Name of the output.
    pub z_name: String,
    /// Values of the first input.
    pub x: Vec<f64>,
    /// Values of the second input.
    pub y: Vec<f64>,
    /// `z[j][i]` is the output at `x[i]`, `y[j]`.
    pub z: Vec<Vec<f64>>,
    /// Range of the output.
    pub z_range: [f64; 2],
    /// Units of the inputs and of the output, for drawings; empty if a quantity has no unit.
    pub units: [&'static str; 3],
}

impl Surface {
    /// Computes output number `output` of a controller over its first two inputs, with `steps` values of each; the
    /// other inputs are at the lower end of their ranges. `None` if the controller has fewer inputs or outputs, or if
    /// there are fewer than two steps.
    ///
    /// ```
    /// use elbowroom_avoidance::{Rules, fuzzy::Surface};
    /// let size = Surface::of(Rules::default().controller(), 0, 33).unwrap();
    /// assert_eq!((size.x_name.as_str(), size.y_name.as_str()), ("proximity", "speed"));
    /// assert!(size.z[32][0] > size.z[0][32], "the correction for near and fast exceeds that for far and slow");
    /// ```
    pub fn of(controller: &Controller, output: usize, steps: usize) -> Option<Self> {
        let [a, b, rest @ ..] = controller.inputs() else { return None };
        let out = controller.outputs().get(output).filter(|_| steps >= 2)?;
        let along = |range: [f64; 2]| -> Vec<f64> {
            (0..steps).map(|i| range[0] + (range[1] - range[0]) * i as f64 / (steps - 1) as f64).collect()
        };
        let (x, y) = (along(a.range), along(b.range));
        let mut inputs = vec![0.0, 0.0];
        inputs.extend(rest.iter().map(|v| v.range[0]));
        let mut values = vec![0.0; controller.outputs().len()];
        let z = y
            .iter()
            .map(|&y| {
                x.iter()
                    .map(|&x| {
                        (inputs[0], inputs[1]) = (x, y);
                        controller.infer(&inputs, &mut values);
                        values[output]
                    })
                    .collect()
            })
            .collect();
        let (x_name, y_name, z_name) = (a.name.clone(), b.name.clone(), out.name.clone());
        Some(Self { x_name, y_name, z_name, x, y, z, z_range: out.range, units: [""; 3] })
    }

    /// Adds units for drawings.
    #[must_use]
    pub fn with_units(self, units: [&'static str; 3]) -> Self {
        Self { units, ..self }
    }
}
