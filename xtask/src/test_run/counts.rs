//! Numbers of tests.

use std::ops::AddAssign;

/// Numbers of tests that passed, failed, and were left out.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    pub passed: usize,
    pub failed: usize,
    pub ignored: usize,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.ignored += other.ignored;
    }
}

/// Parses the numbers of the harness's last line: `test result: ok. 3 passed; 0 failed; 1 ignored; …`.
pub fn counts(output: &str) -> Option<Counts> {
    let line = output.lines().rev().find(|line| line.starts_with("test result:"))?;
    let number = |what: &str| {
        let before = line.split([';', '.']).find(|part| part.trim().ends_with(what))?;
        before.split_whitespace().next()?.parse().ok()
    };
    Some(Counts { passed: number("passed")?, failed: number("failed")?, ignored: number("ignored")? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_the_harness_is_read() {
        let line = "running 4 tests\ntest result: FAILED. 2 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s\n";
        assert_eq!(counts(line), Some(Counts { passed: 2, failed: 1, ignored: 1 }));
        assert_eq!(counts("thread 'main' has overflowed its stack"), None);
    }
}
