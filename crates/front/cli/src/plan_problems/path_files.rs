//! Files of timed paths: `SET-ID.csv`.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use elbowroom::kinematics::JointTrajectory;
use elbowroom::query::plan::write_csv;
use elbowroom::query::problems::ProblemResult;

use crate::output::{Failure, cannot_write};
use crate::output_file::write_file;

/// Longest name; longer names are cut, as file systems allow 255 bytes.
const MAX_CHARS: usize = 100;

/// A folder of timed paths.
#[derive(Debug)]
pub(super) struct PathFiles {
    dir: PathBuf,
    names: HashSet<String>,
}

impl PathFiles {
    pub(super) fn create(dir: &Path) -> Result<Self, Failure> {
        std::fs::create_dir_all(dir).map_err(cannot_write(dir))?;
        Ok(Self { dir: dir.to_owned(), names: HashSet::new() })
    }

    /// Writes the motion of a problem.
    pub(super) fn write(
        &mut self,
        of: &ProblemResult,
        joints: &[String],
        motion: &JointTrajectory,
    ) -> Result<(), Failure> {
        let name = self.unused_name(&of.set, &of.id);
        let path = self.dir.join(name);
        write_file(&path, |out| write_csv(joints, motion, out))
    }

    /// Returns `SET-ID.csv`. Characters that could lead to another folder become `_`; a name already used gets a number.
    fn unused_name(&mut self, set: &str, id: &str) -> String {
        let safe = |text: &str| -> String {
            let allowed = |c: char| if c.is_alphanumeric() || "._-+ ".contains(c) { c } else { '_' };
            text.chars().take(MAX_CHARS).map(allowed).collect()
        };
        let stem = format!("{}-{}", safe(set), safe(id)).trim_start_matches('.').to_owned();
        let mut name = format!("{stem}.csv");
        let mut number = 2;
        while !self.names.insert(name.to_lowercase()) {
            name = format!("{stem}-{number}.csv");
            number += 1;
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_the_folder_and_differ() {
        let mut files = PathFiles { dir: PathBuf::new(), names: HashSet::new() };
        assert_eq!(files.unused_name("shelf", "0001"), "shelf-0001.csv");
        assert_eq!(files.unused_name("../..", "/etc/x"), "_..-_etc_x.csv");
        assert_eq!(files.unused_name("a-b", "c"), "a-b-c.csv");
        assert_eq!(files.unused_name("a", "b-C"), "a-b-C-2.csv");
        assert!(files.unused_name(&"x".repeat(5000), "1").len() < 255);
    }
}
