//! Comparison of every robot and cell of the data with Pinocchio and Coal: the same states, triangles and pairs;
//! distances and contacts must be equal. Also compares elbowroom's allowed collision matrix with each SRDF.

mod compare;
pub mod reference;
mod srdf;
pub mod world;

use std::path::{Path, PathBuf};

use compare::Comparison;
use reference::Answers;
use world::Files;
use xtask::{Failure, python};

/// Options of `cross-validate`.
#[derive(Debug, PartialEq)]
struct Options {
    data: Option<PathBuf>,
    states: usize,
    only: Option<String>,
    json: bool,
}

impl Options {
    fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options =
            Self { data: None, states: elbowroom_testkit::extent::amount(200, 10_000), only: None, json: false };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().copied().ok_or(format!("`cross-validate {word}` needs a value"));
            match *word {
                "--json" => options.json = true,
                "--data" => options.data = Some(value()?.into()),
                "--only" => options.only = Some(value()?.into()),
                "--states" => options.states = xtask::call::count("cross-validate --states", value()?)?,
                other => return Err(format!("`cross-validate` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

/// Compares every robot; an error if an answer differs without explanation.
pub fn run(root: &Path, words: &[&str]) -> Result<(), Failure> {
    let options = Options::parse(words).map_err(Failure::Usage)?;
    let data = xtask::call::data_folder(root, options.data.as_deref());
    let mut robots = world::find(&data);
    robots.retain(|files| options.only.as_ref().is_none_or(|only| files.name.contains(only)));
    if robots.is_empty() {
        println!("skipped: no data at {}", data.display());
        return Ok(());
    }
    let python = interpreter(root)?;
    let folder = std::env::temp_dir().join(format!("elbowroom-cross-validate-{}", std::process::id()));
    let wrong = compare_all(root, &python, &folder, &robots, &options);
    let _ = std::fs::remove_dir_all(&folder);
    match wrong? {
        0 => Ok(()),
        wrong => Err(Failure::Check(format!("{wrong} answers differ from the reference"))),
    }
}

/// Returns a Python with Pinocchio and Coal; installs it if necessary.
pub fn interpreter(root: &Path) -> Result<PathBuf, String> {
    if let Some(named) = std::env::var_os("ELBOWROOM_PYTHON") {
        return Ok(named.into());
    }
    if let Some(ready) = python::ready(root) {
        return Ok(ready);
    }
    python::install(root)?;
    python::ready(root).ok_or_else(|| "target/venv is not ready".to_owned())
}

/// Counts states that differ without explanation.
fn compare_all(
    root: &Path,
    python: &Path,
    folder: &Path,
    robots: &[Files],
    options: &Options,
) -> Result<usize, String> {
    if !options.json {
        print_head(options.states);
    }
    let mut wrong = 0;
    for files in robots {
        let robot = world::load(files, true)?;
        let states = world::states(&robot, options.states);
        let alone = world::scene(&files.name, robot.clone(), Vec::new())?;
        let around = world::scene(&files.name, robot, world::objects(root, &alone)?)?;
        let mut before: Option<Answers> = None;
        for (kind, scene) in [("self", &alone), ("objects", &around)] {
            let pairs = world::by_rule(scene);
            if pairs.is_empty() {
                continue;
            }
            let known = before.as_ref().map(|alone| &alone.least[..]);
            let mut theirs = reference::query_reference(python, folder, &files.urdf, scene, &states, &pairs, known)
                .map_err(|e| format!("{}: {e}", files.name))?;
            theirs.bounded_us += before.map_or(0.0, |alone| alone.bounded_us);
            let comparison = compare::compare(scene, &states, &theirs)?;
            wrong += comparison.disagreements;
            print_row(&files.name, kind, &comparison, &theirs, options.json);
            before = Some(theirs);
        }
    }
    if !options.json {
        print_pairs(robots)?;
    }
    Ok(wrong)
}

fn print_head(states: usize) {
    let whole = states.min(reference::WHOLE);
    println!(
        "{states} random states each; µs per state with the robot's move; theirs: Pinocchio + Coal over the first {whole}, \
         without their Python; bounded: the same distance, each pair within the least so far, over all, with their \
         Python; self: links among each other (a cell's own included), objects: with a box and a mesh beside it\n"
    );
    println!(
        "{:<36} {:<8} {:>5} {:>8} {:>9} {:>8} {:>6} {:>8} | distance: {:>7} {:>9} {:>6} {:>9} | collision: {:>6} {:>8} {:>6}",
        "robot",
        "",
        "pairs",
        "contacts",
        "contained",
        "iterated",
        "differ",
        "worst",
        "ours",
        "theirs",
        "ratio",
        "bounded",
        "ours",
        "theirs",
        "ratio"
    );
}

fn print_row(name: &str, kind: &str, v: &Comparison, theirs: &Answers, json: bool) {
    if json {
        println!(
            r#"{{"robot":"{name}","with":"{kind}","states":{},"pairs":{},"contacts":{},"contained":{},"iterated":{},"disagreements":{},"worst_relative":{:e},"distance_us":{:.3},"their_distance_us":{:.3},"their_bounded_us":{:.3},"collide_us":{:.3},"their_collide_us":{:.3}}}"#,
            v.states,
            v.pairs,
            v.contacts,
            v.contained,
            v.iterated,
            v.disagreements,
            v.worst,
            v.distance_us,
            theirs.distance_us,
            theirs.bounded_us,
            v.collide_us,
            theirs.collide_us
        );
        return;
    }
    println!(
        "{name:<36} {kind:<8} {:>5} {:>8} {:>9} {:>8} {:>6} {:>8.1e} | {:>17.1} {:>9.1} {:>6.1} {:>9.1} | {:>17.2} {:>8.1} {:>6.1}",
        v.pairs,
        v.contacts,
        v.contained,
        v.iterated,
        v.disagreements,
        v.worst,
        v.distance_us,
        theirs.distance_us,
        theirs.distance_us / v.distance_us,
        theirs.bounded_us,
        v.collide_us,
        theirs.collide_us,
        theirs.collide_us / v.collide_us,
    );
    for line in &v.first {
        println!("    {line}");
    }
}

fn print_pairs(robots: &[Files]) -> Result<(), String> {
    for files in robots.iter().filter(|files| files.srdf.is_some()) {
        let (plain, with) = (world::load(files, false)?, world::load(files, true)?);
        let comparison = srdf::compare(&files.name, plain, &with.disabled_pairs)?;
        let (equal, different) = (comparison.equal, comparison.different());
        println!("\n### {}: {equal} pairs equal, {different} different\n\n{}", files.name, comparison.table());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let options = Options::parse(&["--data", "x", "--states", "7", "--only", "ur5e", "--json"]).unwrap();
        let expected = Options { data: Some("x".into()), states: 7, only: Some("ur5e".into()), json: true };
        assert_eq!(options, expected);
        for words in [&["--states"][..], &["--states", "0"], &["--data"], &["--fast"]] {
            assert!(Options::parse(words).is_err(), "{words:?}");
        }
    }

    /// Compares a few states of the example arm with the reference, if it is installed.
    #[test]
    fn our_own_arm_agrees_with_the_reference() {
        let root = crate::workspace_root().unwrap();
        let named = std::env::var_os("ELBOWROOM_PYTHON").map(PathBuf::from);
        let Some(python) = named.or_else(|| python::ready(&root)) else {
            println!("skipped: no Python with pin and numpy in target/venv or ELBOWROOM_PYTHON");
            return;
        };
        let model = root.join("examples/models/rx60b/rx60b");
        let (urdf, srdf) = (model.with_extension("urdf"), Some(model.with_extension("srdf")));
        let files = Files { name: "rx60b".into(), urdf, srdf };
        let robot = world::load(&files, true).unwrap();
        let states = world::states(&robot, 20);
        let alone = world::scene("rx60b", robot.clone(), Vec::new()).unwrap();
        let scene = world::scene("rx60b", robot, world::objects(&root, &alone).unwrap()).unwrap();
        let folder = std::env::temp_dir().join(format!("elbowroom-cross-validate-test-{}", std::process::id()));
        let pairs = world::by_rule(&scene);
        let theirs = reference::query_reference(&python, &folder, &files.urdf, &scene, &states, &pairs, None);
        let _ = std::fs::remove_dir_all(&folder);
        let mut theirs = theirs.unwrap();
        let comparison = compare::compare(&scene, &states, &theirs).unwrap();
        assert_eq!(comparison.disagreements, 0, "{:?}", comparison.first);
        assert!(comparison.contacts > 0 && comparison.contacts < 20, "{comparison:?}");
        // A slightly larger error is found: a nanometre per metre is allowed, a missed contact is not.
        let free = theirs.collides.iter().position(|hit| !hit).unwrap();
        theirs.least[free] *= 1.0 + 1e-5;
        let hit = theirs.collides.iter().position(|hit| *hit).unwrap();
        theirs.collides[hit] = false;
        let comparison = compare::compare(&scene, &states, &theirs).unwrap();
        assert_eq!(comparison.disagreements, 2, "{:?}", comparison.first);
    }
}
