//! Check of planned paths by Coal: random starts and goals on the joint-space map and for real robots, every path
//! checked by Pinocchio and Coal at many points.

mod course;
mod map;
mod reference;
mod robots;

use std::path::{Path, PathBuf};

use xtask::Failure;

use crate::cross_validation;
use course::Course;

/// Options of `paths`.
#[derive(Debug, PartialEq)]
struct Options {
    data: Option<PathBuf>,
    pairs: usize,
    robots: usize,
    points: usize,
    only: Option<String>,
    json: bool,
}

impl Options {
    fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self { data: None, pairs: 1000, robots: 40, points: 10_000, only: None, json: false };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().copied().ok_or(format!("`paths {word}` needs a value"));
            match *word {
                "--json" => options.json = true,
                "--data" => options.data = Some(value()?.into()),
                "--only" => options.only = Some(value()?.into()),
                "--pairs" => options.pairs = xtask::call::count("paths --pairs", value()?)?,
                "--robot-pairs" => options.robots = xtask::call::count("paths --robot-pairs", value()?)?,
                "--points" => options.points = xtask::call::count("paths --points", value()?)?,
                other => return Err(format!("`paths` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

/// Plans and checks; an error if Coal finds a collision.
pub fn run(root: &Path, words: &[&str]) -> Result<(), Failure> {
    let options = Options::parse(words).map_err(Failure::Usage)?;
    let python = cross_validation::interpreter(root)?;
    let folder = std::env::temp_dir().join(format!("elbowroom-paths-{}", std::process::id()));
    let hits = check_all(root, &python, &folder, &options);
    let _ = std::fs::remove_dir_all(&folder);
    match hits? {
        0 => Ok(()),
        hits => Err(Failure::Check(format!("{hits} paths collide"))),
    }
}

/// Counts the paths on which the reference finds a collision.
fn check_all(root: &Path, python: &Path, folder: &Path, options: &Options) -> Result<usize, String> {
    let wanted = |name: &str| options.only.as_ref().is_none_or(|only| name.contains(only.as_str()));
    if !options.json {
        println!("{}", course::HEAD);
    }
    let mut hits = 0;
    let mut check = |course: &Course| -> Result<(), String> {
        let result = reference::check(python, folder, course, options.points)?;
        hits += result.hits;
        println!("{}", if options.json { course.json(&result) } else { course.row(&result) });
        result.first.iter().filter(|_| !options.json).for_each(|first| println!("    {first}"));
        Ok(())
    };
    for (name, obstacles) in elbowroom_planner::example::cells() {
        if wanted(name) {
            check(&map::course(folder, name, &obstacles, options.pairs)?)?;
        }
    }
    let data = xtask::call::data_folder(root, options.data.as_deref());
    let found = cross_validation::world::find(&data);
    if found.is_empty() && !options.json {
        println!("real robots skipped: no data at {}", data.display());
    }
    for files in found.iter().filter(|files| robots::known(&files.name) && wanted(&files.name)) {
        check(&robots::course(files, options.robots)?)?;
    }
    Ok(hits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let options = Options::parse(&["--pairs", "7", "--only", "ur5e", "--json"]).unwrap();
        assert_eq!((options.pairs, options.robots, options.only.as_deref(), options.json), (7, 40, Some("ur5e"), true));
        for words in [&["--pairs"][..], &["--points", "0"], &["--fast"]] {
            assert!(Options::parse(words).is_err(), "{words:?}");
        }
    }

    /// Checks a few paths of the map, and one that goes through a post, with the reference, if it is installed.
    #[test]
    fn the_reference_agrees_and_would_find_a_collision() {
        let root = crate::workspace_root().unwrap();
        let named = std::env::var_os("ELBOWROOM_PYTHON").map(PathBuf::from);
        let Some(python) = named.or_else(|| xtask::python::ready(&root)) else {
            println!("skipped: no Python with pin and numpy in target/venv or ELBOWROOM_PYTHON");
            return;
        };
        let folder = std::env::temp_dir().join(format!("elbowroom-paths-test-{}", std::process::id()));
        let (name, obstacles) = elbowroom_planner::example::cells().swap_remove(1);
        let mut course = map::course(&folder, name, &obstacles, 12).unwrap();
        let free = reference::check(&python, &folder, &course, 500).unwrap();
        // The post is where the arm points half-way.
        let through = [0.0, -0.5].map(|turn| vec![turn, 0.3, 0.2]);
        course.paths.push(course::along(&[through[0].clone(), vec![-1.57, 0.3, 0.2]]));
        let caught = reference::check(&python, &folder, &course, 500).unwrap();
        let _ = std::fs::remove_dir_all(&folder);
        assert_eq!((free.hits, free.points), (0, 500 * (course.paths.len() - 1)));
        assert_eq!(caught.hits, 1, "{:?}", caught.first);
    }
}
