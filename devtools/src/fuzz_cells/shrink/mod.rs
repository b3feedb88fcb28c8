//! Shrinks a failing cell while it fails in the same way.

mod smaller;

use super::oracle::Finding;
use super::spec::CellSpec;
use smaller::candidates;

/// Largest number of runs for shrinking.
const RUNS: usize = 160;

/// Returns the smallest cell found, and the oracle's findings in it.
pub fn smallest(
    spec: &CellSpec,
    finding: &Finding,
    fails: &dyn Fn(&CellSpec) -> Option<Finding>,
) -> (CellSpec, Finding) {
    let (mut best, mut why) = (spec.clone(), finding.clone());
    let mut runs = 0;
    loop {
        let mut shrunk = false;
        for candidate in candidates(&best) {
            if runs >= RUNS {
                return (best, why);
            }
            runs += 1;
            if let Some(found) = fails(&candidate) {
                (best, why, shrunk) = (candidate, found, true);
                break;
            }
        }
        if !shrunk {
            return (best, why);
        }
    }
}
