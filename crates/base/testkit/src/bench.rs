//! Arguments, obstacles, clock and tables of programs that `cargo bench` starts.
#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]

use std::path::Path;
use std::time::Instant;

use crate::random::Random;

/// The arguments after the program's name, without the `--bench` that cargo adds.
///
/// Changes the working directory to the root of the workspace, so that relative paths in the arguments start there:
/// cargo starts a bench in the folder of its package.
///
/// # Panics
/// Panics if the workspace in which the program was compiled does not exist any more.
pub fn arguments() -> impl Iterator<Item = String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    std::env::set_current_dir(root).expect("the program was compiled in this workspace");
    std::env::args().skip(1).filter(|argument| argument != "--bench")
}

/// A table that a bench prints, for people and for `cargo xtask scaling`: a line `# TITLE`, a line of names of columns,
/// then rows of numbers. The first column is the size that grows.
#[derive(Debug)]
pub struct GrowthTable(Vec<String>);

impl GrowthTable {
    /// Prints the title and the names of the columns.
    pub fn start(title: &str, columns: &[&str]) -> Self {
        println!("\n# {title}\n{}", columns.join("  "));
        Self(columns.iter().map(ToString::to_string).collect())
    }

    /// Prints a row, in the order of the columns.
    ///
    /// # Panics
    /// Panics if a column has no value, or a value no column.
    pub fn row(&self, values: &[f64]) {
        assert_eq!(values.len(), self.0.len(), "a value for each of {:?}", self.0);
        let widths = self.0.iter().map(|name| name.chars().count());
        let cells: Vec<String> =
            values.iter().zip(widths).map(|(v, width)| format!("{:>width$}", digits(*v))).collect();
        println!("{}", cells.join("  "));
    }
}

/// Formats a whole number as it is, and another with four significant digits.
fn digits(value: f64) -> String {
    let decimals = if value.fract() == 0.0 { 0 } else { (3.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize };
    format!("{value:.decimals$}")
}

/// Places (m) of so many obstacles in a hall around an arm at the origin, ten in a cube of 2 m. The hall grows with their
/// number, up to 6 m high; none is within 0.35 m of the arm's vertical axis.
pub fn hall_places(count: usize) -> Vec<[f64; 3]> {
    const VOLUME_M3: f64 = 0.8;
    const HEIGHT_M: f64 = 6.0;
    const CLEAR_M: f64 = 0.35;
    let volume_m3 = VOLUME_M3 * count as f64;
    let height_m = volume_m3.cbrt().min(HEIGHT_M);
    let side_m = (volume_m3 / height_m).sqrt();
    let mut random = Random(11);
    let mut places = Vec::with_capacity(count);
    while places.len() < count {
        let mut coordinate = |m: f64| random.between(-0.5 * m, 0.5 * m);
        let at = [coordinate(side_m), coordinate(side_m), coordinate(height_m) + 0.5];
        if at[0].hypot(at[1]) >= CLEAR_M {
            places.push(at);
        }
    }
    places
}

/// The value below which this fraction of the values lies. Sorts the values.
///
/// # Panics
/// Panics without values.
pub fn quantile(values: &mut [f64], fraction: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * fraction) as usize]
}

/// A clock that stops while other programs use the processor.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    begin: Instant,
    processor_s: f64,
}

impl Stopwatch {
    /// Starts it.
    pub fn start() -> Self {
        Self { begin: Instant::now(), processor_s: processor_s() }
    }

    /// Seconds since the start: the smaller of wall time and processor time of all threads.
    pub fn seconds(&self) -> f64 {
        (processor_s() - self.processor_s).min(self.begin.elapsed().as_secs_f64())
    }
}

/// Processor time of this process so far, s.
#[cfg(unix)]
fn processor_s() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Unknown: NaN, so that wall time counts.
#[cfg(not(unix))]
fn processor_s() -> f64 {
    f64::NAN
}

/// Least seconds of several calls.
pub fn least_s(calls: usize, mut call: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..calls {
        let watch = Stopwatch::start();
        call();
        least = least.min(watch.seconds());
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_unless_whole() {
        assert_eq!([100_000.0, 0.123_456, 12.345_6, 0.0].map(digits), ["100000", "0.1235", "12.35", "0"]);
    }

    #[test]
    fn a_stopwatch_does_not_count_sleep() {
        // Other tests in this process may use the processor meanwhile.
        let counts_little = || {
            let watch = Stopwatch::start();
            std::thread::sleep(std::time::Duration::from_millis(100));
            watch.seconds() < 0.05
        };
        assert!(!cfg!(unix) || (0..20).any(|_| counts_little()));
    }

    #[test]
    fn half_of_the_values_lie_below_the_median() {
        assert_eq!(quantile(&mut [3.0, 1.0, 2.0], 0.5), 2.0);
    }
}
