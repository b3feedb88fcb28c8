//! Units that one worker runs at a time: a module of a crate's integration tests, or a whole program.

use std::collections::BTreeMap;
use std::process::{Command, Stdio};

use super::programs::Program;

/// Tests of one program that run in one process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unit {
    /// Name of the program, with the module if the program is split.
    pub name: String,
    /// Index of the program in the list.
    pub program: usize,
    /// Full names of the tests; empty for all tests of the program.
    pub tests: Vec<String>,
}

/// Splits all programs into units.
///
/// # Errors
/// If a program does not list its tests.
pub fn units(programs: &[Program]) -> Result<Vec<Unit>, String> {
    let mut found = Vec::new();
    for (index, program) in programs.iter().enumerate() {
        if !program.has_harness {
            found.push(Unit { name: program.name.clone(), program: index, tests: Vec::new() });
            continue;
        }
        let listed = Command::new(&program.executable)
            .args(["--list", "--format", "terse"])
            .current_dir(&program.folder)
            .stderr(Stdio::inherit())
            .output()
            .map_err(|e| format!("{}: {e}", program.executable.display()))?;
        if !listed.status.success() {
            return Err(format!("{} does not list its tests", program.name));
        }
        let is_split = program.name.ends_with("/main");
        for (module, tests) in grouped(&String::from_utf8_lossy(&listed.stdout), is_split) {
            let name = if module.is_empty() { program.name.clone() } else { format!("{}/{module}", program.name) };
            found.push(Unit { name, program: index, tests });
        }
    }
    Ok(found)
}

/// Groups the tests that a program lists by their first module if they are to be split, else in one group.
fn grouped(listed: &str, is_split: bool) -> BTreeMap<String, Vec<String>> {
    let mut groups: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for test in listed.lines().filter_map(|line| line.strip_suffix(": test")) {
        let module = test.split_once("::").filter(|_| is_split).map_or("", |(module, _)| module);
        groups.entry(module.to_owned()).or_default().push(test.to_owned());
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn integration_tests_are_split_by_module() {
        let listed = "map::a: test\nrobot_map::b: test\nmap::inner::c: test\nalone: test\nfast: benchmark\n";
        let split = grouped(listed, true);
        assert_eq!(split["map"], ["map::a", "map::inner::c"]);
        assert_eq!(split["robot_map"], ["robot_map::b"]);
        assert_eq!(split[""], ["alone"]);
        assert_eq!(grouped(listed, false).len(), 1);
        assert_eq!(grouped(listed, false)[""].len(), 4);
    }
}
