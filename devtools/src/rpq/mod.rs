//! The paper's test of robotic proximity queries (Giralt et al., its figure 3): two RX60B side by side at several
//! distances, an equidistributed set of joint values, time per query by resolution levels, allowed collision matrix and
//! weight matrix.

mod measure;
mod report;
mod sequence;
mod setup;
mod spacing;

use std::path::{Path, PathBuf};

use measure::{Query, Setting};
use spacing::Spacing;
use xtask::Failure;

/// Options of `rpq`.
#[derive(Debug, PartialEq)]
struct Options {
    states: usize,
    out: Option<PathBuf>,
    json: bool,
}

impl Options {
    fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self { states: 5000, out: None, json: false };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().copied().ok_or(format!("`rpq {word}` needs a value"));
            match *word {
                "--json" => options.json = true,
                "--out" => options.out = Some(value()?.into()),
                "--states" => options.states = xtask::call::count("rpq --states", value()?)?,
                other => return Err(format!("`rpq` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

/// Measures, prints, and writes the figures if requested; an error if two settings give different answers.
pub fn run(root: &Path, words: &[&str]) -> Result<(), Failure> {
    let options = Options::parse(words).map_err(Failure::Usage)?;
    let arm = setup::arm(root)?;
    let states = setup::states(&arm, options.states);
    let mut spacings = Vec::new();
    let mut wrong = 0;
    for distance_m in setup::DISTANCES_M {
        eprintln!("{distance_m} m between the bases …");
        let spacing = measure_at(&arm, distance_m, &states)?;
        wrong += measure::disagreements(&spacing.runs);
        spacings.push(spacing);
    }
    if options.json {
        print!("{}", report::json(&spacings));
    } else {
        print!("{}", report::tables(&spacings, setup::triangles(&arm), options.states));
        println!("answers that differ between settings or contradict each other: {wrong}");
    }
    if let Some(folder) = &options.out {
        write(&root.join(folder), &spacings)?;
    }
    if wrong == 0 { Ok(()) } else { Err(Failure::Check(format!("{wrong} answers differ or contradict each other"))) }
}

fn measure_at(arm: &elbowroom_robot::Robot, distance_m: f64, states: &[Vec<f64>]) -> Result<Spacing, String> {
    let scene = setup::scene(arm, distance_m)?;
    let mut runs = Vec::new();
    for query in Query::ALL {
        for setting in Setting::all() {
            runs.push(measure::run(&scene, states, setting, query)?);
        }
    }
    Ok(Spacing { distance_m, pairs: setup::pairs(&scene), runs })
}

fn write(folder: &Path, spacings: &[Spacing]) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, text) in report::figures(spacings) {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let options = Options::parse(&["--states", "9", "--out", "x", "--json"]).unwrap();
        assert_eq!(options, Options { states: 9, out: Some("x".into()), json: true });
        for words in [&["--states"][..], &["--states", "0"], &["--states", "x"], &["--fast"]] {
            assert!(Options::parse(words).is_err(), "{words:?}");
        }
    }
}
