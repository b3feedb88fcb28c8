//! The command as a whole: no arguments, examples, completions, closed pipes, invalid files.

use crate::common::{answer, command, elbowroom, examples, model, swing, with_cell};
use elbowroom_testkit::folder;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

#[test]
fn without_arguments_figure_12_runs_and_writes_its_report() {
    let dir = tempfile::tempdir().unwrap();
    let answer = elbowroom(dir.path(), &[]).expect(0);
    assert!(answer.stdout.contains("before column"), "{}", answer.stdout);
    assert!(answer.stdout.contains("passes through it"), "{}", answer.stdout);
    let report = std::fs::read_to_string(dir.path().join("elbowroom-out/figure12/report.html")).unwrap();
    assert!(report.contains("monitor on") && report.contains("monitor off"));
    // The command that the output proposes works.
    let next = answer.stdout.lines().find_map(|l| l.split_once("elbowroom run ")).expect("says what to type").1;
    let next: Vec<&str> = std::iter::once("run").chain(next.split(' ')).collect();
    elbowroom(dir.path(), &next).expect(0);
}

#[test]
fn examples_are_listed_and_copied_and_own_changes_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let listed = elbowroom(dir.path(), &["example"]).expect(0).stdout;
    for name in ["conveyor", "crate", "exchange", "fence", "figure12", "full_speed", "joint_map", "pallet", "tool_box"]
    {
        assert!(listed.contains(name), "{listed}");
    }
    assert!(!listed.contains("models"), "no cell: {listed}");
    elbowroom(dir.path(), &["example", "mine"]).expect(0);
    elbowroom(dir.path(), &["run", "mine/tool_box/cell.toml"]).expect(0);
    let cell = dir.path().join("mine/figure12/cell.toml");
    std::fs::write(&cell, "# my own").unwrap();
    let again = elbowroom(dir.path(), &["example", "mine"]).expect(0);
    assert!(again.stderr.contains("figure12"), "{}", again.stderr);
    assert_eq!(std::fs::read_to_string(&cell).unwrap(), "# my own");
}

#[test]
fn copied_examples_are_the_ones_in_the_repository() {
    let dir = tempfile::tempdir().unwrap();
    elbowroom(dir.path(), &["example", "."]).expect(0);
    for file in ["exchange/cell.toml", "models/ns16/ns16.urdf", "models/tools/torch.stl"] {
        assert_eq!(std::fs::read(dir.path().join(file)).unwrap(), std::fs::read(examples().join(file)).unwrap());
    }
}

#[test]
fn completions_list_the_verbs() {
    for shell in ["bash", "zsh", "fish"] {
        let script = elbowroom(Path::new("."), &["completions", shell]).expect(0).stdout;
        for verb in ["run", "inspect", "teach", "example"] {
            assert!(script.contains(verb), "{shell} {verb}");
        }
    }
    elbowroom(Path::new("."), &["completions", "cobol"]).expect(2);
}

#[test]
fn help_documents_every_verb() {
    let help = elbowroom(Path::new("."), &["--help"]).expect(0).stdout;
    assert!(help.contains("Exit status") && help.contains("Not a certified safety device."));
    for verb in ["run", "plan", "inspect", "teach", "example", "completions"] {
        assert!(help.contains(verb));
        elbowroom(Path::new("."), &[verb, "--help"]).expect(0);
    }
    assert!(elbowroom(Path::new("."), &["--version"]).expect(0).stdout.starts_with("elbowroom "));
}

/// A reader that closes the pipe causes no failure.
#[test]
fn a_closed_pipe_is_no_failure() {
    let dir = tempfile::tempdir().unwrap();
    let header = "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n";
    let states = header.to_owned() + &"0.1,0.2,0.3,0.4,0.5,0.6\n".repeat(5_000);
    std::fs::write(dir.path().join("q.csv"), states).unwrap();
    let urdf = model("ns16");
    let mut child = command(dir.path(), &["inspect", urdf.to_str().unwrap(), "--states", "q.csv"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = String::new();
    // The reader is dropped, and the pipe with it, after one line of about ten megabytes.
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.starts_with("index,link"));
    answer(child.wait_with_output().unwrap()).expect(0);
}

/// As above, for messages on standard error.
#[cfg(target_os = "linux")]
#[test]
fn messages_into_a_full_device_do_not_panic() {
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let status = command(Path::new("."), &["run", "missing.toml"]).stderr(full()).status().unwrap();
    assert_eq!(status.code(), Some(2));
    let dir = swing();
    let answer = answer(command(dir.path(), &["run", "cell.toml"]).stdout(full()).output().unwrap());
    assert!(answer.expect(2).stderr.contains("standard output"));
}

#[test]
fn invalid_files_are_refused_by_name() {
    let dir = with_cell("");
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).unwrap();
    let noise: Vec<u8> = (0..20_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let models = [
        "noise.stl",
        "noise.urdf",
        "noise.dae",
        "noise.obj",
        "noise.glb",
        "noise.gltf",
        "noise.3ds",
        "noise.wrl",
        "noise.wrz",
        "noise.ply",
        "noise.off",
    ];
    models.iter().chain(&["noise.toml", "noise.csv", "noise"]).for_each(|name| write(name, &noise));
    write("empty.urdf", b"");
    write("empty.stl", b"");
    write("deep.toml", "[".repeat(200_000).as_bytes());
    write("nul.toml", b"version = 1\0");
    write("half.urdf", b"<robot name='r'><link name='a'/><joint name='j' type='revolute'>");
    write(
        "noise.cell.toml",
        b"version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n[robot.r]\nmodel = \"noise.urdf\"\n",
    );
    std::fs::create_dir(dir.path().join("folder")).unwrap();
    let cells =
        ["cell.toml", "noise.toml", "noise.cell.toml", "deep.toml", "nul.toml", "noise", "folder", "missing.toml"];
    for cell in cells {
        let answer = elbowroom(dir.path(), &["run", cell]).expect(2);
        assert_eq!(answer.stdout, "");
        let named = if cell == "noise.cell.toml" { "noise.urdf" } else { cell };
        assert!(answer.stderr.contains(named), "{cell}: {}", answer.stderr);
    }
    for model in models.iter().chain(&["empty.urdf", "empty.stl", "half.urdf", "noise", "folder", "missing.urdf"]) {
        let answer = elbowroom(dir.path(), &["inspect", model]).expect(2);
        assert!(answer.stderr.contains(model), "{model}: {}", answer.stderr);
    }
    let arm = model("ns16");
    for states in ["noise.csv", "folder", "missing.csv"] {
        let answer = elbowroom(dir.path(), &["inspect", arm.to_str().unwrap(), "--states", states]).expect(2);
        assert!(answer.stderr.contains(states), "{states}: {}", answer.stderr);
    }
    // An output folder that cannot be written is an invalid call, too.
    let swing = swing();
    write("file", b"");
    let out = dir.path().join("file/out");
    let answer = elbowroom(swing.path(), &["run", "cell.toml", "--out", out.to_str().unwrap()]).expect(2);
    assert!(answer.stderr.contains("cannot be written"), "{}", answer.stderr);
}

/// Files that broke other programs give a report or an error, never a crash.
#[test]
fn known_broken_files_end_with_a_report_or_an_error() {
    let Some(malformed) = folder::data_part("malformed") else { return };
    let endings = ["urdf", "xml", "stl", "obj", "dae", "gltf", "glb", "3ds", "wrl", "ply", "off"];
    let mut seen = 0;
    for path in folder::files_below(&malformed) {
        if path.extension().is_some_and(|e| endings.iter().any(|known| e.eq_ignore_ascii_case(known))) {
            let answer = elbowroom(Path::new("."), &["inspect", path.to_str().unwrap(), "--json"]);
            assert!(matches!(answer.status, 0 | 2), "{}: {}", path.display(), answer.stderr);
            let answer_status = answer.status;
            let answer = answer.expect(answer_status);
            if answer.status == 0 {
                answer.json();
            } else {
                assert!(answer.stderr.len() > 20, "{}", path.display());
            }
            seen += 1;
        }
    }
    assert!(seen > 10, "only {seen} files");
}
