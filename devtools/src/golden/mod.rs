//! `cargo xtask golden`: hashes of many answers, to the bit. Recorded before a change and compared after it, they show that no
//! answer has changed.
//!
//! Nothing hashed depends on time or on the number of threads: equal answers have equal hashes on every run.

mod bounded_engine;
mod digest;
mod hashed_group;
mod options;
mod overrides;
mod parallel;
mod part;
mod plans;
mod problem_files;
mod progress;
mod queries;
mod reason_code;
mod record;

use std::path::Path;
use std::time::Instant;

use hashed_group::HashedGroup;
use options::Options;
use part::Part;
use record::Record;
use xtask::Failure;

/// Hashes the requested parts, prints, writes and compares them; an error if a hash differs from the record.
pub fn run(root: &Path, words: &[&str]) -> Result<(), Failure> {
    let options = Options::parse(words).map_err(Failure::Usage)?;
    let data = xtask::call::data_folder(root, options.data.as_deref());
    let Ok(data) = data.canonicalize() else {
        let missing = format!("no data at {}", data.display());
        if options.against.is_some() || options.out.is_some() {
            return Err(Failure::Check(missing));
        }
        println!("skipped: {missing}");
        return Ok(());
    };
    let before = options.against.as_deref().map(Record::read).transpose()?;
    let mut differences = Vec::new();
    for part in options.parts() {
        let begin = Instant::now();
        let groups = hash(part, root, &data, &options)?;
        print(part, &groups, begin.elapsed().as_secs_f64(), options.json);
        if let Some(file) = &options.out {
            Record::add_to_file(file, part, &groups)?;
        }
        if let Some(before) = &before {
            differences.extend(before.differences(part, &groups));
        }
    }
    if differences.is_empty() {
        return Ok(());
    }
    let lines = differences.join("\n  ");
    Err(Failure::Check(format!("{} groups differ from the record\n  {lines}", differences.len())))
}

/// Returns the groups of a part, sorted by name.
fn hash(part: Part, root: &Path, data: &Path, options: &Options) -> Result<Vec<HashedGroup>, String> {
    let mut groups = match part {
        Part::Queries => queries::groups(root, data, options.rows),
        Part::Overrides => overrides::groups(root, Some(data), options.cells),
        Part::Plans => plans::groups(data, options.seeds),
    }?;
    groups.sort();
    Ok(groups)
}

fn print(part: Part, groups: &[HashedGroup], seconds: f64, json: bool) {
    let total = HashedGroup::total(groups);
    let part = part.name();
    if json {
        for HashedGroup { name, hash, count } in groups {
            println!(r#"{{"part":"{part}","group":"{name}","hash":"{hash}","count":{count}}}"#);
        }
        let HashedGroup { hash, count, .. } = total;
        println!(r#"{{"part":"{part}","total":"{hash}","count":{count},"seconds":{seconds:.1}}}"#);
        return;
    }
    for group in groups {
        println!("{part} {group}");
    }
    println!("{part}: total {} of {} in {seconds:.1} s\n", total.hash, total.count);
}

#[cfg(test)]
mod tests;
