//! Published robots, if the data is available: no robot collides at its start because of links that always touch at a
//! joint.
//!
//! Some robots that differ in kind; all robots with `ELBOWROOM_LONG=1`.

use std::path::PathBuf;

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_robot::{GeometryId, JointContact, JointContactKind, RobotId, joint_contacts};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState};
use elbowroom_testkit::extent::is_long_run;
use elbowroom_testkit::folder;

/// With a pair at the wrist, with pairs between every second link, with loops, with a contact that does not belong to a
/// joint, with fingers, and two without any contact.
const SOME: [&str; 7] =
    ["abb_irb2400", "motoman_motomini", "abb_irb6600_225_255", "fanuc_m900ia260l", "panda", "kuka_kr16_2", "ur5e"];
/// Further robots with pairs and without.
const MORE: [&str; 2] = ["abb_irb4400l_30_243", "staubli_tx60"];

fn robots() -> Vec<PathBuf> {
    let mut robots = folder::robots(&["urdf"]);
    assert!(robots.is_empty() || robots.len() > 30, "only {}", robots.len());
    if !is_long_run() {
        robots.retain(|path| SOME.iter().any(|name| path.ends_with(format!("{name}.urdf"))));
        assert!(robots.is_empty() || robots.len() == SOME.len(), "{robots:?}");
    }
    // Other robots: a folder of URDFs.
    if let Some(more) = std::env::var_os("ELBOWROOM_MORE_ROBOTS") {
        let files = std::fs::read_dir(more).unwrap().map(|entry| entry.unwrap().path());
        robots.extend(files.filter(|file| file.extension().is_some_and(|e| e == "urdf")));
        robots.sort();
    }
    robots
}

/// Pairs in contact at joint values.
fn contacts(scene: &Scene, q: &[f64]) -> Vec<String> {
    let mut state = SceneState::new(scene);
    state.set_q(scene, RobotId(0), q).unwrap();
    let mut found = Vec::new();
    Checker::new(scene, CheckerOptions::default()).contacts(&state, |pair| found.push((pair.a, pair.b)));
    let link = |id: GeometryId| scene.name(id).replace("r/", "");
    found.into_iter().map(|(a, b)| format!("{} - {}", link(a), link(b))).collect()
}

#[test]
fn no_robot_starts_in_contact_because_of_links_that_always_touch_at_a_joint() {
    let mut with_pairs = Vec::new();
    for urdf in robots() {
        let text = format!(
            "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n[robot.r]\nmodel = {:?}\n",
            urdf.to_str().unwrap()
        );
        let cell = Cell::parse(urdf.with_file_name("cell.toml"), &text).unwrap();
        let robot = &cell.robots[0].robot;
        let zero = &cell.robots[0].start;
        let middle: Vec<f64> =
            robot.chain.lower().iter().zip(robot.chain.upper()).map(|(l, u)| 0.5 * (l + u)).collect();
        let middle: Vec<f64> = middle.into_iter().map(|v| if v.is_finite() { v } else { 0.0 }).collect();
        let found = joint_contacts(robot, zero);
        let pair_name = |c: &JointContact| format!("{} - {}", robot.chain.links()[c.a.0], robot.chain.links()[c.b.0]);
        let pairs: Vec<String> = found.iter().map(pair_name).collect();
        let always: Vec<&String> =
            pairs.iter().zip(&found).filter(|(_, c)| c.contacts == c.samples).map(|(n, _)| n).collect();
        let of_cell = QueryModel::of_cell(&cell).scene(OutOfReachProofs::Omit).unwrap();
        let every = QueryModel::without_rules(&cell).scene(OutOfReachProofs::Omit).unwrap();
        let name = urdf.file_stem().unwrap().to_str().unwrap().to_owned();
        println!(
            "{name}: {:?}; else at zero {:?}, in the middle {:?}",
            found.iter().map(|c| format!("{} {:?} {}", pair_name(c), c.kind, c.contacts)).collect::<Vec<_>>(),
            contacts(&of_cell, zero),
            contacts(&of_cell, &middle)
        );
        for q in [zero, &middle] {
            let (left, all) = (contacts(&of_cell, q), contacts(&every, q));
            // The recognised pairs are gone; the other pairs do not change.
            assert!(always.iter().all(|pair| all.contains(pair)), "{name}: {all:?}");
            let others: Vec<&String> = all.iter().filter(|pair| !pairs.contains(pair)).collect();
            assert_eq!(left.iter().collect::<Vec<_>>(), others, "{name}: {all:?}");
        }
        for (pair, c) in pairs.iter().zip(&found) {
            let (a, b) = pair.split_once(" - ").unwrap();
            let share = if c.kind == JointContactKind::Pivot {
                format!("{} of 1000", c.contacts)
            } else {
                "all 1000".to_owned()
            };
            let text = format!("`{a}` and `{b}` touch in {share} states");
            let said = |w: &elbowroom_formats::Diagnostic| w.message.contains(&text);
            assert!(cell.warnings.iter().any(said), "{name}: {:?}", cell.warnings);
        }
        if !pairs.is_empty() {
            with_pairs.push(name);
        }
    }
    if !with_pairs.is_empty() {
        let is_in = |name: &str| with_pairs.iter().any(|n| n == name);
        assert!(
            SOME[..4].iter().all(|name| is_in(name)) && !SOME[4..].iter().any(|name| is_in(name)),
            "{with_pairs:?}"
        );
        assert!(!is_long_run() || (is_in(MORE[0]) && !is_in(MORE[1])), "{with_pairs:?}");
    }
}
