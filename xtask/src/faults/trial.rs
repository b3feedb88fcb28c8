//! Trial of one fault: runs the tests of its crate, then the tests of the crates that depend on it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

use toml::Value;
use xtask::crates::{self, GROUPS};

use super::copy::SourceCopy;
use super::list::Fault;
use crate::dependents::{Package, dependents};
use crate::test_run::{self, FirstFailure};

/// Longest time of a unit of tests; a unit that takes longer hangs, and the fault is found.
const LONGEST: Duration = Duration::from_mins(5);

/// Result of the tests for a fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// A test of this package failed.
    Found { package: String, failure: FirstFailure },
    /// All tests passed.
    NotFound,
    /// The list is wrong: the fault does not compile.
    DoesNotCompile { package: String },
    /// The list is right, but the test fails without the fault too.
    FailsWithout { failure: FirstFailure },
}

impl Outcome {
    /// Whether the tests have found the fault.
    pub fn is_found(&self) -> bool {
        matches!(self, Self::Found { .. })
    }

    /// Describes the outcome for the table.
    pub fn words(&self, crate_name: &str) -> String {
        match self {
            Self::Found { package, failure } => {
                let beyond =
                    if *package == crates::package(crate_name) { "" } else { ", not by the crate's own tests" };
                format!("{}{}{beyond}", failure.name(), if failure.hangs { " hangs" } else { "" })
            }
            Self::NotFound => "**not found**".into(),
            Self::DoesNotCompile { package } => format!("**does not compile** ({package})"),
            Self::FailsWithout { failure } => format!("**not known**: {} fails without the fault", failure.name()),
        }
    }
}

/// Data that all trials share.
#[derive(Debug)]
pub struct FaultRunner<'a> {
    /// The root of the workspace, which has the times of earlier test runs.
    pub root: &'a Path,
    /// The copy of its sources.
    pub copy: &'a SourceCopy,
    /// The packages of the copy.
    pub packages: BTreeMap<String, Package>,
    /// Variables for cargo and the tests.
    pub env: Vec<(String, String)>,
}

impl FaultRunner<'_> {
    /// Plants the fault, runs tests until one fails, and removes the fault.
    ///
    /// # Errors
    /// If the fault cannot be planted, or a program does not list its tests.
    pub fn search(&self, fault: &Fault) -> Result<Outcome, String> {
        let _planted = self.copy.plant(fault)?;
        for package in self.nearest_first(&crates::package(&fault.crate_name)) {
            let Ok(programs) = self.compile(&package) else { return Ok(Outcome::DoesNotCompile { package }) };
            let failure = test_run::first_failure(self.root, &programs, &self.variables(), LONGEST)?;
            if let Some(failure) = failure {
                return Ok(Outcome::Found { package, failure });
            }
            println!("{}: not found by the tests of {package}", fault.name);
        }
        Ok(Outcome::NotFound)
    }

    /// Runs each test again that has found a fault, without a fault: a test that fails without the fault too has not
    /// found it.
    ///
    /// # Errors
    /// If the sources do not compile without a fault.
    pub fn confirm(&self, outcomes: &mut [Outcome]) -> Result<(), String> {
        let package_of = |outcome: &Outcome| match outcome {
            Outcome::Found { package, .. } => Some(package.clone()),
            _ => None,
        };
        let packages: BTreeSet<String> = outcomes.iter().filter_map(package_of).collect();
        for package in packages {
            let programs = self.compile(&package)?;
            for outcome in outcomes.iter_mut().filter(|outcome| package_of(outcome).as_ref() == Some(&package)) {
                let Outcome::Found { failure, .. } = outcome else { continue };
                if !test_run::passes(&programs, failure, &self.variables(), LONGEST) {
                    *outcome = Outcome::FailsWithout { failure: failure.clone() };
                }
            }
        }
        Ok(())
    }

    /// Returns the package and all packages that its change can break: the nearest first, at equal distance the lower
    /// layer first.
    fn nearest_first(&self, package: &str) -> Vec<String> {
        let found = dependents(&self.packages, BTreeSet::from([package.to_owned()]));
        let mut found: Vec<(usize, usize, String)> =
            found.into_iter().map(|(package, distance)| (distance, layer(&package), package)).collect();
        found.sort();
        found.into_iter().map(|(_, _, package)| package).collect()
    }

    fn compile(&self, package: &str) -> Result<Vec<test_run::Program>, String> {
        let targets = targets(self.copy.folder(), &self.packages[package]);
        let args: Vec<&str> = ["-p", package].into_iter().chain(targets.iter().map(String::as_str)).collect();
        test_run::compile(self.copy.folder(), &args, &self.variables())
    }

    fn variables(&self) -> Vec<(&str, &str)> {
        self.env.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect()
    }
}

/// Place of a package in the layers; developer tools come last.
fn layer(package: &str) -> usize {
    let layers = GROUPS.iter().flat_map(|(_, crates)| *crates);
    layers.clone().position(|name| crates::package(name) == package).unwrap_or_else(|| layers.count())
}

/// Arguments that choose the tests of a package: its library, its programs, its own test programs.
fn targets(root: &Path, package: &Package) -> Vec<String> {
    let has = |path: &str| PathBuf::from(root).join(&package.folder).join(path).exists();
    let mut words = Vec::new();
    if has("src/lib.rs") {
        words.push("--lib".to_owned());
    }
    if has("src/main.rs") || has("src/bin") {
        words.push("--bins".to_owned());
    }
    let tests = package.manifest.get("test").and_then(Value::as_array).into_iter().flatten();
    for name in tests.filter_map(|test| test.get("name").and_then(Value::as_str)) {
        words.extend(["--test".to_owned(), name.to_owned()]);
    }
    // As in the step `tests` of the suite, with the network.
    if package.manifest.get("features").is_some_and(|features| features.get("live").is_some()) {
        words.extend(["--features".to_owned(), "live".to_owned()]);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lower_layers_come_first_and_tools_last() {
        let order = ["elbowroom-spatial", "elbowroom-proximity", "elbowroom-monitor", "elbowroom-cli", "xtask"];
        assert!(order.map(layer).is_sorted());
    }

    #[test]
    fn the_targets_are_those_that_the_package_has() {
        let root = xtask::call::workspace_root().unwrap();
        let packages = crate::dependents::packages(&root).unwrap();
        let words = |package: &str| targets(&root, &packages[package]).join(" ");
        assert_eq!(words("elbowroom-spatial"), "--lib");
        assert_eq!(words("elbowroom-monitor"), "--lib --test main --test alloc");
        assert_eq!(words("elbowroom-cli"), "--bins --test main --features live");
    }
}
