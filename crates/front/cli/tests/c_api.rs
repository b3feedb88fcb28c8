//! The C interface beside the command: the example in C++ and `query` give equal rows for equal states, to the bit.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{elbowroom, model};
use elbowroom_testkit::compiler;
use elbowroom_testkit::extent::amount;
use elbowroom_testkit::folder::{data_part, workspace};

/// Names of the columns of two arms with six joints, in the example.
const JOINTS: usize = 12;

fn example(mut compiler: Command, name: &str) -> PathBuf {
    let capi = workspace().join("crates/front/capi");
    let program = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    compiler.arg("-I").arg(capi.join("include"));
    let links = compiler::linked("elbowroom_capi");
    compiler::compile(compiler, &capi.join("examples/two_arms.cpp"), &program, &links);
    program
}

/// What the example prints.
fn rows_of(program: &Path, args: &[&str]) -> String {
    let output = Command::new(program).args(args).output().expect("the example starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.contains("us per state"), "{}\n{errors}", output.status);
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Two arms of a model, side by side, with the SRDF beside the model.
fn two_arms(urdf: &Path, metres: f64) -> String {
    let mut cell = "version = 1\nunits = { length = \"m\", angle = \"rad\" }\n".to_owned();
    let srdf = urdf.with_extension("srdf");
    let srdf = if srdf.is_file() { format!("srdf = '{}'\n", srdf.display()) } else { String::new() };
    for (name, y) in [("left", 0.0), ("right", metres)] {
        write!(cell, "[robot.{name}]\nmodel = '{}'\n{srdf}base = {{ at = [0, {y:?}, 0] }}\n", urdf.display())
            .expect("a string");
    }
    cell
}

/// The columns of a row with the bits of its numbers.
fn bits(columns: &[&str]) -> Vec<String> {
    let of =
        |column: &&str| column.parse::<f64>().map_or_else(|_| (*column).to_owned(), |v| format!("{:x}", v.to_bits()));
    columns.iter().map(of).collect()
}

/// Asks the command about the states of the example's rows, and compares. Returns the numbers of rows and of collisions.
fn compare(cell: &str, rows: &str) -> (usize, usize) {
    let dir = tempfile::tempdir().expect("a folder");
    let rows: Vec<Vec<&str>> = rows.lines().map(|line| line.split(',').collect()).collect();
    let states: Vec<String> = rows.iter().map(|columns| columns[..JOINTS].join(",")).collect();
    std::fs::write(dir.path().join("cell.toml"), cell).expect("a cell");
    std::fs::write(dir.path().join("q.csv"), states.join("\n")).expect("states");
    let ask = |what: &str, status: i32| {
        elbowroom(dir.path(), &["query", "cell.toml", "--ask", what, "--states", "q.csv"]).expect(status).stdout
    };
    let (distances, contacts) = (ask("distance", 0), ask("collision", 1));
    let mut colliding = 0;
    let lines = rows.iter().zip(distances.lines()).zip(contacts.lines()).skip(1);
    for ((columns, distance), contact) in lines {
        let distance: Vec<&str> = distance.split(',').collect();
        let contact: Vec<&str> = contact.split(',').collect();
        assert_eq!(bits(&columns[JOINTS..JOINTS + 11]), bits(&distance[1..]), "state {}", distance[0]);
        assert_eq!(columns[JOINTS], contact[1], "state {}", contact[0]);
        assert_eq!(columns[JOINTS + 11..], contact[3..5], "state {}", contact[0]);
        colliding += usize::from(contact[1] == "1");
    }
    assert_eq!((distances.lines().count(), contacts.lines().count()), (rows.len(), rows.len()));
    (rows.len() - 1, colliding)
}

#[test]
fn the_example_in_cpp_prints_the_rows_of_the_command() {
    let Some(compiler) = compiler::cpp() else { return };
    let program = example(compiler, "two_arms");
    // From 1000 states on, the command proves pairs out of reach, as the library does.
    let states = amount(1500, 100_000).to_string();
    let mut urdfs = vec![model("rx60b")];
    if amount(false, true) {
        urdfs.extend(data_part("urdf").map(|folder| folder.join("staubli_tx60/staubli_tx60.urdf")));
    }
    for urdf in urdfs {
        let cell = two_arms(&urdf, 0.7);
        let (rows, colliding) = compare(&cell, &rows_of(&program, &[&urdf.to_string_lossy(), "0.7", &states]));
        println!("{}: {rows} rows are equal, {colliding} collide", urdf.display());
        assert!(
            rows.to_string() == states && colliding > rows / 100 && colliding < rows / 10 * 9,
            "{rows}, {colliding}"
        );
    }
}

#[test]
fn a_cell_has_the_rows_of_the_command_under_sanitizers() {
    let dir = tempfile::tempdir().expect("a folder");
    let Some(compiler) = compiler::cpp().and_then(|cpp| compiler::with_sanitizers(cpp, dir.path())) else { return };
    let program = example(compiler, "two_arms_sanitized");
    let cell = two_arms(&model("rx60b"), 0.5);
    let path = dir.path().join("cell.toml");
    std::fs::write(&path, &cell).expect("a cell");
    let states = amount(1024, 100_000).to_string();
    let (rows, colliding) = compare(&cell, &rows_of(&program, &[&path.to_string_lossy(), &states, "7"]));
    assert!(rows.to_string() == states && colliding > 0, "{rows}, {colliding}");
    let wrong = Command::new(&program).args([dir.path().join("none.toml").to_string_lossy().as_ref(), "5"]).output();
    let wrong = wrong.expect("the example starts");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("none.toml: cannot be read"));
}
