//! Selection of problems by `--only` and `--limit`.

use std::collections::HashMap;
use std::path::Path;

use elbowroom::Diagnostic;
use elbowroom::formats::problem_set::PlanningProblem;
use elbowroom::formats::suggest;

use super::args::ProblemArgs;
use crate::output::Failure;

/// The first problems of the selected sets, in the order of the file.
pub(super) fn select(
    file: &Path,
    problems: Vec<PlanningProblem>,
    args: &ProblemArgs,
) -> Result<Vec<PlanningProblem>, Failure> {
    let mut sets: Vec<&str> = problems.iter().map(|p| p.set.as_str()).collect();
    sets.dedup();
    if let Some(unknown) = args.only.iter().find(|name| !sets.contains(&name.as_str())) {
        let error = Diagnostic::new(file, None, format!("has no set `{unknown}`, which --only names"));
        return Err(error.hint(suggest::hint(unknown, sets.iter().copied())).into());
    }
    let mut taken: HashMap<String, u32> = HashMap::new();
    let mut is_selected = |problem: &PlanningProblem| {
        if !args.only.is_empty() && !args.only.contains(&problem.set) {
            return false;
        }
        let count = taken.entry(problem.set.clone()).or_default();
        *count += 1;
        args.limit.is_none_or(|limit| *count <= limit)
    };
    Ok(problems.into_iter().filter(|p| is_selected(p)).collect())
}
