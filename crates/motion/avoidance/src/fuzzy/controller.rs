//! Mamdani inference.

use super::{FuzzyError, Rule, Variable};

/// Largest number of inputs, outputs, and sets of one variable: the arrays of the inference are on the stack.
const MAX_SETS: usize = 16;
/// Largest number of grid points at which the coverage by rules is checked.
const MAX_GRID_POINTS: usize = 200_000;
/// Number of samples of the sets of an output.
const SAMPLES: usize = 129;

/// A fuzzy controller: computes outputs from inputs by rules.
///
/// ```
/// use elbowroom_avoidance::fuzzy::Controller;
/// let fan = Controller::from_toml(
///     r#"
///     [input.warmth]
///     range = [0, 40]
///     cold = [0, 0, 15, 20]
///     hot = [15, 20, 40, 40]
///     [output.speed]
///     range = [0, 1]
///     off = [-0.5, 0, 0, 0.5]
///     full = [0.5, 1, 1, 1.5]
///     [rules]
///     list = ["if warmth is cold then speed is off", "if warmth is hot then speed is full"]
///     "#,
/// )?;
/// let mut speed = [0.0];
/// fan.infer(&[35.0], &mut speed);
/// assert!((speed[0] - 1.0).abs() < 1e-9);
/// fan.infer(&[17.5], &mut speed);
/// assert!((speed[0] - 0.5).abs() < 1e-9);
/// # Ok::<(), elbowroom_avoidance::fuzzy::FuzzyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    inputs: Vec<Variable>,
    outputs: Vec<Variable>,
    rules: Vec<Rule>,
    /// Per output, the samples of its sets.
    samples: Vec<Samples>,
}

#[derive(Debug, Clone, PartialEq)]
struct Samples {
    at: Vec<f64>,
    /// Per set, the membership at each sample.
    degrees: Vec<Vec<f64>>,
}

impl Samples {
    fn of(output: &Variable) -> Self {
        let [low, high] = output.extent();
        let step = (high - low) / (SAMPLES - 1) as f64;
        let at: Vec<f64> = (0..SAMPLES).map(|i| low + step * i as f64).collect();
        let degrees = output.sets.iter().map(|(_, s)| at.iter().map(|x| s.degree(*x)).collect()).collect();
        Self { at, degrees }
    }
}

impl Controller {
    /// Creates a controller. Checks that names are unique, that every set of an output contains a sample, and that at
    /// every input within the ranges at least one rule applies to each output.
    ///
    /// # Errors
    /// [`FuzzyError`] without a line.
    pub fn new(inputs: Vec<Variable>, outputs: Vec<Variable>, rules: Vec<Rule>) -> Result<Self, FuzzyError> {
        for (role, list) in [("input", &inputs), ("output", &outputs)] {
            check_variables(role, list)?;
        }
        let samples: Vec<Samples> = outputs.iter().map(Samples::of).collect();
        for (output, samples) in outputs.iter().zip(&samples) {
            if let Some(i) = samples.degrees.iter().position(|d| d.iter().all(|d| *d <= 0.0)) {
                let what = format!("the set `{}` of the output `{}` is too narrow", output.sets[i].0, output.name);
                return Err(FuzzyError::new(
                    what,
                    "corners farther apart than a hundredth of all that the output's sets span",
                ));
            }
        }
        let controller = Self { inputs, outputs, rules, samples };
        controller.check_coverage()?;
        Ok(controller)
    }

    /// The inputs, in order.
    pub fn inputs(&self) -> &[Variable] {
        &self.inputs
    }

    /// The outputs, in order.
    pub fn outputs(&self) -> &[Variable] {
        &self.outputs
    }

    /// The rules.
    pub fn rules(&self) -> &[Rule] {
        &self.rules
    }

    /// Computes one number per output from one number per input. Numbers are clamped to the ranges of the variables;
    /// NaN and missing inputs count as the lower end of the range. Does not allocate.
    pub fn infer(&self, inputs: &[f64], outputs: &mut [f64]) {
        let degrees = self.degrees(inputs);
        for (number, out) in outputs.iter_mut().enumerate().take(self.outputs.len()) {
            let strengths = self.strengths(&degrees, number);
            *out = self.centre_of_gravity(number, &strengths);
        }
    }

    fn degrees(&self, inputs: &[f64]) -> [[f64; MAX_SETS]; MAX_SETS] {
        let mut degrees = [[0.0; MAX_SETS]; MAX_SETS];
        for (i, variable) in self.inputs.iter().enumerate() {
            let x = variable.within(inputs.get(i).copied().unwrap_or(f64::NAN), variable.range[0]);
            for (degree, (_, set)) in degrees[i].iter_mut().zip(&variable.sets) {
                *degree = set.degree(x);
            }
        }
        degrees
    }

    /// The strength of each set of an output.
    fn strengths(&self, degrees: &[[f64; MAX_SETS]; MAX_SETS], output: usize) -> [f64; MAX_SETS] {
        let mut strengths = [0.0_f64; MAX_SETS];
        for rule in &self.rules {
            let Some((_, set)) = rule.conclusions.iter().find(|(o, _)| *o == output) else { continue };
            let strength = rule.conditions.iter().map(|&(i, s)| degrees[i][s]).fold(1.0, f64::min);
            strengths[*set] = strengths[*set].max(strength);
        }
        strengths
    }

    /// Centre of gravity of the sets, each clipped at its strength.
    fn centre_of_gravity(&self, output: usize, strengths: &[f64; MAX_SETS]) -> f64 {
        let samples = &self.samples[output];
        let mut joined = [0.0_f64; SAMPLES];
        for (set, strength) in samples.degrees.iter().zip(strengths).filter(|(_, s)| **s > 0.0) {
            for (j, degree) in joined.iter_mut().zip(set) {
                *j = j.max(degree.min(*strength));
            }
        }
        let (mut area, mut moment) = (0.0, 0.0);
        for (degree, x) in joined.iter().zip(&samples.at) {
            area += degree;
            moment += degree * x;
        }
        let variable = &self.outputs[output];
        let center = f64::midpoint(variable.range[0], variable.range[1]);
        variable.within(moment / area, center)
    }

    /// Checks coverage by the rules on a grid over the ranges of the inputs; the grid includes the corners of the sets.
    fn check_coverage(&self) -> Result<(), FuzzyError> {
        let mut x = vec![0.0; self.inputs.len()];
        let grid: Vec<Vec<f64>> = self.inputs.iter().map(grid_values).collect();
        let combinations: usize = grid.iter().map(Vec::len).product();
        if combinations > MAX_GRID_POINTS {
            let what = format!("the sets of the inputs make {combinations} combinations, too many to check all");
            return Err(FuzzyError::new(what, "fewer inputs, or fewer sets of each"));
        }
        for index in 0..combinations {
            let mut rest = index;
            for (value, grid) in x.iter_mut().zip(&grid) {
                *value = grid[rest % grid.len()];
                rest /= grid.len();
            }
            let degrees = self.degrees(&x);
            for (number, output) in self.outputs.iter().enumerate() {
                if self.strengths(&degrees, number).iter().all(|s| *s <= 0.0) {
                    return Err(self.uncovered(&x, output));
                }
            }
        }
        Ok(())
    }

    fn uncovered(&self, x: &[f64], output: &Variable) -> FuzzyError {
        let at: Vec<String> = self.inputs.iter().zip(x).map(|(v, x)| format!("{} = {x:.4}", v.name)).collect();
        FuzzyError::new(
            format!("at {} no rule says anything about `{}`", at.join(" and "), output.name),
            "sets that overlap, and a rule for each of their combinations",
        )
    }
}

/// The corners within the range and the midpoints between them.
fn grid_values(variable: &Variable) -> Vec<f64> {
    let [low, high] = variable.range;
    let mut corners: Vec<f64> = variable.sets.iter().flat_map(|(_, s)| s.corners()).collect();
    corners.extend(variable.range);
    corners.retain(|c| *c >= low && *c <= high);
    corners.sort_by(f64::total_cmp);
    corners.dedup();
    let midpoints: Vec<f64> = corners.windows(2).map(|w| f64::midpoint(w[0], w[1])).collect();
    corners.extend(midpoints);
    corners
}

fn check_variables(role: &str, list: &[Variable]) -> Result<(), FuzzyError> {
    // The coverage check visits every combination: four inputs of a few sets have about 100,000.
    if list.is_empty() || list.len() > 4 {
        return Err(FuzzyError::new(
            format!("there are {} {role}s", list.len()),
            format!("1 to 4 tables [{role}.NAME]"),
        ));
    }
    for (i, v) in list.iter().enumerate() {
        let [low, high] = v.range;
        if !(low < high && (high - low).is_finite()) {
            let what = format!("the range of `{}` is [{low}, {high}]", v.name);
            return Err(FuzzyError::new(what, "range = [low, high]"));
        }
        if v.sets.is_empty() || v.sets.len() > MAX_SETS {
            let what = format!("`{}` has {} sets", v.name, v.sets.len());
            return Err(FuzzyError::new(what, format!("1 to {MAX_SETS} sets, each as name = [a, b, c, d]")));
        }
        let twice = list[..i].iter().any(|o| o.name == v.name);
        let set_twice = v.sets.iter().enumerate().any(|(i, (n, _))| v.sets[..i].iter().any(|(o, _)| o == n));
        if twice || set_twice {
            return Err(FuzzyError::new(format!("a name is used twice at `{}`", v.name), "each name once"));
        }
    }
    Ok(())
}
