//! Comparison of the collision point with Coal: robots of the data in slight contact with themselves, a box and a mesh.
//! Point, triangles, normals and the link nearest to the base must equal those that Coal finds when it checks pair by
//! pair.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use elbowroom_robot::GeometryId;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Detail, Scene, SceneState};

use crate::cross_validation::{self, reference, world};
use xtask::Failure;

/// The script, beside [`reference::SCRIPT`].
const SCRIPT: &[u8] = include_bytes!("coal_contacts.py");

/// Robots without `--only`.
const ROBOTS: [&str; 5] = ["kuka_kr150_2", "abb_irb6650s_125_350", "staubli_tx60l", "fanuc_lrmate200ic5l", "ur5e"];

/// Options of `contacts`.
#[derive(Debug, PartialEq)]
struct Options {
    data: Option<PathBuf>,
    states: usize,
    only: Option<String>,
}

impl Options {
    fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self { data: None, states: elbowroom_testkit::extent::amount(100, 2_500), only: None };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().copied().ok_or(format!("`contacts {word}` needs a value"));
            match *word {
                "--data" => options.data = Some(value()?.into()),
                "--only" => options.only = Some(value()?.into()),
                "--states" => options.states = xtask::call::count("contacts --states", value()?)?,
                other => return Err(format!("`contacts` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

/// Compares every robot; an error if an answer differs.
pub fn run(root: &Path, words: &[&str]) -> Result<(), Failure> {
    let options = Options::parse(words).map_err(Failure::Usage)?;
    let data = xtask::call::data_folder(root, options.data.as_deref());
    let mut robots = world::find(&data);
    robots.retain(|files| match &options.only {
        Some(only) => files.name.contains(only),
        None => ROBOTS.contains(&files.name.as_str()),
    });
    if robots.is_empty() {
        println!("skipped: no data at {}", data.display());
        return Ok(());
    }
    let python = cross_validation::interpreter(root)?;
    let folder = std::env::temp_dir().join(format!("elbowroom-contacts-{}", std::process::id()));
    let compared = compare_all(root, &python, &folder, &robots, options.states);
    let _ = std::fs::remove_dir_all(&folder);
    match compared? {
        0 => Ok(()),
        wrong => Err(Failure::Check(format!("{wrong} answers differ from the reference"))),
    }
}

/// Counts that must be 0.
const WRONG: [&str; 7] = ["comparison", "pair", "link", "triangle", "point", "normal", "sign"];
/// Counts for information.
const COUNTED: [&str; 7] = ["states", "free", "contacts", "several", "contained", "face", "edge"];

fn compare_all(
    root: &Path,
    python: &Path,
    folder: &Path,
    robots: &[world::Files],
    states: usize,
) -> Result<usize, String> {
    println!(
        "{states} states per robot, three of four at the edge of a contact. several: links at different depths collide;\n\
         contained: inside without touching; face, edge: Coal's normal is that of a face that we tell, or of an edge;\n\
         then what differs: contact or none, the pair, the link's depth, the triangle, the point off a surface, a normal\n\
         off its triangle, a normal to the wrong side\n"
    );
    print!("{:<24}", "robot");
    for word in COUNTED.iter().chain(&WRONG) {
        print!(" {word:>9}");
    }
    println!(" {:>9}", "µs");
    let mut wrong = 0;
    for files in robots {
        let robot = world::load(files, true)?;
        let random = world::states(&robot, states);
        let alone = world::scene(&files.name, robot.clone(), Vec::new())?;
        let scene = world::scene(&files.name, robot, world::objects(root, &alone)?)?;
        let states = at_contact(&scene, &random)?;
        let (ours, us) = ours(&scene, &states)?;
        let (tally, why) = query_reference(python, folder, files, &scene, (&states, &ours))?;
        print!("{:<24}", files.name);
        for word in COUNTED.iter().chain(&WRONG) {
            print!(" {:>9}", tally.get(*word).copied().unwrap_or(0));
        }
        println!(" {us:>9.1}");
        for line in why {
            println!("    {line}");
        }
        wrong += WRONG.iter().filter_map(|word| tally.get(*word)).sum::<usize>();
    }
    Ok(wrong)
}

/// Returns states just within a contact, by twelve bisections between a free state and a colliding one. Every fourth
/// state stays as it is.
fn at_contact(scene: &Scene, random: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, String> {
    let mut checker = Checker::new(scene, CheckerOptions::default());
    let mut state = SceneState::new(scene);
    let mut collides = |q: &[f64]| -> Result<bool, String> {
        state.set_q(scene, RobotId(0), q).map_err(|e| e.to_string())?;
        Ok(checker.collides(&state).is_some())
    };
    let (mut free, mut hit): (Option<Vec<f64>>, Option<Vec<f64>>) = (None, None);
    let mut states = Vec::with_capacity(random.len());
    for (i, q) in random.iter().enumerate() {
        if collides(q)? {
            hit = Some(q.clone());
        } else {
            free = Some(q.clone());
        }
        let (Some(mut out), Some(mut within), false) = (free.clone(), hit.clone(), i % 4 == 0) else {
            states.push(q.clone());
            continue;
        };
        for _ in 0..12 {
            let middle: Vec<f64> = out.iter().zip(&within).map(|(a, b)| 0.5 * (a + b)).collect();
            if collides(&middle)? {
                within = middle;
            } else {
                out = middle;
            }
        }
        states.push(within);
    }
    Ok(states)
}

/// Returns a line per state for the script, and the time per query, µs.
fn ours(scene: &Scene, states: &[Vec<f64>]) -> Result<(String, f64), String> {
    let mut first = BTreeMap::new();
    let mut count = 0;
    for geometry in scene.geometries() {
        first.insert(geometry, count);
        count += world::colliders(scene, geometry).len();
    }
    let index = |geometry: GeometryId, collider: usize| first.get(&geometry).copied().unwrap_or(0) + collider;
    let mut checker = Checker::new(scene, CheckerOptions::default());
    let mut state = SceneState::new(scene);
    let mut text = String::new();
    let mut spent = 0.0;
    for q in states {
        state.set_q(scene, RobotId(0), q).map_err(|e| e.to_string())?;
        let started = std::time::Instant::now();
        let found = checker.collision_point(&state, Detail::Exact);
        spent += started.elapsed().as_secs_f64();
        let Some(c) = found else {
            text.push_str("-\n");
            continue;
        };
        let number = |t: Option<u32>| t.map_or(-1, i64::from);
        let (i, j) = (index(c.link, c.collider), index(c.other, c.other_collider));
        let touching = u8::from(c.touching);
        let _ = write!(text, "{i} {j} {} {} {touching}", number(c.triangle), number(c.other_triangle));
        for v in [c.on_link, c.on_other, c.normal, c.other_normal] {
            let _ = write!(text, " {:?} {:?} {:?}", v.x, v.y, v.z);
        }
        text.push('\n');
    }
    Ok((text, spent * 1e6 / states.len().max(1) as f64))
}

type Tally = (BTreeMap<String, usize>, Vec<String>);

fn query_reference(
    python: &Path,
    folder: &Path,
    files: &world::Files,
    scene: &Scene,
    (states, ours): (&[Vec<f64>], &str),
) -> Result<Tally, String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (text, binary, _) = reference::job(&files.urdf, scene, states, &world::by_rule(scene), false)?;
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).map_err(|e| format!("{name}: {e}"));
    write("job.txt", text.as_bytes())?;
    write("job.bin", &binary)?;
    write("ours.txt", ours.as_bytes())?;
    write("pin_coal.py", reference::SCRIPT)?;
    write("coal_contacts.py", SCRIPT)?;
    let output = Command::new(python).arg(folder.join("coal_contacts.py")).arg(folder).output();
    let output = output.map_err(|e| format!("cannot start {}: {e}", python.display()))?;
    if !output.status.success() {
        return Err(format!("{}: the reference failed: {}", files.name, String::from_utf8_lossy(&output.stderr)));
    }
    let (mut tally, mut why) = (BTreeMap::new(), Vec::new());
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        match line.split_once(' ') {
            Some(("!", what)) => why.push(what.to_owned()),
            Some((word, number)) => {
                tally.insert(word.to_owned(), number.parse().map_err(|_| format!("the reference said `{line}`"))?);
            }
            None => return Err(format!("the reference said `{line}`")),
        }
    }
    Ok((tally, why))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let options = Options::parse(&["--data", "x", "--states", "7", "--only", "ur5e"]).unwrap();
        assert_eq!(options, Options { data: Some("x".into()), states: 7, only: Some("ur5e".into()) });
        for words in [&["--states"][..], &["--states", "0"], &["--data"], &["--fast"]] {
            assert!(Options::parse(words).is_err(), "{words:?}");
        }
    }

    /// Uses the example arm, if the reference is installed.
    #[test]
    fn our_own_arm_meets_where_the_reference_says() {
        let root = crate::workspace_root().unwrap();
        let named = std::env::var_os("ELBOWROOM_PYTHON").map(PathBuf::from);
        let Some(python) = named.or_else(|| xtask::python::ready(&root)) else {
            println!("skipped: no Python with pin and numpy in target/venv or ELBOWROOM_PYTHON");
            return;
        };
        let model = root.join("examples/models/rx60b/rx60b");
        let (urdf, srdf) = (model.with_extension("urdf"), Some(model.with_extension("srdf")));
        let files = world::Files { name: "rx60b".into(), urdf, srdf };
        let folder = std::env::temp_dir().join(format!("elbowroom-contacts-test-{}", std::process::id()));
        let compared = compare_all(&root, &python, &folder, &[files], 60);
        let _ = std::fs::remove_dir_all(&folder);
        assert_eq!(compared.unwrap(), 0);
    }
}
