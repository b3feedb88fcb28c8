//! Summary of the results, per set and of all.

use serde::Serialize;

use super::ProblemResult;

/// Counts and figures of each set, and of all sets together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProblemSummary {
    /// Sets in the order of their first appearance.
    pub sets: Vec<SetSummary>,
    /// All problems; its name is `all`.
    pub all: SetSummary,
}

/// Counts and figures of a set. Times and means cover the solved problems; null if no problem is solved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetSummary {
    /// Name of the set.
    pub set: String,
    /// Number of problems.
    pub total: usize,
    /// Problems whose start and at least one goal are free.
    pub valid: usize,
    /// Problems with a path.
    pub solved: usize,
    /// Problems with a path that is proven free.
    pub proven: usize,
    /// Time of the search, µs.
    pub planning_us: Option<Statistics>,
    /// Time of shortcutting, µs.
    pub simplify_us: Option<Statistics>,
    /// Mean length before shortcutting, rad (and m).
    pub cost_raw_rad: Option<f64>,
    /// Mean length, rad (and m).
    pub cost_rad: Option<f64>,
    /// Mean duration, s.
    pub duration_s: Option<f64>,
    /// Largest distance of a linear motion from its line, m; null if no linear motion is solved.
    pub line_deviation_m: Option<f64>,
    /// Largest rotation of a linear motion from the orientation on its line, rad.
    pub line_deviation_rad: Option<f64>,
}

/// Figures of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// Median.
    pub p50: f64,
    /// Mean.
    pub mean: f64,
    /// 95th percentile.
    pub p95: f64,
}

impl Statistics {
    /// Computes the figures of some values; `None` without values. Percentiles are linear between two values of the
    /// sorted sample.
    ///
    /// ```
    /// use elbowroom_query::problems::Statistics;
    /// let of = Statistics::of(vec![4.0, 1.0, 2.0, 3.0]).unwrap();
    /// assert_eq!((of.p50, of.mean), (2.5, 2.5));
    /// assert!((of.p95 - 3.85).abs() < 1e-12);
    /// ```
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        let mean = mean(&values)?;
        values.sort_by(f64::total_cmp);
        let percentile = |share: f64| {
            let at = share * (values.len() - 1) as f64;
            let (low, high) = (values[at.floor() as usize], values[at.ceil() as usize]);
            low + (high - low) * at.fract()
        };
        Some(Self { p50: percentile(0.5), mean, p95: percentile(0.95) })
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

impl ProblemSummary {
    /// Summarizes results.
    pub fn of(results: &[ProblemResult]) -> Self {
        let mut names: Vec<&str> = Vec::new();
        for result in results {
            if !names.contains(&result.set.as_str()) {
                names.push(&result.set);
            }
        }
        let of_set = |name: &&str| {
            let of_name: Vec<&ProblemResult> = results.iter().filter(|r| r.set == *name).collect();
            SetSummary::of(name, &of_name)
        };
        let all: Vec<&ProblemResult> = results.iter().collect();
        Self { sets: names.iter().map(of_set).collect(), all: SetSummary::of("all", &all) }
    }
}

impl SetSummary {
    fn of(name: &str, results: &[&ProblemResult]) -> Self {
        let count = |is: fn(&ProblemResult) -> bool| results.iter().filter(|r| is(r)).count();
        let solved = || results.iter().filter(|r| r.found);
        let values = |of: fn(&ProblemResult) -> Option<f64>| solved().filter_map(|r| of(r)).collect::<Vec<f64>>();
        Self {
            set: name.to_owned(),
            total: results.len(),
            valid: count(|r| r.valid),
            solved: count(|r| r.found),
            proven: count(|r| r.proven),
            planning_us: Statistics::of(values(|r| r.planning_us)),
            simplify_us: Statistics::of(values(|r| r.simplify_us)),
            cost_raw_rad: mean(&values(|r| r.cost_raw_rad)),
            cost_rad: mean(&values(|r| r.cost_rad)),
            duration_s: mean(&values(|r| r.duration_s)),
            line_deviation_m: values(|r| r.line_deviation_m).into_iter().reduce(f64::max),
            line_deviation_rad: values(|r| r.line_deviation_rad).into_iter().reduce(f64::max),
        }
    }
}
