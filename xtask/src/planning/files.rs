//! Problems and robot: given, or the Panda of the real data.

use std::path::{Path, PathBuf};

use xtask::call;

use super::options::Options;

/// Files that every planner gets.
pub struct Files {
    problems: PathBuf,
    urdf: PathBuf,
    srdf: Option<PathBuf>,
}

impl Files {
    /// Returns the given files, else the default files beside them; a given URDF without an SRDF has none.
    pub fn find(root: &Path, options: &Options) -> Result<Self, String> {
        let data = call::data_folder(root, None);
        let problems =
            options.problems.clone().unwrap_or_else(|| data.join("problems/mbm_panda/problems_first100.json"));
        let urdf = options.urdf.clone().unwrap_or_else(|| data.join("urdf/panda/panda.urdf"));
        let panda = options.urdf.is_none().then(|| data.join("urdf/panda/panda.srdf"));
        let srdf = options.srdf.clone().or(panda);
        let problems = if options.validity { problems } else { there("--problems", &problems)? };
        let srdf = srdf.map(|file| there("--srdf", &file)).transpose()?;
        Ok(Self { problems, urdf: there("--urdf", &urdf)?, srdf })
    }

    /// Arguments for the Python programs.
    pub fn words(&self, without_problems: bool) -> Vec<String> {
        let problems = Some(("--problems", &self.problems)).filter(|_| !without_problems);
        let srdf = self.srdf.as_ref().map(|file| ("--srdf", file));
        let all = [problems, Some(("--urdf", &self.urdf)), srdf].into_iter().flatten();
        all.flat_map(|(option, file)| [option.to_owned(), file.display().to_string()]).collect()
    }
}

fn there(option: &str, file: &Path) -> Result<PathBuf, String> {
    file.canonicalize().map_err(|e| {
        let hint = format!("give it with `{option} FILE`, or the data's folder in $ELBOWROOM_DATA");
        format!("{}: {e}; {hint}", file.display())
    })
}
