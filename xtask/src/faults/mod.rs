//! `cargo xtask faults`: plants faults one by one; the tests must find each.

mod copy;
mod list;
mod trial;

use std::path::Path;
use std::time::Instant;

use xtask::shell::{self, target_folder};
use xtask::{Failure, call};

use crate::dependents;
use crate::references::References;
use copy::SourceCopy;
use list::Fault;
use trial::{FaultRunner, Outcome};

/// Options of `cargo xtask faults`.
#[derive(Debug, Default, PartialEq)]
pub struct Options {
    only: Vec<String>,
    list: bool,
    check: bool,
}

impl Options {
    /// Reads the words after `faults`.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match *word {
                "--list" => options.list = true,
                "--check" => options.check = true,
                "--only" => options.only.push(words.next().ok_or("`--only` needs the name of a fault")?.to_string()),
                other => return Err(format!("`faults` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

/// Lists the faults, checks the list, or plants the chosen faults.
///
/// # Errors
/// If a fault cannot be planted, does not compile, or is not found.
pub fn run(root: &Path, options: &Options) -> Result<(), Failure> {
    let faults = chosen(list::read(root)?, &options.only)?;
    if options.list {
        for Fault { name, crate_name, why, .. } in &faults {
            println!("{name:<30} {crate_name:<11} {why}");
        }
        return Ok(());
    }
    let problems = unplantable(root, &faults);
    if !problems.is_empty() {
        return Err(Failure::Check(problems.join("\n")));
    }
    if options.check {
        println!("{} faults can be planted", faults.len());
        return Ok(());
    }
    Ok(plant_all(root, &faults)?)
}

/// Lists what is wrong with the list for the sources at `root`; nothing is compiled.
///
/// # Errors
/// If the list cannot be read.
pub fn problems(root: &Path) -> Result<Vec<String>, String> {
    Ok(unplantable(root, &list::read(root)?))
}

fn unplantable(root: &Path, faults: &[Fault]) -> Vec<String> {
    let problem = |fault: &Fault| {
        let source = std::fs::read_to_string(root.join(&fault.file));
        let source = source.map_err(|e| format!("fault `{}`: {}: {e}", fault.name, fault.file));
        source.and_then(|source| fault.planted(&source)).err()
    };
    faults.iter().filter_map(problem).collect()
}

fn chosen(faults: Vec<Fault>, only: &[String]) -> Result<Vec<Fault>, Failure> {
    if let Some(unknown) = only.iter().find(|name| faults.iter().all(|fault| fault.name != **name)) {
        return Err(Failure::Usage(format!("no fault is called `{unknown}`; `faults --list` names them")));
    }
    Ok(faults.into_iter().filter(|fault| only.is_empty() || only.contains(&fault.name)).collect())
}

fn plant_all(root: &Path, faults: &[Fault]) -> Result<(), String> {
    let target = target_folder(root);
    shell::make_folder(&target)?;
    let copy = SourceCopy::new(root, &target.join("faults"))?;
    let runner = FaultRunner {
        root,
        copy: &copy,
        packages: dependents::packages(copy.folder())?,
        env: environment(root, &target.join("faults-build"))?,
    };
    let mut outcomes = Vec::new();
    for (i, fault) in faults.iter().enumerate() {
        println!("\n== {} of {}: {} ({})", i + 1, faults.len(), fault.name, fault.file);
        let started = Instant::now();
        let outcome = runner.search(fault)?;
        println!("{}: {} after {:.0} s", fault.name, outcome.words(&fault.crate_name), started.elapsed().as_secs_f64());
        outcomes.push(outcome);
    }
    println!("\n== the tests that have found a fault, without it");
    runner.confirm(&mut outcomes)?;
    print_table(faults, &outcomes);
    let found = outcomes.iter().filter(|outcome| outcome.is_found()).count();
    println!("\n{found} of {} faults are found", faults.len());
    if found == faults.len() { Ok(()) } else { Err("the tests do not find every fault".into()) }
}

/// Returns variables for cargo and for the tests. The copy is in another folder, so the data folder must be named.
fn environment(root: &Path, build: &Path) -> Result<Vec<(String, String)>, String> {
    let data = call::data_folder(root, None);
    println!("data: {}", data.display());
    let mut env = vec![
        ("CARGO_TARGET_DIR".to_owned(), build.to_string_lossy().into_owned()),
        ("ELBOWROOM_DATA".to_owned(), data.to_string_lossy().into_owned()),
    ];
    // Offline: only references that an earlier run of the suite has installed.
    let references = References::find(root, true)?;
    env.extend(references.environment().map(|(key, value)| (key.to_owned(), value.to_owned())));
    Ok(env)
}

/// Prints the table in the form of the documents.
fn print_table(faults: &[Fault], outcomes: &[Outcome]) {
    println!("\n| fault | crate | found by |\n| --- | --- | --- |");
    for (fault, outcome) in faults.iter().zip(outcomes) {
        println!("| {} | {} | {} |", fault.name, fault.crate_name, outcome.words(&fault.crate_name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let options = Options::parse(&["--only", "a", "--only", "b", "--check"]).unwrap();
        assert_eq!(options, Options { only: vec!["a".into(), "b".into()], list: false, check: true });
        assert!(Options::parse(&["--only"]).is_err());
        assert!(Options::parse(&["--fast"]).is_err());
    }

    #[test]
    fn only_faults_of_the_list_can_be_chosen() {
        let root = call::workspace_root().unwrap();
        let all = list::read(&root).unwrap();
        let first = all[0].name.clone();
        assert_eq!(chosen(all.clone(), &[first]).unwrap(), all[..1]);
        assert!(matches!(chosen(all, &["nothing".into()]), Err(Failure::Usage(_))));
    }
}
