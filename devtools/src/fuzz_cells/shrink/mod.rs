//! Makes a failing cell smaller while it goes on failing in the same way.

mod smaller;

use super::oracle::Finding;
use super::spec::CellSpec;
use smaller::candidates;

/// Runs that shrinking may take.
const RUNS: usize = 160;

/// The smallest cell found, and what the oracle says of it.
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
