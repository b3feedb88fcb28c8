//! Every file of the data set either loads or gives a message.

use std::path::Path;
use std::time::Instant;

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_formats::{mesh, srdf};
use elbowroom_proximity::Shape;
use elbowroom_testkit::folder;

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Returns `loaded (…)`, or the message as an error.
fn outcome(path: &Path) -> Result<String, String> {
    let text = |e: elbowroom_formats::Diagnostic| e.to_string();
    match extension(path).as_str() {
        "urdf" => {
            let loaded =
                robot::load(path, &LoadOptions { load_visuals: true, ..LoadOptions::default() }).map_err(text)?;
            let count = |colliders: &[Vec<elbowroom_robot::Collider>]| {
                let meshes = colliders
                    .iter()
                    .flatten()
                    .filter_map(|b| if let Shape::Mesh(m) = &b.shape { Some(m) } else { None });
                meshes.fold((0, 0), |(n, t), m| (n + 1, t + m.triangles().len()))
            };
            let (collision, visual) = (count(&loaded.robot.colliders), count(&loaded.robot.visuals));
            let mut line = format!(
                "{} links, {} dof, collision {} meshes {} triangles, visual {} meshes {} triangles, {} warnings",
                loaded.robot.chain.links().len(),
                loaded.robot.chain.dof(),
                collision.0,
                collision.1,
                visual.0,
                visual.1,
                loaded.warnings.len()
            );
            line.extend(loaded.warnings.iter().map(|w| format!("\n      {w}")));
            Ok(line)
        }
        "srdf" => {
            let srdf = srdf::parse(&std::fs::read(path).unwrap(), path).map_err(text)?;
            Ok(format!("{} disabled pairs, {} warnings", srdf.disabled.len(), srdf.warnings.len()))
        }
        _ => {
            let loaded = mesh::load(path, None).map_err(text)?;
            let triangles: usize = loaded.meshes.iter().map(|m| m.triangles.len()).sum();
            let e = loaded.aabb().extent();
            let mut line = format!(
                "{} meshes, {triangles} triangles, extent {:.6} {:.6} {:.6}, {} warnings",
                loaded.meshes.len(),
                e.x,
                e.y,
                e.z,
                loaded.warnings.len()
            );
            line.extend(loaded.warnings.iter().map(|w| format!("\n      {w}")));
            Ok(line)
        }
    }
}

#[test]
fn every_file_loads_or_gives_a_reason() {
    let Some(data) = folder::data() else { return };
    let skip = ["md", "txt", "yaml", "xml", "mtl", "rob", "octree", ""];
    for directory in ["malformed", "mesh", "urdf", "cell"] {
        for path in folder::files_below(&data.join(directory)) {
            let name = path.strip_prefix(&data).unwrap().display().to_string();
            let is_license = name.contains("LICENSE") || name.contains("METADATA");
            if is_license || (directory != "malformed" && skip.contains(&extension(&path).as_str())) {
                continue;
            }
            let start = Instant::now();
            let outcome = outcome(&path);
            let ms = start.elapsed().as_secs_f64() * 1e3;
            println!(
                "{name}: {} [{ms:.1} ms]",
                match &outcome {
                    Ok(line) => format!("loaded ({line})"),
                    Err(message) => message.clone(),
                }
            );
            if let Err(message) = &outcome {
                let file = path.file_name().unwrap().to_string_lossy().into_owned();
                assert!(message.contains(&file) || message.contains("named in"), "no file in: {message}");
                assert!(message.contains("write:"), "no advice in: {message}");
            }
            assert!(ms < 10_000.0, "{name} took {ms} ms");
        }
    }
}

/// Reads the counts from `triangles collision 6182, visual 0` of a row of SOURCES.md, counted by another library.
fn counted_elsewhere(sources: &str, name: &str) -> Option<(usize, usize)> {
    let row = sources.lines().find(|l| l.starts_with(&format!("| urdf/{name} |")))?;
    let counts = row.split("triangles collision ").nth(1)?;
    let (collision, rest) = counts.split_once(", visual ")?;
    let visual = rest.split(|c: char| !c.is_ascii_digit()).next()?;
    Some((collision.parse().ok()?, visual.parse().ok()?))
}

/// Every robot has as many triangles as another library counts, equally by package and by relative paths, and an SRDF
/// with its links.
#[test]
fn urdf_robots_are_complete() {
    let Some(data) = folder::data() else { return };
    let sources = std::fs::read_to_string(data.join("SOURCES.md")).unwrap_or_default();
    let mut compared = 0;
    for directory in std::fs::read_dir(data.join("urdf")).unwrap().flatten() {
        let name = directory.file_name().to_string_lossy().into_owned();
        let path = directory.path().join(format!("{name}.urdf"));
        let srdf = Some(directory.path().join(format!("{name}.srdf"))).filter(|p| p.exists());
        let options = LoadOptions { load_visuals: true, srdf, ..LoadOptions::default() };
        let loaded = robot::load(&path, &options).unwrap_or_else(|e| panic!("{e}"));
        let triangles = |colliders: &[Vec<elbowroom_robot::Collider>]| -> usize {
            colliders
                .iter()
                .flatten()
                .map(|b| if let Shape::Mesh(m) = &b.shape { m.triangles().len() } else { 0 })
                .sum()
        };
        let counts = (triangles(&loaded.robot.colliders), triangles(&loaded.robot.visuals));
        if let Some(expected) = counted_elsewhere(&sources, &name) {
            assert_eq!(counts, expected, "{name}");
            compared += 1;
        }
        assert!(!loaded.warnings.iter().any(|w| w.message.contains("no link")), "{name}: {:?}", loaded.warnings);
        let by_package = robot::load(&directory.path().join(format!("{name}.package.urdf")), &options);
        if let Ok(by_package) = by_package {
            let again = (triangles(&by_package.robot.colliders), triangles(&by_package.robot.visuals));
            assert_eq!(again, counts, "{name} by package");
        } else {
            assert!(!directory.path().join(format!("{name}.package.urdf")).exists(), "{name}: {by_package:?}");
        }
    }
    assert!(compared > 20, "only {compared} robots were compared");
}
